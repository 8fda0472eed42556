"""Tyres: the force of a wheel that slips on ground whose friction differs from place to place.

The slip is the velocity s of the tread against the ground, per rolling speed V,

    σ = s / √(V² + ε²)        with the creep speed ε, without which standstill divides by zero,

and the force is F = −N C σ / √(1 + z²) with z = (C σₓ / μ, C σᵧ / (λ μ)): C N per unit of slip as long
as the slip is small, and on the ellipse with half axes μ N and λ μ N when it is large. F always opposes
s, whatever the ellipse, so that a tyre never creates energy. C is what vehicle dynamics call the
cornering (and slip) stiffness per load: 10 to 20 for rubber (Pacejka, Tire and Vehicle Dynamics, 3rd
ed., 2012, chapter 1). All in one, without a division by friction or slip:

    F = −N μ C s / √(μ² (V² + ε²) + C² (sₓ² + (sᵧ / λ)²))
"""

from collections.abc import Sequence
from math import sqrt
from typing import Any, NamedTuple

from osculate.kernel import kernel
from osculate.spec import Spec, quantity


class Patch(Spec):
    """A round patch of ground with a friction of its own."""

    x: float = quantity("m", "its centre in the map frame")
    y: float = quantity("m", "its centre in the map frame")
    radius: float = quantity("m", "its radius", gt=0)
    friction: float = quantity("1", "friction of a tyre on it, along the wheel", gt=0)


class Spot(NamedTuple):
    """A patch as the kernels see it."""

    x: float  # m
    y: float  # m
    squared_radius: float  # m²; negative where there is no patch
    friction: float


class Planar(NamedTuple):
    """A vector in the plane: of a wheel, a body or the ground."""

    along: float  # the direction ahead
    aside: float  # to the left


class TyreParameters(NamedTuple):
    """Parameters of the tyres and of the ground below them."""

    friction: float  # μ along the wheel, off all patches
    narrowness: float  # 1 / λ²: squared friction along per friction across
    stiffness: float  # C, force per load and slip
    squared_creep: float  # ε², m²/s²
    patches: Any  # tuple of `Spot`, a power of two of them


def spots(patches: Sequence[Patch]) -> tuple[Spot, ...]:
    """The patches for the kernels; a power of two, so that few counts need machine code of their own."""
    count = 1 << (max(len(patches), 1) - 1).bit_length()
    real = [Spot(patch.x, patch.y, patch.radius**2, patch.friction) for patch in patches]
    return (*real, *[Spot(0.0, 0.0, -1.0, 1.0)] * (count - len(real)))


@kernel
def friction_at(x: float, y: float, p: TyreParameters) -> float:
    """μ at a place: that of the last patch which contains it."""
    friction = p.friction
    for n in range(len(p.patches)):
        spot = p.patches[n]
        east, north = x - spot.x, y - spot.y
        inside = east * east + north * north <= spot.squared_radius
        friction = spot.friction if inside else friction
    return friction


@kernel
def tyre_force(
    velocity: Planar, tread: float, load: float, friction: float, p: TyreParameters
) -> Planar:
    """Force (N) of the ground on a wheel, in the wheel's own directions.

    Args:
        velocity: Of the wheel's centre (m/s).
        tread: Speed of the tread, spin times radius (m/s).
        load: Normal load (N).
        friction: μ below it.
        p: Parameters.
    """
    along, aside = velocity.along - tread, velocity.aside
    rolling = friction * friction * (tread * tread + p.squared_creep)
    slipping = p.stiffness * p.stiffness * (along * along + p.narrowness * aside * aside)
    drag = load * friction * p.stiffness / sqrt(rolling + slipping)
    return Planar(-drag * along, -drag * aside)
