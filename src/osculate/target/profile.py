"""Profiles ϕ(t): how far along its path a target wants to be, and when, eqs (22)–(23).

A profile is a progress of arc length (m) for targets that prescribe the speed, and a progress of
heading (rad) for the modified target, which prescribes the yaw rate.
"""

import math
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from osculate.curve.contract import Curve
from osculate.curve.cycloid import Cycloid
from osculate.errors import InvalidInput
from osculate.kernel import Grid, Tables, hermite, kernel, locate, lookup
from osculate.kernel.maths import exp
from osculate.spec import Spec, quantity

CELLS = 4096  # resolution of tabulated profiles
FADED = 45.0  # x at which x e^{−x} has fallen below the precision of doubles


class Pace(NamedTuple):
    """A profile at one time; progress is an arc length (m) or a heading (rad)."""

    progress: Any  # ϕ; floats in kernels, arrays of one shape elsewhere
    rate: Any  # ϕ̇, per s
    acceleration: Any  # ϕ̈, per s²


@dataclass(frozen=True)
class PacePart:
    """A profile ready to run."""

    pace: Any  # kernel (t, parameters, tables) -> Pace
    parameters: NamedTuple
    sample: Callable[[NDArray[np.float64]], Pace]  # the same for arrays of times
    horizon: float  # s, after which nothing moves any more to double precision
    duration: float = math.inf  # s, when the profile is complete


class ExponentialPace(NamedTuple):
    """Parameters of `exponential_pace`."""

    amplitude: float  # ∫ϕ̇ dt, m or rad
    decay: float  # 1/s, γ


class TabulatedPace(NamedTuple):
    """Parameters of `tabulated_pace`."""

    grid: Grid
    duration: float  # s


@kernel
def exponential_pace(t: float, p: ExponentialPace, tables: NDArray[np.float64]) -> Pace:
    """ϕ̇ = A γ² t e^{−γt}: starts and ends at rest, eq. (23)."""
    x = p.decay * t
    fading = exp(-x)
    return Pace(
        p.amplitude * (1.0 - (1.0 + x) * fading),
        p.amplitude * p.decay * x * fading,
        p.amplitude * p.decay * p.decay * (1.0 - x) * fading,
    )


@kernel
def tabulated_pace(t: float, p: TabulatedPace, tables: NDArray[np.float64]) -> Pace:
    """A profile from a table with the columns (ϕ, ϕ̇, ϕ̈); it stands still after its end."""
    over = t > p.duration
    row, f = locate(p.duration if over else t, p.grid, 3)
    progress, _ = hermite(
        f,
        p.grid,
        lookup(tables, row),
        lookup(tables, row + 1),
        lookup(tables, row + 3),
        lookup(tables, row + 4),
    )
    rate, acceleration = hermite(
        f,
        p.grid,
        lookup(tables, row + 1),
        lookup(tables, row + 2),
        lookup(tables, row + 4),
        lookup(tables, row + 5),
    )
    return Pace(progress, rate, 0.0 if over else acceleration)


class Profile(Spec):
    """A progress over time."""

    @abstractmethod
    def part(
        self, whole: float, curve: Curve, tables: Tables, *, heading: bool = False
    ) -> PacePart:
        """Kernel and parameters.

        Args:
            whole: Progress (m or rad) that completes the curve.
            curve: Where to drive.
            tables: Where tables go.
            heading: Whether it is a progress of heading (rad) instead of arc length (m).
        """


class Exponential(Profile):
    """ϕ̇ = A γ² t e^{−γt}, eq. (23): smooth from rest to rest, reaching its end asymptotically.

    With the default amplitude the profile covers exactly the whole curve: A = l for an arc length,
    A = the curve's total turn for the modified target.
    """

    kind: Literal["exponential"] = "exponential"
    decay: float = quantity(
        "1/s", "decay rate γ; the peak is at t = 1/γ", default=0.5, gt=0, le=1e6
    )
    amplitude: float | None = quantity(
        "m or rad", "∫ϕ̇ dt; by default what completes the curve", default=None
    )

    def part(
        self, whole: float, curve: Curve, tables: Tables, *, heading: bool = False
    ) -> PacePart:
        """See `Profile.part`."""
        amplitude = whole if self.amplitude is None else self.amplitude
        decay = self.decay

        def sample(t: NDArray[np.float64]) -> Pace:
            x, fading = decay * t, np.exp(-decay * t)
            return Pace(
                amplitude * (1.0 - (1.0 + x) * fading),
                amplitude * decay * x * fading,
                amplitude * decay**2 * (1.0 - x) * fading,
            )

        parameters = ExponentialPace(amplitude, decay)
        return PacePart(exponential_pace, parameters, sample, FADED / decay)


class Natural(Profile):
    """The curve's own parameter at constant rate, as in eqs (21) and (51); only for the cycloid."""

    kind: Literal["natural"] = "natural"
    rate: float = quantity("rad/s", "rate of the curve's parameter, μ", default=1.0, gt=0)

    def part(
        self, whole: float, curve: Curve, tables: Tables, *, heading: bool = False
    ) -> PacePart:
        """See `Profile.part`."""
        if not isinstance(curve, Cycloid):
            raise InvalidInput(
                "profile.kind",
                self.kind,
                "needs a curve with a parameter of its own (cycloid); use exponential or sampled",
            )
        duration = float(curve.parameter(curve.length)) / self.rate
        t = np.linspace(0.0, duration, CELLS + 1)
        half = (self.rate * t + curve.truncation) / 2.0
        lengths = [
            curve.arc_length(self.rate * t),
            2.0 * curve.radius * self.rate * np.sin(half),
            curve.radius * self.rate**2 * np.cos(half),
        ]
        turn = whole / duration  # a cycloid's heading is linear in its parameter
        turns = [turn * t, np.full(len(t), turn), np.zeros(len(t))]
        columns = turns if heading else lengths
        return _tabulated(np.stack(columns, axis=1), duration, tables)


class SampledProfile(Profile):
    """A profile of the user's own: ϕ̇ at given times, joined by a cubic spline.

    `SampledProfile.of` samples any Python function. The rate after the last time is the last one.
    """

    kind: Literal["sampled"] = "sampled"
    times: tuple[float, ...] = quantity("s", "increasing times, the first 0")
    rates: tuple[float, ...] = quantity("m/s or rad/s", "ϕ̇ at these times")

    @classmethod
    def of(
        cls, rate: Callable[[float], float], duration: float, samples: int = 513
    ) -> "SampledProfile":
        """Sample the function ``rate(t)`` (m/s or rad/s) at ``samples`` times up to ``duration``."""
        if not duration > 0:
            raise InvalidInput("duration", duration, "must be greater than 0 (s)")
        times = np.linspace(0.0, duration, samples)
        return cls(times=tuple(times.tolist()), rates=tuple(float(rate(t)) for t in times))

    @field_validator("times")
    @classmethod
    def _increasing(cls, times: tuple[float, ...]) -> tuple[float, ...]:
        if len(times) < 2 or times[0] != 0.0 or not (np.diff(times) > 0).all():
            raise ValueError("must be at least two increasing times starting at 0")
        return times

    @model_validator(mode="after")
    def _one_rate_each(self) -> "SampledProfile":
        if len(self.rates) != len(self.times) or not np.isfinite(self.rates).all():
            raise InvalidInput("rates", self.rates, "must hold one finite rate for every time")
        return self

    def part(
        self, whole: float, curve: Curve, tables: Tables, *, heading: bool = False
    ) -> PacePart:
        """See `Profile.part`; ``whole`` is ignored, the samples say how far the profile goes."""
        spline = _spline(self.times, self.rates)
        duration = self.times[-1]
        t = np.linspace(0.0, duration, CELLS + 1)
        columns = [spline.antiderivative()(t), spline(t), spline.derivative()(t)]
        return _tabulated(np.stack(columns, axis=1), duration, tables)


def _spline(x: Any, y: Any) -> Any:
    from scipy.interpolate import CubicSpline  # a fifth of the package's start-up time

    return CubicSpline(x, y)


def _tabulated(rows: NDArray[np.float64], duration: float, tables: Tables) -> PacePart:
    grid = tables.add(rows, 0.0, duration / (len(rows) - 1))
    progress = _spline(np.linspace(0.0, duration, len(rows)), rows)

    def sample(t: NDArray[np.float64]) -> Pace:
        columns = progress(np.minimum(t, duration))
        return Pace(columns[:, 0], columns[:, 1], np.where(t > duration, 0.0, columns[:, 2]))

    return PacePart(tabulated_pace, TabulatedPace(grid, duration), sample, duration, duration)


AnyProfile = Annotated[Exponential | Natural | SampledProfile, Field(discriminator="kind")]
