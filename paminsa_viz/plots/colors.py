"""Color tables of 256 entries that keep their meaning for color-blind eyes and in gray print.

The diverging table is built here: two arms from one near-white center, blue for negative
and vermillion for positive, lightness falling in equal steps of OKLab (B. Ottosson, 2020) so that
equal differences look equal. Blue against orange survives the common forms of color blindness.
The sequential one is matplotlib's viridis.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.palette import LIGHT

DIVERGING = "blue-vermillion"
"""Table with a neutral center, for signed quantities."""

SEQUENTIAL = "viridis"
"""Table of rising lightness, for magnitudes."""

SIZE = 256

BEYOND: dict[str, tuple[str, str]] = {
    DIVERGING: ("#02234a", "#4a1503"),
    SEQUENTIAL: ("#1c0022", "#fffbc4"),
}
"""Colors for values below and above the range: darker, or beyond the light end."""

REACHLESS = LIGHT.reachless
SINGULAR = "#4b5563"
"""Masked cells: gray with hatching where nothing is reached, plain dark gray where the
mechanism is singular or a value is not finite. The tables contain neither gray."""

_LMS = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def oklab(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convert sRGB (..., 3) in 0..1 to OKLab (..., 3)."""
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return np.cbrt(linear @ _LMS.T) @ _LAB.T


@cache
def table(name: str) -> NDArray[np.float64]:
    """Return a color table (256, 3) of sRGB in 0..1, read-only.

    Raises:
        KeyError: If there is no such table; callers check the name first.
    """
    if name == DIVERGING:
        colors = np.concatenate([_arm(250.0, 0.125)[::-1], _arm(38.0, 0.14)])
    elif name == SEQUENTIAL:
        from matplotlib import colormaps  # late: costs a tenth of a second

        colors = np.asarray(colormaps[name](np.arange(SIZE)))[:, :3]
    else:
        raise KeyError(name)
    colors.flags.writeable = False
    return colors


def _arm(hue: float, chroma: float) -> NDArray[np.float64]:
    """Return half a diverging table (128, 3), from near-white to dark, hue in OKLab degrees."""
    t = (np.arange(SIZE // 2) + 0.5) / (SIZE // 2)
    lightness = 0.97 - 0.59 * t
    # Rises smoothly to its peak at three quarters and falls a little, so that sRGB holds it all.
    rise = np.sin(np.minimum(1.0, t / 0.75) * np.pi / 2)
    strength = chroma * rise * np.where(t < 0.75, 1.0, 1.0 - 0.25 * ((t - 0.75) / 0.25) ** 2)
    angle = np.deg2rad(hue)
    lab = np.stack([lightness, strength * np.cos(angle), strength * np.sin(angle)], axis=1)
    linear = (lab @ np.linalg.inv(_LAB).T) ** 3 @ np.linalg.inv(_LMS).T
    gamma = 1.055 * np.clip(linear, 0.0031308, None) ** (1 / 2.4) - 0.055
    return np.clip(np.where(linear <= 0.0031308, linear * 12.92, gamma), 0.0, 1.0)
