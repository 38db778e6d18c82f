"""What every printed figure shares: file kinds and sizes, fonts, the lock, and writing the file.

One figure is drawn at a time, since matplotlib's settings and font caches belong to the process;
any thread may ask. Equal input gives equal bytes.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.figure import Figure

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.plots.page import INCH

Kind = Literal["png", "svg", "pdf"]
KINDS: tuple[Kind, ...] = ("png", "svg", "pdf")

NARROWEST, WIDEST = 50.0, 1000.0  # mm
MOST_PIXELS = 20_000  # along the width of a PNG

_SETTINGS: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so it is the same everywhere
    "pdf.fonttype": 42,  # whole outlines, as journals ask
    "svg.fonttype": "path",
    "svg.hashsalt": "paminsa_viz",  # names of SVG elements, random otherwise
    "text.hinting": "none",  # so that words are as wide as they were measured, at every dpi
}
_drawing = threading.Lock()


@contextmanager
def printing() -> Iterator[None]:
    """Draw alone, with settings of our own, whatever a person's matplotlibrc says."""
    with _drawing, mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def check_print(kind: str, width_mm: float, dpi: float) -> None:
    """Refuse a kind of file, a width [mm] or a resolution [pixels per inch] that is not possible.

    Raises:
        InvalidInput: Which of them, and what is possible.
    """
    if kind not in KINDS:
        raise InvalidInput("kind", f"one of {', '.join(KINDS)} is needed, not {kind!r}")
    if not NARROWEST <= width_mm <= WIDEST:
        raise InvalidInput("width_mm", f"{NARROWEST:g} to {WIDEST:g} mm are possible")
    if not 20 <= dpi <= 2400:
        raise InvalidInput("dpi", "20 to 2400 pixels per inch are possible")
    if kind == "png" and width_mm / INCH * dpi > MOST_PIXELS:
        raise InvalidInput("dpi", f"the picture would be more than {MOST_PIXELS} pixels wide")


def printed_bytes(
    figure: Figure, kind: Kind, dpi: float, *, title: str, about: str, version: str
) -> bytes:
    """Return a figure as a file, inside `printing`.

    Args:
        figure: The figure.
        kind: Kind of file.
        dpi: Pixels per inch.
        title: Title in the file's metadata.
        about: One line about it, there as well.
        version: Version of this package.
    """
    made_by = f"paminsa_viz {version}"
    said: dict[str, Any]
    if kind == "png":
        said = {"Title": title, "Description": about, "Software": made_by}
    elif kind == "svg":
        said = {"Title": title, "Description": about, "Creator": made_by, "Date": None}
    else:
        said = {"Title": title, "Subject": about, "Creator": made_by}
        said |= {"Producer": "matplotlib", "CreationDate": None}
    stream = BytesIO()
    figure.savefig(stream, format=kind, dpi=dpi, metadata=said)
    return stream.getvalue()
