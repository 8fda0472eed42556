"""A thousand robots that weigh something else than their law believes."""

import numpy as np

from osculate import Cycloid, Disturbance, simulate_batch


def main(runs: int = 1024) -> None:
    rng = np.random.default_rng(1)
    extra = rng.uniform(0.0, 3.0, runs)  # kg on top of the paper's 10 kg
    inertia = (10.0 + extra) * 0.1**2 + 2 * 0.01  # M₁ r² + 2 I_w of the plant alone
    batch = simulate_batch(
        Cycloid.over(),
        vary={"plant.model.drive_inertia": inertia},
        disturbance=Disturbance(speed_amplitude=0.1, speed_feedback=2.0),
    )
    worst = batch.metrics.cross_track_max
    print(f"{runs} runs, worst cross-track error {1e3 * np.max(worst):.3f} mm")
    print(f"correlation with the payload: {np.corrcoef(extra, worst)[0, 1]:.2f}")


if __name__ == "__main__":
    main()
