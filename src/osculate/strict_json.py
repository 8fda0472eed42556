"""JSON as the standard has it: every JSON text that this package writes comes from here.

The standard knows no NaN and no infinity; other programs refuse a file that holds them. A number that is
not finite is written as ``null``: it is unknown, or without bound.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def strict_json(value: Any, indent: int | None = None) -> str:
    """A value as JSON text; NaN and infinities become ``null``, NumPy's numbers and arrays plain ones.

    Args:
        value: Mappings, sequences, arrays, numbers, texts and None, nested in any way.
        indent: Spaces for each level; None writes one line.
    """
    return json.dumps(_plain(value), indent=indent, ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
