"""The paper's target curve: a truncated cycloid over an obstacle, eqs (18), (26)–(29), (45)."""

import math
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from osculate.curve.contract import Curve, CurvePoint
from osculate.errors import InvalidInput, NoSolution
from osculate.spec import quantity

FLATTEST = 1e-6  # (h + ĥ) / D, below which 1 + cos β has lost most of its digits


class Cycloid(Curve):
    """r̂ = (α [w − sin w], α [1 − cos w]), w from β to 2π − β: rises over the obstacle, bends right.

    Raises:
        InvalidInput: A value is out of its range.
        NoSolution: The obstacle is too high for its distance: (h + ĥ) / D must stay below 2/π.
    """

    kind: Literal["cycloid"] = "cycloid"
    distance: float = quantity(
        "m", "from the start to the middle of the obstacle, D", default=10.0, gt=0
    )
    height: float = quantity("m", "height of the obstacle above the start, h", default=5.0, gt=0)
    margin: float = quantity("m", "from the obstacle to the top of the curve, ĥ", default=1.0, ge=0)

    @model_validator(mode="after")
    def _solvable(self) -> "Cycloid":
        if not self._slope < 2.0 / math.pi:
            raise NoSolution(
                f"no cycloid rises {self.height + self.margin:g} m (height + margin) over "
                f"{self.distance:g} m (distance): the ratio {self._slope:.4g} must be below "
                f"2/π = {2.0 / math.pi:.4g}; increase distance above "
                f"{(self.height + self.margin) * math.pi / 2.0:.4g} m or lower height or margin"
            )
        if self._slope < FLATTEST:
            most = (self.height + self.margin) / FLATTEST
            raise InvalidInput(
                "distance", self.distance, f"must be at most {most:.4g} m, or raise height or margin: "
                "so flat a cycloid cannot be told from a line",
            )  # fmt: skip
        return self

    @classmethod
    def over(cls, distance: float = 10.0, height: float = 5.0, margin: float = 1.0) -> "Cycloid":
        """The cycloid over an obstacle: D, h and ĥ of eq. (45), all in m."""
        return cls(distance=distance, height=height, margin=margin)

    @property
    def _slope(self) -> float:
        return (self.height + self.margin) / self.distance

    @cached_property
    def truncation(self) -> float:
        """β (rad) in (0, π): how much of the cycloid is cut off at both ends, eq. (45)."""

        def excess(turn: float) -> float:  # of π − β, so that nothing cancels for flat curves
            return (1.0 - math.cos(turn)) - self._slope * (turn + math.sin(turn))

        low, high = self._slope, math.pi  # the only sign change lies between
        while (middle := 0.5 * (low + high)) not in (low, high):
            low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
        return math.pi - high

    @cached_property
    def radius(self) -> float:
        """α (m), radius of the rolling circle, eq. (45)."""
        return (self.height + self.margin) / (1.0 + math.cos(self.truncation))

    @cached_property
    def length(self) -> float:
        """L = 8 α cos(β/2), eq. (28) (m)."""
        return 8.0 * self.radius * math.cos(self.truncation / 2.0)

    def parameter(self, arc_length: ArrayLike) -> np.ndarray:
        """W − β = μ t in [0, 2π − 2β] (rad) at the arc lengths (m), from eq. (27)."""
        s = np.clip(np.asarray(arc_length, dtype=float), 0.0, self.length)
        cosine = math.cos(self.truncation / 2.0) - s / (4.0 * self.radius)
        # near w = 0 the arc cosine loses digits, the arc tangent of sine over cosine does not
        w: np.ndarray = 2.0 * np.arctan2(np.sqrt((1.0 - cosine) * (1.0 + cosine)), cosine)
        return w - self.truncation

    def arc_length(self, parameter: ArrayLike) -> np.ndarray:
        """S = 4 α [cos(β/2) − cos((μ t + β)/2)] (m) at the parameters μ t (rad), eq. (27)."""
        half = (np.asarray(parameter, dtype=float) + self.truncation) / 2.0
        s: np.ndarray = 4.0 * self.radius * (math.cos(self.truncation / 2.0) - np.cos(half))
        return s

    def at(self, arc_length: ArrayLike) -> CurvePoint:
        """The curve at the arc lengths (m); curvature from eq. (26)."""
        w = self.parameter(arc_length) + self.truncation
        curvature = -1.0 / (4.0 * self.radius * np.sin(w / 2.0))
        return CurvePoint(
            x=self.radius * (w - np.sin(w)),
            y=self.radius * (1.0 - np.cos(w)),
            heading=(math.pi - w) / 2.0,
            curvature=curvature,
            curvature_rate=-(curvature**3) * 4.0 * self.radius * np.cos(w / 2.0),
        )
