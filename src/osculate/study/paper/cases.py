"""The experiments of Section 5, each in every reading that the printed text allows."""

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from osculate.control import CurvatureLaw, SlidingMode
from osculate.curve import Cycloid
from osculate.errors import InvalidInput
from osculate.plant import Disturbance
from osculate.simulation import Continuous, InitialState, Run, simulate
from osculate.study.paper.unending import Unending
from osculate.target import Dynamical, Exponential, Modified, Natural, Static, Target
from osculate.vehicle import Tricycle

CURVE = Cycloid.over(distance=10.0, height=5.0, margin=1.0)
ROBOT = Tricycle()
STEP = 1e-3  # s, the paper's h
DURATION = 20.0  # s, the paper's N = 20 / h

CONSISTENT = Modified()  # ∫θ̂̇ dt is the curve's own total turn, −(π − β)
PRINTED = Modified(profile=Exponential(amplitude=-3.0))  # eq. (50): θ̂̇ = −¾ t e^{−t/2}
STATIC = Static(profile=Natural())  # eq. (51)
D1, D11 = (5.0, 5.0), (12.0, 11.2)
D2 = Disturbance(speed_amplitude=0.1, speed_feedback=2.0)  # d₂ alone

Runs = Mapping[str, Run]


class Interpretation(NamedTuple):
    """What the text leaves open about every run."""

    yaw_origin: Literal["start", "printed"] = "start"  # θ̂(0) = θ(0), or 0 as θ̂ = ∫₀ᵗ says
    after_end: Literal["stop", "continue"] = "stop"  # what happens after s = l

    @classmethod
    def checked(cls, yaw_origin: str, after_end: str) -> "Interpretation":
        """From words.

        Raises:
            InvalidInput: Another word.
        """
        choices = {"yaw_origin": ("start", "printed"), "after_end": ("stop", "continue")}
        given = {"yaw_origin": yaw_origin, "after_end": after_end}
        for field, words in choices.items():
            if given[field] not in words:
                raise InvalidInput(field, given[field], f"must be one of {', '.join(words)}")
        return cls(**given)  # type: ignore[arg-type]


AS_MEANT = Interpretation()


class Case(NamedTuple):
    """One experiment."""

    target: Target
    disturbance: Disturbance
    meaning: str
    controller: CurvatureLaw = CurvatureLaw()


def internal(gains: tuple[float, float], sign: float) -> Disturbance:
    """d₁ = sign (gains₁ y₁, gains₂ y₂), and d₂."""
    return Disturbance.internal(sign * gains[0], sign * gains[1])


_EXTERNAL = Disturbance.external()
_SMOOTH = CurvatureLaw(speed=SlidingMode(switching=0.0, uncertainty=0.0))
_OWN_PACE = {decay: Modified(profile=Exponential(decay=decay)) for decay in (0.35, 0.8)}

#: All experiments by name; "plus" and "minus" are the two readings of the signs inside d₁.
CASES = {
    "modified": Case(CONSISTENT, Disturbance(), "modified target, undisturbed"),
    "modified_smooth": Case(
        CONSISTENT, Disturbance(), "the same without the switching torque u₂₁", _SMOOTH
    ),
    "printed": Case(PRINTED, Disturbance(), "modified target as printed (¾), undisturbed"),
    "modified_slow": Case(_OWN_PACE[0.35], Disturbance(), "modified target, γ = 0.35, undisturbed"),
    "modified_fast": Case(_OWN_PACE[0.8], Disturbance(), "modified target, γ = 0.8, undisturbed"),
    "dynamical": Case(Dynamical(), Disturbance(), "dynamical target (24), undisturbed"),
    "static": Case(STATIC, Disturbance(), "static target, undisturbed"),
    "static_d2": Case(STATIC, D2, "static target, d₂ alone"),
    "modified_d1": Case(PRINTED, internal(D1, 1.0), "modified target, d₁ = (5y₁, 5y₂)"),
    "modified_d1_minus": Case(PRINTED, internal(D1, -1.0), "modified target, d₁ = −(5y₁, 5y₂)"),
    "modified_d1_minus_smooth": Case(
        PRINTED, internal(D1, -1.0), "the same without the switching torque u₂₁", _SMOOTH
    ),
    "static_d1": Case(STATIC, internal(D1, 1.0), "static target, d₁ = (5y₁, 5y₂)"),
    "static_d1_minus": Case(STATIC, internal(D1, -1.0), "static target, d₁ = −(5y₁, 5y₂)"),
    "modified_d11": Case(PRINTED, internal(D11, 1.0), "modified target, d₁₁ = (12y₁, 11.2y₂)"),
    "modified_d11_minus": Case(
        PRINTED, internal(D11, -1.0), "modified target, d₁₁ = −(12y₁, 11.2y₂)"
    ),
    "modified_d12": Case(PRINTED, _EXTERNAL, "modified target, d₁₂ = (sin 4t, cos 4t)"),
    "modified_d12_smooth": Case(
        PRINTED, _EXTERNAL, "the same without the switching torque u₂₁", _SMOOTH
    ),
    "modified_d12_consistent": Case(
        CONSISTENT, _EXTERNAL, "the same with the consistent profile, 20 s long"
    ),
    "dynamical_d12": Case(Dynamical(), _EXTERNAL, "dynamical target (24), d₁₂"),
    "modified_d12_heading_disturbed": Case(
        PRINTED,
        Disturbance.external(acts_on="robot"),
        "modified target, d₁₂ turning the robot itself",
    ),
}  # fmt: skip


def run_case(case: Case, interpretation: Interpretation = AS_MEANT, step: float = STEP) -> Run:
    """Run one experiment with the paper's robot and gains for 20 s.

    Args:
        case: The experiment.
        interpretation: What the text leaves open.
        step: Integration step (s).
    """
    target = case.target
    if interpretation.after_end == "continue" and isinstance(target, Modified):
        target = endless(target)
    origin = 0.0 if interpretation.yaw_origin == "printed" else None
    return simulate(
        CURVE, ROBOT, target=target, disturbance=case.disturbance, controller=case.controller,
        clock=Continuous(step=step, duration=DURATION), initial=InitialState(target_heading=origin),
    )  # fmt: skip


def endless(target: Modified) -> Unending:
    """The same target, which goes on beyond s = l."""
    profile = target.profile
    assert isinstance(profile, Exponential)
    amplitude = CURVE.total_turn if profile.amplitude is None else profile.amplitude
    return Unending.of(CURVE, Exponential(amplitude=amplitude, decay=profile.decay))


def run_cases(
    interpretation: Interpretation = AS_MEANT,
    step: float = STEP,
    report: Callable[[float], None] | None = None,
) -> dict[str, Run]:
    """Run all experiments; ``report`` is called with the fraction that is done."""
    runs = {}
    for done, (name, case) in enumerate(CASES.items(), start=1):
        runs[name] = run_case(case, interpretation, step)
        if report:
            report(done / len(CASES))
    return runs
