"""The robot of a film in its own proportions: drive wheels, hull, a fork that steers, the deck above.

Drawn with the steered wheel ahead; for a robot that is steered behind the axle, x changes its sign.
"""

from typing import Any

from osculate.simulation.recording.video.shapes import Mesh, prism
from osculate.vehicle import Tricycle

BLUE, PALE, WHITE = "0.12 0.37 0.66 1", "0.2 0.47 0.78 1", "0.97 0.98 1 1"
TYRE, METAL, DARK = "0.07 0.08 0.09 1", "0.66 0.69 0.73 1", "0.17 0.19 0.22 1"
SPOKES = 5
TURN = 6.283185307179586
INERTIA = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'  # nothing moves by itself


def robot_meshes(robot: Tricycle) -> dict[str, tuple[Mesh, str]]:
    """What is not made of boxes and cylinders, with its colour, by name."""
    r, a, half = robot.wheel_radius, robot.wheelbase, robot.footprint.half_width
    low, high = 2.12 * r, deck_height(robot)
    edge = 0.12 * min(high - low, half)
    inner, swing = half - 1.25 * robot.wheel_width, a - 1.25 * r  # the steered wheel turns ahead
    back = r + (0.3 if robot.steered == "rear" else 1.0) * robot.overhang  # a mast needs room
    nose = a + r + robot.overhang
    hull = _plan(robot, [(-0.9 * back, inner), (0.6 * swing, inner), (swing, 0.5 * inner)], 0.2)
    deck = _plan(robot, [(-back, half), (0.4 * a, half), (nose, 0.36 * half)], 0.22)
    return {
        "hull": (prism(hull, 0.5 * r, low), DARK),
        "deck": (prism(deck, low, high - edge), BLUE),
        "lid": (prism(deck.buffer(-edge), high - edge, high), PALE),
        "arrow": (prism(_arrow(robot), high, high + 0.1 * edge), WHITE),
    }


def robot_parts(robot: Tricycle) -> str:
    """Scanner, wheels, fork, and the mast of a truck: MJCF elements of the body at O."""
    r, side, ahead = robot.wheel_radius, robot.track_width / 2.0, _ahead(robot) * robot.wheelbase
    drives = "".join(
        f'<body name="{name}" pos="0 {y} {r}">{_wheel(robot, name)}</body>'
        for name, y in (("left", side), ("right", -side))
    )
    return f"""{INERTIA}{_scanner(robot)}{_mast(robot) if robot.steered == "rear" else ""}{drives}
      <body name="fork" pos="{ahead} 0 {r}">
        <joint name="steering" axis="0 0 1"/>{INERTIA}{_fork(robot)}
        <body name="steered">{_wheel(robot, "steered")}</body>
      </body>"""


def deck_height(robot: Tricycle) -> float:
    """Height (m) of the deck: the centre of mass lies about halfway between it and the floor."""
    r = robot.wheel_radius
    return max(2.0 * robot.centre_height - 0.5 * r, 2.5 * r)


def _ahead(robot: Tricycle) -> float:
    """The sign of x at the steered wheel."""
    return 1.0 if robot.steered == "front" else -1.0


def _plan(robot: Tricycle, outline: list[tuple[float, float]], rounding: float) -> Any:
    """A polygon from its left side; its corners are rounded by a fraction of the half width."""
    import shapely

    corners = [*outline, *((x, -y) for x, y in reversed(outline))]
    sharp = shapely.Polygon([(_ahead(robot) * x, y) for x, y in corners])
    radius = rounding * robot.footprint.half_width
    return sharp.buffer(-radius).buffer(radius, quad_segs=8)


def _arrow(robot: Tricycle) -> Any:
    """A chevron on the deck that points where the robot drives."""
    import shapely

    size, tip = 0.4 * robot.footprint.half_width, _ahead(robot) * 0.3 * robot.wheelbase
    line = shapely.LineString([(tip - size, size), (tip, 0.0), (tip - size, -size)])
    return line.buffer(0.24 * size, cap_style="flat", join_style="mitre")


def _scanner(robot: Tricycle) -> str:
    radius, x = 0.17 * robot.footprint.half_width, _ahead(robot) * 0.82 * robot.wheelbase
    z = deck_height(robot)
    return "".join(
        f'<geom type="cylinder" pos="{x} 0 {z + middle * radius}" size="{wide * radius} '
        f'{tall * radius}" rgba="{colour}" material="gloss"/>'
        for middle, tall, wide, colour in ((0.5, 0.5, 1.0, DARK), (1.1, 0.1, 1.05, METAL))
    )


def _mast(robot: Tricycle) -> str:
    """Two posts and the forks' heels, ahead of the driven axle."""
    half, high, reach = robot.footprint.half_width, deck_height(robot), robot.overhang
    x, thick = robot.wheel_radius + 0.5 * reach, 0.06 * half
    boxes = [
        (x, 0.0, 0.22 * high, thick, 0.62 * half, 0.05 * high),
        (x, 0.0, 1.45 * high, thick, 0.5 * half, 0.03 * high),
    ]
    for y in (0.46 * half, -0.46 * half):
        boxes += [
            (x, y, 0.77 * high, thick, 0.07 * half, 0.71 * high),
            (x + 0.25 * reach, y, 0.08 * high, 0.25 * reach, 0.12 * half, 0.02 * high),
        ]
    return "".join(
        f'<geom type="box" pos="{-_ahead(robot) * x} {y} {z}" size="{a} {b} {c}" rgba="{DARK}"/>'
        for x, y, z, a, b, c in boxes
    )


def _wheel(robot: Tricycle, name: str) -> str:
    r, half = robot.wheel_radius, robot.wheel_width / 2.0
    discs = "".join(
        f'<geom type="cylinder" zaxis="0 1 0" size="{size * r} {out * half}" rgba="{colour}"/>'
        for size, out, colour in ((1.0, 1.0, TYRE), (0.66, 1.03, METAL), (0.16, 1.12, DARK))
    )
    spokes = "".join(
        f'<body euler="0 {TURN * n / SPOKES} 0">{INERTIA}<geom type="box" pos="{0.37 * r} 0 0" '
        f'size="{0.2 * r} {1.06 * half} {0.06 * r}" rgba="{DARK}"/></body>'
        for n in range(SPOKES)
    )
    return f'<joint name="{name}" axis="0 1 0"/>{INERTIA}{discs}{spokes}'


def _fork(robot: Tricycle) -> str:
    r, half = robot.wheel_radius, robot.wheel_width / 2.0
    blade, top = 0.12 * robot.wheel_width, 1.06 * r
    blades = "".join(
        f'<geom type="box" pos="0 {y} {top / 2}" size="{0.13 * r} {blade} {top / 2 + 0.13 * r}" '
        f'rgba="{METAL}"/>'
        for y in (half + 2 * blade, -half - 2 * blade)
    )
    return (
        f'{blades}<geom type="box" pos="0 0 {top}" rgba="{METAL}" '
        f'size="{0.13 * r} {half + 3 * blade} {0.05 * r}"/>'
    )
