"""What the arrows of the layers mean, for the legend: at rest or in motion, and to which scale."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.scene.actuators import FULL_LENGTH, FULL_TURN, arrow_scales
from paminsa_viz.explorer.scene.mechanism import mass_centers, newtons_per_bar
from paminsa_viz.palette import ACTUATOR_COLORS, BAD, INK
from paminsa_viz.units import number

Row = tuple[tuple[str, ...], str] | None
"""Colors ``#rrggbb`` and text; None where the layer has no arrow to explain."""


def torques(frame: Frame) -> Row:
    """Explain the arrows of the actuators."""
    torque, force = arrow_scales(frame.shown_design)
    turn = f"{math.degrees(FULL_TURN):.0f}° = {number(torque, 3)} N·m"
    length = f"{1e3 * FULL_LENGTH:.0f} mm = {number(force, 3)} N"
    return ACTUATOR_COLORS, f"static torques, arc {turn}; F₄ {length}"


def load(frame: Frame) -> Row:
    """Explain the arrow of the external load; its own label states the scale."""
    state = frame.state
    if not frame.shown_design.load.acts:
        return None
    when = "of the design and the motion" if state.playback.following else "of the design"
    return (BAD,), f"external load {when}, scale at the arrow"


def weights(frame: Frame) -> Row:
    """Explain the arrows of the bodies' weights."""
    design = frame.shown_design
    if not np.isfinite(frame.configuration.pose).all() or not frame.drawable:
        return None
    scale = newtons_per_bar(mass_centers(design, frame.configuration), design.gravity)
    return (INK,), f"weights, 100 mm = {number(scale, 3)} N"


def joint_forces(frame: Frame) -> Row:
    """Explain the arrows of the joint forces; their own label states the scale."""
    when = "of the motion" if frame.state.playback.following else "at rest"
    return (INK,), f"joint forces {when}, scale at the largest"


def escape(frame: Frame) -> Row:
    """Explain the arrows of the platform's motion at a planned crossing."""
    state = frame.state
    if not state.document.motion.crosses or "path" not in state.layers:
        return None
    return (BAD,), "escape twist at the crossing, not to scale"
