"""Figures: results in, figures out, for the page, notebooks and files.

Maps: all read `map_values.MapData`; `ranges` and `scale` decide the colors,
`contours` the lines, `map_layout` the places. `map_figure` draws for the page and for print,
`interactive` for notebooks; `hover` shows values at the pointer. `formats` is the registry of file
formats. Nothing is imported here, since matplotlib is slow to import.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.plots.formats import FIGURE_FORMATS, FigureFormat
    from paminsa_viz.plots.interactive import interactive_map
    from paminsa_viz.plots.map_figure import render_maps
    from paminsa_viz.plots.map_values import MapData, difference, map_data, workspace_field
    from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
    from paminsa_viz.plots.scale import InvalidScale, Scale
    from paminsa_viz.plots.series import FIGURES, EngineTorques
    from paminsa_viz.plots.series_figure import figure_bytes

__all__ = [
    "FIGURES",
    "FIGURE_FORMATS",
    "EngineTorques",
    "FigureFormat",
    "InvalidScale",
    "MapData",
    "Scale",
    "ScaleChoice",
    "choose_scales",
    "difference",
    "figure_bytes",
    "interactive_map",
    "map_data",
    "render_maps",
    "workspace_field",
]

__getattr__ = late_names(__name__)
