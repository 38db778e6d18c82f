"""Where the numbers of contour lines go: along the lines, clear of each other and of other lines.

All lengths are in mm on paper; y runs up.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Line = NDArray[np.float64]

PER_LEVEL = 2
"""Most numbers for one level."""

_STEP = 0.5  # between points at which lines are compared
_CLEAR = 0.35  # between a number and anything else
_APART = 15.0  # between two numbers of one level


@dataclass(frozen=True)
class Label:
    """A number on a contour line.

    Attributes:
        level: The level.
        x: Middle of the number.
        y: Middle of the number.
        angle: Its turn [degrees], reading from the left.
    """

    level: float
    x: float
    y: float
    angle: float


@dataclass(frozen=True)
class _Track:
    """A contour line walked in equal steps."""

    level: float
    points: Line
    width: float  # of its number

    @property
    def reach(self) -> int:
        """Steps from the middle of a number to its end."""
        return math.ceil((self.width / 2 + _CLEAR) / _STEP)


def place_labels(
    found: dict[float, list[Line]],
    width_of: Callable[[float], float],
    height: float,
    obstacles: list[Line],
) -> tuple[list[Label], dict[float, list[Line]]]:
    """Choose places for numbers and cut the lines under them.

    Args:
        found: Contour lines (n, 2) by level.
        width_of: Width of a level's number.
        height: Height of the numbers.
        obstacles: Other lines (n, 2) that numbers keep clear of.

    Returns:
        The numbers, and the lines by level with gaps where the numbers are.
    """
    tracks = [
        _Track(level, walk(line, _STEP), width_of(level))
        for level, lines in found.items()
        for line in lines
        if len(line) > 1
    ]
    crowd = [walk(line, _STEP) for line in obstacles if len(line) > 1]
    labels: list[Label] = []
    gaps: dict[int, list[int]] = {}
    for number in sorted(range(len(tracks)), key=lambda i: _order(tracks[i])):
        track = tracks[number]
        same = [label for label in labels if label.level == track.level]
        if len(same) >= PER_LEVEL or len(track.points) < 4 * track.reach:
            continue
        others = [t.points for i, t in enumerate(tracks) if i != number] + crowd
        best = _best(track, np.concatenate(others) if others else np.empty((0, 2)), height, same)
        if best is None:
            continue
        index, label = best
        labels.append(label)
        gaps.setdefault(number, []).append(index)
        crowd.append(_outline(label, track.width, height))
    cut: dict[float, list[Line]] = {level: [] for level in found}
    for number, track in enumerate(tracks):
        cut[track.level] += _without(track, gaps.get(number, []))
    return labels, cut


def walk(line: Line, step: float) -> Line:
    """Return points in equal steps of about ``step`` along a line, both ends included."""
    way = np.hypot(*np.diff(line, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(way)])
    count = max(2, math.ceil(along[-1] / step) + 1)
    where = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(where, along, line[:, i]) for i in (0, 1)], axis=1)


def _order(track: _Track) -> tuple[float, int]:
    return abs(track.level), -len(track.points)


def _best(
    track: _Track, others: Line, height: float, same: list[Label]
) -> tuple[int, Label] | None:
    """Return the clearest place on a line, if any is clear enough."""
    points, reach = track.points, track.reach
    found: tuple[float, int, Label] | None = None
    for index in range(reach + 1, len(points) - reach - 1, 2):
        x, y = points[index]
        if any(math.hypot(x - label.x, y - label.y) < _APART for label in same):
            continue
        chord = points[index + reach] - points[index - reach]
        straight = float(np.hypot(*chord))
        if straight < 0.93 * 2 * reach * _STEP:
            continue
        along = chord / straight
        far = np.concatenate(
            [others, points[: max(0, index - 2 * reach)], points[index + 2 * reach :]]
        )
        clear = _clearance(far - points[index], along, track.width, height)
        if clear > _CLEAR and (found is None or clear > found[0]):
            angle = math.degrees(math.atan2(along[1], along[0]))
            angle = (angle + 90) % 180 - 90  # never upside down
            found = clear, index, Label(track.level, float(x), float(y), angle)
    return None if found is None else found[1:]


def _clearance(offsets: Line, along: Line, width: float, height: float) -> float:
    """Return how far a turned rectangle is from the nearest of some points."""
    if len(offsets) == 0:
        return math.inf
    lengthwise = np.abs(offsets @ along) - width / 2
    crosswise = np.abs(offsets @ np.array([-along[1], along[0]])) - height / 2
    return float(np.maximum(lengthwise, crosswise).min())


def _outline(label: Label, width: float, height: float) -> Line:
    angle = math.radians(label.angle)
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    rows = [
        np.array([label.x, label.y]) + s * across * height / 2 + along * t * width / 2
        for s in (-1, 0, 1)
        for t in np.linspace(-1, 1, 7)
    ]
    return np.stack(rows)


def _without(track: _Track, indices: list[int]) -> list[Line]:
    keep = np.ones(len(track.points), dtype=np.bool_)
    for index in indices:
        keep[max(0, index - track.reach) : index + track.reach + 1] = False
    cuts = np.flatnonzero(np.diff(keep.astype(np.int8))) + 1
    parts = np.split(np.arange(keep.size), cuts)
    return [track.points[part] for part in parts if keep[part[0]] and part.size > 1]
