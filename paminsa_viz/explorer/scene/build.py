"""Makes the views of the layers that are registered."""

from __future__ import annotations

from paminsa_viz.explorer.core.session import View
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.places import found_at
from paminsa_viz.explorer.state.layers import LAYERS


def build_views(context: SceneContext, *, animated: bool) -> list[View]:
    """Make the views of the animated layers, or of the others; each class of views once."""
    from paminsa_viz.explorer.scene.nodes import LayerView  # brings trimesh and the viewer

    views: dict[object, View] = {}
    for layer in LAYERS.values():
        if layer.animated is not animated:
            continue
        view = found_at(layer.view)
        if not isinstance(view, type):
            views[layer.key] = LayerView(layer, view, context)
        elif view not in views:
            views[view] = view(context)
    return list(views.values())
