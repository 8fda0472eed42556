"""The public name, unit and meaning of everything that a run records."""

from typing import NamedTuple

from osculate.kernel import Nothing, names
from osculate.simulation.records import Row


class Variable(NamedTuple):
    """A labelled quantity."""

    name: str
    unit: str
    long_name: str


#: From the leaf of a `Row` to the variable in the record.
VARIABLES = {
    "time": Variable("time", "s", "time"),
    "motion.x": Variable("x", "m", "position of O, x"),
    "motion.y": Variable("y", "m", "position of O, y"),
    "motion.heading": Variable("heading", "rad", "heading"),
    "motion.speed": Variable("speed", "m/s", "speed of O"),
    "motion.yaw_rate": Variable("yaw_rate", "rad/s", "yaw rate"),
    "motion.steering_angle": Variable("steering_angle", "rad", "steering angle"),
    "reference.speed": Variable("target_speed", "m/s", "target speed"),
    "reference.speed_drift": Variable(
        "target_speed_drift", "m/s²", "rate of the target speed without yaw acceleration"
    ),
    "reference.speed_slaving": Variable(
        "target_speed_slaving", "m/rad", "target speed per actual yaw rate"
    ),
    "reference.yaw_rate": Variable("target_yaw_rate", "rad/s", "target yaw rate"),
    "reference.yaw_drift": Variable(
        "target_yaw_drift", "rad/s²", "rate of the target yaw rate without acceleration"
    ),
    "reference.yaw_slaving": Variable(
        "target_yaw_slaving", "rad/m", "target yaw rate per actual speed"
    ),
    "reference.curvature": Variable("target_curvature", "1/m", "curvature of the target curve"),
    "reference.heading": Variable("target_heading", "rad", "integral of the target yaw rate"),
    "command.steering_angle": Variable(
        "commanded_steering_angle", "rad", "commanded steering angle"
    ),
    "command.torque_left": Variable("torque_left", "N m", "drive torque of the left wheel"),
    "command.torque_right": Variable("torque_right", "N m", "drive torque of the right wheel"),
    "command.brake": Variable("brake", "1", "brake applied, part of the full brake"),
    "errors.heading": Variable("law_heading_error", "rad", "heading error as the law sees it"),
    "errors.yaw_rate": Variable("yaw_rate_error", "rad/s", "yaw rate minus target"),
    "errors.speed": Variable("speed_error", "m/s", "speed minus target"),
    "arc_length": Variable("arc_length", "m", "distance travelled, progress of the target"),
    "foot": Variable("foot", "m", "arc length of the nearest point of the curve"),
    "cross_track": Variable("cross_track_error", "m", "signed distance from the curve, left > 0"),
    "heading_error": Variable("heading_error", "rad", "heading minus the curve's"),
    "insight.x": Variable("estimated_x", "m", "estimated position, x, at the last decision"),
    "insight.y": Variable("estimated_y", "m", "estimated position, y, at the last decision"),
    "insight.heading": Variable("estimated_heading", "rad", "estimated heading"),
    "insight.speed": Variable("estimated_speed", "m/s", "estimated speed"),
    "insight.intervention": Variable(
        "intervention", "1", "number of the reason for an intervention, 0 is none"
    ),
    "insight.excess": Variable(
        "corridor_excess", "m", "predicted distance beyond the corridor's edge"
    ),
    "insight.cause": Variable(
        "intervention_cause", "1", "number of what caused the intervention, 0 is nothing"
    ),
}

#: Variables that are zero while a robot stands still and nothing is asked of it.
RATES = frozenset(
    {
        "speed", "yaw_rate", "target_speed", "target_speed_drift", "target_speed_slaving",
        "target_yaw_rate", "target_yaw_drift", "target_yaw_slaving", "torque_left", "torque_right",
        "yaw_rate_error", "speed_error", "estimated_speed",
    }
)  # fmt: skip
#: Every variable by its public name.
BY_NAME = {variable.name: variable for variable in VARIABLES.values()}


def variables_of(row: Row) -> tuple[Variable, ...]:
    """The variables in the order of a row's leaves, which may go on with a zero that means nothing."""
    known = row if row.insight != Nothing() else row._replace(insight=())
    return tuple(VARIABLES[leaf] for leaf in names(known))
