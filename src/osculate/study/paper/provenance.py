"""By what a reproduction was made: everything that its numbers depend on."""

import subprocess
from pathlib import Path

import osculate
from osculate.control import CurvatureLaw
from osculate.study.paper.cases import CURVE, DURATION, ROBOT, STEP, Interpretation


def provenance(interpretation: Interpretation) -> dict[str, str | float | int]:
    """Version, commit, step, number of samples, integrator, gains and what was chosen."""
    law = CurvatureLaw()
    return {
        "version": osculate.__version__,
        "commit": _commit(),
        "h": STEP,
        "N": round(DURATION / STEP),
        "integrator": "RK4 (classical, order 4) on law and robot together",
        "Q": f"diag({law.yaw.heading_weight:g}, {law.yaw.rate_weight:g})",
        "R": law.yaw.effort_weight,
        "k": law.speed.gain,
        "G": law.speed.weight,
        "epsilon": law.speed.switching,
        "E": law.speed.uncertainty,
        "robot": ROBOT.model_dump_json(),
        "curve": CURVE.model_dump_json(),
        "yaw_origin": interpretation.yaw_origin,
        "after_end": interpretation.after_end,
    }


def _commit() -> str:
    """The commit of the checkout that this runs from, marked where files differ from it."""
    folder = Path(__file__).parent
    described = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=40"]
    tracked = ["git", "-C", str(folder), "ls-files", "--error-unmatch", Path(__file__).name]
    try:
        ours = subprocess.run(tracked, capture_output=True, check=False).returncode == 0
        done = subprocess.run(described, capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    return done.stdout.strip() if ours and done.returncode == 0 else "unknown"
