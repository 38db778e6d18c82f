"""The inspector: what the robot's part is that was clicked, and what it carries."""
