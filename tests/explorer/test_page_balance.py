"""Balancing in a browser: one click, infeasible bounds, the front."""

from __future__ import annotations

import re

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.state.balance import CounterweightSlot
from paminsa_viz.model import APPENDIX_4, static_imbalance
from tests.support.chromium import COMPUTING, Tab, until

pytestmark = pytest.mark.browser


@pytest.fixture
def balance(tab: Tab) -> Tab:
    """The tab with the balance open and the robot at a pose with static torques."""
    tab.dispatch(lambda s: actions.move(s, x=0.1, y=-0.05, theta=0.3))
    tab.wait_pose(0, 0.1)
    tab.open_tab("Balance")
    return tab


def test_one_click_balances_and_undo_takes_it_back(balance: Tab) -> None:
    balance.click("Balance as in the paper")
    status = balance.page.get_by_test_id("balance-status")
    status.get_by_text("Statically balanced", exact=True).wait_for()
    assert static_imbalance(balance.state.document.design) == pytest.approx(0, abs=1e-12)
    assert balance.state.document.reference == APPENDIX_4
    text = until(lambda: balance.text("balance-result"), "the tables")
    assert re.search(r"m7 \[kg\]\s+0.28\s+3.063\s+\+994 %", text)
    assert "no added mass is below 8.349 kg" in text
    balance.open_tab("Pose")
    until(lambda: not balance.torques()[:3].any(), "no static torques")
    balance.session.undo()
    until(lambda: np.abs(balance.torques()[:3]).max() > 0.1, "static torques again")
    assert balance.state.document.design == APPENDIX_4
    assert balance.state.document.reference is None


def test_infeasible_bounds_are_shown_and_relaxed_ones_solved(balance: Tab) -> None:
    def limit(b8: float) -> None:
        slots = {"slot_b3": CounterweightSlot(0.1, 0.0), "slot_b8": CounterweightSlot(0.1, b8)}
        balance.dispatch(lambda s: balancing.change_settings(s, **slots))

    limit(0.5)
    balance.unfold("Optimization settings")
    balance.click("Optimize")
    until(lambda: balance.state.balance.outcome is not None, "the task is done", COMPUTING)
    status = balance.page.get_by_test_id("balance-status")
    status.get_by_text("The bounds do not allow it").wait_for()
    assert "Raise the upper bound of weight on B8 past 8 from 0.5 kg to 3.8962 kg" in balance.text(
        "balance-status"
    )
    assert balance.state.document.design == APPENDIX_4
    limit(5.0)
    balance.click("Optimize")
    status.get_by_text("Statically balanced", exact=True).wait_for()
    node = "/robot/leg2/slider/b8/weight1"
    until(lambda: balance.place(node), "the counterweight is in the scene")
    # Written once the page is idle, with what is above it: until then the button moves.
    balance.page.get_by_test_id("weights-room").get_by_text("Distance past").wait_for()
    balance.click("all")
    until(lambda: balance.state.document.design == APPENDIX_4, "the counterweight is removed")
    until(lambda: balance.place(node) is None, "it is removed from the scene")


def test_click_on_the_front_takes_that_design(balance: Tab) -> None:
    page = balance.page
    page.get_by_text("Pareto front: dynamic vs. static torque").click()
    balance.click("Compute the front")
    until(lambda: balance.state.balance.front is not None, "the front")
    designs = balance.state.balance.points
    points = page.locator(".js-plotly-plot .scatterlayer .trace").first.locator("path.point")
    until(lambda: points.count() == len(designs), "its points are drawn")
    points.nth(3).scroll_into_view_if_needed()
    balance.click_in(points.nth(3))
    until(lambda: balance.state.document.design == designs[3], "the design of that point")
    assert balance.state.document.reference == APPENDIX_4
    until(lambda: balance.handle("Point").value == 4, "the slider follows")
    balance.press("Point", "End")
    until(lambda: balance.state.document.design == designs[-1], "the end of the front")


def test_price_of_a_balance_is_shown_for_all_four_actuators(balance: Tab) -> None:
    balance.click("Balance as in the paper")
    status = balance.page.get_by_test_id("balance-status")
    status.get_by_text("The price: M4: largest at rest +").wait_for()
    text = until(lambda: balance.text("balance-result"), "the tables")
    for group in ("largest at rest", "largest in motion", "RMS in motion", "largest power"):
        assert re.search(rf"{group}\s+(M[1-4] \[[^\]]+\].*\s+){{4}}", text)
    assert re.search(r"M4 \[N\]\s+\d+\.\d\s+308\.6\s+\+\d+\.\d %", text)
    assert "κ ≤ 10" in text


def test_maps_fade_with_the_imbalance_next_to_a_reference(balance: Tab) -> None:
    def shown() -> tuple[float, float]:
        return tuple(balance.handle("Ends").value)

    balance.open_tab("Torque maps")  # is up to date as long as it can be seen
    store = MapStore()
    (scale, *_) = store.scales(balance.state, store.data(balance.state))
    before = (scale.low, scale.high)
    until(lambda: shown() == before, "the range of the design as it is")
    balance.click("Balance as in the paper")
    until(lambda: balance.state.document.reference is not None, "the reference is pinned")
    balance.wait_frames(1500)
    assert shown() == before
