"""Where bodies meet: bars whose center lines would touch, and the two nearest bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from paminsa_viz.elastostatics.leg_frame import contacts, pair_name
from paminsa_viz.explorer.core import clearance
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.nodes import Node, ball, curves, label, mesh
from paminsa_viz.palette import BAD
from paminsa_viz.units import format_value

RADIUS: Final = 0.028
"""Radius of a ball [m]: more than that of a bar, so that it can be seen."""

ABOVE: Final = 0.012
"""Height of the label of the nearest bodies over the line between them [m]."""


def contact_marks(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``contacts``: a ball where two bars would touch, and a label for each leg."""
    design, pose = frame.shown_design, frame.configuration.pose
    if not np.isfinite(pose).all():
        return
    scale = design.geometry.body_scale
    found, shape = contacts(design, pose), ball(RADIUS)
    for leg, gap in enumerate(found.gap):
        pairs = np.flatnonzero(gap < 0)
        for pair in pairs:
            yield mesh(
                f"/contacts/{leg + 1}-{pair}", scale * shape.vertices, shape.faces, BAD,
                place=found.point[leg, pair], opacity=0.5, side="front",
            )  # fmt: skip
        if pairs.size:
            top = max(found.point[leg, pairs], key=lambda place: place[2])
            text = ", ".join(map(pair_name, pairs.tolist()))
            place = top + np.array([0.0, 0.0, scale * RADIUS])
            yield label(f"/contacts/{leg + 1}", text, place, "bottom-center", 0.8)


def nearest_bodies(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``clearance``: a line between the two nearest bodies, with the distance.

    A pose whose clearance is not known yet has none.
    """
    found = clearance.nearest(frame.state)
    if found is None:
        return
    theme = frame.state.theme
    little = found.distance < frame.state.clearance.settings.required
    color = theme.warn_fill if little else theme.ink
    if found.distance < 0:
        color = theme.bad_fill
    yield curves("/clearance/line", [found.points], color, 4.0)
    text = f"{found.names[0]} – {found.names[1]}: {format_value(found.distance, 'm', 3)}"
    above = ABOVE * frame.shown_design.geometry.body_scale
    place = found.points.mean(axis=0) + np.array([0.0, 0.0, above])
    yield label("/clearance/label", text, place, "bottom-center")
