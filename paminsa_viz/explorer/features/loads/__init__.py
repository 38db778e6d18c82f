"""Joint forces and bar loads."""
