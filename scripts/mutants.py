"""Do the tests bite? Changes one thing in the code at a time and asks whether some test fails.

    make mutants                                   # control, target, curve and plant: hours
    .venv/bin/python scripts/mutants.py --room target --count 20

Mutants are drawn at random (``--seed``) from all places of a room: signs, operators, comparisons, numbers,
branches. Each is tried in a copy of the checkout with the tests in `TESTS`, one by one. Survivors
are printed with their place; those judged to change nothing that matters stand in ``mutants.txt``, one a
line, as printed but without the line's number and with the reason behind, and do not count. The exit status
is 1 where fewer than 85 % of a room's mutants are killed.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parent.parent
JUDGED = Path(__file__).with_suffix(".txt")
WANTED = 0.85
PATIENCE = 900.0  # s, after which the tests of a mutant run in circles: killed

#: What runs for a room, most telling first.
TESTS = {
    "control": ("tests/control", "tests/simulation/test_run.py", "tests/study/test_paper.py"),
    "target": ("tests/target", "tests/simulation/test_run.py", "tests/study/test_paper.py"),
    "curve": ("tests/curve", "tests/simulation/test_run.py"),
    "plant": ("tests/plant", "tests/simulation/test_run.py", "tests/study/test_paper.py"),
    "kernel": ("tests/kernel", "tests/simulation/test_batch.py"),
    "vehicle": ("tests/vehicle", "tests/plant", "tests/simulation/test_run.py"),
}

OPERATORS: dict[type, type] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip
NAMES = {"min": "max", "max": "min", "sin": "cos", "cos": "sin", "minimum": "maximum"}


def mutations(tree: ast.Module) -> Iterator[tuple[ast.AST, str, object]]:
    """Every single change: a node, its attribute, and the attribute's other value."""
    for node in _code(tree):
        if isinstance(node, (ast.BinOp, ast.BoolOp)) and type(node.op) in OPERATORS:
            yield node, "op", OPERATORS[type(node.op)]()
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in OPERATORS:
            yield node, "ops", [OPERATORS[type(node.ops[0])](), *node.ops[1:]]
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield node, "op", ast.UAdd()
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield (
                node,
                "value",
                node.value + 1 if type(node.value) is int else 1.5 * node.value + 0.5,
            )
        elif isinstance(node, ast.Name) and node.id in NAMES:
            yield node, "id", NAMES[node.id]
        elif isinstance(node, ast.IfExp):
            yield node, "test", ast.UnaryOp(ast.Not(), node.test)
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "select":
            yield node, "args", [node.args[0], node.args[2], node.args[1]]


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes that run: no annotations, no decorators, nothing for type checkers."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            checked = isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING"
            if isinstance(child, ast.AST) and not checked:
                yield from _code(child)


def mutated(source: str, number: int) -> tuple[str, int, str]:
    """The source with its change ``number``, the line's number, and what was changed, in words."""
    tree = ast.parse(source)
    statements = [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]
    node, attribute, value = list(mutations(tree))[number]
    inside = [s for s in statements if s.lineno <= node.lineno <= (s.end_lineno or s.lineno)]
    innermost = min(inside, key=lambda s: (s.end_lineno or s.lineno) - s.lineno)
    before = ast.unparse(node)
    setattr(node, attribute, value)
    after, line = ast.unparse(node), ast.unparse(innermost).splitlines()[0]
    return ast.unparse(tree), node.lineno, f"{before} → {after}, in: {line}"


def survives(copy: Path, room: str) -> bool:
    """Whether all tests of a room pass in the copy."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(copy / "src"),
        "OSCULATE_CACHE_DIR": str(copy / "machine-code"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *TESTS[room]]
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def try_room(copy: Path, room: str, count: int, seed: int) -> bool:
    """Try mutants of one room; whether enough of them are killed."""
    files = sorted((ROOT / "src" / "osculate" / room).rglob("*.py"))
    places = [
        (file.relative_to(ROOT), number)
        for file in files
        for number in range(len(list(mutations(ast.parse(file.read_text(encoding="utf-8"))))))
    ]
    chosen = random.Random(seed).sample(places, min(count or len(places), len(places)))
    judged = JUDGED.read_text(encoding="utf-8").splitlines() if JUDGED.exists() else []
    if not survives(copy, room):
        raise SystemExit(f"the tests of {room} fail without any mutant")
    tried = killed = 0
    for file, number in chosen:
        source = (ROOT / file).read_text(encoding="utf-8")
        text, line, change = mutated(source, number)
        if any(known.startswith(f"{file.as_posix()}: {change}") for known in judged):
            continue
        (copy / file).write_text(text, encoding="utf-8")
        alive = survives(copy, room)
        (copy / file).write_text(source, encoding="utf-8")
        tried, killed = tried + 1, killed + (not alive)
        verdict = "survived" if alive else "killed"
        print(f"{verdict:8} {file.as_posix()}:{line}: {change}", flush=True)
    print(f"{room}: {killed} of {tried} killed, drawn from {len(places)} places", flush=True)
    return killed >= WANTED * tried


def main() -> None:
    """Copy the checkout, then try mutants room by room."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    rooms = ["control", "target", "curve", "plant"]
    parser.add_argument("--room", choices=TESTS, action="append", help="by default the four")
    parser.add_argument("--count", type=int, default=40, help="mutants of a room; 0 tries all")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("src", "tests", "examples", "docs"):
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md"):
            shutil.copy(ROOT / name, copy)
        enough = [try_room(copy, r, options.count, options.seed) for r in options.room or rooms]
    sys.exit(0 if all(enough) else 1)


if __name__ == "__main__":
    main()
