"""The map on the ground: the right way round, at its place, and where a click meets it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.maps import COARSE, FULL, MapStore, half_width
from paminsa_viz.explorer.scene import floor
from paminsa_viz.explorer.scene.floor import FloorMap, floor_image, where_on_floor
from paminsa_viz.explorer.scene.floor_legend import LEGEND_SIZE, legend_image, legend_place
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import RangeMode, initial_state
from paminsa_viz.meshes.frame import plinth_radius
from paminsa_viz.meshes.layout import layout
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.model.reach import workspace_radius
from paminsa_viz.plots import map_data
from paminsa_viz.plots.scale import color_table
from tests.support.desk import Desk, desk_with
from tests.support.samples import with_knee

STORE = MapStore()
ANY = st.floats(-5.0, 5.0)


class TestRays:
    @given(x=ANY, y=ANY, height=ANY, px=ANY, py=ANY, above=st.floats(0.01, 5.0))
    def test_a_ray_to_a_point_meets_the_floor_there(
        self, x: float, y: float, height: float, px: float, py: float, above: float
    ) -> None:
        origin = (px, py, height + above)
        direction = (x - px, y - py, -above)
        found = where_on_floor(origin, direction, height)
        assert found is not None
        np.testing.assert_allclose(found, (x, y), atol=1e-9)

    @pytest.mark.parametrize(
        "direction",
        [(0, 0, 1), (1, 0, 0), (0, 0, 0), (0, 0, math.nan), (math.inf, 0, -1), (1e308, 0, -1e-8)],
    )
    def test_a_ray_that_does_not_meet_it(self, direction: tuple[float, float, float]) -> None:
        assert where_on_floor((0.0, 0.0, 1.0), direction, 0.0) is None


class TestPicture:
    def test_rows_rise_with_y_and_what_is_out_of_reach_is_clear(self) -> None:
        state = actions.move(initial_state(), theta=0.4)
        data = STORE.data(state, COARSE, ("tau_2",))
        (scale,) = STORE.scales(state, data, ("tau_2",))
        pixels = floor_image(data, scale, 0.5)
        reached = data.status == 0
        assert (pixels[~reached, 3] == 0).all()
        assert (pixels[reached, 3] == 128).all()
        # the workspace is not symmetric about y = 0, so a flipped picture would fail above
        assert (reached != reached[::-1]).any()
        inside = reached & (np.abs(data.values[0]) < 0.9 * scale.high)
        row, column = (int(v) for v in np.argwhere(inside)[40])
        fraction = float(scale.position(data.values[0, row, column]))
        expected = color_table(scale)[1 + int(fraction * 256), :3]
        np.testing.assert_array_equal(pixels[row, column, :3], expected)

    @pytest.mark.parametrize(("opacity", "alpha"), [(0.0, 0), (1.0, 255), (7.0, 255), (-1.0, 0)])
    def test_opacity(self, opacity: float, alpha: int) -> None:
        state = initial_state()
        data = STORE.data(state, COARSE, ("f_4",))
        pixels = floor_image(data, STORE.scales(state, data, ("f_4",))[0], opacity)
        assert set(np.unique(pixels[data.status == 0, 3])) == {alpha}


class TestLegend:
    @pytest.mark.parametrize("knee", list(KneeBranch))
    @pytest.mark.parametrize("base", [0.2, 0.35, 0.6])
    def test_it_lies_on_the_plinth_beside_the_map(self, knee: KneeBranch, base: float) -> None:
        geometry = replace(APPENDIX_4.geometry, base_radius=base)
        (x, y), (w, _, _, k) = legend_place(with_knee(geometry, knee))
        turn = 2 * math.atan2(k, w)
        out = np.array([-math.sin(turn), math.cos(turn)])  # the letters' up
        along = np.array([math.cos(turn), math.sin(turn)])
        corners = [
            np.array([x, y]) + i * LEGEND_SIZE[0] / 2 * along + j * LEGEND_SIZE[1] / 2 * out
            for i in (-1, 1)
            for j in (-1, 1)
        ]
        assert max(np.hypot(*corner) for corner in corners) < plinth_radius(
            with_knee(geometry, knee)
        )
        assert out @ [x, y] < 0  # it is read from outside
        if base == 0.35:
            assert math.hypot(x, y) - LEGEND_SIZE[1] / 2 > workspace_radius(geometry)

    def test_it_shows_the_colors_in_order(self) -> None:
        state = initial_state()
        data = STORE.data(state, COARSE, ("tau_1",))
        (scale,) = STORE.scales(state, data, ("tau_1",))
        image = legend_image(scale)
        row = image[image.shape[0] // 2]
        colored = row[row[:, 3] == 255][:, :3].astype(int)
        blue_first = colored[20] - colored[-20]
        assert blue_first[2] > 0 > blue_first[0]
        assert image[0, 0, 3] == 0
        assert image[-1, -1, 3] == 0


def _floor_map(session: Session) -> FloorMap:
    return FloorMap(SceneContext(session.client.scene, session.dispatch))


@pytest.fixture
def desk(server: viser.ViserServer) -> Iterator[Desk]:
    with desk_with(server, _floor_map) as made:
        made.until(lambda: made.panel._map.image.shape[0] == FULL)
        yield made


class TestOnTheGround:
    def test_size_and_place(self, desk: Desk) -> None:
        node = desk.panel._map
        side = 2 * half_width(APPENDIX_4.geometry)
        assert node.scale == (side, side, 1.0)
        ground = layout(APPENDIX_4.geometry).ground
        np.testing.assert_allclose(node.position, (0, 0, ground + floor.ABOVE["map"]))

    def test_it_moves_to_the_ground_of_the_other_knee(self, desk: Desk) -> None:
        desk.dispatch(lambda s: actions.set_knee(s, KneeBranch.UPPER))
        ground = layout(with_knee(APPENDIX_4.geometry, KneeBranch.UPPER)).ground
        for node in (desk.panel._map, desk.panel._legend.bar, desk.panel._ring):
            desk.until(lambda node=node: abs(node.position[2] - ground) < 0.01)

    def test_the_mark_lies_below_the_platform_that_stands(self, desk: Desk) -> None:
        desk.dispatch(lambda s: actions.move(s, x=0.05, y=-0.07))
        desk.until(lambda: tuple(desk.panel._ring.position[:2]) == (0.05, -0.07))
        desk.dispatch(lambda s: actions.move(s, x=3.0))
        assert tuple(desk.panel._ring.position[:2]) == (0.05, -0.07)

    def test_the_legend_says_what_the_colors_mean(self, desk: Desk) -> None:
        view = {"range_mode": RangeMode.MANUAL, "low": -2.5, "high": 7.5}
        desk.dispatch(lambda s: s.updated("map_view", quantity="tau_1", **view))
        words = desk.panel._legend._labels
        desk.until(lambda: (words["low"].text, words["high"].text) == ("−2.5", "7.5"))
        assert words["name"].text == "τ₁  [N·m]"

    def test_a_position_draws_no_new_map(self, desk: Desk) -> None:
        before = desk.panel._map.image
        desk.dispatch(lambda s: actions.move(s, x=0.05))
        desk.until(lambda: desk.panel._ring.position[0] == 0.05)
        assert desk.panel._map.image is before
        desk.dispatch(lambda s: actions.vary(s, {"links.b3": 1.0}))
        desk.until(lambda: desk.panel._map.image is not before)

    def test_layers(self, desk: Desk) -> None:
        parts = desk.panel
        switches = {
            "floor_map": parts._map,
            "workspace": parts._boundary,
            "singularity": parts._circle,
        }
        for name, node in switches.items():
            assert node.visible
            desk.dispatch(lambda s, name=name: actions.set_layers(s, **{name: False}))
            desk.until(lambda node=node: not node.visible)
        assert not parts._legend.visible
        assert not parts._ring.visible

    def test_nothing_is_solved_for_hidden_layers(
        self, desk: Desk, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        off = dict.fromkeys(("floor_map", "workspace", "singularity"), False)
        desk.dispatch(lambda s: actions.set_layers(s, **off))
        desk.until(lambda: not desk.panel._map.visible)
        calls: list[int] = []
        monkeypatch.setattr(map_data, "solve_field", lambda *args, **kwargs: calls.append(1))
        desk.dispatch(lambda s: actions.move(s, theta=1.2))
        desk.until(lambda: desk.state.standing.pose[2] == 1.2)
        desk.dispatch(lambda s: actions.move(s, theta=1.1))
        assert calls == []

    def test_a_click_on_it_moves_the_robot(self, desk: Desk) -> None:
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
        desk.until(lambda: np.allclose(desk.state.standing.pose[:2], (x, y)))
