"""What counts as a number in a file: decimal digits, nothing that other programs read otherwise."""

import math
import re
from typing import Any

_DECIMAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_STRICT = re.compile(
    r"[+-]?(?:(?:0|[1-9]\d*)(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII
).fullmatch
_LONGEST = 400  # characters of a number


def decimal(cell: str) -> float:
    """The number in a cell of a table.

    Raises:
        ValueError: No decimal number, or too large for one.
    """
    if len(cell) > _LONGEST or not _DECIMAL.fullmatch(cell):
        raise ValueError
    value = float(cell)
    if not math.isfinite(value):
        raise ValueError
    return value


def is_number(cell: str) -> bool:
    """Whether a cell of a table is a decimal number."""
    try:
        decimal(cell)
    except ValueError:
        return False
    return True


def explain_number(cell: Any) -> str:
    """Why something is no number."""
    text = str(cell)
    shown = repr(text if len(text) <= 40 else text[:40] + "…")
    lower = text.strip().lower().lstrip("+-")
    if not text.strip():
        return "is empty"
    if isinstance(cell, float) or lower in (".nan", "nan", "inf", ".inf", "infinity"):
        return f"is {text}, must be finite"
    if re.fullmatch(r"\d+(:\d+)+", lower):
        return f"is {shown}, which is no decimal number (minutes and seconds?)"
    if re.fullmatch(r"0\d+", lower):
        return f"is {shown}; write it without leading zeros (some programs read it as octal)"
    if is_number(text):
        return f"is the text {shown}; write it as a number, without quotes"
    if _DECIMAL.fullmatch(text):
        return f"is {shown}, must be finite"
    return f"is {shown}, no number"


def strict(text: str) -> float | str:
    """A plain scalar of a document as a number, or as it is if it is not plainly a decimal one."""
    return float(text) if _STRICT(text) and len(text) <= _LONGEST else text


def number(value: Any) -> float:
    """A number of a document.

    Raises:
        ValueError: A text, a boolean, nothing, or not finite; says what it is.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            result = float(value)
        except OverflowError:
            result = math.inf
        if math.isfinite(result):
            return result
        value = result
    if value is None or isinstance(value, (bool, dict, list)):
        kinds = {dict: "a mapping", list: "a list", bool: "a truth value", type(None): "empty"}
        raise ValueError(f"is {kinds[type(value)]}, no number")
    raise ValueError(explain_number(value))
