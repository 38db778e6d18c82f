"""How the page is shown: its theme and its docks."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

from paminsa_viz.explorer.state.settings import Settings

LARGEST_DOCK: Final = 4000
"""Greatest width of a dock that is believed [px]."""


class Appearance(Enum):
    """Which theme the page has."""

    BROWSER = "as the browser"
    LIGHT = "light"
    DARK = "dark"


@dataclass(frozen=True)
class Dock:
    """One of the page's docks, as a person has left it; None for what the page itself chooses.

    Attributes:
        width: Width [px].
        folded: Whether it is folded.
    """

    width: int | None = None
    folded: bool | None = None


@dataclass(frozen=True)
class Docks(Settings):
    """The dock of the maps, left, and that of the tabs, right."""

    left: Dock = Dock()
    right: Dock = Dock()

    @property
    def possible(self) -> bool:
        widths = (self.left.width, self.right.width)
        return all(width is None or 0 < width <= LARGEST_DOCK for width in widths)


@dataclass(frozen=True)
class Camera:
    """Where a person has put the camera of the scene [m].

    Attributes:
        position: Where it is.
        look_at: What it looks at.
    """

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]


@dataclass(frozen=True)
class WorkspaceView:
    """How a workspace was left.

    Attributes:
        name: Its name.
        layers: Keys of the layers of the scene that were shown.
        quantity: Key of what the single map showed.
        beside: Name of the tab that was open in the left dock.
        camera: Where the camera was put, None for a preset.
        docks: What was done with the docks, None if that is not known.
    """

    name: str
    layers: frozenset[str]
    quantity: str
    beside: str
    camera: Camera | None = None
    docks: Docks | None = None
