"""Obstacles: what must not be touched, as polygons in the map frame."""

from abc import abstractmethod
from functools import cached_property
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from osculate.errors import InvalidInput
from osculate.spec import Spec, quantity

FARTHEST = 1e9  # m: geometry further out is not exact any more
SIDES = 64  # of the polygon around a disc, at least
MOST_SIDES = 256
EXCESS = 1e-3  # m, by which that polygon may reach beyond the disc


class Obstacle(Spec):
    """Something with an outline.

    Raises:
        InvalidInput: It reaches beyond all measure.
    """

    @model_validator(mode="after")
    def _measurable(self) -> Self:
        if not np.abs(self.outline((0.0, 0.0))).max() <= FARTHEST:
            raise InvalidInput("", self, f"must lie within {FARTHEST:g} m of the origin")
        return self

    @abstractmethod
    def outline(self, start: tuple[float, float]) -> NDArray[np.float64]:
        """Corners (m), shape (n, 2), counter-clockwise; ``start`` is where the path begins."""


class Wall(Obstacle):
    """The paper's obstacle: something of height h whose middle is a distance D ahead of the start."""

    kind: Literal["wall"] = "wall"
    distance: float = quantity("m", "from the start to the middle, D", default=10.0, gt=0)
    height: float = quantity("m", "height above the start, h", default=5.0, gt=0)
    width: float = quantity("m", "extent along x", default=1.0, gt=0)

    def outline(self, start: tuple[float, float]) -> NDArray[np.float64]:
        """See `Obstacle.outline`."""
        middle, base = start[0] + self.distance, start[1]
        left, right = middle - self.width / 2.0, middle + self.width / 2.0
        top = base + self.height
        return np.array([[left, base], [right, base], [right, top], [left, top]])


class Disc(Obstacle):
    """A round obstacle in the map frame."""

    kind: Literal["disc"] = "disc"
    x: float = quantity("m", "centre, x")
    y: float = quantity("m", "centre, y")
    radius: float = quantity("m", "radius", gt=0)

    def outline(self, start: tuple[float, float]) -> NDArray[np.float64]:
        """A regular polygon around the disc, which reaches at most 1 mm beyond: see `Obstacle.outline`.

        From a radius of 13 m on it has no more corners and reaches further, by 8e-5 of the radius.
        """
        wished = np.pi / np.sqrt(2.0 * EXCESS / self.radius)
        sides = int(np.clip(np.ceil(wished), SIDES, MOST_SIDES))
        angle = 2.0 * np.pi * np.arange(sides) / sides
        radius = self.radius / np.cos(np.pi / sides)
        return np.stack([self.x + radius * np.cos(angle), self.y + radius * np.sin(angle)], axis=1)


class Block(Obstacle):
    """A polygon in the map frame."""

    kind: Literal["block"] = "block"
    corners: tuple[tuple[float, float], ...] = quantity("m", "corners (x, y), at least three")

    @field_validator("corners")
    @classmethod
    def _area(cls, corners: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if len(corners) < 3 or not np.isfinite(corners).all():
            raise ValueError("must be at least three finite corners")
        import shapely

        if not shapely.Polygon(corners).is_valid:
            raise ValueError(
                "must be the corners in order, round an outline that does not cross itself"
            )
        return corners

    def outline(self, start: tuple[float, float]) -> NDArray[np.float64]:
        """See `Obstacle.outline`."""
        return np.array(self.corners, dtype=float)


AnyObstacle = Annotated[Wall | Disc | Block, Field(discriminator="kind")]


class Scene(Spec):
    """What is there: the obstacles around a path."""

    obstacles: tuple[AnyObstacle, ...] = ()
    corridor: float | None = quantity(
        "m",
        "half-width of the corridor around the path: a run in which O is as far from the path has left "
        "it; by default 1 m, or the safety layer's",
        default=None,
        gt=0,
    )

    @cached_property
    def is_empty(self) -> bool:
        """Whether there is nothing to hit."""
        return not self.obstacles

    def fixed(self, start: tuple[float, float]) -> "Scene":
        """The same obstacles in the map frame, wherever a path begins: walls are blocks.

        Args:
            start: Where the path begins for which the walls are meant (m).
        """
        placed = (
            Block(corners=tuple((float(x), float(y)) for x, y in obstacle.outline(start)))
            if isinstance(obstacle, Wall) else obstacle
            for obstacle in self.obstacles
        )  # fmt: skip
        return self.but(obstacles=tuple(placed))

    def geometry(self, start: tuple[float, float]) -> Any:
        """The union of all outlines, as a Shapely geometry in the map frame."""
        import shapely

        return shapely.union_all(
            [shapely.Polygon(obstacle.outline(start)) for obstacle in self.obstacles]
        )

    def clearance(
        self,
        start: tuple[float, float],
        corners: tuple[tuple[float, float], ...],
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        heading: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Distance (m) from a robot's footprint to the nearest obstacle; 0 when they touch.

        Args:
            start: Where the path begins (m).
            corners: The footprint in the robot's frame (m).
            x: Positions of O (m), shape (n,); likewise ``y``.
            y: See ``x``.
            heading: Headings (rad), shape (n,).

        Returns:
            Shape (n,); infinite when there is no obstacle.
        """
        if self.is_empty:
            return np.full(np.shape(x), np.inf)
        import shapely

        obstacles = self.geometry(start)
        shapely.prepare(obstacles)
        robots = bodies_at(corners, x, y, heading)
        distance: NDArray[np.float64] = shapely.distance(robots, obstacles)
        return distance


def bodies_at(
    corners: tuple[tuple[float, float], ...],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    heading: NDArray[np.float64],
) -> Any:
    """A robot's footprint wherever it is, as Shapely polygons of shape (n,): see `Scene.clearance`."""
    import shapely

    body = np.array([*corners, corners[0]])
    cosine, sine = np.cos(heading)[:, None], np.sin(heading)[:, None]
    outline_x = x[:, None] + cosine * body[:, 0] - sine * body[:, 1]
    outline_y = y[:, None] + sine * body[:, 0] + cosine * body[:, 1]
    return shapely.polygons(np.stack([outline_x, outline_y], axis=-1))
