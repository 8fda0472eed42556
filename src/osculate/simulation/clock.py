"""The two clocks: a law integrated together with the plant, or one that decides at instants."""

import math
from abc import abstractmethod
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from osculate.errors import InvalidInput
from osculate.spec import Spec, quantity

RK4_LIMIT = 2.785  # |λ| h beyond which RK4 amplifies a decaying mode
HOLD_LIMIT = 2.0  # |λ| T beyond which a held first-order feedback oscillates out


class Clock(Spec):
    """When the law acts, and how finely the plant is integrated."""

    step: float = quantity("s", "integration step, h", default=1e-3, gt=0)
    duration: float = quantity("s", "end of the run if the path has not ended", default=20.0, gt=0)

    @model_validator(mode="after")
    def _one_step(self) -> Self:
        if self.duration < self.step:
            raise InvalidInput(
                "duration", self.duration, f"must be at least step = {self.step:g} s"
            )
        return self

    @property
    def steps(self) -> int:
        """Number of integration steps that fill the duration."""
        return max(1, round(self.duration / self.step))

    @property
    def substeps(self) -> int:
        """Integration steps between two decisions of the law."""
        return 1

    @property
    def delay_steps(self) -> int:
        """Integration steps between a decision and its effect."""
        return 0

    @abstractmethod
    def check(self, fastest_rate: float) -> None:
        """Refuse a clock too slow for the closed loop's fastest mode (1/s).

        Raises:
            InvalidInput: Says how short the step or period must be.
        """


class Continuous(Clock):
    """Law and plant as one continuous-time system, integrated by RK4: the paper's way."""

    kind: Literal["continuous"] = "continuous"

    def check(self, fastest_rate: float) -> None:
        """See `Clock.check`."""
        if fastest_rate * self.step > RK4_LIMIT:
            raise InvalidInput(
                "clock.step",
                self.step,
                f"too large for the closed loop's fastest rate of {fastest_rate:.4g} 1/s; "
                f"must be below {RK4_LIMIT / fastest_rate:.3g} s (or lower the gains)",
            )


class Sampled(Clock):
    """A law that decides once a period, held in between and acting after a delay: the robot's way."""

    kind: Literal["sampled"] = "sampled"
    period: float = quantity("s", "time between two decisions", default=1e-2, gt=0)
    delay: float = quantity("s", "time from a decision to its effect", default=0.0, ge=0)
    unknown_delay: float = quantity(
        "s", "more of the same, of which the law does not know", default=0.0, ge=0
    )

    @model_validator(mode="after")
    def _whole_steps(self) -> "Sampled":
        for field, value in (
            ("period", self.period),
            ("delay", self.delay),
            ("unknown_delay", self.unknown_delay),
        ):
            ratio = value / self.step
            if not math.isclose(ratio, round(ratio), abs_tol=1e-6):
                raise InvalidInput(field, value, f"must be a multiple of step = {self.step:g} s")
        if self.period < self.step:
            raise InvalidInput("period", self.period, f"must be at least step = {self.step:g} s")
        return self

    @property
    def substeps(self) -> int:
        """See `Clock.substeps`."""
        return round(self.period / self.step)

    @property
    def delay_steps(self) -> int:
        """See `Clock.delay_steps`."""
        return round((self.delay + self.unknown_delay) / self.step)

    def check(self, fastest_rate: float) -> None:
        """See `Clock.check`."""
        if fastest_rate * self.period > HOLD_LIMIT:
            raise InvalidInput(
                "clock.period",
                self.period,
                f"too long for the closed loop's fastest rate of {fastest_rate:.4g} 1/s; "
                f"must be below {HOLD_LIMIT / fastest_rate:.3g} s (or lower the gains)",
            )


AnyClock = Annotated[Continuous | Sampled, Field(discriminator="kind")]
