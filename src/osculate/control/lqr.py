"""Linear-quadratic regulator with preview of a known target, eqs (31)–(35).

The only Riccati and preview solver of the package. For the error system Ẏ = A Y + B u + η with known
η(t), the optimal input is u = −R⁻¹ Bᵀ (P Y + b), where b anticipates η:

    ḃ = −(A − B R⁻¹ Bᵀ P)ᵀ b − P η,   b(∞) = 0
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_are, solve_sylvester

from osculate.errors import NoSolution
from osculate.target.contract import SampledYaw

Matrix = NDArray[np.float64]


class Regulator(NamedTuple):
    """A solved regulator of a single-input system, with n states."""

    gain: Matrix  # shape (n,), K = R⁻¹ Bᵀ P
    riccati: Matrix  # shape (n, n), P
    closed: Matrix  # shape (n, n), A − B K
    input_weight: Matrix  # shape (n,), R⁻¹ Bᵀ: what turns b into an input


def regulator(a: Matrix, b: Matrix, q: Matrix, r: float) -> Regulator:
    """Solve P A + Aᵀ P − P B R⁻¹ Bᵀ P + Q = 0, eq. (35).

    Args:
        a: System matrix, shape (n, n).
        b: Input vector, shape (n,).
        q: State weight, shape (n, n), positive semidefinite.
        r: Input weight, > 0.

    Raises:
        NoSolution: Numbers of too many orders of magnitude.
    """
    try:
        with np.errstate(all="ignore"):
            riccati = solve_continuous_are(a, b.reshape(-1, 1), q, np.array([[r]]))
            weight = b / r
            gain = weight @ riccati
    except ValueError:  # of it a LinAlgError is one
        gain = np.array([np.nan])
    if not np.isfinite(gain).all():
        weights = ", ".join(f"{w:.3g}" for w in (*np.diag(q), r))
        raise NoSolution(
            f"no regulator for weights of {weights} and an input gain of {np.abs(b).max():.3g}: they "
            "differ by too many orders of magnitude"
        )
    return Regulator(gain, riccati, a - np.outer(b, gain), weight)


def yaw_regulator(yaw_gain: float, heading: float, rate: float, effort: float) -> Regulator:
    """Regulator of the yaw errors (θ − θ̂, ω − ω̂) with ω̇ = c u₁, Q = diag(heading, rate), R = effort."""
    a = np.array([[0.0, 1.0], [0.0, 0.0]])
    return regulator(a, np.array([0.0, yaw_gain]), np.diag([heading, rate]), effort)


def exponential_preview(solved: Regulator, decay: float) -> tuple[float, float]:
    """The preview input for a yaw rate ω̂ ∝ t e^{−γt}, in closed form.

    Such an ω̂ obeys ω̂̈ = −γ² ω̂ − 2γ ω̂̇, so that η and b are linear in (ω̂, ω̂̇) and b solves one
    Sylvester equation.

    Args:
        solved: Regulator of the yaw errors.
        decay: γ (1/s).

    Returns:
        The factors of ω̂ and of ω̂̇ in −R⁻¹ Bᵀ b.
    """
    motion = np.array([[0.0, 1.0], [-(decay**2), -2.0 * decay]])  # of (ω̂, ω̂̇)
    disturbance = np.array([[0.0, 0.0], [0.0, -1.0]])  # η = (0, −ω̂̇)
    b = solve_sylvester(solved.closed.T, motion, -solved.riccati @ disturbance)
    rate, acceleration = -solved.input_weight @ b
    return float(rate), float(acceleration)


def sampled_preview(solved: Regulator, known: SampledYaw) -> Matrix:
    """The preview input for a sampled yaw acceleration, integrated backwards with the exact step.

    Between samples η is linear in time; e^{Aᵀδ} and its moments come from one matrix exponential,
    so that the stiff backward equation is solved without a step-size limit.

    Returns:
        Shape (samples, 2): −R⁻¹ Bᵀ b and its time derivative at every sample.
    """
    n = len(solved.gain)
    transition, constant, ramp = _moments(solved.closed.T, known.step)
    eta = np.zeros((len(known.accelerations), n))
    eta[:, -1] = -known.accelerations
    drive = eta @ solved.riccati.T
    b = np.zeros_like(drive)
    for j in range(len(b) - 2, -1, -1):
        slope = drive[j + 1] - drive[j]
        b[j] = transition @ b[j + 1] + constant @ drive[j] + ramp @ slope
    rate = -b @ solved.closed - drive
    return np.stack([-b @ solved.input_weight, -rate @ solved.input_weight], axis=1)


def _moments(a: Matrix, step: float) -> tuple[Matrix, Matrix, Matrix]:
    """e^{aδ}, ∫₀^δ e^{aσ} dσ and ∫₀^δ e^{aσ} (σ/δ) dσ."""
    n = len(a)
    block = np.zeros((3 * n, 3 * n))
    block[:n, :n] = a
    block[:n, n : 2 * n] = block[n : 2 * n, 2 * n :] = np.eye(n)
    whole = expm(block * step)
    # the last block is ∫₀^δ e^{aσ} (δ − σ) dσ
    constant = whole[:n, n : 2 * n]
    return whole[:n, :n], constant, constant - whole[:n, 2 * n :] / step
