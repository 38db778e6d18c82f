"""The search for a robot."""
