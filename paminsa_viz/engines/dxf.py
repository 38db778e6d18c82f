"""The mechanism's skeleton as a DXF drawing: from above, and each leg in its own plane.

Drawn at a pose, in millimeters, in the form that every CAD program reads (R12). Lines are the
center lines of the links, circles the joints. From above, the origin is the robot's axis and x and
y are the base's. The legs stand to the right of that, one after the other: horizontally the
distance from the leg axis along the guide, upward z, with a cross on the leg axis at z = 0. Each
view has a layer.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from paminsa_viz.engines.mechanism import LEAST_ROD, MechanismTree, build_mechanism, leg_name
from paminsa_viz.engines.poses import start_pose, start_values, world_frames
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.units import MM
from paminsa_viz.version import MADE_BY

LAYERS = {"FROM_ABOVE": 7, "LEG_1": 1, "LEG_2": 3, "LEG_3": 5, "NOTES": 8}
"""Layers with their colors by AutoCAD's index: black or white, red, green, blue, gray."""

GAP = 0.15
"""Space between views, over the width of the one from above."""


class _View(NamedTuple):
    """Lines (n, 2, 2) and joints (m, 2) of a layer [m]."""

    layer: str
    lines: Array
    joints: Array


@of_design
def dxf_text(design: Design, *, pose: Sequence[float] | None = None) -> str:
    """Write the skeleton of a design at a pose as a DXF drawing.

    Args:
        design: The robot.
        pose: (x, y, theta, z) [m, m, rad, m]; default `start_pose`.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        UnreachablePose: If the robot cannot be in the pose.
    """
    at = start_pose(design, pose)
    views = _views(build_mechanism(design), start_values(design, at))
    radius = 0.012 * (design.geometry.crank_length + design.geometry.coupler_length)
    left, right = _extent(views[0])
    gap = GAP * (right - left)
    entities, offset = [], 0.0
    for number, view in enumerate(views):
        if number:
            offset += gap - _extent(view)[0]
        entities += _entities(view, offset, radius, crossed=number > 0)
        height = view.lines[..., 1].min() - 6 * radius
        entities.append(_text("NOTES", offset + _extent(view)[0], height, 2 * radius, view.layer))
        offset += _extent(view)[1]
    x, y, theta, z = at.tolist()
    note = (
        f"{_plain(design.name)}: x {MM * x:.6g} mm, y {MM * y:.6g} mm, theta "
        f"{math.degrees(theta):.6g} deg, z {MM * z:.6g} mm; {MADE_BY}"
    )
    note = noting_equal_legs(note, design.deviations)
    lowest = min(view.lines[..., 1].min() for view in views)
    entities.append(_text("NOTES", left, lowest - 10 * radius, 2 * radius, note))
    header = _section("HEADER", _pairs((9, "$ACADVER"), (1, "AC1009"), (9, "$INSUNITS"), (70, 4)))
    layers = [
        _pairs((0, "LAYER"), (2, name), (70, 0), (62, color), (6, "CONTINUOUS"))
        for name, color in LAYERS.items()
    ]
    table = [_pairs((0, "TABLE"), (2, "LAYER"), (70, len(layers))), *layers, _pairs((0, "ENDTAB"))]
    parts = (header, _section("TABLES", *table), _section("ENTITIES", *entities))
    return "".join(parts) + _pairs((0, "EOF"))


def _views(mechanism: MechanismTree, values: dict[str, float]) -> list[_View]:
    """Return what is seen from above, and of each leg in its plane."""
    frames = world_frames(mechanism, values)
    lines: dict[str, list[Array]] = {}
    joints: dict[str, list[Array]] = {}
    for link in mechanism.links:
        place, turn = frames[link.name]
        ends = [np.array([rod.start, rod.end]) for rod in link.rods]
        lines[link.name] = [place + turn.apply(each) for each in ends]
        joints[link.name] = [place] if link.leg is not None else []
    for pin in mechanism.pins:
        place, turn = frames[pin.first]
        joints[pin.first].append(place + turn.apply(pin.first_point))
    found = [_view("FROM_ABOVE", list(lines), lines, joints, np.zeros(3), np.eye(3)[:, :2])]
    for leg in range(3):
        own = [link.name for link in mechanism.links if link.leg == leg]
        place, turn = frames[leg_name(leg, "B10")]
        plane = np.column_stack([turn.as_matrix()[:, 0], [0.0, 0.0, 1.0]])
        found.append(_view(f"LEG_{leg + 1}", own, lines, joints, place, plane))
    return found


def _view(
    layer: str, names: list[str], lines: dict[str, list[Array]], joints: dict[str, list[Array]],
    origin: Array, plane: Array,
) -> _View:  # fmt: skip
    """Return links as they are seen from a point (3,) on a plane (3, 2)."""
    ends = np.array([line for name in names for line in lines[name]])
    points = np.array([point for name in names for point in joints[name]])
    return _View(layer, (ends - origin) @ plane, (points - origin) @ plane)


def _extent(view: _View) -> tuple[float, float]:
    across = view.lines[..., 0]
    return float(across.min()), float(across.max())


def _entities(view: _View, offset: float, radius: float, crossed: bool) -> list[str]:
    lines = view.lines
    if crossed:
        arm = 3 * radius
        lines = np.concatenate([lines, [[[-arm, 0], [arm, 0]], [[0, -arm], [0, arm]]]])
    long = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) > LEAST_ROD
    found = [
        _pairs((0, "LINE"), (8, view.layer), *_point(start, offset), *_point(end, offset, 1))
        for start, end in lines[long]
    ]
    places = np.unique(view.joints.round(9), axis=0)
    return found + [
        _pairs((0, "CIRCLE"), (8, view.layer), *_point(place, offset), (40, MM * radius))
        for place in places
    ]


def _text(layer: str, x: float, y: float, height: float, text: str) -> str:
    place = _point(np.array([x, y]), 0.0)
    return _pairs((0, "TEXT"), (8, layer), *place, (40, MM * height), (1, text))


def _point(place: Array, offset: float, number: int = 0) -> list[tuple[int, float]]:
    x, y = (MM * np.add(place, (offset, 0.0))).tolist()
    return [(10 + number, x), (20 + number, y), (30 + number, 0.0)]


def _plain(text: str) -> str:
    """Return a name that any reader of R12 shows."""
    return re.sub(r"[^ -~]|%%", "?", text)


def _section(name: str, *content: str) -> str:
    return "".join([_pairs((0, "SECTION"), (2, name)), *content, _pairs((0, "ENDSEC"))])


def _pairs(*pairs: tuple[int, object]) -> str:
    """Return codes and values, a line each."""
    return "".join(
        f"{code:>3}\n{value + 0.0 if isinstance(value, float) else value}\n"
        for code, value in pairs
    )
