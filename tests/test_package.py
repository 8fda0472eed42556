"""What users get: the public names, and a wheel that holds the package and nothing else."""

import importlib
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.core

ROOT = Path(__file__).parent.parent
NAMES = Path(__file__).with_name("public_names.txt")
MODULES = (
    "osculate",
    *(
        f"osculate.{room}"
        for room in (
            "kernel", "vehicle", "scene", "curve", "target", "control", "plant", "simulation", "study",
        )
    ),
)  # fmt: skip


def public_names():
    for module in MODULES:
        for name in importlib.import_module(module).__all__:
            yield f"{module}.{name}"


def test_the_public_names_are_those_that_are_listed():
    now, listed = set(public_names()), set(NAMES.read_text(encoding="utf-8").split())
    assert now == listed, (
        f"new: {sorted(now - listed)}; gone: {sorted(listed - now)}. Users depend on them: say so in "
        f"CHANGELOG.md and put them into {NAMES.name} (python {Path(__file__).name} writes it)"
    )


def test_public_names_are_said_once():
    for module in MODULES:
        names = importlib.import_module(module).__all__
        assert len(set(names)) == len(names), module


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    builder = pytest.importorskip("hatchling.builders.wheel", reason="hatchling builds the wheel")
    folder = str(tmp_path_factory.mktemp("wheel"))
    (path,) = builder.WheelBuilder(str(ROOT)).build(directory=folder, versions=["standard"])
    with zipfile.ZipFile(path) as archive:
        yield archive


def test_the_wheel_holds_the_package_and_nothing_else(wheel):
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "src/osculate"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        pytest.skip("not a git checkout")
    source = {
        name.removeprefix("src/") for name in listed.stdout.split() if (ROOT / name).is_file()
    }
    packed = set(wheel.namelist())
    information = {name for name in packed if name.partition("/")[0].endswith(".dist-info")}
    assert packed - information == source
    assert {Path(name).name for name in information} >= {
        "METADATA",
        "RECORD",
        "LICENSE",
        "entry_points.txt",
    }
    for name in source:
        assert wheel.read(name) == (ROOT / "src" / name).read_bytes(), name


def test_the_unpacked_wheel_works(wheel, tmp_path):
    wheel.extractall(tmp_path)
    code = (
        "import osculate, osculate.study.scenario as s; print(osculate.__file__); "
        "[s.Scenario.load(name) for name in s.built_in()]; print(len(s.built_in()))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    place, count = done.stdout.split()
    assert Path(place).is_relative_to(tmp_path)
    assert int(count) == len(
        list((ROOT / "src" / "osculate" / "study" / "scenarios").glob("*.yaml"))
    )


if __name__ == "__main__":
    NAMES.write_text("\n".join(sorted(public_names())) + "\n", encoding="utf-8")
