"""Rules of the whole project: layers, lightness, and what its files may not name."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import osculate

ROOT = Path(__file__).parent.parent


def test_data_flows_one_way():
    tool = Path(sys.executable).with_name("lint-imports")
    if not tool.exists():
        pytest.skip("import-linter comes with the dev extra")
    done = subprocess.run([tool], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_importing_the_package_loads_nothing_heavy():
    code = "import sys, osculate; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    heavy = {"numpy", "numba", "scipy", "xarray", "matplotlib", "plotly", "sympy", "pydantic"}
    assert heavy.isdisjoint(loaded)


def test_every_public_name_exists_and_is_documented():
    for name in osculate.__all__:
        value = getattr(osculate, name)
        if name != "__version__":
            assert value.__doc__, name
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        osculate.nonsense  # noqa: B018


def test_public_fields_state_unit_and_meaning():
    from osculate.spec import Spec

    for name in osculate.__all__:
        value = getattr(osculate, name)
        if isinstance(value, type) and issubclass(value, Spec):
            for field, info in value.model_fields.items():
                number = info.annotation in (float, int, float | None)
                assert not number or info.description, f"{name}.{field}"


def tracked_files():
    done = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if done.returncode:
        pytest.skip("not a git checkout")
    for name in done.stdout.split():
        path = ROOT / name
        if path.is_file() and path.suffix in {
            ".py",
            ".toml",
            ".txt",
            ".md",
            ".yaml",
            ".yml",
            ".sh",
        }:
            yield name, path.read_text(encoding="utf-8")


def test_no_file_names_a_registry_or_a_machine():
    hosts = re.compile(r"--index-url|--extra-index|pypi\.org/simple|file:///|/home/\w|/work/")
    here = Path(__file__).name
    for name, text in tracked_files():
        assert name.endswith(here) or not hosts.search(text), name


def test_pins_are_versions_only():
    for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines():
        assert re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.+!]+", line), line
