"""The color bar of a printed map, and matplotlib's own form of a color scale."""

from __future__ import annotations

from typing import Any

from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, ListedColormap, Normalize, SymLogNorm

from paminsa_viz.palette import INK
from paminsa_viz.plots import axes
from paminsa_viz.plots.layout import Box
from paminsa_viz.plots.lettering import TextMetrics
from paminsa_viz.plots.maps import MapData
from paminsa_viz.plots.page import Page
from paminsa_viz.plots.scale import Scale


def matplotlib_colors(scale: Scale) -> tuple[Normalize, Colormap]:
    """Return matplotlib's own norm and color map for a scale."""
    under, over = scale.beyond
    table = ListedColormap(scale.table, name=scale.colors).with_extremes(
        under=under, over=over, bad=(0.0, 0.0, 0.0, 0.0)
    )
    if scale.kind == "linear":
        return Normalize(scale.low, scale.high), table
    norm = SymLogNorm(scale.threshold, linscale=1.0, vmin=scale.low, vmax=scale.high, base=10)
    return norm, table


def draw_bar(
    page: Page,
    data: MapData,
    scale: Scale,
    box: Box,
    letters: TextMetrics,
    *,
    upright: bool,
    shared: bool,
) -> None:
    """Draw the color bar of a scale into its box; ``shared`` bars are long."""
    panel = page.axes(box)
    norm, table = matplotlib_colors(scale)
    arrow = 0.06 if shared else 0.1
    bar = page.figure.colorbar(
        ScalarMappable(norm, table),
        cax=panel,
        orientation="vertical" if upright else "horizontal",
        extend="both",
        extendfrac=arrow,
    )
    length = (box.height if upright else box.width) / (1 + 2 * arrow)

    def room(words: str) -> float:
        return letters.line * 1.2 if upright else letters.width(words)

    factor, unit = data.display
    marks = axes.bar_marks(factor, scale, length, room)
    bar.set_ticks([m.value for m in marks], labels=[m.words for m in marks])
    bar.minorticks_off()
    panel.tick_params(
        labelsize=letters.size, labelcolor=INK, color=INK, length=2.0, width=0.5, pad=1.5
    )
    bar.outline.set(edgecolor=INK, linewidth=0.5)  # type: ignore[operator]
    label = axes.unit_label(unit)
    style: dict[str, Any] = {"size": letters.size}
    if upright:
        page.text(box.left - 0.5, box.top - 1.0, label, ha="left", va="baseline", **style)
    else:
        middle = box.left + box.width / 2
        page.text(middle, box.bottom + 4.4, label, ha="center", va="top", **style)
