"""What comparison and tuning can be asked for: everything that is given has an effect or is refused."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Real
from typing import TypeVar

from osculate.errors import InvalidInput, require_kind
from osculate.simulation.size import require_whole
from osculate.study.comparison.suite import Condition
from osculate.target import Limits

T = TypeVar("T")


def require_named(
    field: str, given: Mapping[str, T] | None, kind: type, usual: Callable[[], Mapping[str, T]]
) -> dict[str, T]:
    """What is given by name, or what is usual.

    Raises:
        InvalidInput: Nothing, or something of another kind.
    """
    chosen = usual() if given is None else given
    if not isinstance(chosen, Mapping) or not chosen:
        raise InvalidInput(field, chosen, f"must have at least one {kind.__name__} by its name")
    for name, value in chosen.items():
        require_kind(f"{field}[{name!r}]", value, kind)
    return dict(chosen)


def require_speeds(speeds: Sequence[float]) -> None:
    """Refuse speeds that nobody can drive at.

    Raises:
        InvalidInput: None at all, or one that is not positive and finite.
    """
    given = list(speeds) if isinstance(speeds, Iterable) else []
    if not given or not all(isinstance(v, Real) and 0.0 < v < math.inf for v in given):
        raise InvalidInput("speeds", speeds, "must be positive (m/s), at least one")


def require_effect(
    limits: Limits, speeds: Sequence[float], draws: int, states: Mapping[str, Condition]
) -> None:
    """Refuse what would change nothing beside the other arguments.

    Raises:
        InvalidInput: A speed among the limits, draws of what is not random.
    """
    require_speeds(speeds)
    require_whole("draws", draws, 1)
    if draws > 1 and not any(state.seeded for state in states.values()):
        message = "nothing is random under these conditions; must be 1, or add one such as noisy"
        raise InvalidInput("draws", draws, message)
    if "speed" in limits.model_fields_set:
        raise InvalidInput("limits.speed", limits.speed, "give speeds=(...) instead (m/s)")
