"""The robot in MuJoCo: an MJCF model made from a vehicle's parameters.

Bodies, masses and inertias are those of the reduced model; wheels are spheres that touch the floor in
one point each and roll by friction, so that the no-slip constraints are not assumed but result. The
steering servo is a position actuator on a joint with armature, the motors act through the same lag.
"""

import math
from typing import Any, ClassVar, Literal

import numpy as np

from osculate.control.contract import Start
from osculate.errors import import_extra
from osculate.plant.actuated import CRAWL, ActuatedPlant
from osculate.plant.contract import PlantPart, Push
from osculate.plant.tyre import Patch
from osculate.spec import quantity
from osculate.vehicle.brake import brake_parameters
from osculate.vehicle.motion import Command, Motion, Wheels
from osculate.vehicle.tricycle import Tricycle

WHEELS = ("left", "right", "front")
ARMATURE = 0.1  # kg m², of the steering joint: far above what turns with the wheel


class Mujoco(ActuatedPlant):
    """The robot simulated by MuJoCo (extra ``mujoco``), one run at a time."""

    kind: Literal["mujoco"] = "mujoco"
    feels: ClassVar[frozenset[str]] = frozenset({"acceleration", "yaw_acceleration", "aside"})
    friction: float = quantity("1", "friction of tyres on the floor", default=1.0, gt=0)
    softness: float = quantity(
        "s", "time constant of the contacts; two steps or more", default=0.002, gt=0
    )
    patches: tuple[Patch, ...] = ()

    def part(self, robot: Tricycle, start: Start) -> PlantPart:
        """A MuJoCo plant has no kernel: see `MujocoRobot`."""
        raise NotImplementedError

    def load(self) -> Any:
        """The module of MuJoCo.

        Raises:
            MissingExtra: It is not installed.
        """
        return import_extra("mujoco", "mujoco", "mujoco")

    def robot(self, robot: Tricycle, start: Start, step: float) -> "MujocoRobot":
        """The robot standing at its start.

        Raises:
            MissingExtra: MuJoCo is not installed.
        """
        return MujocoRobot(self, robot, start, step)


class MujocoRobot:
    """One robot in MuJoCo.

    Attributes:
        model: The compiled ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``.
    """

    def __init__(self, plant: Mujoco, robot: Tricycle, start: Start, step: float) -> None:
        self._mujoco = plant.load()
        real = plant.real(robot)
        self.model = self._mujoco.MjModel.from_xml_string(mjcf(robot, plant, step))
        self.data = self._mujoco.MjData(self.model)
        self._plant, self._inertia = plant, real.turn_inertia
        self._brake = brake_parameters(robot.brake, robot.total_mass * robot.wheel_radius, CRAWL)
        self._rolling = 0.5 * robot.actuators.rolling_resistance * real.weight * real.wheel_radius
        self._mass = real.body_mass + 3.0 * real.wheel_mass
        self._nominal = robot.wheel_radius
        self._rate = robot.actuators.steering_rate_limit * step
        self._slewed = float(np.arctan(robot.wheelbase * start.curvature))
        self._base = int(self.model.body("base").id)
        self._spins = [int(self.model.joint(name).dofadr[0]) for name in WHEELS]
        self._tyres = [int(self.model.geom(f"{name} tyre").id) for name in WHEELS]
        self._steering = int(self.model.joint("steering").qposadr[0])
        self._heading = start.heading  # rad, of the last step: what the next one goes on from
        half = 0.5 * start.heading
        self.data.qpos[:7] = [
            start.x,
            start.y,
            real.wheel_radius,
            np.cos(half),
            0,
            0,
            np.sin(half),
        ]
        self.data.qpos[self._steering] = self._slewed + plant.steering_offset
        self.data.qvel[:2] = (
            start.speed * np.cos(start.heading),
            start.speed * np.sin(start.heading),
        )
        yaw_rate, side = start.speed * start.curvature, robot.track_width / 2.0
        self.data.qvel[5] = yaw_rate
        for name, speed in (
            ("left", start.speed - side * yaw_rate),
            ("right", start.speed + side * yaw_rate),
            ("front", start.speed / np.cos(self._slewed)),
        ):
            self.data.qvel[int(self.model.joint(name).dofadr[0])] = speed / real.wheel_radius
        self._mujoco.mj_forward(self.model, self.data)

    def measure(self) -> Motion:
        """Pose of O, its speed as the wheels' encoders see it, and the servo's angle.

        The heading goes on beyond half a turn, as that of every plant does.
        """
        q, v = self.data.qpos, self.data.qvel
        turned = 2.0 * float(np.arctan2(q[6], q[3])) - self._heading
        heading = self._heading + math.remainder(turned, 2.0 * math.pi)
        speed = float(v[0] * np.cos(heading) + v[1] * np.sin(heading)) * self._plant.odometry
        angle = float(q[self._steering]) - self._plant.steering_offset
        return Motion(float(q[0]), float(q[1]), heading, speed, float(v[5]), angle)

    def wheels(self) -> Wheels:
        """Speeds of the drive wheels, by their spins and the nominal radius."""
        left, right, _ = (float(self.data.qvel[spin]) * self._nominal for spin in self._spins)
        return Wheels(left, right)

    @property
    def lateral_speed(self) -> float:
        """Speed (m/s) of O across the heading: slip, left is positive."""
        motion = self.measure()
        v = self.data.qvel
        return float(v[1] * np.cos(motion.heading) - v[0] * np.sin(motion.heading))

    @property
    def tipped(self) -> bool:
        """Whether the robot has fallen on its side: its own z axis points down."""
        _, x, y, _ = self.data.qpos[3:7]
        return bool(1.0 - 2.0 * (x * x + y * y) < 0.5)

    def step(self, command: Command, push: Push | None = None) -> None:
        """One time step under a command; the steering command moves no faster than the servo may."""
        change = np.clip(command.steering_angle - self._slewed, -self._rate, self._rate)
        self._slewed += float(change)
        angle = self._slewed + self._plant.steering_offset
        self.data.ctrl[:] = angle, command.torque_left, command.torque_right
        if self._brake.holding > 0.0:
            self._apply_brake(command.brake)
        if push is not None:
            self._push(push)
        if self._plant.patches:
            self._stand_on_patches()
        self._mujoco.mj_step(self.model, self.data)
        self._heading = self.measure().heading

    def _apply_brake(self, command: float) -> None:
        """Dry friction on the drive wheels' axles: it slows them down, and holds them."""
        for spin in self._spins[:2]:
            still = abs(float(self.data.qvel[spin])) * self._nominal < CRAWL
            torque = self._brake.holding if still else self._brake.moving
            self.model.dof_frictionloss[spin] = self._rolling + 0.5 * command * torque

    def _push(self, push: Push) -> None:
        """Accelerations of the whole mass as forces on the body's centre of mass."""
        heading = self.measure().heading
        cosine, sine = np.cos(heading), np.sin(heading)
        along, aside = self._mass * push.acceleration, self._mass * push.aside
        self.data.xfrc_applied[self._base] = (
            along * cosine - aside * sine,
            along * sine + aside * cosine,
            0.0,
            0.0,
            0.0,
            self._inertia * push.yaw_acceleration,
        )

    def _stand_on_patches(self) -> None:
        """Give every tyre the friction of the ground below it."""
        for tyre in self._tyres:
            x, y, _ = self.data.geom_xpos[tyre]
            friction = self._plant.friction
            for patch in self._plant.patches:
                inside = np.hypot(x - patch.x, y - patch.y) < patch.radius
                friction = patch.friction if inside else friction
            self.model.geom_friction[tyre, 0] = friction


def mjcf(robot: Tricycle, plant: Mujoco, step: float) -> str:
    """The robot as an MJCF document (SI units, radians)."""
    real, act, a = plant.real(robot), robot.actuators, robot.wheelbase
    r, mass, turn = real.wheel_radius, real.body_mass, robot.body_inertia
    rolling = 0.5 * act.rolling_resistance * real.weight * r
    height = robot.centre_height - r

    def wheel(name: str) -> str:
        yaw = robot.wheel_yaw_inertia
        return (
            f'<inertial pos="0 0 0" mass="{robot.wheel_mass}" '
            f'diaginertia="{yaw} {robot.wheel_inertia} {yaw}"/>'
            f'<geom name="{name} tyre" type="sphere" size="{r}" priority="1"/>'
        )

    side = robot.track_width / 2.0
    drives = "".join(
        f'<body name="{name}" pos="0 {y} 0"><joint name="{name}" axis="0 1 0" '
        f'frictionloss="{rolling}"/>{wheel(name)}</body>'
        for name, y in (("left", side), ("right", -side))
    )
    frequency = act.steering_frequency * plant.servo
    gain = ARMATURE * frequency**2
    damping = 2.0 * act.steering_damping * frequency * ARMATURE
    limit = act.steering_angle_limit
    motors = "".join(
        f'<general name="{name}" joint="{name}" dyntype="filterexact" dynprm="{act.motor_lag}" '
        f'gainprm="1" ctrllimited="true" ctrlrange="{-act.torque_limit} {act.torque_limit}"/>'
        for name in ("left", "right")
    )
    return f"""
<mujoco model="osculate">
  <compiler angle="radian"/>
  <option timestep="{step}" integrator="implicitfast" cone="elliptic" impratio="10" solver="Newton"
          gravity="0 0 {-robot.gravity}"/>
  <default>
    <geom condim="3" friction="{plant.friction} 0.005 0.0001" solref="{plant.softness} 1"
          solimp="0.95 0.99 0.001" rgba="0.12 0.14 0.18 1"/>
  </default>
  <worldbody>
    <light pos="0 0 6" dir="0 0 -1" directional="true"/>
    <geom name="floor" type="plane" size="200 200 1" rgba="0.93 0.94 0.96 1"/>
    <body name="base" pos="0 0 {r}">
      <freejoint name="base"/>
      <inertial pos="{a / 2} 0 {height}" mass="{mass}" diaginertia="{turn} {turn} {turn}"/>
      <geom type="box" pos="{a / 2} 0 {max(height, 0.0)}" size="{a / 2 + r} {side * 0.8} {r / 3}"
            contype="0" conaffinity="0" rgba="0.12 0.37 0.66 0.8"/>
      {drives}
      <body name="fork" pos="{a} 0 0">
        <joint name="steering" axis="0 0 1" armature="{ARMATURE}"/>
        <inertial pos="0 0 0" mass="0.001" diaginertia="1e-6 1e-6 1e-6"/>
        <body name="front"><joint name="front" axis="0 1 0"/>{wheel("front")}</body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="steering" joint="steering" kp="{gain}" kv="{damping}" ctrllimited="true"
              ctrlrange="{-limit} {limit}"/>
    {motors}
  </actuator>
</mujoco>
"""
