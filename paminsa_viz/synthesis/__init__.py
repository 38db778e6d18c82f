"""Synthesis: from requirements to a robot."""
