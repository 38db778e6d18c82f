"""How far the maps reach, and where a click on them may lead."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.maps import MapStore, go_to
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import APPENDIX_4, check_reach
from paminsa_viz.plots.map_data import COARSE, FULL, cell_centers, half_width
from tests.support.map_states import at


class TestExtent:
    @settings(max_examples=60, deadline=None)
    @given(
        theta=st.floats(-math.pi, math.pi),
        z=st.floats(-1.0, 1.0),
        crank=st.floats(0.3, 0.6),
        base=st.floats(0.15, 0.5),
    )
    def test_nothing_within_reach_lies_outside(
        self, theta: float, z: float, crank: float, base: float
    ) -> None:
        geometry = replace(APPENDIX_4.geometry, crank_length=crank, base_radius=base)
        half = half_width(geometry)
        angle = np.linspace(0, 2 * np.pi, 61)
        edge = half * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        outside = np.concatenate([edge * factor for factor in (1.0, 1.01, 1.2, 2.0)])
        poses = np.column_stack([outside, np.tile([theta, z], (len(outside), 1))])
        assert not check_reach(geometry, poses).ok.any()

    def test_it_stays_while_pose_and_masses_change(self) -> None:
        store, state = MapStore(), at()
        extents = {
            store.data(s, cells).extent
            for s in (
                state,
                actions.move(state, theta=-2.0, z=-0.9, x=0.1),
                actions.vary(state, {"links.b3": 2.0}),
            )
            for cells in (COARSE, FULL)
        }
        half = half_width(APPENDIX_4.geometry)
        np.testing.assert_allclose(list(extents), [(-half, half, -half, half)] * len(extents))

    def test_it_is_not_much_larger_than_the_workspace(self) -> None:
        state = actions.move(initial_state(), theta=0.0, z=-0.0275)
        data = MapStore().data(state, FULL)
        radius = np.hypot(*np.meshgrid(data.x, data.y))[data.status == 0].max()
        assert radius > 0.9 * half_width(APPENDIX_4.geometry)

    def test_cells_are_equal_and_symmetric(self) -> None:
        centers = cell_centers(0.3, 7)
        np.testing.assert_allclose(np.diff(centers), 0.6 / 7)
        np.testing.assert_allclose(centers, -centers[::-1], atol=1e-16)


class TestGoTo:
    @given(
        x=st.floats(allow_nan=False, allow_infinity=False),
        y=st.floats(allow_nan=False, allow_infinity=False),
    )
    def test_it_stays_on_the_map(self, x: float, y: float) -> None:
        half = half_width(APPENDIX_4.geometry)
        state = go_to(at(), x, y)
        assert max(map(abs, state.document.pose[:2])) <= half
        assert state.document.pose[2:] == at().document.pose[2:]

    def test_a_reachable_place_is_taken(self) -> None:
        state = go_to(at(), 0.0512349, -0.03)
        assert state.document.pose[:2] == (0.0512, -0.03)
        assert state.standing.pose == state.document.pose
