"""Every error osculate raises on purpose derives from `OsculateError`.

An error names the field, the value it had and what would be valid, so that the reader knows what
to change without opening the source.
"""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, TypeVar

T = TypeVar("T")
LONGEST = 400  # characters of a value in a message


class OsculateError(Exception):
    """Base of all errors raised by osculate."""


class InvalidInput(OsculateError, ValueError):
    """A field has a value that cannot be used.

    Attributes:
        field: Dotted name of the field, as written in Python and in a scenario file.
        value: The offending value.
        valid: What would be accepted, in words.
    """

    def __init__(self, field: str, value: object, valid: str) -> None:
        super().__init__(f"{field} = {_shown(value)}: {valid}")
        self.field = field
        self.value = value
        self.valid = valid


def _shown(value: object) -> str:
    """A value as it is written, without the middle of a long one."""
    written = repr(value)
    if len(written) <= LONGEST:
        return written
    return f"{written[: LONGEST // 2]} … {written[-LONGEST // 2 :]}"


class InvalidScenario(OsculateError, ValueError):
    """Several fields of one object or file are wrong; lists every one of them."""

    def __init__(self, problems: list[InvalidInput]) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems


def require_kind(field: str, value: object, kind: type) -> None:
    """Refuse a part that is of another kind than its place.

    Raises:
        InvalidInput: Names the kind.
    """
    if not isinstance(value, kind):
        raise InvalidInput(field, value, f"must be a {kind.__name__}")


def uncomputable(field: str, value: object, error: Exception) -> InvalidInput:
    """What is said of values with which arithmetic fails: no number is that large or that small."""
    message = f"is too large, too small or too unequal to compute with ({error})"
    return InvalidInput(field, value, message)


def choose(field: str, name: str, known: Mapping[str, T]) -> T:
    """What ``name`` stands for among ``known``.

    Raises:
        InvalidInput: Unknown; lists the names.
    """
    if name not in known:
        raise InvalidInput(field, name, f"must be one of {', '.join(known)}")
    return known[name]


class NoSolution(OsculateError, ValueError):
    """The problem as posed has no solution; the message says which condition fails and by how much."""


class MissingExtra(OsculateError, ImportError):
    """An optional dependency is not installed; the message is the command that installs it."""

    def __init__(self, extra: str, package: str) -> None:
        super().__init__(
            f"{package} is not installed; install it with: pip install 'osculate[{extra}]'"
        )
        self.extra = extra


def import_extra(module: str, extra: str, package: str) -> Any:
    """A module of an optional package.

    Raises:
        MissingExtra: It is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise MissingExtra(extra, package) from None


class NotWritten(OsculateError):
    """Some of the files that belong together could not be written; the others are there.

    Attributes:
        place: The folder, or what the files are for.
        missing: Name of every missing file, and the error that kept it from being written.
    """

    def __init__(self, place: str, missing: Mapping[str, Exception]) -> None:
        each = "; ".join(f"{name} is missing ({_reason(e)})" for name, e in missing.items())
        super().__init__(f"{place} is not complete: {each}")
        self.place, self.missing = place, dict(missing)


def _reason(error: Exception) -> str:
    return str(error) if isinstance(error, (OsculateError, OSError)) else repr(error)
