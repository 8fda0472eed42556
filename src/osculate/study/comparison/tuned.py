"""Trackers as tuned for the robots of the catalogue, so that each is compared at its best.

All numbers are from ``osculate tune TRACKER --robot ROBOT --quick --generations 12``: two of the package's
training curves, which are never reported, with exact poses. Where there are none, the defaults of the
classes are the values for the paper's robot. `CurvatureTracker` is tuned for no robot.
"""

import warnings

from osculate.control.tracking import TRACKERS, PathTracker
from osculate.vehicle import VEHICLES, Tricycle

#: Robot, tracker, fields.
TUNED: dict[str, dict[str, dict[str, float]]] = {
    "paper": {"lqr-preview": {"aside_weight": 3145.19, "heading_weight": 25.7123}},
    "tugger": {
        "lqr-preview": {"aside_weight": 322.915, "heading_weight": 24.0036},
        "lqr": {"aside_weight": 67.5505, "heading_weight": 22.51, "lead": 0.0398628},
        "pure-pursuit": {"lookahead": 0.483523, "lookahead_time": 0.390371},
        "kanayama": {"aside_gain": 8.16678, "heading_gain": 6.25641},
        "stanley": {"gain": 15.6004, "softening": 0.932385, "damping": 0.499324},
    },
    "forklift": {
        "lqr-preview": {"aside_weight": 45.4291, "heading_weight": 0.298632},
        "lqr": {"aside_weight": 3.6743, "heading_weight": 2.04847, "lead": 0.250099},
        "pure-pursuit": {"lookahead": 0.812201, "lookahead_time": 0.059757},
        "kanayama": {"aside_gain": 2.11721, "heading_gain": 3.127},
        "stanley": {"gain": 3.2257, "softening": 0.043543, "damping": 0.497787},
    },
}


def trackers_for(robot: Tricycle) -> dict[str, PathTracker]:
    """All compiled trackers by name, with what was tuned for the robot.

    A robot that is not in the catalogue gets the defaults and a warning.
    """
    for name, known in VEHICLES.items():
        if robot == known:
            fields = TUNED[name]
            return {kind: law.but(**fields.get(kind, {})) for kind, law in TRACKERS.items()}
    warnings.warn(
        "the baselines are not tuned for this robot, they have the defaults of the paper's; "
        "`osculate.tune(law, robot=robot)` tunes one",
        stacklevel=3,
    )
    return dict(TRACKERS)
