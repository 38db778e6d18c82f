"""The design next to the reference."""
