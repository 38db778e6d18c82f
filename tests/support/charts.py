"""Curves of the page as a test reads them."""

from __future__ import annotations

import numpy as np

from paminsa_viz.plots.series import Values
from paminsa_viz.plots.series_uplot import ChartShape


def shown_curve(series: tuple[Values, ...], shape: ChartShape, number: int) -> Values:
    """Return one curve (n,) out of series that `uplot_data` made, its pieces put together."""
    first = 3 + number * shape.pieces  # after time, range of the axis, and failures
    parts = np.array(series[first : first + shape.pieces])
    known = ~np.isnan(parts)
    return np.where(known.any(axis=0), np.where(known, parts, 0.0).sum(axis=0), np.nan)
