"""Write the tables of the reality suite into README.md and docs/reality.md (`make tables`).

Every robot, condition and tracker is one task, whose cells are kept under ``build/tables``: a second run
takes what is finished from there. A task is named after everything that decides its numbers: the code
that simulates, the tracker, the robot, the condition, curves, speeds and draws.
"""

import argparse
import ast
import hashlib
import json
import os
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any, NamedTuple

import osculate
from osculate.plant import Mujoco
from osculate.simulation import InitialState
from osculate.study.comparison.compare import Comparison, compare
from osculate.study.comparison.report import OURS
from osculate.study.comparison.significance import condition_table, paired_comparisons, summary
from osculate.study.comparison.suite import CONDITIONS, conditions, curves, starts
from osculate.study.comparison.tuned import trackers_for
from osculate.vehicle import vehicle_named

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = ("paper", "tugger", "forklift")
PAGES = ("README.md", "docs/reality.md")
SHOWS = {"apps", "study"}  # rooms that show results and do not make them
MAKES = "study/comparison/compare.py"
RIVAL = "lqr-preview"


class Task(NamedTuple):
    """One tracker on one robot under one condition."""

    robot: str
    condition: str
    tracker: str
    curves: tuple[str, ...]
    speeds: tuple[float, ...]
    draws: int


def fingerprint() -> str:
    """Of the code that makes numbers; comments, layout and docstrings do not count."""
    package = Path(osculate.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package)
        if name.parts[0] not in SHOWS or name.as_posix() == MAKES:
            tree = ast.parse(path.read_text(encoding="utf-8"))
            digest.update(f"{name.as_posix()} {ast.dump(_bare(tree))}".encode())
    return digest.hexdigest()


def _bare(tree: ast.Module) -> ast.Module:
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [n for n in body if not _is_text(n)]  # type: ignore[attr-defined]
    return tree


def _is_text(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _in_mujoco(condition: str) -> bool:
    return isinstance(CONDITIONS[condition].plant, Mujoco)


def _starts(condition: str) -> dict[str, InitialState]:
    """Where runs begin; those that a fault stops early are counted from the start."""
    return starts(["on-path" if CONDITIONS[condition].safety else "running"])


def place(task: Task, folder: Path, code: str) -> Path:
    """The file of a task's cells."""
    robot = vehicle_named(task.robot)
    specs = [
        trackers_for(robot)[task.tracker], robot,
        *conditions([task.condition], robot=robot).values(), *curves(task.curves).values(),
        *_starts(task.condition).values(),
    ]  # fmt: skip
    text = [code, repr(task), *(spec.model_dump_json() for spec in specs)]
    key = hashlib.sha256("\n".join(text).encode()).hexdigest()[:16]
    return folder / task.robot / task.condition / f"{task.tracker}-{key}.json"


def work(task: Task, target: Path) -> None:
    """Run a task and keep its cells; the file appears whole or not at all."""
    robot = vehicle_named(task.robot)
    chosen = conditions([task.condition], robot=robot)
    found = compare(
        {task.tracker: trackers_for(robot)[task.tracker]},
        curves(task.curves),
        speeds=task.speeds,
        start=_starts(task.condition),
        condition=chosen,
        robot=robot,
        draws=task.draws if chosen[task.condition].seeded else 1,
    )
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps(found.cells), encoding="utf-8")
    part.replace(target)


def finish(places: dict[Task, Path], workers: int) -> None:
    """Run the tasks whose cells are not there yet, the slow ones first."""
    left = [task for task, path in places.items() if not path.is_file()]
    left.sort(key=lambda task: not _in_mujoco(task.condition))
    print(f"{len(places) - len(left)} of {len(places)} tasks are finished already")
    with ProcessPoolExecutor(workers) as pool:
        running = {pool.submit(work, task, places[task]): task for task in left}
        for done, future in enumerate(as_completed(running), 1):
            future.result()
            print(f"{done}/{len(left)} {' '.join(running[future][:3])}", flush=True)


def texts(robot: str, places: dict[Task, Path]) -> Iterator[tuple[str, str]]:
    """Names and texts of the marked parts of one robot: its table, and its rival in words."""
    cells: list[dict[str, Any]] = []
    for task, path in places.items():
        if task.robot == robot:
            cells += json.loads(path.read_text(encoding="utf-8"))
    result = Comparison(cells, {}, {})
    found = paired_comparisons(result, OURS)
    head, *rows = condition_table(result, OURS)
    rule = ["---", *["---:"] * (len(head) - 1)]
    lines = ["| " + " | ".join(row) + " |" for row in (head, rule, *rows)]
    words = summary(found).replace("the controller", f"`{OURS}`")
    yield f"table {robot}", "\n".join([*lines, "", words, *_repeats(robot, places)])
    yield f"rival {robot}", "\n".join(f"- {v.sentence}" for v in found if v.other == RIVAL)


def _repeats(robot: str, places: dict[Task, Path]) -> list[str]:
    """How often runs with random numbers were repeated, if there are any."""
    seeded = {kind for kind, state in conditions(CONDITIONS).items() if state.seeded}
    mine = [task for task in places if task.robot == robot and task.condition in seeded]
    counts = {_in_mujoco(task.condition): task.draws for task in mine}
    words = {False: "outside MuJoCo", True: "in MuJoCo"}
    parts = [f"{words[inside]} {counts[inside]}" for inside in sorted(counts)]
    return [f"Draws of every combination with random numbers: {', '.join(parts)}."] if parts else []


def insert(page: str, name: str, text: str) -> str:
    """The page with the text between its markers, if it has them."""
    marked = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    return marked.sub(lambda match: f"{match[1]}\n{text}\n\n{match[2]}", page)


def _arguments(given: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--conditions", default="", help="by commas; all of the suite by default")
    parser.add_argument("--controllers", default="", help="by commas; all by default")
    parser.add_argument("--curves", default="", help="by commas; all by default")
    parser.add_argument("--speeds", default="0.5,1,2", help="m/s, by commas")
    parser.add_argument("--draws", type=int, default=5, help="of noisy runs; in MuJoCo always 1")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--pages", type=Path, default=ROOT, help="folder of README.md and docs")
    parser.add_argument("--cells", type=Path, default=ROOT / "build" / "tables")
    return parser.parse_args(given)


def _split(text: str) -> list[str]:
    return [part for part in text.split(",") if part]


def main(given: list[str]) -> None:
    """Finish all tasks and write the pages."""
    chosen = _arguments(given)
    speeds = tuple(float(part) for part in _split(chosen.speeds))
    paths = tuple(curves(_split(chosen.curves) or None))
    robots, code = _split(chosen.robots), fingerprint()
    tasks = [
        Task(robot, kind, law, paths, speeds, 1 if _in_mujoco(kind) else chosen.draws)
        for robot in robots
        for kind in conditions(_split(chosen.conditions) or None, "reality")
        for law in _split(chosen.controllers) or trackers_for(vehicle_named(robot))
    ]
    places = {task: place(task, chosen.cells, code) for task in tasks}
    finish(places, chosen.workers)
    for name in PAGES:
        page = chosen.pages / name
        text = page.read_text(encoding="utf-8")
        for robot in robots:
            for mark, part in texts(robot, places):
                text = insert(text, mark, part)
        page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
