"""Maps of torques and other quantities."""
