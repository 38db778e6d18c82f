"""The pinned design in the scene, seen through."""

from __future__ import annotations

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.ghost import Ghost
from paminsa_viz.model import Design
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics


class PinnedDesign(Ghost):
    """The layer ``pinned_design``: the reference at the robot's pose, where it differs in shape."""

    root = "/pinned"

    def seen(self, frame: Frame) -> tuple[Design, Configuration] | None:
        state = frame.state
        reference = state.document.reference if "pinned_design" in state.layers else None
        if reference is None or same_look(reference, frame.shown_design):
            return None
        configuration = inverse_kinematics(reference.geometry, state.last_reachable.pose)
        return (reference, configuration) if configuration.reach.ok else None


def same_look(one: Design, other: Design) -> bool:
    """Whether two designs are drawn the same, so that one would only flicker in the other."""
    return (one.geometry, one.payload, one.counterweights) == (
        other.geometry, other.payload, other.counterweights
    )  # fmt: skip
