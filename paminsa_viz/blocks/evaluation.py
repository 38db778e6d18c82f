"""Tables of poses: how many rows have numbers, and why the others have none."""

from __future__ import annotations

import math
from collections import Counter

from paminsa_viz.units import counted, number


def evaluation_text(counts: Counter[str], turn: float = 0.0) -> str:
    """Return how many rows a table that was written has, by the words of `reach.status_words`.

    Args:
        counts: Rows by their word.
        turn: Largest |theta| of a column in radians [rad]; of more than a turn degrees may be
            meant.
    """
    rows = counts.total()
    text = counted(rows, "row")
    if lost := [f"{count:,} {word}" for word, count in counts.most_common() if word != "ok"]:
        text += f", {rows - counts['ok']:,} without numbers ({', '.join(lost)})"
    if turn > math.tau:
        text += f"; theta_rad is up to {number(turn, 4)} rad: write degrees as theta_deg"
    return text
