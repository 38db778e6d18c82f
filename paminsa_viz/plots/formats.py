"""Figure formats: the registry that page, command line and report read, and how a file is written.

A new format is one entry of `FIGURE_FORMATS`. matplotlib is imported late, since
listing formats does not need it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any, NamedTuple

from paminsa_viz.errors import InvalidInput
from paminsa_viz.version import MADE_BY

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import LayoutEngine

INCH = 25.4  # mm
POINT = INCH / 72  # mm

WIDTHS = (50.0, 1000.0)
"""Possible widths of a figure [mm]."""
RESOLUTIONS = (20.0, 2400.0)
"""Possible resolutions [pixels per inch]."""
MOST_PIXELS = 20_000
"""Largest width of a figure made of pixels."""


class Credits(NamedTuple):
    """Metadata of a file: title, and one line about it."""

    title: str
    about: str


@dataclass(frozen=True)
class FigureFormat:
    """A file format of figures.

    Attributes:
        name: matplotlib's name, which is also the file's ending.
        metadata: What matplotlib is to write into the file; None if it can write nothing.
        pixels: Whether the whole figure is made of pixels.
    """

    name: str
    metadata: Callable[[Credits], dict[str, Any]] | None = None
    pixels: bool = False

    @property
    def ending(self) -> str:
        """Ending of the file, with the dot."""
        return f".{self.name}"

    @property
    def label(self) -> str:
        """Name on a button."""
        return self.name.upper()


FIGURE_FORMATS: dict[str, FigureFormat] = {
    each.name: each
    for each in (
        FigureFormat(
            "png",
            lambda c: {"Title": c.title, "Description": c.about, "Software": MADE_BY},
            pixels=True,
        ),
        FigureFormat(
            "svg",
            # Without a date, so that equal input gives equal bytes; the same for PDF.
            lambda c: {
                "Title": c.title, "Description": c.about, "Creator": MADE_BY, "Date": None
            },
        ),
        FigureFormat(
            "pdf",
            lambda c: {
                "Title": c.title, "Subject": c.about, "Creator": MADE_BY,
                "Producer": "matplotlib", "CreationDate": None,
            },
        ),
    )
}  # fmt: skip
"""Every figure format by name."""


def figure_endings() -> tuple[str, ...]:
    """Return the endings of figure files, with their dots."""
    return tuple(each.ending for each in FIGURE_FORMATS.values())


def figure_format(name: str) -> FigureFormat:
    """Return a format by its name.

    Raises:
        InvalidInput: If there is none.
    """
    if name not in FIGURE_FORMATS:
        raise InvalidInput("format", f"one of {', '.join(FIGURE_FORMATS)} is needed, not {name!r}")
    return FIGURE_FORMATS[name]


def check_size(name: str, width_mm: float, dpi: float) -> FigureFormat:
    """Return a format after checking width [mm] and resolution [pixels per inch] for it.

    Raises:
        InvalidInput: If one of them is not possible; names the possible range.
    """
    chosen = figure_format(name)
    for argument, value, (low, high), unit in (
        ("width_mm", width_mm, WIDTHS, "mm"),
        ("dpi", dpi, RESOLUTIONS, "pixels per inch"),
    ):
        if not low <= value <= high:
            problem = f"{low:g} to {high:g} {unit} are possible, not {value:g}"
            raise InvalidInput(argument, problem)
    if chosen.pixels and width_mm / INCH * dpi > MOST_PIXELS:
        raise InvalidInput("dpi", f"the figure would be more than {MOST_PIXELS:,} pixels wide")
    return chosen


_SETTINGS: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so it is the same everywhere
    "pdf.fonttype": 42,  # whole outlines, as journals require
    "svg.fonttype": "path",
    "svg.hashsalt": "paminsa_viz",  # names of SVG elements, random otherwise
    "text.hinting": "none",  # so that text is as wide at every resolution
    "text.parse_math": False,  # a design's name may contain dollar signs
}
drawing_lock = threading.Lock()
"""Held while drawing: matplotlib's settings and font caches belong to the process."""


@contextmanager
def drawing() -> Iterator[None]:
    """Draw in one thread at a time, with settings of the package and not of the user."""
    import matplotlib as mpl

    with drawing_lock, mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def arrange(figure: Figure, layout: LayoutEngine) -> None:
    """Place the axes of a figure by a layout that is not its own, inside `drawing`.

    By its own they would be placed twice to be saved. The solver's last digits depend on where its
    variables are in memory, and names of SVG elements on those of the axes, which are rounded here.
    """
    layout.execute(figure)
    for area in figure.axes:
        left, bottom, width, height = area.get_position().bounds
        area.set_position((round(left, 9), round(bottom, 9), round(width, 9), round(height, 9)))


def figure_file(figure: Figure, name: str, dpi: float, credits: Credits) -> bytes:
    """Return a figure as a file, inside `drawing`.

    Args:
        figure: The figure.
        name: Name of the format.
        dpi: Pixels per inch.
        credits: Metadata of the file.
    """
    stream = BytesIO()
    metadata = figure_format(name).metadata
    figure.savefig(stream, format=name, dpi=dpi, metadata=metadata and metadata(credits))
    return stream.getvalue()
