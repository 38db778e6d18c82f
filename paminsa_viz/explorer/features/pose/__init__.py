"""The pose: its status and numbers, and a slider for each coordinate."""
