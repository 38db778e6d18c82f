"""Cells of a map that are outside a volume of poses: hatched by the reason, live and in print."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.kept import kept
from paminsa_viz.palette import rgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SPACING = 0.75
"""Distance of hatching lines [em]."""

STROKES = ("/", "\\", "|", "-")
"""Directions of the hatching, by the reason."""


@dataclass(frozen=True, eq=False)
class Outside:
    """Which cells of a map are outside a volume, and why.

    Attributes:
        code: (ny, nx) 0 inside, else the number of the reason.
        reasons: Texts by that number; the first is of the cells inside.
        colors: ``#rrggbb`` of the hatching by that number.
    """

    code: NDArray[np.uint8]
    reasons: tuple[str, ...]
    colors: tuple[str, ...]

    def present(self) -> tuple[tuple[str, str], ...]:
        """Return the reasons that a map shows with their colors."""
        counts = np.bincount(self.code.ravel(), minlength=len(self.reasons))
        return tuple(
            (self.reasons[code], self.colors[code])
            for code in range(1, len(self.reasons))
            if counts[code]
        )


@kept(8)
def _lines(height: int, width: int, step: int, thick: int) -> NDArray[np.bool_]:
    """Return where lines of each direction of `STROKES` are, (directions, height, width)."""
    down, right = np.arange(height)[:, None], np.arange(width)
    diagonal = round(step * np.sqrt(2))
    wide = round(thick * np.sqrt(2))
    return np.stack(
        [
            (right + down) % diagonal < wide,
            (right - down) % diagonal < wide,
            np.broadcast_to(right % step < thick, (height, width)),
            np.broadcast_to(down % step < thick, (height, width)),
        ]
    )


def paint_outside(
    place: NDArray[np.uint32],
    outside: Outside,
    rows: NDArray[Any],
    columns: NDArray[Any],
    em: float,
) -> None:
    """Draw the hatching on pixels (h, w), packed RGBA, in place.

    Args:
        place: The pixels of a panel.
        outside: What is hatched.
        rows, columns: Indices of the cells below the pixels, (h, 1) and (w,).
        em: Size of letters [device pixels].
    """
    code = outside.code[rows, columns]
    step, thick = max(round(SPACING * em), 4), max(round(em / 11), 1)
    lines = _lines(*code.shape, step, thick)
    direction = (np.arange(len(outside.reasons)) - 1) % len(STROKES)
    colors = np.zeros((len(outside.reasons), 4), dtype=np.uint8)
    colors[1:, :3] = [rgb(color) for color in outside.colors[1:]]
    colors[:, 3] = 255
    packed = colors.view(np.uint32)[:, 0]
    for number in np.unique(code):
        if number:
            np.copyto(place, packed[number], where=(code == number) & lines[direction[number]])


def add_outside(axes: Axes, outside: Outside, x: Any, y: Any, em: float) -> None:
    """Add the hatching to a figure for print."""
    for number in range(1, len(outside.reasons)):
        cells = outside.code == number
        if not cells.any():
            continue
        stroke = STROKES[(number - 1) % len(STROKES)]
        hatched = axes.contourf(
            x, y, cells.astype(float), levels=[0.5, 1.5], colors="none", hatches=[2 * stroke],
            zorder=1.2,
        )  # fmt: skip
        hatched.set(edgecolor=outside.colors[number], linewidth=0.0)
        hatched.set_hatch_linewidth(0.07 * em)
