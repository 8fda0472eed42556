"""Obstacles and the clearance of a footprint to them."""

import numpy as np
import pytest

from osculate import Block, Disc, InvalidInput, Scene, Wall

pytestmark = pytest.mark.core

SQUARE = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


def clearance(scene, x, y, heading=0.0):
    return scene.clearance((0.0, 0.0), SQUARE, *(np.array([v]) for v in (x, y, heading)))[0]


def test_the_wall_stands_where_the_paper_puts_it():
    outline = Wall(distance=10, height=5, width=2).outline((1.0, 0.5))
    assert outline[:, 0].mean() == pytest.approx(11.0)
    assert (outline[:, 1].min(), outline[:, 1].max()) == (0.5, 5.5)
    assert np.ptp(outline[:, 0]) == pytest.approx(2.0)


def test_clearance_is_the_distance_between_outlines():
    scene = Scene(obstacles=(Wall(distance=10, height=5, width=2),))
    assert clearance(scene, 6.0, 2.0) == pytest.approx(2.5)
    assert clearance(scene, 6.0, 2.0, np.pi / 4) == pytest.approx(3.0 - np.sqrt(0.5))
    assert clearance(scene, 9.0, 2.0) == 0.0


def test_the_nearest_obstacle_counts():
    disc = Disc(x=0.0, y=4.0, radius=1.0)
    block = Block(corners=((2.0, -1.0), (3.0, -1.0), (3.0, 1.0), (2.0, 1.0)))
    assert clearance(Scene(obstacles=(disc,)), 0.0, 0.0) == pytest.approx(2.5, abs=0.01)
    assert clearance(Scene(obstacles=(disc, block)), 0.0, 0.0) == pytest.approx(1.5, abs=0.01)


def test_a_disc_is_never_drawn_too_small():
    outline = Disc(x=1.0, y=2.0, radius=3.0).outline((0.0, 0.0))
    middles = 0.5 * (outline + np.roll(outline, 1, axis=0)) - [1.0, 2.0]
    assert np.hypot(*middles.T).min() == pytest.approx(3.0)


def test_an_empty_scene_is_infinitely_far():
    assert clearance(Scene(), 0.0, 0.0) == np.inf


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Wall(height=-1), "Wall.height = -1: must be greater than 0 \\(m\\)"),
        (lambda: Disc(x=0, y=0, radius=0), "Disc.radius"),
        (lambda: Disc(x=0, y=0), "required field is missing"),
        (lambda: Block(corners=((0, 0), (1, 1))), "at least three"),
        (lambda: Scene(obstacles=({"kind": "moat"},)), "moat"),
    ],
)
def test_bad_obstacles_are_explained(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()
