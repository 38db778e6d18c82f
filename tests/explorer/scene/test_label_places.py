"""Labels: on the screen none covers another, and each stays near its place."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.scene import nodes
from paminsa_viz.explorer.scene.actuators import NAME_SIZE, label_places
from paminsa_viz.explorer.scene.cameras import CAMERAS, preset
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.label_places import Projection, apart, hung, lifts
from paminsa_viz.explorer.scene.mechanism import NUMBER_SIZE, skeleton
from paminsa_viz.explorer.scene.nodes import LayerView, label_below
from paminsa_viz.explorer.scene.sizes import LABELS_BELOW
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.model import APPENDIX_4, Geometry, KneeBranch
from paminsa_viz.model.parameters import LEG_JOINTS
from tests.support.raw_page import TIMEOUT
from tests.support.scene import frame_at

PLACES = st.lists(st.tuples(st.floats(-60, 60), st.floats(-60, 60)), min_size=1, max_size=8).map(
    np.array
)


def covering(places: np.ndarray, size: tuple[float, float] = NAME_SIZE) -> list[tuple[int, int]]:
    width, height = size
    return [
        (i, j)
        for i, j in combinations(range(len(places)), 2)
        if abs(places[i, 0] - places[j, 0]) < width - 1e-6
        and abs(places[i, 1] - places[j, 1]) < height - 1e-6
    ]


class LabelScene:
    """A scene that keeps its labels."""

    def __init__(self) -> None:
        self.labels: dict[str, Any] = {}

    def add_label(self, name: str, text: str, **properties: Any) -> Any:
        handle = SimpleNamespace(text=text, remove=lambda: self.labels.pop(name), **properties)
        self.labels[name] = handle
        return handle

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: SimpleNamespace(remove=lambda: None)


@given(places=PLACES)
def test_no_label_covers_another_and_none_moves_without_need(places: np.ndarray) -> None:
    lift = lifts(places, NAME_SIZE)
    assert (lift >= 0).all()
    assert covering(places + np.stack([0 * lift, lift], axis=1)) == []
    if not covering(places):
        assert not lift.any()


def test_what_is_behind_the_camera_is_left_alone() -> None:
    places = np.array([[0.0, 0.0], [np.nan, np.nan], [1.0, 1.0]])
    assert lifts(places, NAME_SIZE)[1] == 0


def cameras_around(geometry: Geometry) -> Iterator[tuple[str, Any]]:
    """Yield the presets, and the front one turned about the axis."""
    for name in CAMERAS:
        yield name, preset(name, geometry, aspect=0.7)
    view = preset("Front", geometry, aspect=0.7)
    for angle in range(0, 360, 15):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ view.position
        yield f"{angle} degrees", replace(view, position=turned)


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("height", [500, 720, 1080])
def test_names_of_the_actuators_are_apart_from_every_side(knee: KneeBranch, height: int) -> None:
    geometry = APPENDIX_4.with_knee(knee).geometry
    for name, view in cameras_around(geometry):
        camera = SimpleNamespace(
            position=view.position, look_at=view.look_at, up_direction=view.up, fov=view.fov,
            image_height=height,
        )  # fmt: skip
        before = np.array(label_places(geometry))
        after = apart(before, camera, NAME_SIZE)
        projection = Projection.of(camera)
        assert projection is not None
        assert covering(projection.seen(after)[0]) == [], name
        moved = projection.seen(after)[0] - projection.seen(before)[0]
        assert np.abs(moved[:, 0]).max() < 1e-6
        assert moved[:, 1].max() < 2 * NAME_SIZE[1] + 1e-6


def test_labels_below_the_platform_stand_clear_of_one_another_from_every_side() -> None:
    """Of all layers; in space too, for what has no camera."""
    assert set(LABELS_BELOW) <= LAYERS.keys()
    nodes = [label_below(name, "", (0.08, 0.05, -0.55), name, 1.0) for name in LABELS_BELOW]
    places = np.array([node.live["position"] for node in nodes])
    down = np.array([node.hanging for node in nodes])
    assert np.diff(places[:, 2]).max() <= -0.055  # a letter is some 0.05 m in a robot of this size
    for name, view in cameras_around(APPENDIX_4.geometry):
        camera = SimpleNamespace(
            position=view.position, look_at=view.look_at, up_direction=view.up, fov=view.fov,
            image_height=720,
        )  # fmt: skip
        projection = Projection.of(camera)
        assert projection is not None
        seen = projection.seen(hung(places, down, camera))[0]
        assert np.diff(seen[:, 1]).max() < -0.7 * NAME_SIZE[1], name
        assert np.ptp(seen[:, 0]) < 1e-6
    assert hung(places, down, SimpleNamespace(**(vars(camera) | {"image_height": 0}))) is places


def test_projection_agrees_with_the_picture() -> None:
    camera = SimpleNamespace(
        position=(0, -4, 0), look_at=(0, 0, 0), up_direction=(0, 0, 1), fov=np.pi / 2,
        image_height=800,
    )  # fmt: skip
    projection = Projection.of(camera)
    assert projection is not None
    seen, depth = projection.seen(np.array([[4.0, 0, 0], [0, 0, 4.0], [0, -5.0, 0]]))
    np.testing.assert_allclose(seen[:2], [[400, 0], [0, 400]], atol=1e-9)  # at the edge
    assert np.isnan(seen[2]).all()
    np.testing.assert_allclose(depth, [4, 4, -1])
    camera.image_height = 0
    assert Projection.of(camera) is None


@pytest.mark.parametrize("ratio", [1, 2])
def test_numbers_of_joints_are_apart_while_the_camera_moves(ratio: int) -> None:
    moved: list[Any] = []
    camera = SimpleNamespace(image_height=720 * ratio, on_update=moved.append)
    size = (ratio * NUMBER_SIZE[0], ratio * NUMBER_SIZE[1])

    def look(name: str) -> None:
        view = preset(name, APPENDIX_4.geometry, aspect=0.7)
        vars(camera).update(
            position=view.position, look_at=view.look_at, up_direction=view.up, fov=view.fov
        )
        for call in moved:
            call(None)

    scene = LabelScene()
    context = SceneContext(cast(Any, scene), camera=camera, pixel_ratio=lambda: ratio)
    view = LayerView(LAYERS["skeleton"], skeleton, context)
    look("3D")
    for pose in ((0.0, 0.0, 0.0, -0.55), (0.1, 0.0, 0.5, -0.6)):
        frame = frame_at(pose, layers=["skeleton"])
        view.draw(frame, False)
        for name in CAMERAS:
            look(name)
            projection = Projection.of(camera)
            assert projection is not None
            joints = np.concatenate([frame.configuration.points[joint] for joint in LEG_JOINTS])
            assert covering(projection.seen(joints)[0], size) != [], name
            places = np.array([label.position for label in scene.labels.values()])
            assert covering(projection.seen(places)[0], size) == [], name
    assert len(moved) == 1
    view.draw(frame_at(layers=[]), False)
    look("3D")
    assert scene.labels == {}


def test_an_arrangement_that_a_newer_frame_overtakes_is_not_written_over_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    moved: list[Any] = []
    view = preset("3D", APPENDIX_4.geometry, aspect=0.7)
    camera = SimpleNamespace(
        image_height=720, on_update=moved.append, position=view.position, look_at=view.look_at,
        up_direction=view.up, fov=view.fov,
    )  # fmt: skip
    scene = LabelScene()
    context = SceneContext(cast(Any, scene), camera=camera)
    layer = LayerView(LAYERS["skeleton"], skeleton, context)
    layer.draw(frame_at((0.0, 0.0, 0.0, -0.55), layers=["skeleton"]), False)
    arranging, go_on, real = threading.Event(), threading.Event(), nodes.apart

    def slow(*arguments: Any) -> Any:
        monkeypatch.setattr(nodes, "apart", real)
        arranging.set()
        assert go_on.wait(TIMEOUT)
        return real(*arguments)

    monkeypatch.setattr(nodes, "apart", slow)
    frame = frame_at((0.1, 0.0, 0.5, -0.6), layers=["skeleton"])
    older = threading.Thread(target=moved[0], args=(None,))  # on a thread of viser's
    older.start()
    assert arranging.wait(TIMEOUT)
    newer = threading.Thread(target=layer.draw, args=(frame, False))
    newer.start()
    newer.join(0.05)  # it has to wait, or is done by now
    go_on.set()
    for thread in (older, newer):
        thread.join(TIMEOUT)
    found = {name: np.array(label.position) for name, label in scene.labels.items()}
    layer.draw(frame, False)
    for name, label in scene.labels.items():
        np.testing.assert_allclose(found[name], label.position, err_msg=name)
