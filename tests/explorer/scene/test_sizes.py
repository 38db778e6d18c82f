"""Arrows, handles and marks are as large as the robot asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.features.maps.floor import RING, FloorMap
from paminsa_viz.explorer.scene.actuators import arrow_scales, torques_meaning
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.sizes import LEAST, symbol_size
from paminsa_viz.model import APPENDIX_4, LoadCase
from paminsa_viz.model.design import Design
from tests.support.samples import enlarged, resized
from tests.support.scene import POSE, Scene, frame_at

LOADED = replace(APPENDIX_4, load=LoadCase(30.0, 0.0, -40.0, moment_z=5.0))


def size_of(name: str) -> Callable[[Any], float]:
    """Return what measures a property of a node that holds places: their largest extent [m]."""
    return lambda node: float(np.ptp(np.asarray(getattr(node, name)).reshape(-1, 3), axis=0).max())


def longest(node: Any) -> float:
    """Return the length of the longest of a node's arrows [m]."""
    return float(np.linalg.norm(np.diff(node.points, axis=1), axis=-1).max())


def test_torques_of_a_tiny_robot_are_drawn_as_those_of_the_prototype() -> None:
    """Their scale followed the weight down to 10⁻⁶ N·m, beside which they were no arcs."""
    prototype, tiny = np.array([arrow_scales(enlarged(APPENDIX_4, share)) for share in (1.0, 0.01)])
    np.testing.assert_allclose(tiny / prototype, [1e-8, 1e-6])
    assert "F₄ 2.6 mm" in str(torques_meaning(frame_at(POSE, enlarged(APPENDIX_4, 0.01))))


EXACT: dict[str, tuple[str, Callable[[Any], float]]] = {
    "/efforts/m4": ("torques", size_of("vertices")),
    "/load/moment": ("load", size_of("vertices")),
    "/masses/gravity": ("gravity", lambda node: node.shaft_radius),
    "/gizmo": ("gizmo", lambda node: node.scale),
}
"""Layers and what is measured of them, by the names of nodes."""

ROUNDED: dict[str, tuple[str, Callable[[Any], float]]] = {
    "/load/force": ("load", longest),
    "/forces/solid": ("wrench_solid", size_of("vertices")),
    "/joint_forces/arrows": ("joint_forces", longest),
    "/drive_errors/rms": ("drive_errors", size_of("points")),
}
"""Those that are drawn to a scale that is a round number."""


@pytest.mark.parametrize("name", EXACT | ROUNDED)
def test_symbols_grow_with_the_robot(scene: Scene, name: str) -> None:
    layer, measure = (EXACT | ROUNDED)[name]

    def size(times: float) -> float:
        x, y, theta, z = POSE
        pose = (times * x, times * y, theta, times * z)
        scene.draw(pose, resized(LOADED, times), [layer])
        return measure(scene.nodes[name])

    before, large = size(1.0), size(8.0)
    play = 2.6 if name in ROUNDED else 1.001
    assert 8.0 / play < large / before < 8.0 * play
    assert size(1.0) == pytest.approx(before)  # what is drawn already follows


def test_mark_on_the_ground_grows_with_the_robot(server: viser.ViserServer) -> None:
    view = FloorMap(SceneContext(server.scene))
    sizes, heights = [], []
    for times in (1.0, 3.0):
        view.draw(frame_at(design=resized(APPENDIX_4, times), layers=[]), False)
        nodes: Any = server.scene._handle_from_node_name
        back, mark = (nodes[f"/floor/pose/{name}"] for name in ("back", "mark"))
        sizes.append(size_of("vertices")(back))
        heights.append(np.ptp([*back.vertices[:, 2], *mark.vertices[:, 2]]))
    assert sizes == pytest.approx([2 * RING, 6 * RING], rel=0.005)  # a polygon
    assert heights[1] == pytest.approx(3 * heights[0], rel=1e-5)  # or its parts are beside another


def test_symbols_are_of_a_stated_size_and_none_is_tiny() -> None:
    def meaning(design: Design) -> str:
        row = torques_meaning(frame_at(design=design))
        assert row is not None
        return row[1]

    assert symbol_size(APPENDIX_4.geometry) == 1.0
    assert symbol_size(resized(APPENDIX_4, 3.0).geometry) == 3.0
    assert symbol_size(resized(APPENDIX_4, 0.1).geometry) == LEAST
    assert "F₄ 260 mm = " in meaning(APPENDIX_4)
    assert "F₄ 780 mm = " in meaning(resized(APPENDIX_4, 3.0))


LENGTHS = (
    "position", "points", "vertices", "batched_positions", "batched_scales", "radius",
    "shaft_radius", "head_radius",
)  # fmt: skip
"""Properties of nodes that are lengths."""

SHAPES = ("/skeleton/dots", "/masses/centers", "/joint_forces/bars")
"""Nodes of one shape in the sizes of `batched_scales`."""

SCALED = ("/gizmo", "/stage/ground/below", "/robot/platform/payload")
"""Nodes in a size of their own."""

SAMPLED = ("/path/", "/joint_limits/theta", "/floor/")
"""Starts of the names of those that follow what is found at samples: the size alone is compared."""

WITH_BODIES = (
    "mesh", "skeleton", "torques", "labels", "path", "points", "joint_limits", "gizmo",
    "floor_map", "workspace", "mass_centers", "utilization",
)  # fmt: skip
"""Layers whose symbols stand at bodies."""


def test_a_robot_enlarged_with_its_bodies_looks_the_same(scene: Scene) -> None:
    def lengths(design: Design, times: float) -> dict[tuple[str, str], Any]:
        x, y, theta, z = POSE
        scene.draw((times * x, times * y, theta, times * z), design, WITH_BODIES)
        found = {(name, "scale"): np.array(scene.nodes[name].scale) for name in SCALED}
        for name, node in scene.nodes.items():
            for what in LENGTHS:
                value = getattr(node, what, None)
                if value is None or (name in SHAPES and what == "vertices") or "/stage/" in name:
                    continue
                value = np.array(value, float)
                if name.startswith(SAMPLED) and what in ("points", "vertices"):
                    value = np.ptp(value.reshape(-1, 3), axis=0).max()
                found[name, what] = value
        return found

    design = APPENDIX_4.vary({"payload.mass": 1.0})
    whole, small = lengths(design, 1.0), lengths(enlarged(design, 0.1), 0.1)
    assert len(whole) > 100
    for key, value in whole.items():
        play = 0.1 if key[0].startswith(SAMPLED) and key[1] != "position" else 1e-3
        np.testing.assert_allclose(small[key], 0.1 * value, rtol=play, atol=1e-5, err_msg=str(key))
