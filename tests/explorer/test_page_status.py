"""What the page says of poses that cannot be reached, or that no one should trust."""

from __future__ import annotations

import re

import numpy as np
import pytest

from paminsa_viz.explorer import actions
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

TABS = ["Pose", "Design", "Balance", "Motion", "Compare", "View", "File"]
OPACITY = "element => +getComputedStyle(element.closest('.pv-stale') ?? element).opacity"


def gray(tab: Tab, test_id: str) -> bool:
    """Whether a readout is grayed."""
    return tab.page.get_by_test_id(test_id).evaluate(OPACITY) < 1


def test_numbers_of_the_last_reachable_pose_are_gray_and_say_which_it_is(tab: Tab) -> None:
    assert not gray(tab, "actuators")
    tab.dispatch(lambda s: actions.move(actions.move(s, x=0.05, theta=0.2), x=0.4, z=-2.0))
    until(lambda: "Unreachable" in tab.text("status"), "the status")
    place = tab.text("at-pose")
    assert place.startswith("Last reachable pose")
    assert [float(n.replace("−", "-")) for n in re.findall(r"−?[\d.]+", place)] == [
        50.0, 0.0, pytest.approx(np.degrees(0.2), abs=0.05), -552.0,
    ]  # fmt: skip
    for test_id in ("actuators", "summary", "quality"):
        assert gray(tab, test_id)
    tab.dispatch(actions.go_home)
    until(lambda: not gray(tab, "actuators"), "numbers of this pose")
    assert tab.text("at-pose").startswith("Pose (")


def test_design_that_reaches_nothing_is_said_on_every_tab_and_keeps_the_sliders(tab: Tab) -> None:
    before = [tab.slider(f"{name}  [mm]").get_attribute("aria-valuemax") for name in "xyz"]
    tab.dispatch(lambda s: actions.vary(s, {"geometry.guide_stroke": 0.01}))
    for name in TABS:
        tab.open_tab(name)
        until(lambda: tab.page.get_by_text("Unreachable").first.is_visible(), f"a warning: {name}")
        assert gray(tab, "actuators")
    assert "pose and lengths" in tab.text("at-pose")
    tab.open_tab("Pose")
    after = [tab.slider(f"{name}  [mm]").get_attribute("aria-valuemax") for name in "xyz"]
    assert after[:2] == before[:2]
    assert float(after[2]) > float(tab.slider("z  [mm]").get_attribute("aria-valuemin"))


def test_pose_next_to_a_singularity_is_warned_of_and_the_limit_can_be_set(tab: Tab) -> None:
    tab.dispatch(lambda s: actions.move(s, x=0.215, y=0.175, theta=np.pi / 3))
    until(lambda: "Near a singularity" in tab.text("status"), "the status")
    assert "κ = 67.5 > 10" in tab.text("status")
    assert "35 mm from the singular circle" in tab.text("status")
    field = tab.element("κ counts up to")
    field.click()
    field.press_sequentially("70")
    field.press("Enter")
    until(lambda: "Reachable" in tab.text("status"), "the limit is set")
    assert tab.state.condition_limit == 70


def test_pose_beyond_the_circle_says_that_a_singularity_lies_between(tab: Tab) -> None:
    tab.dispatch(
        lambda s: actions.move(s, x=0.3, theta=np.radians(-20)).updated("", condition_limit=1e6)
    )
    until(lambda: "Beyond a singularity" in tab.text("status"), "the status")
    assert "the singular circle lies between this pose and home" in tab.text("status")
    level = tab.page.get_by_test_id("status").get_attribute("class") or ""
    assert "pv-warn" in level
