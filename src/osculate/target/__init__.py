"""How fast to drive and turn: profiles and the targets that slave one speed to the other."""

from typing import Annotated

from pydantic import Field

from osculate.target.contract import Reference, Target, TargetMemory, TargetPart
from osculate.target.dynamical import Dynamical
from osculate.target.modified import Modified
from osculate.target.profile import AnyProfile, Exponential, Natural, Profile, SampledProfile
from osculate.target.projected import Projected
from osculate.target.speed import Limits, SpeedPlan, plan_speed
from osculate.target.static import Static

AnyTarget = Annotated[Static | Dynamical | Modified | Projected, Field(discriminator="kind")]

__all__ = [
    "AnyProfile",
    "AnyTarget",
    "Dynamical",
    "Exponential",
    "Limits",
    "Modified",
    "Natural",
    "Profile",
    "Projected",
    "Reference",
    "SampledProfile",
    "SpeedPlan",
    "Static",
    "Target",
    "TargetMemory",
    "TargetPart",
    "plan_speed",
]
