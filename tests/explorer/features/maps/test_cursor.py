"""The cursor: which place of the platform a message about the pointer means."""

from __future__ import annotations

from typing import Any

import pytest

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.features.maps.cursor import marked_place
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.state import initial_state

ARCH = motions.choose_kind(initial_state(), Kind.ARCH)


def test_place_in_a_map_is_at_the_height_of_the_pose() -> None:
    z = initial_state().document.pose[3]
    assert marked_place(initial_state(), {"x": 120.0, "y": -30}) == (0.12, -0.03, z)


@pytest.mark.parametrize("time", [-1.0, 0.0, 0.37, 1e300])
def test_time_means_where_the_robot_is_then(time: float) -> None:
    trajectory = planned(ARCH.document.motion, ARCH.document.design).trajectory
    assert trajectory is not None
    x, y, _, z = trajectory.at(min(max(time, 0.0), trajectory.t[-1])).pose
    assert marked_place(ARCH, {"time": time}) == pytest.approx((x, y, z))


@pytest.mark.parametrize(
    "data", [None, {}, [], "x", {"x": 1.0}, {"x": "1", "y": 2.0}, {"time": None}, {"time": 1e400}]
)
def test_other_messages_mean_none(data: Any) -> None:
    assert marked_place(ARCH, data) is None
