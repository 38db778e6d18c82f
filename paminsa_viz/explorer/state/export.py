"""How files are exported."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ExportSettings:
    """How files are exported.

    Attributes:
        single: The single map instead of the three torque maps.
        width: Width of a figure [mm].
        dpi: Its resolution [pixels per inch].
        view_size: Width and height of the 3D view's picture [pixels]; None for the page's own.
    """

    single: bool = False
    width: float = 170.0
    dpi: float = 300.0
    view_size: tuple[int, int] | None = None
