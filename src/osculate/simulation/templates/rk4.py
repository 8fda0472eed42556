"""Template: the classical Runge–Kutta method of order four on named tuples."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from osculate.kernel import axpy, kernel

if TYPE_CHECKING:  # part, bound by `compose`
    from osculate.simulation.templates.continuous import rates


@kernel
def rk4(t: float, h: float, state: Any, action: Any, p: Any, tables: NDArray[np.float64]) -> Any:
    """The state a step ``h`` (s) after ``t``, while ``action`` is constant."""
    half = 0.5 * h
    k1 = rates(t, state, action, p, tables)
    k2 = rates(t + half, axpy(half, k1, state), action, p, tables)
    k3 = rates(t + half, axpy(half, k2, state), action, p, tables)
    k4 = rates(t + h, axpy(h, k3, state), action, p, tables)
    total = axpy(2.0, k3, axpy(2.0, k2, axpy(1.0, k4, k1)))
    return axpy(h / 6.0, total, state)
