"""Colors as the browser takes them.

The viewer reads the colors of lines, of batched meshes and of arrows as linear light, but those of
plain meshes as they are seen. What is given here looks like the palette either way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.meshes.materials import srgb_to_linear


def drawn(*colors: str) -> NDArray[np.uint8]:
    """Return ``#rrggbb`` colors for lines, batched meshes and arrows, (n, 3)."""
    return np.rint(255 * np.array([srgb_to_linear(color) for color in colors])).astype(np.uint8)
