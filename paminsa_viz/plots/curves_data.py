"""The data behind every figure over time: panels of traces, what failed when, and its caption.

The printed figure (`curves_paper`) and the page's plots read the same object. Values are in SI
units; `Panel.display` leads to what a person reads.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.palette import INK
from paminsa_viz.units import DisplayUnit, display_unit

Dash = Literal["solid", "dashed", "dotted", "dashdot"]


@dataclass(frozen=True, eq=False)
class Trace:
    """A curve.

    Attributes:
        label: What it is, short, for legends; the same in every panel that has it.
        values: (n,) in the panel's unit; NaN where there is none.
        color: ``#rrggbb``.
        dash: Its stroke.
        width: Its width, 1 for ordinary.
    """

    label: str
    values: NDArray[np.float64]
    color: str
    dash: Dash = "solid"
    width: float = 1.0


@dataclass(frozen=True)
class Peak:
    """A marked point: a value that is largest in size, with its time [s]."""

    t: float
    value: float
    color: str


@dataclass(frozen=True)
class Level:
    """A level line, such as an RMS, in the panel's unit."""

    value: float
    color: str
    label: str = "RMS"


@dataclass(frozen=True)
class Reading:
    """Numbers about a panel in words, and the color of the trace that they belong to."""

    words: str
    color: str


@dataclass(frozen=True, eq=False)
class Panel:
    """One set of axes.

    Attributes:
        name: Heading, for example ``"M1"``.
        symbol: Symbol of what is drawn, for the axis: ``"τ₁"``.
        unit: Unit of the values.
        color: Color of the heading.
        traces: The curves, later ones above earlier ones.
        peaks: Marked points.
        levels: Level lines.
        readings: Numbers in words.
    """

    name: str
    symbol: str
    unit: str
    color: str
    traces: tuple[Trace, ...]
    peaks: tuple[Peak, ...] = ()
    levels: tuple[Level, ...] = ()
    readings: tuple[Reading, ...] = ()

    @property
    def display(self) -> DisplayUnit:
        """The unit that people read the values in."""
        return display_unit(self.unit)

    @property
    def label(self) -> str:
        """Label of the axis, such as ``τ₁ [N·m]``."""
        return f"{self.symbol} [{self.display.text}]"


@dataclass(frozen=True)
class Interval:
    """A time during which the motion fails; an instant if start and end are the same [s]."""

    start: float
    end: float
    reason: str


@dataclass(frozen=True, eq=False)
class CurveData:
    """Panels over one time axis.

    Attributes:
        kind: Which of `curves.KINDS`.
        title: What is shown, in words.
        time: (n,) increasing [s].
        panels: In reading order.
        columns: Columns that suit the panels where there is room for more than one.
        failures: When and why the motion fails, in order.
        caption: Sentences about what is shown.
        summary: One line for a file's metadata.
        version: Version of this package.

    Raises:
        InvalidInput: If a trace is not as long as the time.
    """

    kind: str
    title: str
    time: NDArray[np.float64]
    panels: tuple[Panel, ...]
    columns: int
    failures: tuple[Interval, ...]
    caption: tuple[str, ...]
    summary: str
    version: str

    def __post_init__(self) -> None:
        for panel in self.panels:
            for trace in panel.traces:
                if trace.values.shape != self.time.shape:
                    problem = f"shape {self.time.shape} is needed, not {trace.values.shape}"
                    raise InvalidInput(f"{panel.name}, {trace.label}", problem)

    @property
    def legend(self) -> tuple[Trace, ...]:
        """One trace for each label that needs a key: not those that are alone in their panel.

        Of each panel the uppermost comes first.
        """
        found: dict[str, Trace] = {}
        for panel in self.panels:
            if len(panel.traces) == 1:
                continue
            for trace in (*panel.traces[-1:], *panel.traces[:-1]):
                known = found.setdefault(trace.label, trace)
                if known.color != trace.color:  # it has the colors of the panels
                    found[trace.label] = replace(known, color=INK)
        return tuple(found.values())


def extremes(values: NDArray[np.float64], most: int) -> NDArray[np.intp]:
    """Return the indices of at most about ``most`` samples that draw the same curve.

    The list is cut into equal parts; of each the least and the largest value stay, and the ends of
    runs of NaN, so that gaps and peaks are drawn as they are.
    """
    n = values.size
    parts = max(most // 2, 1)
    if n <= most:
        return np.arange(n)
    size = math.ceil(n / parts)
    parts = math.ceil(n / size)
    padded = np.full(parts * size, np.nan)
    padded[:n] = values
    grid = padded.reshape(parts, size)
    base = np.arange(parts) * size
    least = base + np.argmin(np.where(np.isnan(grid), np.inf, grid), axis=1)
    largest = base + np.argmax(np.where(np.isnan(grid), -np.inf, grid), axis=1)
    edges = np.flatnonzero(np.diff(np.isnan(values)))
    found = np.unique(np.concatenate([[0, n - 1], least, largest, edges, edges + 1]))
    return found[found < n]
