"""Sizes of the parts of fixed shape are those of their drawings, the mesh files."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import PAYLOAD_HEIGHT
from paminsa_viz.meshes.part import fixed_part

ROUNDED = 3e-5
"""By how much a drawing may be off [m]."""


@cache
def vertices(part: str, *materials: str) -> Any:
    """Vertices (n, 3) of a part, of all its materials or of some."""
    solids = fixed_part(part).solids
    return np.vstack(
        [one.mesh.vertices for one in solids if not materials or one.material in materials]
    )


def around(points: Any, axis: str = "z") -> float:
    """Largest distance from an axis."""
    return float(np.linalg.norm(np.delete(points, "xyz".index(axis), axis=1), axis=1).max())


def spans(part: str, *materials: str) -> Any:
    """Lowest and highest coordinates, (3, 2)."""
    found = vertices(part, *materials)
    return np.stack([found.min(axis=0), found.max(axis=0)], axis=1)


def close(found: Any, expected: Any) -> None:
    np.testing.assert_allclose(found, expected, atol=ROUNDED)


def test_barrels_sockets_and_pins() -> None:
    close(around(vertices("barrel"), "y"), at.BARREL_RADIUS)
    close(spans("barrel", "steel")[1], (-at.BARREL / 2, at.BARREL / 2))
    close(spans("barrel")[1], np.array([-1, 1]) * (at.BARREL / 2 + size.BARREL_CAP))
    close(spans("bar_end")[0], size.SOCKET)
    close(around(vertices("bar_end"), "x"), size.SOCKET_RADIUS)
    for part, bar in (("shaft_end", "b3"), ("swivel_head", "b4")):
        ends = at.span(bar)[1]  # the pin holds what runs in the layer of that bar
        close(spans(part, "steel")[1, 1], ends + at.PIN_HEAD)
        close(spans(part)[1, 1], ends + size.PIN_REACH)
        close(around(vertices(part, "steel"), "y"), size.COLLAR_RADIUS)
    close(spans("slider", "steel")[1, 0], at.span("b8")[0] - at.PIN_HEAD)
    close(spans("slider")[1, 0], at.span("b8")[0] - size.PIN_REACH)
    assert at.PIN_RADIUS < size.COLLAR_RADIUS


def test_motors_of_the_legs() -> None:
    close(around(vertices("rotary_actuator", "body")), size.MOTOR_RADIUS)
    close(spans("rotary_actuator", "body")[2], (0.0, at.MOTOR_HEIGHT))
    close(spans("rotary_actuator")[2, 1], at.MOTOR_HEIGHT + size.MOTOR_FACE)
    connector = spans("rotary_actuator", "dark")
    close((connector[0, 0], spans("rotary_actuator")[0, 1]), size.CONNECTOR)
    close(connector[1], (-size.CONNECTOR_WIDTH / 2, size.CONNECTOR_WIDTH / 2))
    close(connector[2], size.CONNECTOR_HEIGHTS)


def test_quill_with_the_block_that_holds_the_guide() -> None:
    steel = vertices("quill", "steel")
    close(around(steel), at.QUILL_RADIUS)
    close(np.linalg.norm(steel[:, :2], axis=1).min(), at.QUILL_BORE)
    close(spans("quill", "body")[2, 1], at.QUILL_TOP)
    close(spans("quill")[2], (size.QUILL_LOW, at.QUILL_TOP + size.QUILL_KEY))
    body = vertices("quill", "body")
    close(body[:, 0].min(), size.QUILL_BLOCK[0])
    close(body[:, 2].min(), -size.QUILL_BLOCK[1])
    collar = body[body[:, 2] > 0.1]
    close(around(collar), size.QUILL_COLLAR_RADIUS)
    close(np.ptp(collar[:, 2]), size.QUILL_COLLAR)
    close(np.abs(vertices("slider", "body")[:, 1]).max(), at.CORE)


def test_slider_shaft_and_swivel() -> None:
    close(spans("slider")[2], size.SLIDER_HEIGHTS)
    assert 0 <= spans("slider")[0, 1] - at.SLIDER_HALF < 2e-4  # the wipers' edges
    block = vertices("shaft_end", "body")
    close(np.ptp(block[:, 0]), size.SHAFT_BLOCK)
    close(block[:, 2].min(), size.SHAFT_BLOCK_HEIGHTS[0])
    close(spans("shaft_end")[2, 1], size.SHAFT_NECK_TOP)
    close(around(vertices("shaft_end", "accent")), size.SHAFT_NECK_RADIUS)
    close(around(vertices("shaft_nut")), size.NUT_RADIUS)
    close(spans("shaft_nut")[2], size.NUT)
    close(around(vertices("swivel_disc")), size.SWIVEL_DISC_RADIUS)
    close(spans("swivel_disc")[2, 1], size.SWIVEL_DISC_HEIGHT - at.PLATE_BELOW_5)
    close(spans("swivel_head")[0], (-size.SWIVEL_HALF, size.SWIVEL_HALF))
    close(spans("swivel_head")[2, 1], size.SWIVEL_TOP)


def test_carriage_column_and_head_of_m4() -> None:
    close(around(vertices("lift_carriage")), size.CARRIAGE_RADIUS)
    close(spans("lift_carriage", "accent")[2], (-at.CARRIAGE_HALF, at.CARRIAGE_HALF))
    close(spans("lift_carriage")[2, 0], -at.CARRIAGE_HALF - size.CARRIAGE_CAP)
    below, above = size.CARRIAGE_COLLAR
    collars = spans("lift_carriage", "steel")[2]
    close(collars, (-at.CARRIAGE_HALF - below, at.CARRIAGE_HALF + above))
    close(around(vertices("lift_carriage", "steel")), size.CARRIAGE_COLLAR_RADIUS)
    close(around(vertices("arm_bearing")), size.ARM_BEARING_RADIUS)
    close(spans("arm_bearing", "accent")[2], (-at.ARM_BEARING_HALF, at.ARM_BEARING_HALF))
    close(spans("arm_bearing")[2, 1], at.ARM_BEARING_HALF + size.ARM_BEARING_CAP)
    foot = vertices("lift_foot")
    close(around(foot), size.FOOT_RADIUS)
    close(spans("lift_foot", "steel")[2, 1], size.FOOT_HEIGHT)
    close(foot[:, 2].max(), size.FOOT_NECK_HEIGHT)
    close(around(foot[foot[:, 2] > size.FOOT_HEIGHT + 1e-3]), size.FOOT_NECK_RADIUS)
    close(around(vertices("lift_motor", "body")), size.HEAD_RADIUS)
    close(spans("lift_motor", "steel")[2, 1], size.HEAD_PLATE)
    close(np.ptp(vertices("lift_motor", "accent")[:, 0]), size.HEAD_WIDTH)
    close(spans("lift_motor")[2], (0.0, at.LIFT_MOTOR_HEIGHT))
    dark = vertices("lift_motor", "dark")
    connector = dark[dark[:, 1] > size.HEAD_WIDTH / 2]
    half, middle = np.array(size.HEAD_CONNECTOR) / 2, np.array(size.HEAD_CONNECTOR_AT)
    close(connector.max(axis=0), middle + half)
    close(connector.min(axis=0)[[0, 2]], (middle - half)[[0, 2]])


def test_flange_mast_and_payload() -> None:
    close(around(vertices("tool_flange")), size.FLANGE_RADIUS)
    close(-spans("tool_flange", "body")[2, 0], size.FLANGE_DEPTH)
    close(-spans("tool_flange")[2, 0], size.FLANGE_TIP_DEPTH)
    close(around(vertices("tool_flange", "steel")), size.FLANGE_TIP_RADIUS)
    foot = spans("mast_foot")
    close(np.ptp(foot[:2], axis=1), size.MAST_FOOT[:2])
    close(spans("mast_foot", "steel")[2, 1], size.MAST_FOOT[2])
    body = vertices("mast_foot", "body")
    sleeve = body[body[:, 2] > 0.03]
    close(np.ptp(sleeve[:, :2], axis=0), size.MAST_SLEEVE[:2])
    close(foot[2, 1], size.MAST_SLEEVE[2])
    close(-spans("payload")[2, 0], PAYLOAD_HEIGHT)
    close(around(vertices("payload")), PAYLOAD_HEIGHT / size.PAYLOAD_RATIO)


@pytest.mark.parametrize("bar", ["b3", "b4", "b7", "b8"])
def test_layers_of_bars_leave_room_for_what_moves_beside_them(bar: str) -> None:
    """What lies in the middle, and a bar in another layer, are never touched."""
    low, high = at.span(bar)
    assert min(abs(low), abs(high)) > at.CORE
    assert at.TUBE_RADIUS[bar] <= at.BARREL / 2 + 1e-12
    assert at.TUBE_RADIUS[bar] < at.BARREL_RADIUS
    for other in ("b3", "b4", "b8"):
        if at.LAYER[other] != at.LAYER[bar]:
            beside = at.span(other)
            assert beside[0] > high or beside[1] < low
