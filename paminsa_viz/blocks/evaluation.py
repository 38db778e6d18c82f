"""Tables of poses: how many rows have numbers, and why the others have none."""

from __future__ import annotations

from collections import Counter

from paminsa_viz.units import counted


def evaluation_text(counts: Counter[str]) -> str:
    """Return how many rows a table that was written has, by the words of `reach.status_words`."""
    rows = counts.total()
    text = counted(rows, "row")
    if lost := [f"{count:,} {word}" for word, count in counts.most_common() if word != "ok"]:
        text += f", {rows - counts['ok']:,} without numbers ({', '.join(lost)})"
    return text
