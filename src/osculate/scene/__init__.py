"""What is there: obstacles and the clearance to them."""

from osculate.scene.contact import Contact, first_contact
from osculate.scene.obstacle import AnyObstacle, Block, Disc, Obstacle, Scene, Wall

__all__ = [
    "AnyObstacle",
    "Block",
    "Contact",
    "Disc",
    "Obstacle",
    "Scene",
    "Wall",
    "first_contact",
]
