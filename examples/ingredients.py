"""What each ingredient is worth on a curve with inflections: from a timetable to the tracker.

The first three are targets of the paper's law on its own plant, with a weak speed loop: speeds are never
exactly what was commanded. The modified target cannot take part, it divides by the curvature. The tracker
drives the actuated robot.
"""

import math

from osculate import (
    Actuated,
    CurvatureLaw,
    CurvatureTracker,
    Disturbance,
    Dynamical,
    InitialState,
    Limits,
    Parametric,
    Projected,
    Sampled,
    SlidingMode,
    Static,
    simulate,
)


def main() -> None:
    wave = Parametric(x=lambda p: 2 * p, y=lambda p: 0.8 * math.sin(p), end=2 * math.pi)
    weak = CurvatureLaw(speed=SlidingMode(gain=0.5, switching=0.0, uncertainty=0.0))
    pushed = Disturbance(speed_amplitude=0.3)
    turned = Disturbance(heading_amplitude=0.05, frequency=1.0, acts_on="robot")
    aside = InitialState(cross_track=0.1, settled=3.0)
    print(f"{'':28}{'speeds pushed':>18}{'robot turned':>16}{'start 0.1 m aside':>20}")
    for name, target in (
        ("timetable (static)", Static()),
        ("yaw slaved (dynamical)", Dynamical()),
        ("both slaved (projected)", Projected()),
    ):
        cases = [
            simulate(wave, target=target, controller=weak, disturbance=pushed),
            simulate(wave, target=target, controller=weak, disturbance=turned),
            simulate(wave, target=target, controller=weak, initial=aside),
        ]
        print(f"{name:28}{row(cases)}")
    drive = {
        "controller": CurvatureTracker(),
        "plant": Actuated(),
        "clock": Sampled(period=0.01, delay=0.01, duration=40.0),
        "limits": Limits(speed=1.0),
    }
    cases = [
        simulate(wave, disturbance=pushed, **drive),
        simulate(wave, disturbance=turned, **drive),
        simulate(wave, initial=aside, **drive),
    ]
    print(f"{'pose fed back (tracker)':28}{row(cases)}")


def row(runs: list) -> str:
    """RMS of the cross-track error of three runs, in mm."""
    widths = (18, 16, 20)
    texts = (f"{1e3 * run.metrics.cross_track_rms:.3g} mm" for run in runs)
    return "".join(f"{text:>{width}}" for text, width in zip(texts, widths, strict=True))


if __name__ == "__main__":
    main()
