"""Numbers that are pinned to the strip."""
