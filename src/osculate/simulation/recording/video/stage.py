"""The stage of a film: floor, curve, trace, obstacles and the robot, as a MuJoCo model to look at.

Nothing is simulated here, so that runs of any plant can be shown: a record says where everything is.
A wheel that is steered behind the axle is drawn there, and turns to the other side.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from osculate.simulation.recording.video.opengl import load_mujoco
from osculate.simulation.recording.video.robot import robot_meshes, robot_parts
from osculate.simulation.recording.video.shapes import Mesh, prism, ribbon

if TYPE_CHECKING:
    from osculate.simulation.run import Run

Array = NDArray[np.float64]
STATIONS = 3000  # of curve and trace, at most
AFTERWARDS = 1.0  # s that the end of a run is shown
BLUE, ORANGE, GREY = "0.12 0.37 0.66 1", "0.85 0.45 0.05 1", "0.66 0.69 0.73 1"
SKY = "0.92 0.935 0.955"


class Frame(NamedTuple):
    """What a film shows at one instant."""

    time: float  # s
    x: float  # m
    y: float  # m
    heading: float  # rad, not wrapped
    wheel_angle: float  # rad, of the steered wheel against the body
    left: float  # rad, how far the left wheel has rolled
    right: float  # rad
    steered: float  # rad, how far the steered wheel has rolled
    speed: float  # m/s
    cross_track_error: float  # m


def moments(run: "Run", rate: float) -> list[Frame]:
    """The record at ``rate`` frames per second, and its end for a while; wheels roll without slipping."""
    c, robot = run.columns, run.setup.robot
    time, side = c["time"], robot.track_width / 2.0 * c["yaw_rate"]

    def rolled(speed: Array) -> Array:
        turns = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time) / robot.wheel_radius
        return np.concatenate([[0.0], np.cumsum(turns)])

    columns = (
        time, c["x"], c["y"], np.unwrap(c["heading"]), robot.wheel_angle(1.0) * c["steering_angle"],
        rolled(c["speed"] - side), rolled(c["speed"] + side),
        rolled(c["speed"] / np.cos(c["steering_angle"])), c["speed"], c["cross_track_error"],
    )  # fmt: skip
    wanted = np.arange(0.0, time[-1] + AFTERWARDS, 1.0 / rate)
    rows = zip(*(np.interp(wanted, time, column) for column in columns), strict=True)
    return [Frame(*map(float, row)) for row in rows]


class Stage:
    """A run's surroundings and its robot in MuJoCo.

    Attributes:
        model: The compiled ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``.
        length: Of the robot (m).
        trace: Number of the mesh that `show` changes; -1 if the robot never moved.
    """

    def __init__(self, run: "Run", size: tuple[int, int]) -> None:
        self._mujoco = load_mujoco()
        self._driven, self._passed = _driven(run)
        footprint = run.setup.robot.footprint
        self.length = footprint.front + footprint.rear
        self.model = self._mujoco.MjModel.from_xml_string(_document(run, self._driven, size))
        self.data = self._mujoco.MjData(self.model)
        self._joints = [
            int(self.model.joint(name).qposadr[0])
            for name in ("steering", "left", "right", "steered")
        ]
        self.trace, self._whole = -1, np.empty((0, 4, 3))
        if len(self._driven):
            self.trace = int(self.model.mesh("trace").id)
            first = int(self.model.mesh_vertadr[self.trace])
            self._rows = slice(first, first + int(self.model.mesh_vertnum[self.trace]))
            self._whole = self.model.mesh_vert[self._rows].reshape(-1, 4, 3).copy()

    def camera(self) -> Any:
        """A new ``mujoco.MjvCamera``."""
        return self._mujoco.MjvCamera()

    def follow(self, camera: Any) -> None:
        """Let a camera go with the robot, from where it looks now."""
        camera.type = self._mujoco.mjtCamera.mjCAMERA_TRACKING
        camera.trackbodyid = int(self.model.body("base").id)

    def show(self, frame: Frame) -> None:
        """Put the robot where a frame says, and let its trace end there."""
        q, half = self.data.qpos, 0.5 * frame.heading
        q[:7] = frame.x, frame.y, 0.0, np.cos(half), 0.0, 0.0, np.sin(half)
        q[self._joints] = frame.wheel_angle, frame.left, frame.right, frame.steered
        self._mujoco.mj_forward(self.model, self.data)
        if self.trace < 0:
            return
        # what is not yet driven shrinks to the end of the trace
        station = self.station(frame)
        before = min(int(station), len(self._whole) - 2)
        a, b = self._whole[before], self._whole[before + 1]
        vertices = self._whole.copy()
        vertices[before + 1 :] = a + (station - before) * (b - a)
        self.model.mesh_vert[self._rows] = vertices.reshape(-1, 3)

    def station(self, frame: Frame) -> float:
        """How many stretches of the trace lie behind the robot."""
        count = len(self._passed)
        return float(np.interp(frame.time, self._passed, np.arange(count))) if count else 0.0

    def lay(self, scene: Any) -> None:
        """Make the trace of capsules in a ``mujoco.MjvScene`` instead, for the caller to count.

        A viewer that is being closed would wait for ever for a mesh to be uploaded.
        """
        if self.trace < 0:
            return
        self.model.geom("trace").rgba[3] = 0.0
        shape, radius = self._mujoco.mjtGeom.mjGEOM_CAPSULE, 0.07 * self.length / 2.0
        points = np.column_stack([self._driven, np.full(len(self._driven), -0.6 * radius)])
        colour, zero = np.array(BLUE.split(), np.float32), np.zeros(3)
        for geom, begin, end in zip(scene.geoms, points[:-1], points[1:], strict=False):
            self._mujoco.mjv_initGeom(geom, shape, zero, zero, np.eye(3).ravel(), colour)
            self._mujoco.mjv_connector(geom, shape, radius, begin, end)


def _driven(run: "Run") -> tuple[Array, Array]:
    """Stations of the trace (m), shape (n, 2), and when the robot passed them (s); none if it stood."""
    c = run.columns
    steps = np.hypot(np.diff(c["x"]), np.diff(c["y"]))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    width = 2.0 * run.setup.robot.footprint.half_width
    if way[-1] < 0.1 * width:
        return np.empty((0, 2)), np.empty(0)
    count = _stations(way[-1], width)
    moved = np.concatenate([[True], steps > 0.0])
    passed = np.interp(np.linspace(0.0, way[-1], count), way[moved], c["time"][moved])
    points = [np.interp(passed, c["time"], c[name]) for name in ("x", "y")]
    return np.stack(points, axis=1), passed


class Thing(NamedTuple):
    """A mesh that stands on the stage or belongs to the robot."""

    mesh: Mesh
    colour: str
    material: str

    def asset(self, name: str) -> str:
        """Its shape in MJCF."""
        vertices = " ".join(f"{value:.7g}" for value in self.mesh.vertices.ravel())
        faces = " ".join(map(str, self.mesh.faces.ravel()))
        return f'<mesh name="{name}" vertex="{vertices}" face="{faces}"/>'

    def geom(self, name: str) -> str:
        """Where it is drawn."""
        return (
            f'<geom name="{name}" type="mesh" mesh="{name}" rgba="{self.colour}" '
            f'material="{self.material}"/>'
        )


def _scenery(run: "Run", driven: Array) -> dict[str, Thing]:
    """Bands for the curve and the path driven, and the obstacles, by name."""
    footprint, curve = run.setup.robot.footprint, run.setup.curve
    width, height = 2.0 * footprint.half_width, 0.45 * (footprint.front + footprint.rear)
    point = curve.at(np.linspace(0.0, curve.length, _stations(curve.length, width)))
    path = np.stack([point.x, point.y], axis=1)
    things = {"curve": Thing(ribbon(path, 0.26 * width, 0.004 * width), ORANGE, "paint")}
    if len(driven):
        things["trace"] = Thing(ribbon(driven, 0.1 * width, 0.008 * width), BLUE, "paint")
    if not run.scene.is_empty:
        around = run.scene.geometry((float(path[0, 0]), float(path[0, 1])))
        for n, part in enumerate(getattr(around, "geoms", [around])):
            things[f"obstacle {n}"] = Thing(prism(part, 0.0, height), GREY, "paint")
    return things


def _stations(length: float, width: float) -> int:
    return int(np.clip(length / (0.2 * width), 2, STATIONS))


def _document(run: "Run", driven: Array, size: tuple[int, int]) -> str:
    """The stage as an MJCF document; its light and its fog grow with the robot."""
    robot = run.setup.robot
    length = robot.footprint.front + robot.footprint.rear
    scenery = _scenery(run, driven)
    body = {n: Thing(mesh, colour, "gloss") for n, (mesh, colour) in robot_meshes(robot).items()}
    assets = "".join(thing.asset(name) for name, thing in (scenery | body).items())
    around, shell = (
        "".join(thing.geom(name) for name, thing in some.items()) for some in (scenery, body)
    )
    return f"""
<mujoco model="osculate">
  <compiler angle="radian"/>
  <option gravity="0 0 0"/>
  <statistic extent="{length}"/>
  <visual>
    <global offwidth="{size[0]}" offheight="{size[1]}" fovy="38"/>
    <quality shadowsize="3072" offsamples="0" numstacks="4" numquads="1"/>
    <headlight ambient="0.48 0.49 0.51" diffuse="0.24 0.24 0.24" specular="0.1 0.1 0.1"/>
    <map znear="0.1" zfar="24" shadowclip="16" fogstart="9" fogend="23"/>
    <rgba fog="{SKY} 1"/>
  </visual>
  <default>
    <geom contype="0" conaffinity="0" mass="0"/>
  </default>
  <asset>
    <texture type="skybox" builtin="gradient" rgb1="{SKY}" rgb2="{SKY}" width="16" height="96"/>
    <texture name="floor" type="2d" builtin="checker" rgb1="0.8 0.815 0.84" rgb2="0.77 0.785 0.81"
             mark="edge" markrgb="0.7 0.72 0.75" width="512" height="512"/>
    <material name="floor" texture="floor" texrepeat="0.5 0.5" texuniform="true" specular="0"/>
    <material name="paint" specular="0.05" shininess="0.1" emission="0.1"/>
    <material name="gloss" specular="0.5" shininess="0.7"/>
    {assets}
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" material="floor"/>
    {around}
    <body name="base">
      <freejoint name="base"/>
      <light mode="track" directional="true" pos="{2.6 * length} {-3.4 * length} {8 * length}"
             dir="-0.33 0.42 -1" diffuse="0.5 0.49 0.47" specular="0.3 0.3 0.3" castshadow="true"/>
      {shell}{robot_parts(robot)}
    </body>
  </worldbody>
</mujoco>
"""
