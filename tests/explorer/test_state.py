"""What stands: the newest pose and geometry that the robot can take."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Health, compute
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import check_reach
from tests.support.documents import COORDINATE, standing_state

FAR = {"x": 5.0}
"""A move that no leg can follow."""


def test_a_pose_out_of_reach_leaves_the_last_good_one_standing() -> None:
    good = actions.move(initial_state(), x=0.05, theta=0.3)
    asked = actions.move(actions.move(good, **FAR), y=0.01)
    assert asked.document.pose[:2] == (5.0, 0.01)
    assert asked.standing is good.standing
    assert compute(asked).health is Health.UNREACHABLE
    assert np.isfinite(compute(asked).torques).all()
    back = actions.move(asked, x=0.02)
    assert back.standing.pose == back.document.pose == (0.02, 0.01, 0.3, good.document.pose[3])


def test_a_geometry_that_can_not_stand_leaves_the_last_good_one_standing() -> None:
    good = initial_state()
    asked = actions.vary(good, {"geometry.guide_stroke": 0.01})
    assert asked.standing is good.standing
    heavier = actions.vary(asked, {"links.b4": 3.0})
    assert heavier.standing is good.standing
    assert compute(heavier).torques[3] > compute(good).torques[3]  # the masses still count


@given(seed=st.integers(0, 10**6), x=COORDINATE, theta=COORDINATE)
def test_what_stands_can_always_stand(seed: int, x: float, theta: float) -> None:
    state = actions.move(actions.move(standing_state(seed), x=x), theta=theta)
    assert check_reach(state.standing.geometry, state.standing.pose).ok.all()
    followed = check_reach(state.document.design.geometry, state.document.pose).ok.all()
    assert (state.standing.pose == state.document.pose) == bool(followed)
