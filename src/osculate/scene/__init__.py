"""What is there: obstacles and the clearance to them."""

from osculate.scene.obstacle import AnyObstacle, Block, Disc, Obstacle, Scene, Wall

__all__ = ["AnyObstacle", "Block", "Disc", "Obstacle", "Scene", "Wall"]
