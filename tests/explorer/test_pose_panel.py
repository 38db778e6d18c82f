"""The sliders of the pose: which poses they offer, and how they show others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.panels.pose_panel import GRAIN, POSE, heights, holding, pose_limits
from paminsa_viz.meshes.layout import layout
from paminsa_viz.model import APPENDIX_4, KneeBranch, check_reach
from paminsa_viz.model.reach import home_pose
from tests.support.desk import Desk
from tests.support.samples import random_design, with_knee

HOME = -552.0


@given(seed=st.integers(0, 10**6), knee=st.sampled_from(KneeBranch))
def test_heights_are_clear_of_the_frame_or_on_the_way_to_home(seed: int, knee: KneeBranch) -> None:
    geometry = random_design(np.random.default_rng(seed)).geometry
    low, high = heights(with_knee(geometry, knee))
    place, home = layout(with_knee(geometry, knee)), 1e3 * home_pose(with_knee(geometry, knee))[3]
    assert low <= home <= high
    assert high - low >= GRAIN
    assert low > min(1e3 * place.platform_low, home) - 2 * GRAIN
    assert high < max(1e3 * place.platform_high, home) + 2 * GRAIN
    clear = 1e3 * place.platform_low, 1e3 * place.platform_high
    if clear[0] + 2 * GRAIN < home < clear[1] - 2 * GRAIN:
        assert clear[0] <= low < high <= clear[1]


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_ends_of_the_sliders_are_in_reach_at_the_center(knee: KneeBranch) -> None:
    limits = pose_limits(with_knee(APPENDIX_4.geometry, knee))
    for z in limits[3]:
        for theta in limits[2]:
            pose = (0.0, 0.0, np.radians(theta), 1e-3 * z)
            assert check_reach(APPENDIX_4.geometry, pose).ok.all()


@given(value=st.floats(-1e9, 1e9))
def test_a_range_grows_to_what_it_has_to_hold_and_no_further(value: float) -> None:
    low, high = holding((-830.0, -230.0), value)
    assert low <= value <= high
    assert low == -830.0 or value - GRAIN <= low < -830.0
    assert high == -230.0 or -230.0 < high <= value + GRAIN
    assert holding((low, high), value) == (low, high)


PANEL = POSE


def ends(desk: Desk) -> tuple[float, float]:
    """Return what the slider of z offers [mm]."""
    slider = desk.handle("pose.z")
    return slider.min, slider.max


def test_a_height_beyond_the_slider_can_be_typed(desk: Desk) -> None:
    slider = desk.handle("pose.z")
    assert ends(desk) == (-830.0, -230.0)
    desk.set(slider, -904.5)
    desk.until(lambda: desk.state.standing.pose[3] == pytest.approx(-0.9045))
    desk.until(lambda: ends(desk) == (-910.0, -230.0))
    # The hand is still on it: nothing slips from under it.
    desk.set(slider, -600.0)
    desk.until(lambda: desk.state.standing.pose[3] == pytest.approx(-0.6))
    assert ends(desk) == (-910.0, -230.0)
    desk.dispatch(actions.go_home)
    desk.until(lambda: (slider.value, ends(desk)) == (HOME, (-830.0, -230.0)))


def test_poses_from_elsewhere_are_shown(desk: Desk) -> None:
    sliders = [desk.handle(f"pose.{name}") for name in ("x", "y", "theta", "z")]
    far = replace(desk.state.document, pose=(2.0, -3.0, 4.0, 5.0))
    desk.dispatch(lambda s: actions.restore(s, far))
    desk.until(lambda: sliders[3].max >= sliders[3].value == 5000.0)
    for slider in sliders:
        assert slider.min <= slider.value <= slider.max
    desk.session.undo()
    desk.until(lambda: (sliders[3].value, ends(desk)) == (HOME, (-830.0, -230.0)))
    assert (sliders[0].min, sliders[0].max) == (-550.0, 550.0)


def test_the_range_follows_knee_and_lengths(desk: Desk) -> None:
    slider = desk.handle("pose.z")
    desk.set(desk.handle("pose.knee"), "upper knee (mirrored)")
    mirrored = heights(with_knee(APPENDIX_4.geometry, KneeBranch.UPPER))
    desk.until(lambda: ends(desk) == mirrored)
    assert mirrored[0] <= slider.value <= mirrored[1]
    desk.dispatch(lambda s: actions.vary(s, {"geometry.crank_length": 0.5}))
    longer = heights(with_knee(desk.design.geometry, KneeBranch.UPPER))
    assert longer != mirrored
    desk.until(lambda: ends(desk) == longer)


def test_a_pose_that_other_lengths_put_out_of_the_range_keeps_its_place(desk: Desk) -> None:
    slider = desk.handle("pose.z")
    desk.dispatch(lambda s: actions.move(s, z=-0.82))
    desk.dispatch(lambda s: actions.vary(s, {"geometry.shaft_length": 0.4}))
    low, high = heights(desk.design.geometry)
    assert low > -820.0
    desk.until(lambda: ends(desk) == (-820.0, high))
    assert slider.value == -820.0
