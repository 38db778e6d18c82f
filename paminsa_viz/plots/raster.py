"""Values to pixels through a table of colors: one look-up a cell, no drawing library."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import rgb
from paminsa_viz.plots import colors
from paminsa_viz.plots.scale import Scale

UNDER = 0
"""Code of a value below the range; the 256 colors of the scale have the codes 1 to 256."""
OVER = colors.SIZE + 1
MASKED = OVER + 1
"""Code of a cell that no pose reaches."""
UNDEFINED = MASKED + 1
"""Code of a cell on a singularity, or without a finite value where the pose is reached."""
HATCHED = UNDEFINED + 1
"""Code of a masked pixel on a line of the hatching."""


def codes(values: ArrayLike, status: NDArray[np.uint8] | None, scale: Scale) -> NDArray[np.intp]:
    """Return the color code of every cell; see the constants of this module.

    Args:
        values: (ny, nx) in the unit of the scale; infinite values lie beyond the range.
        status: (ny, nx) reason codes, 0 where the value is good, or None if all are.
        scale: The color scale.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        fraction = scale.position(values) * colors.SIZE
        # fmax and fmin also turn NaN into a number; those cells are overwritten below.
        cells = np.floor(np.fmin(np.fmax(fraction, -1.0), colors.SIZE + 1.0)).astype(np.intp) + 1
    cells[fraction == colors.SIZE] = colors.SIZE
    np.minimum(cells, OVER, out=cells)
    cells[np.isnan(fraction)] = UNDEFINED
    if status is not None:
        cells[status != 0] = MASKED
        cells[status == Limit.SINGULAR] = UNDEFINED
    return cells


@lru_cache(maxsize=64)
def lut(scale: Scale) -> NDArray[np.uint8]:
    """Return the colors of all codes as (261, 4) RGBA, read-only."""
    under, over = scale.beyond
    table = np.empty((HATCHED + 1, 4), dtype=np.uint8)
    table[:, 3] = 255
    table[1:OVER, :3] = (scale.table * 255 + 0.5).astype(np.uint8)
    special = {
        UNDER: under,
        OVER: over,
        MASKED: colors.REACHLESS,
        UNDEFINED: colors.SINGULAR,
        HATCHED: colors.HATCH,
    }
    for code, color in special.items():
        table[code, :3] = rgb(color)
    table.flags.writeable = False
    return table


def map_image(
    values: ArrayLike,
    status: NDArray[np.uint8] | None,
    scale: Scale,
    unreachable: Literal["clear", "gray"] = "clear",
) -> NDArray[np.uint8]:
    """Return a map as RGBA pixels (ny, nx, 4), one a cell.

    Row i is ``y[i]`` and column j is ``x[j]``, so row 0 is the SMALLEST y. This is what an image
    node of viser without rotation needs to lie on the floor the right way round; for a picture
    file, which starts at the top, reverse the rows.

    Args:
        values: (ny, nx) in the unit of the scale.
        status: (ny, nx) reason codes, 0 where the value is good, or None if all are.
        scale: The color scale.
        unreachable: Cells that no pose reaches are fully transparent, or light gray.
    """
    cells = codes(values, status, scale)
    table = lut(scale)
    if unreachable == "clear":
        table = table.copy()
        table[MASKED] = 0
    return np.take(table, cells, axis=0)


@lru_cache(maxsize=16)
def hatching(rows: int, columns: int, spacing: int) -> NDArray[np.bool_]:
    """Return where diagonal lines one pixel wide run in a picture (rows, columns)."""
    return (np.arange(rows)[:, None] + np.arange(columns)[None, :]) % spacing == 0


def picture(
    values: ArrayLike,
    status: NDArray[np.uint8] | None,
    scale: Scale,
    height: int,
    width: int,
    spacing: int,
) -> NDArray[np.uint8]:
    """Return a map enlarged to RGBA (height, width, 4), row 0 at the LARGEST y, hatched.

    Every pixel takes the cell under its center.

    Args:
        values: (ny, nx) in the unit of the scale.
        status: (ny, nx) reason codes, 0 where the value is good, or None if all are.
        scale: The color scale.
        height: Height of the picture [pixels].
        width: Width of the picture [pixels].
        spacing: Distance of the lines of the hatching along a row [pixels].
    """
    cells = codes(values, status, scale)
    table = lut(scale).view(np.uint32)[:, 0]  # a whole pixel at a time
    ny, nx = cells.shape
    rows = ny - 1 - ((np.arange(height) * 2 + 1) * ny) // (2 * height)
    columns = ((np.arange(width) * 2 + 1) * nx) // (2 * width)
    pixels = table.take(cells).take(rows, axis=0).take(columns, axis=1)
    masked = pixels == table[MASKED]
    if masked.any():
        masked &= hatching(height, width, spacing)
        pixels[masked] = table[HATCHED]
    return pixels.view(np.uint8).reshape(height, width, 4)
