"""What the robot believes: pose, speed, steering, and how it differs from its own description."""
