"""A printed figure measured in mm, and the lines and colors that its parts share."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from paminsa_viz.palette import INK
from paminsa_viz.plots.formats import INCH
from paminsa_viz.plots.layout import Box


class Page:
    """A figure measured in mm from its top left corner."""

    def __init__(self, width: float, height: float, dpi: float) -> None:
        self.width, self.height = width, height
        # A hundredth of a pixel more, since the size in pixels is rounded down later.
        inches = [(round(length / INCH * dpi) + 0.01) / dpi for length in (width, height)]
        self.figure = Figure(figsize=(inches[0], inches[1]), dpi=dpi)
        FigureCanvasAgg(self.figure)

    def axes(self, box: Box) -> Axes:
        """Add axes that fill a box."""
        bottom = self.height - box.bottom
        return self.figure.add_axes(
            (
                box.left / self.width,
                bottom / self.height,
                box.width / self.width,
                box.height / self.height,
            )
        )

    def text(self, x: float, y: float, words: str, **style: Any) -> None:
        """Write plain words at a place [mm]; dollar signs are dollar signs."""
        style = {"color": INK, "parse_math": False, **style}
        self.figure.text(x / self.width, 1 - y / self.height, words, **style)
