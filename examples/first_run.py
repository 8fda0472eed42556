"""Over the paper's obstacle: simulate, look at the numbers, save a picture."""

from osculate import Cycloid, Disturbance, Modified, Scene, Tricycle, Wall, simulate


def main() -> None:
    robot = Tricycle()
    curve = Cycloid.over(distance=10, height=5, margin=1)
    run = simulate(
        curve,
        robot,
        target=Modified(),
        disturbance=Disturbance.external(),
        scene=Scene(obstacles=(Wall(distance=10, height=5),)),
    )
    print(f"cross-track error: {1e3 * run.metrics.cross_track_rms:.2f} mm RMS")
    print(run.data.speed.sel(time=3.0, method="nearest"))
    run.plot().savefig("first_run.png")


if __name__ == "__main__":
    main()
