"""How large a run is, before it begins: one sentence instead of a machine that runs out of memory."""

from numbers import Integral

from osculate.errors import InvalidInput
from osculate.simulation.clock import Clock, Sampled
from osculate.target import SpeedPlan

MOST_BYTES = 8e9  # of records and lanes together
PATIENCE = 10.0  # times its plan: no path tracker that arrives takes longer
MOST_SLOTS = 128  # commands on their way; the machine code grows with them


def longest(clock: Clock, plan: SpeedPlan | None) -> float:
    """How long (s) a run may take: its duration, but no path tracker needs many times its plan."""
    if plan is None:
        return clock.duration
    return min(clock.duration, PATIENCE * plan.duration + 60.0)


def require_size(field: str, value: object, numbers: float, what: str) -> None:
    """Refuse to keep more numbers than memory holds.

    Args:
        field: What the user can lower.
        value: Its value.
        numbers: How many numbers would be kept.
        what: What they are, in words.

    Raises:
        InvalidInput: More than `MOST_BYTES`; says how many.
    """
    if not 8.0 * numbers <= MOST_BYTES:
        raise InvalidInput(
            field, value, f"would need {numbers / 1e6:.3g} M numbers ({what}; {8e-9 * numbers:.3g} GB), "
            f"at most {MOST_BYTES / 8e6:g} M fit: make it smaller",
        )  # fmt: skip


def require_whole(field: str, value: object, least: int, most: int | None = None) -> None:
    """Refuse what is no whole number, too small or too large.

    Raises:
        InvalidInput: Says what would be valid.
    """
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if whole and least <= int(value) and (most is None or int(value) <= most):  # type: ignore[call-overload]
        return
    bound = f"at least {least}" if most is None else f"from {least} to {most}"
    raise InvalidInput(field, value, f"must be {bound}, a whole number")


def require_callable(report: object) -> None:
    """Refuse what cannot be told how far a run is.

    Raises:
        InvalidInput: Neither None nor a function.
    """
    if report is not None and not callable(report):
        raise InvalidInput("report", report, "must be a function of the fraction that is done")


def require_slots(clock: Clock, added: float) -> None:
    """Refuse a delay of more commands than are kept on their way.

    Args:
        clock: The clock, with its delay.
        added: Delay (s) from elsewhere, such as a fault's.

    Raises:
        InvalidInput: More than `MOST_SLOTS` of them.
    """
    if not isinstance(clock, Sampled):
        return
    slots = (clock.delay + clock.unknown_delay + added) / clock.period
    if slots > MOST_SLOTS:
        raise InvalidInput(
            "clock.delay", clock.delay, f"would keep {slots:.4g} commands on their way, at most "
            f"{MOST_SLOTS}: must be at most {MOST_SLOTS * clock.period:g} s with this period",
        )  # fmt: skip
