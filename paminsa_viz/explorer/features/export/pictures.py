"""Pictures of the 3D view, as the page draws them."""

from __future__ import annotations

import io
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from paminsa_viz.explorer.browser.style import over_backdrop
from paminsa_viz.explorer.kit.downloads import File, file_name
from paminsa_viz.explorer.scene.legend import NO_LEGEND, Legend, with_legend
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError

VIEW_SIDES = (64, 4096)
"""Sides of a picture of the 3D view [pixels]."""
VIEW_TIMEOUT = 30.0
"""How long a page may take for a picture of the 3D view [s]."""

LEGEND_LETTERS = 13.0
"""Size of the letters of the legend on a picture whose shorter side has 720 pixels [px]."""


class Viewpoint(NamedTuple):
    """From where a picture of the 3D view is taken.

    Attributes:
        wxyz: How the camera is turned, a quaternion.
        position: Where it is [m].
        fov: Its vertical field of view [rad].
    """

    wxyz: NDArray[np.float64]
    position: NDArray[np.float64]
    fov: float

    @classmethod
    def now(cls, client: viser.ClientHandle) -> Viewpoint:
        """Return from where a page looks by now."""
        camera = client.camera
        return cls(camera.wxyz, camera.position, camera.fov)


class NoView(PaminsaError):
    """The page did not give a picture of its 3D view."""


def picture(
    client: viser.ClientHandle,
    size: tuple[float, float],
    legend: Legend = NO_LEGEND,
    viewpoint: Viewpoint | None = None,
) -> NDArray[np.uint8]:
    """Return a picture of the 3D view over the light gradient, (height, width, 3).

    Args:
        client: The page.
        size: Width and height [pixels]; kept within `VIEW_SIDES`.
        legend: What the legend over the view says.
        viewpoint: From where it is taken; None for where the page looks from when it takes it.

    Raises:
        NoView: If the page does not answer in time.
    """
    low, high = VIEW_SIDES
    width, height = (int(min(max(side, low), high)) for side in size)
    try:
        pixels = client.get_render(
            height, width, **(viewpoint._asdict() if viewpoint else {}), transport_format="png",
            timeout=VIEW_TIMEOUT,
        )  # fmt: skip
        if pixels.dtype != np.uint8 or pixels.shape != (height, width, 4):
            raise ValueError(f"a picture of shape {pixels.shape}")
        letters = LEGEND_LETTERS * min(height, width) / 720
        return with_legend(over_backdrop(pixels), legend, max(letters, 8.0))
    except Exception as error:  # what a page sends may break any decoder in any way
        raise NoView(
            "the page did not give a picture of the 3D view; keep its tab in front and try again"
        ) from error


def view(state: State, client: viser.ClientHandle, legend: Legend = NO_LEGEND) -> File:
    """Take a picture of the 3D view, as the page draws it.

    Args:
        state: What it shows, for the name, and the picture's size.
        client: The page.
        legend: What the legend over the view says.

    Raises:
        NoView: If the page does not answer in time.
    """
    from PIL import Image

    camera = client.camera
    size = state.export.view_size or (camera.image_width, camera.image_height)
    stream = io.BytesIO()
    Image.fromarray(picture(client, size, legend)).save(stream, format="png")
    return File(file_name(state, "view", "png", "pose"), stream.getvalue())
