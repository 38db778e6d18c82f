"""What the views of a scene are made with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from viser import SceneApi

    from paminsa_viz.explorer.core.maps import MapStore
    from paminsa_viz.explorer.scene.legend import SceneLegend


def _ignore(source: str, action: Callable[[Any], Any], **options: bool) -> None:
    """Dispatch nothing: a scene without a session answers to nobody."""


@dataclass(frozen=True)
class SceneContext:
    """What a view of a layer is made with.

    Attributes:
        scene: Where its nodes go.
        dispatch: `Session.dispatch`, for layers that a person can click or drag.
        camera: The tab's camera, for what depends on how the scene is seen.
        pixel_ratio: Returns how many of its pixels one of the page's is.
        maps: The session's maps; only for layers that are not animated.
        legend: Says what the colors of the floor map mean; only for layers that are not animated.
    """

    scene: SceneApi
    dispatch: Callable[..., None] = _ignore
    camera: Any = None
    pixel_ratio: Callable[[], float] = lambda: 1.0
    maps: MapStore | None = None
    legend: SceneLegend | None = None
