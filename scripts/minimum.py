"""The lowest versions that ``pyproject.toml`` admits, as constraints for pip.

    python scripts/minimum.py test > minimum.txt    # the core and the extra "test"

Only what is named directly is held down; what these packages need themselves is for pip to choose. A
requirement without a lower bound is an error, since nothing could test it.
"""

import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = Path(__file__).parent.parent / "pyproject.toml"
REQUIREMENT = re.compile(r"([A-Za-z0-9_.-]+)(?:\[([^]]+)\])?(?:>=([0-9.]+)(?:,<[0-9.]+)?)?")


def lower_bounds(project: dict, extra: str) -> Iterator[tuple[str, str]]:
    """Name and lowest version of every package that the core and ``extra`` name."""
    waiting = [*project["dependencies"], *project["optional-dependencies"][extra]]
    for requirement in waiting:
        match = REQUIREMENT.fullmatch(requirement)
        if match and match[1] == project["name"]:
            for part in match[2].split(","):
                waiting.extend(project["optional-dependencies"][part])
        elif match and match[3]:
            yield match[1].lower(), match[3]
        else:
            raise SystemExit(f"no lower bound: {requirement}")


def constraints(project: dict, extra: str) -> dict[str, str]:
    """The lowest version of every package that satisfies all its bounds."""
    lowest: dict[str, str] = {}
    for name, version in lower_bounds(project, extra):
        bounds = (lowest.get(name, version), version)
        lowest[name] = max(bounds, key=lambda text: [int(part) for part in text.split(".")])
    return lowest


def main() -> None:
    """Print the constraints for the extra that is named."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    for name, version in constraints(project, sys.argv[1]).items():
        print(f"{name}=={version}")


if __name__ == "__main__":
    main()
