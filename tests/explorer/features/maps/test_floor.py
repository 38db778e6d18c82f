"""The map on the floor: orientation, place, legend, and where a click meets it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.maps import COARSE, FULL, MapStore
from paminsa_viz.explorer.features.maps import floor
from paminsa_viz.explorer.features.maps.floor import FloorMap, floor_image, where_on_floor
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.plots import map_values
from paminsa_viz.plots.map_values import MapData, frame_half
from paminsa_viz.plots.scale import Scale, color_table
from tests.support.desk import Desk, desk_with
from tests.support.scene import Scene

STORE = MapStore()
ANY = st.floats(-5.0, 5.0)
LAYERS = ("floor_map", "workspace", "singularity")


@given(x=ANY, y=ANY, height=ANY, px=ANY, py=ANY, above=st.floats(0.01, 5.0))
def test_ray_to_a_point_of_the_floor_meets_it_there(
    x: float, y: float, height: float, px: float, py: float, above: float
) -> None:
    found = where_on_floor((px, py, height + above), (x - px, y - py, -above), height)
    assert found is not None
    np.testing.assert_allclose(found, (x, y), atol=1e-9)


@pytest.mark.parametrize(
    "direction",
    [(0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 0, math.nan), (math.inf, 0, -1), (1e308, 0, -1e-8)],
    ids=str,
)
def test_ray_that_does_not_meet_the_floor_is_nowhere(
    direction: tuple[float, float, float],
) -> None:
    assert where_on_floor((0.0, 0.0, 1.0), direction, 0.0) is None


def map_of(quantity: str) -> tuple[MapData, Scale]:
    """Return a map that is not symmetric about y = 0, and its scale."""
    state = actions.move(initial_state(), theta=0.4)
    data = STORE.data(state, COARSE, (quantity,))
    (scale,) = STORE.scales(state, data, (quantity,))
    return data, scale


def test_rows_of_the_image_rise_with_y() -> None:
    data, scale = map_of("tau_2")
    pixels = floor_image(data, scale, 0.5)
    reached = data.status == 0
    assert (reached != reached[::-1]).any()
    np.testing.assert_array_equal(pixels[..., 3], np.where(reached, 128, 0))
    inside = reached & (np.abs(data.values[0]) < 0.9 * scale.high)
    row, column = (int(v) for v in np.argwhere(inside)[40])
    fraction = float(scale.position(data.values[0, row, column]))
    expected = color_table(scale)[1 + int(fraction * 256), :3]
    np.testing.assert_array_equal(pixels[row, column, :3], expected)


@pytest.mark.parametrize(("opacity", "alpha"), [(0.0, 0), (1.0, 255), (7.0, 255), (-1.0, 0)])
def test_opacity_is_limited(opacity: float, alpha: int) -> None:
    data, scale = map_of("f_4")
    assert set(np.unique(floor_image(data, scale, opacity)[data.status == 0, 3])) == {alpha}


@pytest.fixture
def desk(server: viser.ViserServer) -> Iterator[Desk]:
    """The floor map, once it is drawn finely."""
    with desk_with(server, lambda s: FloorMap(SceneContext(s.client.scene, s.dispatch))) as made:
        made.until(lambda: made.panel._map.image.shape[0] == FULL)
        yield made


def test_map_covers_its_extent_on_the_ground_of_either_knee(desk: Desk) -> None:
    node = desk.panel._map
    side = 2 * frame_half(APPENDIX_4.geometry, *desk.state.document.pose[2:])
    assert node.scale == pytest.approx((side, side, 1.0))
    ground = layout(APPENDIX_4.geometry).ground
    np.testing.assert_allclose(node.position, (0, 0, ground + floor.ABOVE["map"]))
    desk.dispatch(lambda s: actions.set_knee(s, KneeBranch.UPPER))
    ground = layout(desk.design.geometry).ground
    for node in (desk.panel._map, desk.panel._ring):
        desk.until(lambda node=node: abs(node.position[2] - ground) < 0.01)


def test_mark_is_below_the_platform_and_a_position_draws_no_new_map(desk: Desk) -> None:
    before, ring = desk.panel._map.image, desk.panel._ring
    desk.dispatch(lambda s: actions.move(s, x=0.05, y=-0.07))
    desk.until(lambda: tuple(ring.position[:2]) == (0.05, -0.07))
    desk.dispatch(lambda s: actions.move(s, x=3.0))
    assert tuple(ring.position[:2]) == (0.05, -0.07)
    assert desk.panel._map.image is before
    desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0}))
    desk.until(lambda: desk.panel._map.image is not before)


def test_a_picture_is_of_its_own_map_however_soon_after_another(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("PERIOD", "PERIOD_PLAIN"):
        monkeypatch.setattr(floor, name, 1e6)
    first, second = (compute(actions.move(desk.state, theta=theta)) for theta in (0.2, 0.3))
    assert desk.panel.draw_at_once(first)
    before = desk.panel._map.image
    desk.panel.draw(second, True)
    assert desk.panel._map.image is before
    assert desk.panel.draw_at_once(second)
    assert desk.panel._map.image is not before
    assert not desk.panel.draw_at_once(second)


def test_pictures_keep_their_colors_while_the_page_finds_others(desk: Desk) -> None:
    first, second = (compute(actions.move(desk.state, theta=theta)) for theta in (0.2, 0.3))
    desk.panel.draw_at_once(first)
    scale = desk.panel._key[3]
    heavy = actions.vary(desk.state, {"links.b3": 20.0})
    store, quantities = desk.panel._store, (heavy.map_view.quantity,)
    (other,) = store.scales(heavy, store.data(heavy, COARSE, quantities), quantities)
    assert desk.panel.draw_at_once(second)
    assert desk.panel._key[3] == scale != other


@pytest.mark.slow
def test_hidden_layers_are_not_drawn_and_nothing_is_solved_for_them(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene(desk.session.client.scene, [])
    nodes = ("/floor/map", "/floor/workspace", "/floor/singularity")
    for name, node in zip(LAYERS, nodes, strict=True):
        assert node in scene.shown
        desk.dispatch(lambda s, name=name: actions.set_layers(s, **{name: False}))
        desk.until(lambda node=node: node not in scene.shown)
    assert not desk.panel._ring.visible
    calls: list[int] = []
    monkeypatch.setattr(map_values, "solve_field", lambda *args, **kwargs: calls.append(1))
    for theta in (1.2, 1.1):
        desk.dispatch(lambda s, theta=theta: actions.move(s, theta=theta))
        desk.until(lambda theta=theta: desk.state.last_reachable.pose[2] == theta)
    assert calls == []


def test_click_moves_the_robot_there(desk: Desk) -> None:
    height = float(desk.panel._map.position[2])
    x, y = 0.06, -0.04
    desk.page.send(
        {
            "type": "SceneNodeClickMessage",
            "name": "/floor/map",
            "instance_index": None,
            "ray_origin": [1.0, -2.0, height + 3.0],
            "ray_direction": [x - 1.0, y + 2.0, -3.0],
            "screen_pos": [0.5, 0.5],
            "modifier": None,
            "owner": str(desk.session.client.client_id),
        }
    )
    desk.until(lambda: np.allclose(desk.state.last_reachable.pose[:2], (x, y)))
