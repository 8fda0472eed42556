"""Any smooth curve, straights and inflections included, with the projected target."""

import math

from osculate import Exponential, Parametric, Projected, simulate


def main() -> None:
    wave = Parametric(x=lambda p: p, y=lambda p: 0.8 * math.sin(p), end=4 * math.pi)
    run = simulate(wave, target=Projected(profile=Exponential(decay=0.6)))
    print(f"{wave.length:.3f} m long; the run {run.verdict.sentence}")
    print(f"cross-track error: {1e9 * run.metrics.cross_track_rms:.2f} nm RMS")


if __name__ == "__main__":
    main()
