"""Trackers as tuned for the robots of the catalogue, so that each is compared at its best.

Made by ``osculate tune TRACKER --robot ROBOT`` on the package's training curves, never reported.
The defaults of the classes are the values for the paper's robot. `CurvatureTracker` is tuned for none.
"""

import warnings

from osculate.control.tracking import TRACKERS, PathTracker
from osculate.vehicle import VEHICLES, Tricycle

#: Robot, tracker, fields.
TUNED: dict[str, dict[str, dict[str, float]]] = {
    "paper": {},
    "tugger": {"lqr-preview": {"aside_weight": 459.336, "heading_weight": 22.572}},
    "forklift": {},
}


def trackers_for(robot: Tricycle) -> dict[str, PathTracker]:
    """All compiled trackers by name, with what was tuned for the robot.

    A robot that is not in the catalogue gets the defaults and a warning.
    """
    for name, known in VEHICLES.items():
        if robot == known:
            fields = TUNED[name]
            return {kind: _with(law, fields.get(kind, {})) for kind, law in TRACKERS.items()}
    warnings.warn(
        "the baselines are not tuned for this robot, they have the defaults of the paper's; "
        "`osculate.tune(law, robot=robot)` tunes one",
        stacklevel=3,
    )
    return dict(TRACKERS)


def _with(law: PathTracker, fields: dict[str, float]) -> PathTracker:
    return type(law)(**{**law.model_dump(), **fields}) if fields else law
