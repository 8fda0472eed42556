"""Contacts: which obstacle is touched first, and how deep a robot goes into it."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from osculate import Block, Disc, InvalidInput, Scene, Wall
from osculate.scene import first_contact
from osculate.scene.contact import penetration

BODY = ((-0.2, -0.15), (0.6, -0.15), (0.6, 0.15), (-0.2, 0.15))
ORIGIN = (0.0, 0.0)
OUTLINES = {
    "box": np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]),
    "notched": np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.0, 2.0]]),
    "disc": Disc(x=0.5, y=0.5, radius=0.4).outline(ORIGIN),
}


def body_at(x, y, heading):
    c, s = math.cos(heading), math.sin(heading)
    return shapely.Polygon([(x + c * a - s * b, y + s * a + c * b) for a, b in BODY])


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(sorted(OUTLINES)),
    st.floats(-0.8, 2.5),
    st.floats(-0.8, 2.5),
    st.floats(-math.pi, math.pi),
)
def test_moved_by_the_depth_a_robot_is_free_and_by_less_in_no_direction(name, x, y, heading):
    outline = OUTLINES[name]
    obstacle, depth = shapely.Polygon(outline), penetration(outline, BODY, x, y, heading)
    assert (depth > 0.0) <= obstacle.intersects(body_at(x, y, heading))
    angles = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)

    def free(shift):
        moved = [body_at(x + shift * math.cos(a), y + shift * math.sin(a), heading) for a in angles]
        return ~shapely.intersects(obstacle, moved)

    if depth == 0.0:
        assert shapely.intersection(obstacle, body_at(x, y, heading)).area < 1e-9
    else:
        assert not free(0.999 * depth - 1e-9).any()
        assert free(1.001 * depth + 1e-3).any()


def drive(scene, x, y=0.0):
    x = np.asarray(x, dtype=float)
    still = np.zeros_like(x)
    distance = scene.clearance(ORIGIN, BODY, x, still + y, still)
    return first_contact(
        scene, ORIGIN, BODY, distance, 0.01 * np.arange(len(x)), x, still + y, still
    )


def test_the_first_obstacle_that_is_touched_counts():
    scene = Scene(obstacles=(Disc(x=3.0, y=0.0, radius=0.1), Wall(distance=2.0, height=0.1)))
    found = drive(scene, np.linspace(0.0, 4.0, 401))
    assert (found.obstacle, found.kind) == (2, "wall")
    assert found.sample == 90  # its front, 0.6 m ahead of O, touches the wall at 1.5 m
    assert found.penetration == pytest.approx(0.15)  # to the right: its half width
    assert drive(scene, [0.0, 0.89]) is None
    assert drive(scene, [0.0, 0.95]).penetration == pytest.approx(0.05)


def test_an_outline_that_crosses_itself_is_refused():
    with pytest.raises(InvalidInput, match="does not cross itself"):
        Block(corners=((0, 0), (1, 1), (1, 0), (0, 1)))
