"""Colors of torques and forces by their size, from low to high."""

from __future__ import annotations

from functools import cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.model.arrays import Array
from paminsa_viz.plots import colors

_LIGHTEST: Final = 0.9
"""Share of the color table that is used; its end is too light to be seen against the backdrop."""


class ForceScale(NamedTuple):
    """Sizes of torque [N m] or force [N] that the first and the last color mean."""

    low: float
    high: float


@cache
def _hues() -> tuple[str, ...]:
    """Return the colors from low to high, as ``#rrggbb``."""
    table = colors.table(colors.SEQUENTIAL)[: round(_LIGHTEST * colors.SIZE)]
    return tuple("#{:02x}{:02x}{:02x}".format(*row) for row in np.rint(255 * table).astype(int))


@cache
def drawn_hues() -> NDArray[np.uint8]:
    """Return the colors from low to high for lines and batched meshes, (n, 3)."""
    return linear_colors(*_hues())


def hue(values: Array, scale: ForceScale) -> NDArray[np.intp]:
    """Return the place of torques or forces (...) among the colors."""
    share = np.clip((np.abs(values) - scale.low) / (scale.high - scale.low), 0.0, 1.0)
    return np.rint(share * (len(_hues()) - 1)).astype(np.intp)


def hue_colors(values: Array, scale: ForceScale) -> NDArray[np.uint8]:
    """Return the colors of values (n,) for batched meshes, (n, 3)."""
    return drawn_hues()[hue(values, scale)]


def hue_gradient(scale: ForceScale) -> list[str]:
    """Return colors from the low to the high end of a scale, as ``#rrggbb``."""
    return [_hues()[i] for i in hue(np.linspace(scale.low, scale.high, 9), scale)]
