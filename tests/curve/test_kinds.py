"""Every kind of curve obeys the one contract: derivatives, ends, and clear errors."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from osculate import (
    Arc,
    Chain,
    Clothoid,
    Composite,
    Cycloid,
    InvalidInput,
    Laps,
    Line,
    NoSolution,
    Nurbs,
    Parametric,
    Pose,
    Segment,
    Spline,
    read_curve,
)
from osculate.curve import Part, parse_curve
from osculate.curve.approach import dubins, plan_approach

WAYPOINTS = ((0.0, 0.0), (1.0, 0.4), (2.2, 0.1), (3.0, -0.5), (4.5, 0.2))
NURBS = Nurbs(
    degree=3,
    knots=(0, 0, 0, 0, 0.5, 1, 1, 1, 1),
    points=((0, 0), (1, 0), (2, 1), (3, 1), (4, 0)),
    weights=(1, 1, 2, 1, 1),
)
KINDS = {
    "line": Line(start=Pose(x=1, y=2, heading=0.5), distance=3.0),
    "arc": Arc(start=Pose(heading=1.0), radius=2.0, angle=-2.5),
    "clothoid": Clothoid(start=Pose(x=-1), distance=4.0, start_curvature=-0.5, end_curvature=1.5),
    "chain": Chain.corner(turn=math.pi / 2, radius=0.8, ramp=0.4, straight=2.0),
    "spline": Spline(points=WAYPOINTS),
    "loop": Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True),
    "nurbs": NURBS,
    "composite": Composite(
        pieces=(Line(distance=1.0), Clothoid(start=Pose(x=1.0), distance=2.0, end_curvature=0.7))
    ),
    "part": Part(curve=Cycloid.over(), start=3.0, end=9.0),
    "laps": Laps(track=Spline(points=((0, 0), (4, -1), (6, 2), (2, 4)), loop=True), count=3),
}


@pytest.mark.parametrize("curve", KINDS.values(), ids=KINDS)
def test_position_heading_and_curvature_are_derivatives_of_each_other(curve):
    h = 1e-5
    s = np.linspace(0.01, curve.length - 0.01, 331)
    before, here, after = curve.at(s - h), curve.at(s), curve.at(s + h)
    assert (after.x - before.x) / (2 * h) == pytest.approx(np.cos(here.heading), abs=1e-8)
    assert (after.y - before.y) / (2 * h) == pytest.approx(np.sin(here.heading), abs=1e-8)
    smooth = np.abs(after.curvature - before.curvature) < 1e-3  # not across a knot
    slope = (after.heading - before.heading) / (2 * h)
    assert slope == pytest.approx(here.curvature, abs=1e-5)
    rate = (after.curvature - before.curvature) / (2 * h)
    near = np.abs(rate - here.curvature_rate) < 1e-3 * (1 + np.abs(here.curvature_rate))
    assert near[smooth].mean() > 0.97  # a chain's rate jumps where segments meet


@pytest.mark.parametrize("curve", KINDS.values(), ids=KINDS)
def test_a_curve_is_its_plain_data(curve):
    again = parse_curve(curve.model_dump(mode="json"))
    s = np.linspace(0.0, curve.length, 17)
    assert again.length == curve.length
    assert np.stack(again.at(s)) == pytest.approx(np.stack(curve.at(s)), abs=1e-12)


def test_a_corner_turns_as_told():
    end = KINDS["chain"].at(KINDS["chain"].length)
    assert float(end.heading) == pytest.approx(math.pi / 2)
    assert float(end.curvature) == 0.0


def test_clothoids_between_poses_end_there():
    goal = Pose(x=2.0, y=1.0, heading=0.8)
    one = Clothoid.between(Pose(), goal)
    three = Chain.between(Pose(), goal, (0.1, -0.3))
    for curve in (one, three):
        end = curve.at(curve.length)
        assert (end.x, end.y, end.heading) == pytest.approx((2.0, 1.0, 0.8), abs=1e-9)
    assert float(three.at(0.0).curvature) == pytest.approx(0.1)
    assert float(three.at(three.length).curvature) == pytest.approx(-0.3)


def test_a_spline_goes_through_its_points_with_continuous_curvature_rate():
    spline = KINDS["spline"]
    assert spline.deviation[0] < 1e-4
    s = np.linspace(0.0, spline.length, 40001)
    assert np.abs(np.diff(spline.at(s).curvature_rate)).max() < 0.02


def test_a_loop_closes_smoothly():
    loop = KINDS["loop"]
    start, end = loop.at(0.0), loop.at(loop.length)
    assert loop.closed
    assert float(start.x) == pytest.approx(float(end.x))
    assert float(start.y) == pytest.approx(float(end.y))
    assert float(start.curvature) == pytest.approx(float(end.curvature), abs=1e-6)
    assert loop.total_turn == pytest.approx(2 * math.pi)


def test_noisy_uneven_and_repeated_points_become_a_fair_curve():
    rng = np.random.default_rng(3)
    u = np.sort(np.concatenate([rng.uniform(0, 10, 250), [2.0, 2.0, 2.0]]))
    points = np.stack([u, np.sin(u)], axis=1) + rng.normal(0, 0.01, (len(u), 2))
    points = np.concatenate([points[:100], points[99:100], points[100:]])
    fair = Spline(points=tuple(map(tuple, points)), tolerance=0.04)
    worst, rms = fair.deviation
    assert worst <= 0.045
    assert 0.005 < rms < 0.02
    bend = np.abs(fair.at(np.linspace(0.5, fair.length - 0.5, 4001)).curvature)
    assert bend.max() < 1.6  # the sine's own is 1


def test_nurbs_is_the_textbook_formula():
    u = 0.3
    basis = [(1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u * u * (1 - u), u**3]
    points = np.array([(0, 0), (1, 2), (3, 2), (4, 0)])
    weights = np.array([1.0, 2.0, 0.5, 1.0])
    bezier = Nurbs(
        degree=3, knots=(0, 0, 0, 0, 1, 1, 1, 1), points=tuple(map(tuple, points)),
        weights=tuple(weights),
    )  # fmt: skip
    expected = (basis * weights) @ points / (basis @ weights)
    assert bezier._derivative(np.array([u]), 0)[0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Spline(points=((1.0, 1.0),)), "two different points"),
        (lambda: Spline(points=((1.0, 1.0), (1.0, 1.0))), "two different points"),
        (lambda: Spline(points=((1.0, 1.0), (math.nan, 1.0))), "finite"),
        (lambda: Line(distance=-1.0), r"Line\.distance = -1\.0: must be greater than 0 \(m\)"),
        (lambda: Arc(radius=1.0, angle=0.0), "use a line"),
        (
            lambda: Chain(segments=(Segment(length=1.0), Segment(length=1.0, curvature=0.5))),
            r"jumps by 0\.5 1/m at s = 1 m; must continue with 0 1/m \(put a clothoid between\)",
        ),
        (
            lambda: Composite(pieces=(Line(distance=1.0), Line(start=Pose(x=1.2), distance=1.0))),
            r"its position jumps by 0\.2 m at s = 1 m",
        ),
        (
            lambda: Composite(
                pieces=(Line(distance=1.0), Line(start=Pose(x=1.0, heading=0.1), distance=1.0))
            ),
            r"its heading jumps by 0\.1 rad",
        ),
        (lambda: Nurbs(degree=3, knots=(0, 1), points=((0, 0), (1, 1))), "must be 6 numbers"),
        (
            lambda: Nurbs(
                degree=2, knots=(0, 0, 0, 0.5, 1, 1, 1), points=((0, 0), (1, 0), (1, 1), (3, 1))
            ),
            "the curvature jumps there by",
        ),
        (lambda: Laps(track=Line(distance=1.0), count=2), "must be a closed curve"),
        (lambda: Chain.corner(1.0, 0.5, 0.6, 1.0), r"ramp = 0\.6: must be below 0\.5 m"),
    ],
)
def test_impossible_curves_are_explained(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()


def test_files_of_all_formats(tmp_path):
    def wrote(name, text):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return read_curve(path)

    rows = "\n".join(f"{x},{y}" for x, y in WAYPOINTS)
    plain = wrote("plain.csv", rows)
    named = wrote("named.csv", "y,x\n" + "\n".join(f"{y},{x}" for x, y in WAYPOINTS))
    poses = [{"pose": {"position": {"x": x, "y": y, "z": 0}}} for x, y in WAYPOINTS]
    ros = wrote("path.json", json.dumps({"header": {}, "poses": poses}))
    text = "poses:\n" + "".join(
        f"- pose:\n    position: {{x: {x}, y: {y}}}\n" for x, y in WAYPOINTS
    )
    ros_yaml = wrote("path.yaml", text)
    for curve in (named, ros, ros_yaml):
        assert curve == plain
    lines = "\n".join(f"{s}; {x}; {y}; 0; 0; 1; 0" for s, (x, y) in enumerate(WAYPOINTS))
    assert (
        wrote("line.csv", f"# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n{lines}")
        == plain
    )
    trajectory = {
        "degree": NURBS.degree, "knotVector": NURBS.knots,
        "controlPoints": [
            {"x": x, "y": y, "weight": w}
            for (x, y), w in zip(NURBS.points, NURBS.weights, strict=True)
        ],
    }  # fmt: skip
    vda = wrote("order.json", json.dumps({"edges": [{"trajectory": trajectory}]}))
    assert vda == NURBS
    ring = "\n".join(
        f"{10 * math.cos(t)},{10 * math.sin(t)},1.1,1.1"
        for t in np.linspace(0, 2 * math.pi, 60)[:-1]
    )
    track = wrote("track.csv", f"# x_m,y_m,w_tr_right_m,w_tr_left_m\n{ring}")
    assert track.closed
    assert track.length == pytest.approx(20 * math.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "1,2\n3,zebra\n", "line 2 = .*|line 2'.*is no point"),
        ("a.csv", "1,2\n", "two different points"),
        ("a.csv", "", "must hold lines with x and y"),
        ("a.csv", "1,2\nnan,3\n4,5\n", "must be finite"),
        ("a.json", "{", "is not valid JSON"),
        ("a.json", '{"poses": [{"x": 1}]}', "a nav_msgs/Path or a list"),
    ],
)
def test_wrong_files_are_explained(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInput, match=message):
        read_curve(path)


def test_units_that_look_wrong_are_pointed_out(tmp_path):
    path = tmp_path / "gps.csv"
    path.write_text("13.40,52.52\n13.41,52.53\n13.42,52.52\n", encoding="utf-8")
    with pytest.warns(UserWarning, match="degrees"):
        read_curve(path)
    path.write_text("0,0\n50000,100\n90000,0\n", encoding="utf-8")
    with pytest.warns(UserWarning, match="millimetres"):
        read_curve(path)


def test_tracks_from_elsewhere(shared_data):
    for path in sorted((shared_data / "tracks").glob("*.csv")):
        track = read_curve(path, scale=0.1)
        assert track.closed
        assert abs(track.total_turn) == pytest.approx(2 * math.pi)
        fair = read_curve(path, scale=0.1, tolerance=0.02)
        assert fair.deviation[0] <= 0.025
        assert fair.length == pytest.approx(track.length, rel=1e-3)


poses = st.builds(
    Pose, x=st.floats(-5, 5), y=st.floats(-5, 5), heading=st.floats(-math.pi, math.pi)
)


@given(poses, poses)
def test_a_dubins_path_ends_at_its_goal(start, goal):
    from osculate.curve.approach import _moved

    legs = dubins(start, goal, 0.7)
    at = start
    for leg in legs:
        at = _moved(at, leg.side, leg.length, 0.7)
    assert (at.x, at.y) == pytest.approx((goal.x, goal.y), abs=1e-6)
    assert math.cos(at.heading - goal.heading) == pytest.approx(1.0, abs=1e-9)
    direct = math.hypot(goal.x - start.x, goal.y - start.y)
    assert direct - 1e-9 <= sum(leg.length for leg in legs) <= direct + 4 * math.pi * 0.7 + 1e-9


@pytest.mark.parametrize("turned", [math.pi, 2.0, -2.5])
def test_an_approach_leaves_straight_and_joins_smoothly(turned):
    curve = Cycloid.over()
    begin = curve.at(0.0)
    start = Pose(x=float(begin.x), y=float(begin.y), heading=float(begin.heading) + turned)
    way, length = plan_approach(curve, start, tightest=6.0)
    first = way.at(0.0)
    assert (float(first.x), float(first.y)) == pytest.approx((start.x, start.y))
    assert math.cos(float(first.heading) - start.heading) == pytest.approx(1.0)
    assert float(first.curvature) == pytest.approx(0.0, abs=1e-9)
    around = way.at(np.array([length - 1e-6, length + 1e-6]))
    assert np.diff(around.curvature)[0] == pytest.approx(0.0, abs=1e-2)
    assert np.abs(way.at(np.linspace(0, length, 2001)).curvature).max() <= 0.92 * 6.0


def test_an_approach_that_cannot_be_is_refused():
    with pytest.raises(NoSolution, match="no approach from"):
        plan_approach(Line(distance=0.5), Pose(y=3.0, heading=3.0), tightest=0.5, begin=0.4999)
    with pytest.raises(InvalidInput, match="must be"):
        Parametric(x="p", y="0", end=-1.0)
