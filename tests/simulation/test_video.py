"""Films: shapes, the robot's likeness, what a frame says, the files, and polite errors."""

import sys
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
import shapely
from PIL import Image
from typer.testing import CliRunner

from osculate import (
    Block,
    Continuous,
    Cycloid,
    Disc,
    InvalidInput,
    MissingExtra,
    OsculateError,
    Scene,
    Wall,
    simulate,
    vehicle_named,
)
from osculate.simulation.recording.video import require_display, view, write_video
from osculate.simulation.recording.video.camera import aim, shots
from osculate.simulation.recording.video.caption import readings
from osculate.simulation.recording.video.opengl import offscreen
from osculate.simulation.recording.video.shapes import prism, ribbon
from osculate.simulation.recording.video.stage import Stage, moments

mujoco = pytest.importorskip("mujoco")
av = pytest.importorskip("av")

SIZE = (160, 90)
ROBOTS = ("paper", "tugger", "forklift")
SCENE = Scene(
    obstacles=(
        Wall(),
        Disc(x=1.0, y=3.0, radius=0.4),
        Block(corners=((2.0, -1.0), (4.0, -1.0), (4.0, 0.0), (3.0, -0.7), (2.0, 0.0))),
    )
)


@pytest.fixture(scope="module")
def run():
    return simulate(Cycloid.over(), clock=Continuous(duration=1.5), scene=SCENE)


@pytest.fixture(scope="module")
def opengl():
    try:
        context = offscreen(*SIZE)
    except OsculateError as error:
        pytest.skip(str(error))
    context.free()


def driven_by(run, name):
    return replace(run, setup=run.setup._replace(robot=vehicle_named(name)))


def volume_and_edges(mesh):
    """Volume by Gauss's theorem, and whether every edge is there once in each direction."""
    a, b, c = (mesh.vertices[mesh.faces[:, n]] for n in range(3))
    corners = np.round(mesh.vertices, 9)
    edges = [(*corners[f[n]], *corners[f[(n + 1) % 3]]) for f in mesh.faces for n in range(3)]
    back = {edge[3:] + edge[:3] for edge in edges}
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0, set(edges) == back


@pytest.mark.parametrize(
    "outline",
    [
        shapely.box(0, 0, 2, 1),
        shapely.Polygon([(0, 0), (4, 0), (4, 3), (2, 0.5), (0, 3)]),
        shapely.Point(1, 2).buffer(2).difference(shapely.Point(1, 2).buffer(1)),
    ],
    ids=["box", "not convex", "ring"],
)
def test_prisms_are_closed_and_look_outwards(outline):
    volume, closed = volume_and_edges(prism(outline, 0.5, 2.0))
    assert volume == pytest.approx(1.5 * outline.area)
    assert closed


def test_ribbons_are_closed_and_as_wide_as_they_say():
    angle = np.linspace(0, 1.5, 200)
    mesh = ribbon(3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.2, 0.01)
    volume, closed = volume_and_edges(mesh)
    assert volume == pytest.approx(4.5 * 0.01 * 0.75 * 0.2, rel=1e-3)  # three quarters: it tapers
    assert closed
    radius = np.hypot(*mesh.vertices[:, :2].T)
    assert (radius.min(), radius.max()) == pytest.approx((2.9, 3.1), abs=1e-3)


def test_frames_are_the_record_and_its_wheels_roll(run):
    frames, c, r = moments(run, 50), run.columns, run.setup.robot.wheel_radius
    assert len(frames) == pytest.approx(50 * (c["time"][-1] + 1.0), abs=1)
    n = 37
    at = np.searchsorted(c["time"], n / 50)
    assert frames[n].x == pytest.approx(c["x"][at], abs=1e-6)
    assert frames[n].wheel_angle == pytest.approx(c["steering_angle"][at], abs=1e-6)
    assert frames[-1][1:] == frames[-2][1:]
    way = c["arc_length"][-1]
    turned = run.setup.robot.track_width * (c["heading"][-1] - c["heading"][0])
    assert r * (frames[-1].left + frames[-1].right) / 2 == pytest.approx(way, rel=1e-4)
    assert r * (frames[-1].right - frames[-1].left) == pytest.approx(turned, rel=1e-3)
    assert r * frames[-1].steered > way


@pytest.mark.parametrize("name", ROBOTS)
def test_the_robot_is_drawn_in_its_proportions(run, name):
    run = driven_by(run, name)
    robot, stage, frame = run.setup.robot, Stage(run, SIZE), moments(run, 10)[3]
    stage.show(frame._replace(x=0.0, y=0.0, heading=0.0, left=0.4))
    model, data = stage.model, stage.data
    lowest, highest = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in range(model.ngeom):
        if model.geom_bodyid[geom] == 0:
            continue
        middle, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
        corners = (
            data.geom_xpos[geom] + (middle + signs * half) @ data.geom_xmat[geom].reshape(3, 3).T
        )
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_CYLINDER:
            lowest, highest = (
                np.minimum(lowest, corners.min(0)),
                np.maximum(highest, corners.max(0)),
            )
    footprint = robot.footprint
    hair = 0.02 * stage.length
    assert (-lowest[0], highest[0]) == pytest.approx((footprint.rear, footprint.front), abs=hair)
    assert (-lowest[1], highest[1]) == pytest.approx([footprint.half_width] * 2, abs=hair)
    assert lowest[2] > -1e-6
    side = 1 if robot.steered == "front" else -1
    assert data.body("steered").xpos == pytest.approx(
        [side * robot.wheelbase, 0, robot.wheel_radius]
    )
    # the wheel points along the circle: its axle meets the drive axle where the robot turns
    axle = data.body("fork").xmat.reshape(3, 3)[:, 1]
    angle = np.interp(frame.time, run.columns["time"], run.columns["steering_angle"])
    centre = robot.wheelbase / np.tan(angle)
    assert side * robot.wheelbase * axle[1] == pytest.approx(-centre * axle[0], abs=1e-6)


def test_the_trace_ends_below_the_robot(run):
    stage = Stage(run, SIZE)
    frames = moments(run, 10)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, stage.model.mesh_quat[stage.trace])
    for frame in (frames[0], frames[9], frames[-1]):
        stage.show(frame)
        first = stage.model.mesh_vertadr[stage.trace]
        count = stage.model.mesh_vertnum[stage.trace]
        local = stage.model.mesh_vert[first : first + count]
        points = local @ turn.reshape(3, 3).T + stage.model.mesh_pos[stage.trace]
        last = points[-4:].mean(0)
        assert last[:2] == pytest.approx((frame.x, frame.y), abs=0.02)


def test_a_robot_that_stands_has_no_trace(run):
    still = {name: values[:1] for name, values in run.columns.items()}
    stage = Stage(replace(run, columns=still), SIZE)
    stage.show(moments(replace(run, columns=still), 10)[0])
    assert stage.trace == -1


def test_the_camera_keeps_the_robot_in_the_picture_and_is_calm(run):
    frames = moments(run, 30)
    stage = Stage(run, SIZE)
    path = shots(frames, 30, stage.length)
    camera, scene = stage.camera(), mujoco.MjvScene(stage.model, maxgeom=200)
    for frame, shot in zip(frames[::10], path[::10], strict=True):
        stage.show(frame)
        aim(camera, shot, stage.length)
        mujoco.mjv_updateCamera(stage.model, stage.data, camera, scene)
        eye, forward, up = (np.array(getattr(scene.camera[0], v)) for v in ("pos", "forward", "up"))
        to = np.array([frame.x, frame.y, 0.0]) - eye
        depth = to @ forward
        assert abs(to @ up) / depth < 0.6 * np.tan(np.radians(19))
        assert abs(to @ np.cross(forward, up)) / depth < 0.5 * np.tan(np.radians(19))
        assert eye[2] > 2 * stage.length
    turned = np.diff([shot.azimuth for shot in path]) * 30
    assert np.abs(turned).max() <= np.abs(np.diff([f.heading for f in frames]) * 30).max()


def test_numbers_carry_their_units(run):
    frame = moments(run, 10)[0]._replace(time=1.234, speed=0.5, cross_track_error=-0.0123456)
    assert readings(frame) == ("1.23 s", "0.50 m/s", "−12.346 mm")
    assert readings(frame._replace(cross_track_error=-1e-9))[2] == "+0.000 mm"


@pytest.mark.usefixtures("opengl")
def test_mp4_plays_in_real_time(run, tmp_path):
    seen = []
    path = write_video(run, tmp_path / "deep" / "film.mp4", SIZE, fps=8, report=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    with av.open(str(path)) as film:
        stream = film.streams.video[0]
        assert (stream.width, stream.height, stream.average_rate) == (*SIZE, 8)
        pictures = [picture.to_ndarray(format="rgb24") for picture in film.decode(video=0)]
    assert len(pictures) == 20  # 1.5 s of driving and 1 s at its end
    red, green, blue = np.moveaxis(pictures[8].astype(int), -1, 0)
    assert ((red - blue > 60) & (red > green)).sum() > 30  # the curve
    assert ((blue - red > 60) & (blue > green)).sum() > 50  # the robot
    assert np.abs(pictures[12].astype(int) - pictures[2]).mean() > 2


@pytest.mark.usefixtures("opengl")
def test_gif_keeps_its_time(run, tmp_path):
    path = write_video(driven_by(run, "forklift"), tmp_path / "film.gif", SIZE, fps=6)
    with Image.open(path) as film:
        assert film.size == SIZE
        total = 0
        for n in range(film.n_frames):
            film.seek(n)
            total += film.info["duration"]
    assert total == pytest.approx(2500, abs=10)


@pytest.mark.usefixtures("opengl")
def test_runs_save_films(run, tmp_path):
    short = replace(run, columns={name: values[:2] for name, values in run.columns.items()})
    assert short.save(tmp_path / "run.gif").stat().st_size > 1000
    folder = tmp_path / "folder.mp4"
    folder.mkdir()
    with pytest.raises(InvalidInput, match="must be writable"):
        write_video(short, folder, SIZE, fps=2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("film.avi",), r"path = 'film\.avi': must end in \.mp4 or \.gif"),
        (("film.mp4", (1281, 720)), "size = .*must be even"),
        (("film.mp4", SIZE, 500), "fps = 500: must be from 1 to 100"),
    ],
)
def test_what_cannot_be_filmed_is_explained(run, arguments, message):
    with pytest.raises(InvalidInput, match=message):
        write_video(run, *arguments)


@pytest.mark.parametrize("missing", ["av", "mujoco"])
def test_missing_packages_name_the_extra(run, tmp_path, monkeypatch, missing, request):
    if missing == "av":
        request.getfixturevalue("opengl")
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(MissingExtra, match=r"pip install 'osculate\[video\]'"):
        write_video(run, tmp_path / "film.mp4", SIZE)


def test_missing_opengl_names_the_debian_packages(run, tmp_path, monkeypatch):
    def no_library(name):
        raise OSError(name)

    for name in ("MUJOCO_GL", "DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr("ctypes.CDLL", no_library)
    with pytest.raises(OsculateError, match="apt-get install libegl1 libgl1"):
        write_video(run, tmp_path / "film.mp4", SIZE)
    assert not (tmp_path / "film.mp4").exists()


def test_an_opengl_that_does_not_work_is_named(run, tmp_path, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "disable")
    monkeypatch.delattr(mujoco, "GLContext", raising=False)
    with pytest.raises(OsculateError, match="does not work here with MUJOCO_GL=disable"):
        write_video(run, tmp_path / "film.mp4", SIZE)


def test_without_a_display_the_viewer_points_to_films(run, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(InvalidInput, match=r"needs a display.* --video FILE"):
        view(run)
    from osculate.apps.cli import app

    for arguments, message in (
        (["run", "--view"], "needs a display"),
        (["run", "--video", "film.avi"], "must end in .mp4 or .gif"),
    ):
        assert message in str(CliRunner().invoke(app, arguments).exception)
    monkeypatch.setenv("DISPLAY", ":0")
    require_display()


class Window:
    """A viewer that is closed after a few pictures."""

    def __init__(self, model, data, **_):
        self.model, self.data, self.cam = model, data, mujoco.MjvCamera()
        self.user_scn = mujoco.MjvScene(model, 5000)
        self.places, self.traces = [], []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def lock(self):
        return self

    def is_running(self):
        return len(self.places) < 10

    def sync(self):
        self.places.append(self.data.qpos[0])
        self.traces.append(self.user_scn.ngeom)


def test_the_viewer_replays_the_run(run, monkeypatch):
    windows = []

    def launch(*arguments, **options):
        windows.append(Window(*arguments, **options))
        return windows[0]

    monkeypatch.setenv("DISPLAY", ":0")
    viewer = import_module("mujoco.viewer")
    monkeypatch.setattr(viewer, "launch_passive", launch)
    monkeypatch.setattr("glfw.init", lambda: True)
    view(run)
    window = windows[0]
    assert window.places == sorted(window.places)
    assert window.traces == sorted(window.traces)
    assert window.cam.trackbodyid == window.model.body("base").id
    monkeypatch.setattr("glfw.init", lambda: False)
    with pytest.raises(InvalidInput, match="needs a display"):
        view(run)
