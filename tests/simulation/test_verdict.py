"""Verdicts: what happened first, in one word; single runs, batches, and the kernel that watches."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from osculate import (
    Actuated,
    Continuous,
    CurvatureTracker,
    Cycloid,
    Disc,
    Disturbance,
    InitialState,
    Limits,
    Line,
    Modified,
    Natural,
    Safety,
    Sampled,
    Scene,
    Shove,
    Spline,
    Static,
    StuckSteering,
    Tricycle,
    VerdictKind,
    simulate,
    simulate_batch,
    vehicle_named,
)
from osculate.errors import NoSolution
from osculate.kernel import names
from osculate.scene.contact import penetration
from osculate.simulation.events import (
    BACKWARD,
    LEFT,
    NOTHING,
    REVERSED,
    SPUN,
    Event,
    EventParameters,
    no_events,
    slides,
    watch_events,
)
from osculate.simulation.hits import HitWatch
from osculate.simulation.loop import BLANK, path_end, size
from osculate.simulation.records import DIVERGED, FINISHED, RUNNING, STOPPED
from osculate.simulation.tally import empty_tally
from osculate.simulation.verdict import EXIT_CODES, Hit, Outcome, infeasible, judge
from osculate.vehicle import Motion

CURVE = Cycloid.over()
KINDS = {LEFT: "left", REVERSED: "reversed", SPUN: "left"}
STEP = 0.01
LANE = EventParameters(half_width=0.5, strict=0.0, settled=0.0, wheelbase=0.4, sliding=0.15)
OUTCOME = Outcome(
    code=FINISHED, tipped=0.0, time=10.0, place=8.0, arc_length=8.0, x=8.0, y=0.5, speed=0.0,
    cross_track=0.01, intervention=0.0, excess=0.0, cause=0.0, stop=0.0, slid=-1e9,
    first=Event(NOTHING, 0.0, 0.0, 0.0, 0.0, 0.0), length=8.0, closed=0.0, timed=0.0, timetable=0.0,
    half_width=1.0, given=0.0,
)  # fmt: skip


def but(**changes):
    return OUTCOME._replace(**changes)


times = st.floats(0.0, 10.0)


@given(
    st.sampled_from([RUNNING, FINISHED, DIVERGED, STOPPED]),
    st.sampled_from([NOTHING, LEFT, REVERSED, SPUN]),
    times,
    st.none() | times,
    st.booleans(),
)
def test_the_first_in_time_counts_and_the_end_is_told(code, kind, when, touched, slid):
    stop = 4.0 if code == STOPPED else 0.0
    outcome = but(code=code, stop=stop, first=Event(kind, when, 2.0, 2.5, 0.5, float(slid)))
    hit = None if touched is None else Hit(3, "disc", 0.125, touched, 4.0, 4.5, 0.25)
    verdict = judge(outcome, hit)
    ending = {RUNNING: "reached", FINISHED: "reached", DIVERGED: "diverged", STOPPED: "stopped"}
    discounted = code == DIVERGED and not slid  # leaving and turning back on the way to infinity
    assert (touched is None) == ("obstacle 3 (disc)" not in verdict.sentence)
    if hit and (kind == NOTHING or touched <= when or discounted):
        assert (verdict.kind, verdict.time, verdict.place) == ("hit", touched, 4.0)
        assert (verdict.obstacle, verdict.penetration, verdict.x) == (3, 0.125, 4.5)
        assert "obstacle 3 (disc)" in verdict.sentence
        assert "125 mm deep" in verdict.sentence
    elif kind != NOTHING and discounted:
        assert (verdict.kind, verdict.time, verdict.place) == ("diverged", 10.0, 8.0)
        assert "; before that it " in verdict.sentence
        assert "(2.500, 0.500) m" in verdict.sentence
    elif kind != NOTHING:
        assert (verdict.kind, verdict.time, verdict.place) == (KINDS[kind], when, 2.0)
        assert ("slid" in verdict.sentence, verdict.reason == "slid") == (slid, slid)
        assert "(2.500, 0.500) m" in verdict.sentence
    else:
        assert (verdict.kind, verdict.time, verdict.place) == (ending[code], 10.0, 8.0)
    assert ("it then" in verdict.sentence) == (verdict.time < 10.0)
    assert verdict.reached == (verdict.kind is VerdictKind.REACHED)
    assert json.loads(json.dumps(verdict.as_dict(), allow_nan=False))["kind"] == verdict.kind
    assert str(verdict) == f"{verdict.kind}: {verdict.sentence}"


def test_every_kind_has_its_exit_code():
    assert {str(kind): code for kind, code in EXIT_CODES.items()} == {
        "reached": 0, "infeasible": 2, "hit": 10, "left": 11, "stopped": 12, "diverged": 13,
        "late": 14, "reversed": 15,
    }  # fmt: skip
    assert set(EXIT_CODES) == set(VerdictKind)
    assert infeasible(NoSolution("it cannot")).exit_code == 2


@given(st.sampled_from([RUNNING, FINISHED]), st.floats(-0.3, 0.3), st.booleans())
def test_a_tracker_is_there_within_20_mm(code, short, closed):
    assume(abs(abs(short) - 0.02) > 1e-9)
    outcome = but(code=code, place=8.0 - short, closed=float(closed))
    expected = "late" if short > 0.02 else "left" if short < -0.02 and not closed else "reached"
    assert judge(outcome).kind == expected
    assert (f"{1e3 * abs(short):.3g} mm" in judge(outcome).sentence) == (abs(short) >= 1e-3)


@given(st.floats(-1e-4, 1e-4), st.floats(0.002, 2.0))
def test_a_robot_that_rolls_over_the_end_has_left_however_the_landing_rounds(error, speed):
    over = path_end(Line(distance=8.0), Limits())
    assert judge(but(place=over + error, speed=speed)).kind == "left"


@given(st.booleans(), st.booleans(), st.floats(-2.0, 2.0), st.floats(-1.0, 1.0), st.floats(0, 90))
def test_a_law_of_the_paper_is_there_whatever_its_speed(done, table, short, behind, speed):
    assume(min(abs(short - 1.0), abs(behind - 0.02)) > 1e-9)
    code = FINISHED if done else RUNNING
    outcome = but(
        code=code, timed=1.0, timetable=float(table), place=8.0 - short, arc_length=8.0 - behind,
        speed=speed,
    )  # fmt: skip
    there = (done or behind <= 0.02) and short < 1.0
    assert judge(outcome).kind == ("reached" if there else "late")
    assert f"moving at {speed:.3f} m/s" in judge(outcome).sentence


def test_a_robot_that_never_came_onto_the_path_has_left_it():
    assert judge(but(cross_track=-1.25)).kind == "left"
    assert "1.25 m off the path" in judge(but(cross_track=-1.25)).sentence
    assert judge(but(cross_track=0.4, half_width=0.3)).kind == "left"
    assert judge(but(tipped=1.0, code=DIVERGED)).reason == "tipped"
    fell = judge(but(tipped=1.0, code=DIVERGED, slid=9.0))  # 1 s before the end
    assert (fell.kind, fell.reason) == ("left", "slid")
    assert fell.sentence.startswith("slid and tipped over at t = 10.000 s")
    assert judge(but(code=DIVERGED, slid=9.0)).reason == "slid"
    assert judge(but(code=DIVERGED, slid=7.0)).reason == ""


def watched(samples, p=LANE):
    """Events of samples: cross track, heading error, speed, arc length; and sideways speed."""
    memory, x, y = no_events(0.0, 0.0), 0.0, 0.0
    for n, (off, turned, speed, foot, aside) in enumerate(samples):
        x, y = (x + STEP * speed, y + STEP * aside) if n else (x, y)
        tally = empty_tally(foot)._replace(cross_track=off, heading_error=turned)
        motion = Motion(x, y, 0.0, speed, 0.0, 0.0)
        elapsed = STEP if n else 0.0
        memory = watch_events.py_func(STEP * n, elapsed, motion, tally, memory, p)
    return memory


walks = st.lists(st.floats(-0.9, 0.9), min_size=2, max_size=40)


@settings(max_examples=60, deadline=None)
@given(walks, st.booleans(), st.sampled_from([0.0, 0.1]))
def test_leaving_is_the_first_sample_outside_after_one_inside(walk, strict, settled):
    p = LANE._replace(strict=float(strict), settled=settled)
    feet = [0.02 * n for n in range(len(walk))]
    first = watched([(off, 0.0, 1.0, s, 0.0) for off, s in zip(walk, feet, strict=True)], p).first
    inside = [abs(off) < 0.5 for off in walk]
    expected = None
    for n, foot in enumerate(feet):
        counts = settled == 0.0 or foot >= settled
        been = any(inside[:n]) and (counts or strict)
        if not inside[n] and (been or (settled > 0.0 and counts)):
            expected = n
            break
    assert (first.kind, first.time, first.place) == (
        (NOTHING, 0.0, 0.0) if expected is None else (LEFT, STEP * expected, feet[expected])
    )


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=2, max_size=60))
def test_going_backwards_is_the_largest_retreat_along_the_path(moves):
    samples = [(0.0, turned, speed, 1.0, 0.0) for speed, turned in moves]
    ahead = STEP * np.array([speed * math.cos(turned) for speed, turned in moves])
    ahead[0] = 0.0
    place = np.cumsum(ahead)
    retreat = np.maximum.accumulate(np.maximum(place, 0.0)) - place
    assume(np.abs(retreat - BACKWARD).min() > 1e-9)
    first = watched(samples).first
    late = np.flatnonzero(retreat >= BACKWARD)
    assert first.kind == (REVERSED if late.size else NOTHING)
    if late.size:
        assert first.time == STEP * late[0]


@pytest.mark.parametrize(("aside", "slid"), [(0.1, 0.0), (0.3, 1.0), (-0.3, 1.0)])
def test_sliding_is_more_than_creep(aside, slid):
    samples = [(0.0, 0.0, 1.0, 1.0, aside)] * 3 + [(0.6, 0.0, 1.0, 1.0, 0.0)]
    assert watched(samples).first.slid == slid
    back = [(0.0, 0.0, 1.0, 1.0, aside)] * 3 + [(0.0, math.pi, 1.0, 1.0, 0.0)] * 11
    assert watched(back).first.kind == (SPUN if slid else REVERSED)
    assert watched(samples, LANE._replace(sliding=math.inf)).first.slid == 0.0


SCENE = Scene(obstacles=(Disc(x=5.0, y=6.0, radius=0.3),), corridor=0.6)
PARTS = {"target": Modified(), "clock": Continuous(duration=4.0)}


def test_a_batch_has_the_verdicts_of_its_runs():
    starts = [InitialState(cross_track=c) for c in (0.0, 0.3, 0.5, 0.8, -0.3)]
    batch = simulate_batch(CURVE, initial=starts, scene=SCENE, **PARTS)
    alone = [simulate(CURVE, initial=start, scene=SCENE, **PARTS) for start in starts]
    assert list(batch.verdicts) == [run.verdict for run in alone]
    assert [v.kind for v in batch.verdicts] == ["late", "hit", "hit", "hit", "late"]
    assert batch.data.verdict.values.tolist() == [str(v.kind) for v in batch.verdicts]
    depth = [v.penetration for v in batch.verdicts[1:4]]
    assert 0.0 < depth[0] < depth[1]
    for run in alone[1:4]:
        c, v = run.columns, run.verdict
        n = int(np.flatnonzero(run.clearance <= 0.0)[0])
        assert (v.time, v.place, v.x, v.y) == (c["time"][n], c["foot"][n], c["x"][n], c["y"][n])


def test_where_errors_begin_to_count_varies_by_one_name():
    start, scene = InitialState(heading_error=0.6), Scene(corridor=0.2)
    places = [0.0, 3.0, 20.0]
    batch = simulate_batch(CURVE, initial=start, scene=scene, vary={"settled": places}, **PARTS)
    alone = [
        simulate(CURVE, initial=start.but(settled=place), scene=scene, **PARTS) for place in places
    ]
    assert list(batch.verdicts) == [run.verdict for run in alone]
    assert len({run.verdict.time for run in alone}) > 1


def test_a_lane_that_ends_inside_an_obstacle_waits_without_going_deeper():
    """The deepest place is the last one, at an instant of its own, long before the block ends."""
    end = CURVE.at(CURVE.length)
    ahead = Tricycle().footprint.front
    x, y = end.x + ahead * math.cos(end.heading), end.y + ahead * math.sin(end.heading)
    scene = Scene(obstacles=(Disc(x=float(x), y=float(y), radius=0.1),))
    starts = [InitialState(arc_length=s) for s in (12.0, 11.0, 2.0)]
    batch = simulate_batch(CURVE, initial=starts, scene=scene, **PARTS)
    alone = [simulate(CURVE, initial=start, scene=scene, **PARTS) for start in starts]
    assert list(batch.verdicts) == [run.verdict for run in alone]
    for run in alone[:2]:
        last = {name: run.columns[name][-1] for name in ("x", "y", "heading")}
        outline = scene.obstacles[0].outline((0.0, 0.0))
        depth = penetration(outline, run.setup.robot.footprint.corners, **last)
        assert run.metrics.ended == "path end"
        assert run.verdict.penetration == depth > 0.05


def test_what_a_lane_records_after_its_end_is_no_hit():
    """Until its block ends a lane stands a moment before its landing, here deeper inside."""
    scene = Scene(obstacles=(Disc(x=2.0, y=0.0, radius=0.1),))
    setup = SimpleNamespace(curve=Line(distance=6.0), robot=Tricycle())
    watch = HitWatch([setup], [scene], BLANK)
    touching = 1.9 - setup.robot.footprint.front
    for instants in ([(0.0, -0.1), (0.5, 0.05), (1.0, 0.08), (1.5, 0.08)], [], [(0.75, 0.02)]):
        rows = np.zeros((len(instants), size(BLANK), 64))
        for row, (t, deep) in zip(rows, instants, strict=True):
            row[list(names(BLANK)).index("time")] = t
            row[list(names(BLANK)).index("motion.x")] = touching + deep
        watch.see(rows)
    (hit,) = watch.hits()
    assert hit.time == 0.5
    assert hit.penetration == pytest.approx(0.05, abs=1e-3)


def test_a_batch_with_obstacles_keeps_the_same_record():
    parts = {"initial": [InitialState(), InitialState(cross_track=0.5)], "record_every": 7, **PARTS}
    with_obstacles = simulate_batch(CURVE, scene=SCENE, **parts)
    assert np.array_equal(with_obstacles.record, simulate_batch(CURVE, **parts).record)


def test_the_papers_laws_leave_and_arrive():
    parts = {"target": Static(profile=Natural())}
    fine = simulate(CURVE, **parts).verdict
    assert fine.kind == "reached"
    assert "completed its timetable at t = 5.259 s" in fine.sentence
    run = simulate(CURVE, disturbance=Disturbance.internal(5, 5), **parts)
    off, v = np.abs(run.columns["cross_track_error"]), run.verdict
    n = int(np.flatnonzero(off >= 1.0)[0])
    assert (v.kind, v.time) == ("diverged", run.columns["time"][-1])
    told = f"before that it left the path by 1 m at t = {run.columns['time'][n]:.3f} s"
    assert told in v.sentence


SLALOM = Spline(points=((0, 0), (1.5, 0.5), (3, 0), (4.5, -0.5), (6, 0)))
SHORT = Sampled(period=0.01, delay=0.01, duration=2.0)


@pytest.mark.parametrize("name", ["paper", "tugger", "forklift"])
def test_trackers_of_all_robots(name):
    """Late where the clock ends, hit where an obstacle is, reversed, diverged, left."""
    robot = vehicle_named(name)
    path = Line(distance=6.0)
    same = {"controller": CurvatureTracker(), "limits": Limits(speed=1.0), "plant": Actuated()}
    there = robot.footprint.front + 0.3
    where = Scene(obstacles=(Disc(x=there, y=0.0, radius=0.1),))

    def verdict(scene=None, **parts):
        return simulate(path, robot, scene=scene, **{**same, "clock": SHORT, **parts}).verdict

    assert verdict().kind == "late"
    hit = verdict(where)
    assert (hit.kind, hit.obstacle) == ("hit", 1)
    assert hit.place == pytest.approx(0.2, abs=2e-3)
    back = verdict(faults=(Shove(time=0.1, along=-30.0, duration=0.2),))
    assert back.kind == "reversed"
    wild = verdict(faults=(Shove(time=0.1, along=1e9),))
    assert wild.kind == "diverged"
    aside = {"initial": InitialState(heading_error=0.6), "scene": Scene(corridor=0.03)}
    assert verdict(**aside).kind == "left"
    assert "corridor of 0.03 m to each side" in verdict(**aside).sentence
    later = verdict(initial=InitialState(heading_error=0.6, settled=5.0), scene=aside["scene"])
    assert later.time > verdict(**aside).time


def test_a_safety_stop_says_why():
    parts = {
        "controller": CurvatureTracker(), "limits": Limits(speed=1.0), "safety": Safety(),
        "faults": (StuckSteering(time=2.0),),
    }  # fmt: skip
    run = simulate(SLALOM, **parts)
    assert run.verdict.kind == "stopped"
    assert "the steering does not obey" in run.verdict.reason
    assert run.verdict.reason in run.verdict.sentence
    assert str(run.verdict).count("stopped") == 1


def test_mujoco_names_sliding():
    pytest.importorskip("mujoco")
    from osculate import Mujoco

    x = np.linspace(0, 12, 49)
    curve = Spline(points=tuple(zip(x, 0.8 * np.sin(2 * np.pi * x / 6), strict=True)))
    parts = {
        "limits": Limits(speed=1.5), "plant": Mujoco(friction=0.2), "scene": Scene(corridor=0.1),
    }  # fmt: skip
    with pytest.warns(UserWarning, match="the robot may slide on a floor with the friction 0.2"):
        run = simulate(curve, controller=CurvatureTracker(), **parts)
    assert run.verdict.kind == "left"
    assert run.verdict.reason == "slid"
    assert "slid" in run.verdict.sentence


def test_a_start_that_is_to_be_made_good_has_left_if_it_is_not():
    samples = [(0.7, 0.0, 1.0, 0.02 * n, 0.0) for n in range(20)]
    assert watched(samples).first.kind == NOTHING
    left = watched(samples, LANE._replace(settled=0.15)).first
    assert (left.kind, left.place) == (LEFT, 0.16)


@given(st.floats(-2, 2), st.floats(-1.2, 1.2), st.floats(-3, 3), st.floats(-0.9, 0.9))
def test_wheels_slide_when_they_move_over_the_ground(speed, angle, heading, slip):
    """A robot that turns as its wheel is steered rolls; one that turns otherwise slides at the front."""
    allowed = math.hypot(0.15, 0.2 * speed)
    assume(abs(abs(slip) - allowed) > 1e-6)
    turning = speed * math.tan(angle) + slip / math.cos(angle)
    x, y = STEP * speed * math.cos(heading), STEP * speed * math.sin(heading)
    motion = Motion(x, y, heading, speed, turning / LANE.wheelbase, angle)
    assert slides.py_func(STEP, motion, 0.0, 0.0, LANE) == (abs(slip) > allowed)
    along = motion._replace(speed=0.0, yaw_rate=0.0, steering_angle=0.0)
    assume(abs(abs(speed) - 0.15) > 1e-6)
    assert slides.py_func(STEP, along, 0.0, 0.0, LANE) == (abs(speed) > 0.15)  # blocked wheels


@pytest.mark.filterwarnings("ignore:the robot may slide")
def test_a_robot_that_rolls_past_the_end_has_left_the_path():
    """It is clearly beyond what counts as reached: rounding does not decide."""
    run = simulate(
        Line(distance=800.0),
        controller=CurvatureTracker(),
        limits=Limits(speed=30.0, acceleration=5.0, deceleration=5.0),
        clock=Sampled(period=0.05, delay=0.05, step=0.05, duration=600.0),
    )
    assert run.columns["speed"][-1] > 1.0
    assert run.verdict.kind is VerdictKind.LEFT
    assert run.verdict.reason == "ran past the end"
