"""The actuators in the scene: their names, and arrows of their static torques and of F_4."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.body_scale import times_body_scale
from paminsa_viz.dimensions.layout import lift_motor_height
from paminsa_viz.dimensions.placement import about_z
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.nodes import Node, label, mesh
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.layers import LegendRow
from paminsa_viz.kept import kept
from paminsa_viz.model import lift_constant, lumped_coefficients
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES, LEG_AXES
from paminsa_viz.units import number

ARC_RADIUS: Final = 0.100
ARC_HEIGHT: Final = at.MOUNT + at.PLATE + 0.026
FULL_TURN: Final = np.radians(300.0)
"""Sweep of an arc at full scale [rad]."""

FULL_LENGTH: Final = 0.26
"""Length of the force arrow at full scale, at Appendix 4's lengths [m]."""

THIN, THICK = 0.0045, 0.0095
"""Radius of an arrow's shaft at zero and at full scale [m]."""

NEXT_TO_LIFT: Final = 0.072 * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
"""Place of the force arrow next to the lift's axis, (x, y) [m]."""

ARROW_TURNS: Final = (*about_z(np.array([*AXIS_ANGLES, 0.0])),)
"""Quaternions of the four arrows."""

_RINGS, _SIDES = 24, 8

_AROUND: Final = 2 * np.pi * np.arange(_SIDES) / _SIDES
_COS: Final = np.cos(_AROUND)
_SIN: Final = np.sin(_AROUND)


def _skin() -> NDArray[np.uint32]:
    """Return the triangles over a row of rings, the same for every arrow."""
    i, j = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    low = _SIDES * np.arange(_RINGS - 1)[:, None]
    high = low + _SIDES
    pairs = [
        np.stack([low + i, high + j, low + j], -1),
        np.stack([low + i, high + i, high + j], -1),
    ]
    return np.stack(pairs, axis=2).reshape(-1, 3).astype(np.uint32)


FACES: Final = _skin()
"""Triangles of every arrow."""


def _rings(fraction: float, largest: float, scale: float) -> tuple[Array, Array, Array]:
    """Return the rings of an arrow along an axis, for a fraction of full scale.

    Its shaft is that fraction of ``largest`` long, the head follows; ``scale`` turns meters into
    units of its length. Values beyond full scale are drawn as full.

    Returns:
        Places along the axis (rings, 1), and the two coordinates across it (rings, sides) [m].
    """
    size = min(abs(fraction), 1.0)
    length, radius = max(size * largest, 1e-3), THIN + (THICK - THIN) * size
    tip = length + 4.5 * radius * scale
    along = np.array([0.0, *np.linspace(0.0, length, _RINGS - 3), length, tip])
    wide = np.full((_RINGS, 1), radius)
    wide[[0, -2, -1], 0] = 0.0, 2.7 * radius, 0.0
    return along[:, None], wide * _COS, wide * _SIN


def arc_arrow(fraction: float) -> Array:
    """Return the corners of an arc arrow about z for a torque as a fraction of full scale.

    Positive values turn counter-clockwise seen from above. The arc's shaft is centered on the
    direction x.
    """
    along, outward, up = _rings(fraction, FULL_TURN, 1 / ARC_RADIUS)
    angle = (along - along[-2] / 2) * (1.0 if fraction >= 0 else -1.0)
    distance = ARC_RADIUS + outward
    return np.stack([distance * np.cos(angle), distance * np.sin(angle), up], -1).reshape(-1, 3)


def force_arrow(fraction: float) -> Array:
    """Return the corners of a vertical arrow from the origin for a force as a fraction, + up."""
    along, across, aside = _rings(fraction, FULL_LENGTH, 1.0)
    height = np.broadcast_to(along if fraction >= 0 else -along, across.shape)
    return np.stack([across, aside, height], axis=-1).reshape(-1, 3)


NO_WEIGHT: Final = 1e-6
"""Torque [N m] and force [N] of an arrow at full size, of a robot that nothing pulls down."""


def arrow_scales(design: Design) -> tuple[float, float]:
    """Return the torque [N m] and the force [N] of an arrow at full size.

    They follow the weight of the design, so that the arrows of a balanced one are seen to shrink
    only because its torques do.
    """
    c = lumped_coefficients(design)
    weight = float(abs(c[0]) + abs(c[1]) + abs(c[2]))
    torque = 0.5 * weight * design.geometry.base_radius
    return torque or NO_WEIGHT, max(1.5 * lift_constant(design), 0.0) or NO_WEIGHT


@kept(8)
@times_body_scale
def _arc_places(geometry: Geometry) -> tuple[tuple[float, ...], ...]:
    height = ARC_HEIGHT * geometry.knee.sign
    return tuple((*geometry.base_radius * axis, height) for axis in LEG_AXES)


def torque_arrows(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``torques``: torques of M1..M3 and the force of M4.

    The longest arrow is a full scale, see `arrow_scales`; greater values are drawn as
    long, and values that are not finite are not drawn.
    """
    geometry = frame.shown_design.geometry
    size, (torque, force) = symbol_size(geometry), arrow_scales(frame.shown_design)
    with np.errstate(all="ignore"):
        fractions = frame.torques / [torque, torque, torque, force]
    lift = (*geometry.body_scale * NEXT_TO_LIFT, frame.configuration.actuators[3])
    places = (*_arc_places(geometry), lift)
    for index, fraction in enumerate(fractions):
        if np.isfinite(fraction) and abs(fraction) > 1e-4:
            if index < 3:  # about its motor, which is as large in a robot of small lengths
                shape = max(size, geometry.body_scale) * arc_arrow(fraction)
            else:
                shape = size * force_arrow(fraction)
            color = palette.ACTUATOR_COLORS[index]
            yield mesh(
                f"/efforts/m{index + 1}", shape, FACES, color,
                place=places[index], turn=ARROW_TURNS[index],
            )  # fmt: skip


def torques_meaning(frame: Frame) -> LegendRow:
    """Explain the arrows of the actuators."""
    torque, force = arrow_scales(frame.shown_design)
    turn = f"{math.degrees(FULL_TURN):.0f}° = {number(torque, 3)} N·m"
    full = FULL_LENGTH * symbol_size(frame.shown_design.geometry)
    length = f"{number(1e3 * full, 3)} mm = {number(force, 3)} N"
    return palette.ACTUATOR_COLORS, f"static torques, arc {turn}; F₄ {length}"


@times_body_scale
def label_places(geometry: Geometry) -> list[tuple[float, float, float]]:
    """Return the places of the names M1..M4 [m]."""
    radius = geometry.base_radius + 0.165
    height = geometry.knee.sign * (at.MOUNT + at.PLATE + 0.018)
    around = [(float(radius * np.cos(a)), float(radius * np.sin(a)), height) for a in AXIS_ANGLES]
    return [*around, (0.0, 0.0, lift_motor_height(geometry) + 0.02)]


NAME_SIZE: Final = (30.0, 21.0)
"""Width and height of a name on the screen [px]."""


def actuator_labels(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``labels``: the names M1..M4 next to their bodies, none over another."""
    for index, place in enumerate(label_places(frame.shown_design.geometry), start=1):
        name = f"/actuators/m{index}"
        yield label(name, f"M{index}", place, "bottom-center", 1.0, spaced=NAME_SIZE)
