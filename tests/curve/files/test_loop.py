"""Open or closed: the gap and the heading at the join decide, overruns are cut, reversals refused."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from osculate import InvalidInput
from osculate.curve.files import read_file
from osculate.curve.files.checks import turning
from osculate.curve.files.loop import closure


def put(folder, points, name="points.csv"):
    path = folder / name
    path.write_text("x,y\n" + "".join(f"{x:.5f},{y:.5f}\n" for x, y in points), encoding="utf-8")
    return path


def ring(count, radius=5.0, start=0.0, turns=1.0):
    a = start + np.linspace(0.0, 2 * np.pi * turns, count)
    return radius * np.stack([np.cos(a), 0.7 * np.sin(a)], axis=1)


@given(count=st.integers(12, 200), gap=st.floats(0.05, 3.0), start=st.floats(0, 6))
def test_a_ring_is_closed_while_its_gap_is_below_one_and_a_half_steps(count, gap, start):
    a = start + np.arange(count) / (count - 1 + gap) * 2 * np.pi
    points = 5.0 * np.stack([np.cos(a), np.sin(a)], axis=1)
    chord = math.sin(math.pi * gap / (count - 1 + gap)) / math.sin(math.pi / (count - 1 + gap))
    assume(abs(chord - 1.5) > 0.02)
    found = closure(points, None)
    assert found.closed == (chord < 1.5)
    assert found.kept == count
    assert "steps" in found.why
    assert closure(points, True).closed
    assert not closure(points, False).closed


@given(width=st.floats(0.3, 0.7), step=st.floats(0.4, 0.5))
def test_a_road_back_beside_itself_stays_open(width, step):
    out = np.stack([np.arange(0, 20, step), np.zeros(len(np.arange(0, 20, step)))], axis=1)
    back = out[::-1] + [0.0, width]
    arc = np.array([[out[-1, 0] + width / 2, width / 2]])
    road = np.concatenate([out, arc, back])
    found = closure(road, None)
    assert not found.closed
    if width < 1.5 * step - 0.01:
        assert "but the heading turns by" in found.why
        assert "--loop closes it" in found.why


@given(
    count=st.integers(30, 120),
    over=st.integers(1, 10),
    phase=st.floats(0.0, 0.99),
    still=st.integers(0, 3),
)
def test_a_lap_that_runs_on_past_its_start_is_cut_there(count, over, phase, still):
    step = 2 * np.pi / (count + phase)
    a = np.arange(count + 1 + over) * step
    points = 5.0 * np.stack([np.cos(a), np.sin(a)], axis=1)
    points = np.concatenate([np.repeat(points[:1], still, axis=0), points])
    found = closure(points, None)
    assert found.closed
    whole = points[: found.kept]
    assert abs(len(whole) - still - count) <= 1
    gap = np.hypot(*(whole[-1] - whole[0]))
    assert 0.2 * 5 * step < gap < 1.5 * 5 * step


def test_several_laps_stay_open_and_say_so(tmp_path):
    reading = read_file(put(tmp_path, ring(200, turns=3.2)))
    assert not reading.closed
    assert "passes its start" in reading.why
    assert "several laps" in reading.why


def test_a_first_point_written_twice_closes_even_a_few_points(tmp_path):
    for last in ((0.0, 0.0), (0.0001, 0.0)):
        reading = read_file(put(tmp_path, [(0, 0), (1, -1), (2, 0), (1, 1), last]))
        assert reading.closed
        assert len(reading.points) == 4
        assert reading.curve.length == pytest.approx(6.274, abs=2e-3)
    assert not read_file(put(tmp_path, [(0, 0), (1, 0), (1, 1), (0, 1)])).closed
    assert read_file(put(tmp_path, [(0, 0), (1, 0), (1, 1), (0, 1)]), loop=True).closed
    with pytest.raises(InvalidInput, match="on one line: that is no loop"):
        read_file(put(tmp_path, [(0, 0), (1, 0), (2, 0), (1.5, 0)]), loop=True)


@given(
    ahead=st.integers(6, 60),
    back=st.integers(4, 60),
    heading=st.floats(-3, 3),
    bend=st.floats(-0.1, 0.1),
    step=st.sampled_from([0.05, 0.25, 2.0]),
    still=st.sampled_from([0, 1, 9]),
)
def test_a_path_that_turns_round_is_refused_at_the_place(ahead, back, heading, bend, step, still):
    h = heading + 0.02 * np.arange(ahead)
    there = np.concatenate([[[0, 0]], np.cumsum(step * np.stack([np.cos(h), np.sin(h)], 1), 0)])
    g = h[-1] + np.pi + bend * np.arange(min(back, 12))
    away = there[-1] + np.cumsum(step * np.stack([np.cos(g), np.sin(g)], 1), axis=0)
    turn = turning(np.concatenate([there, np.repeat(there[-1:], still, axis=0), away]))
    assert turn.point == ahead
    assert turn.place == pytest.approx(ahead * step)
    assert turning(there) is None


@given(st.integers(0, 10_000), st.sampled_from([0.001, 0.01, 0.03]))
def test_noise_and_standing_still_are_no_reversal(seed, noise):
    rng = np.random.default_rng(seed)
    a = np.linspace(0.0, 4.0, 300)
    points = 4.0 * np.stack([np.cos(a), np.sin(a)], axis=1)
    points = np.concatenate([np.repeat(points[:1], 20, axis=0), points])
    assert turning(points + rng.normal(0, noise, points.shape)) is None


def test_the_message_of_a_reversal_names_point_and_line(tmp_path):
    there = [(0.25 * n, 0.0) for n in range(13)]
    path = put(tmp_path, [*there, *((3 - 0.25 * n, -0.02 * n * n) for n in range(1, 9))])
    with pytest.raises(
        InvalidInput, match=r"turns round at point 12 \(line 14\) = \(3, 0\), s = 3 m"
    ):
        read_file(path)


def test_far_jumps_are_pointed_out(tmp_path):
    points = [(0.1 * n, 0.0) for n in range(20)] + [(50 + 0.1 * n, 1.0) for n in range(20)]
    with pytest.warns(UserWarning, match=r"jumps by 48.* m from line 21 to line 22"):
        read_file(put(tmp_path, points))


def test_recorded_laps(shared_data):
    folder = shared_data / "files"
    with pytest.warns(UserWarning, match="points at the end, 2.42 m past the start, are left out"):
        assert read_file(folder / "tmp02_xypose.csv").closed
    almost = read_file(folder / "sim_waypoints1.csv")
    assert not almost.closed
    assert "0.658 m apart (1.6 steps)" in almost.why
