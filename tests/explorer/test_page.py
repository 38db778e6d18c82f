"""The page in a browser: pose, masses, undo, tabs that keep their own state."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.state.maps import RangeMode
from paminsa_viz.explorer.state.motion import Timing
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.example_logs import example_log
from paminsa_viz.model import APPENDIX_4, static_imbalance, static_torques
from tests.support.chromium import TIMEOUT, Tab, until

pytestmark = pytest.mark.browser

SLIDERS = ("x  [mm]", "y  [mm]", "θ  [°]", "z  [mm]")
SCALE = np.array([1e3, 1e3, 180 / np.pi, 1e3])


def wait_agreement(tab: Tab) -> None:
    """Wait until the page's inputs and the state agree, and stay so."""

    def agree() -> bool:
        shown = [tab.handle(label).value for label in SLIDERS]
        return np.allclose(shown, tab.state.document.pose * SCALE, atol=1e-3)

    until(agree, "inputs and state agree")
    tab.wait_frames(150)
    until(agree, "inputs and state still agree")


@pytest.mark.parametrize("index", range(4))
def test_pose_slider_moves_its_parts_and_the_torques_are_the_models(tab: Tab, index: int) -> None:
    start = np.array(tab.state.last_reachable.pose)
    carriage = until(lambda: tab.place("/robot/carriage"), "the scene is there")
    tab.press(SLIDERS[index], "ArrowRight", 12)
    until(lambda: tab.state.last_reachable.pose[index] > start[index], "the pose changes")
    wait_agreement(tab)
    tab.wait_platform()
    pose = np.array(tab.state.last_reachable.pose)
    np.testing.assert_array_equal(np.delete(pose, index), np.delete(start, index))
    assert (tab.place("/robot/carriage") == carriage) == (index != 3)
    expected = static_torques(APPENDIX_4, pose)
    until(lambda: np.allclose(tab.torques(), expected, atol=6e-3), "the model's torques")
    assert "Reachable" in tab.text("status")


def test_mass_scales_the_torques_and_the_colors(tab: Tab) -> None:
    def shown() -> float:
        return float(tab.handle("Ends").value[1])

    def wanted() -> float:
        store = MapStore()
        return store.scales(tab.state, store.data(tab.state))[0].high

    tab.dispatch(lambda s: actions.move(s, x=0.06, y=-0.04, theta=0.5))
    tab.wait_pose(0, 0.06)
    until(lambda: abs(tab.torques()[0]) > 0.1, "the readout follows")
    until(lambda: shown() == wanted(), "the color range of this pose")
    before, colors = tab.torques()[:3], shown()
    tab.open_tab("Masses")
    tab.type_number("m_B4 bar 9–4–5 [kg]", 2.5)
    until(lambda: tab.state.document.design.links.b4 == 2.5, "the mass is set")
    until(lambda: tab.session.shows("Robot/Masses"), "the page says what is open")
    factor = static_imbalance(tab.state.document.design) / static_imbalance(APPENDIX_4)
    assert factor > 1.9
    assert not tab.session.shows("Robot/Pose")
    tab.open_tab("Pose")
    until(lambda: tab.session.shows("Robot/Pose"), "the page says what is open")
    until(
        lambda: np.allclose(tab.torques()[:3], factor * before, atol=3e-3), "torques in proportion"
    )
    # Limits of a color range are round numbers, next to the proportional ones.
    until(lambda: shown() == wanted(), "the color range of this design")
    assert 0.8 < shown() / colors / factor < 1.25


def test_unreachable_pose_is_explained_and_left_again(tab: Tab) -> None:
    reachable = tab.state.last_reachable
    tab.type_number(SLIDERS[0], 520)
    tab.page.get_by_text("Unreachable").wait_for()
    assert "leg" in tab.text("status")
    assert "mm" in tab.text("status")
    assert tab.state.last_reachable == reachable
    tab.wait_platform(reachable.pose)
    tab.type_number(SLIDERS[0], 30)
    tab.wait_pose(0, 0.03)
    until(lambda: "Reachable" in tab.text("status"), "reachable again")


def changed(state: State) -> State:
    """Return a state with choices that a reload keeps, and a log, which it does not."""
    low_high = {"range_mode": RangeMode.MANUAL, "low": 1.0, "high": 7.0}
    state = motions.change(state, timing=Timing.GIVEN, duration=2.5)
    return (
        actions.set_layers(state, path=False)
        .updated("map_view", quantity="condition", **low_high)
        .updated("plots", plot="power")
        .updated("identification.settings", cut_off=9.0)
        .updated("identification", log=example_log())
    )


def test_tabs_are_independent_and_find_their_state_after_a_reload(
    tab: Tab, open_tab: Callable[..., Tab]
) -> None:
    second = open_tab(context=tab.page.context)
    opened = ("Masses", "Single map")
    for name in opened:
        tab.open_tab(name)
    tab.dispatch(changed)
    until(lambda: tab.state.identification.log is not None, "the log")
    both = ((tab, 40), (second, -70))
    for each, x in both:
        each.dispatch(lambda s, x=x: actions.move(s, x=1e-3 * x))
        each.wait_pose(0, 1e-3 * x)
        wait_agreement(each)
        each.wait_saved()
    assert tab.handle(SLIDERS[0]).value == 40
    kept = tab.state
    tab.reload()  # the other tab has saved its state after this one
    tab.wait_pose(0, 0.04)
    until(lambda: tab.handle(SLIDERS[0]).value == 40, "the slider shows it")
    assert (tab.state.map_view, tab.state.layers) == (kept.map_view, kept.layers)
    assert (tab.state.plots, tab.state.document.motion) == (kept.plots, kept.document.motion)
    assert tab.state.identification.settings.cut_off == 9.0
    assert tab.state.identification.log is None
    assert second.state.map_view != kept.map_view
    for name in opened:
        found = tab.page.get_by_role("tab", name=name, exact=True)
        until(lambda t=found: t.get_attribute("aria-selected") == "true", f"{name} is open")


def test_keys_undo_redo_and_go_home(tab: Tab) -> None:
    start = tab.state.document.pose[1]
    tab.type_number(SLIDERS[1], 90)
    tab.wait_pose(1, 0.09)
    tab.page.evaluate("document.activeElement.blur()")
    for keys, y in (
        ("Control+z", start), ("Control+Shift+z", 0.09), ("Control+z", start), ("Control+y", 0.09),
        ("h", 0.0),
    ):  # fmt: skip
        tab.page.keyboard.press(keys)
        tab.wait_pose(1, y)


def test_drag_of_many_events_ends_at_its_last_value(tab: Tab) -> None:
    released = threading.Event()
    tab.slider(SLIDERS[2]).focus()
    for step in range(60):
        if step == 40:  # from here on values overtake each other, on a fast machine too
            tab.session.submit(lambda: released.wait(TIMEOUT))
        tab.page.keyboard.press("ArrowRight" if step < 36 else "ArrowLeft")

    def shown() -> float:
        return float(tab.slider(SLIDERS[2]).get_attribute("aria-valuenow") or "nan")

    until(lambda: tab.handle(SLIDERS[2]).value == shown(), "the last value comes to the server")
    released.set()
    wait_agreement(tab)
    assert np.degrees(tab.state.document.pose[2]) == pytest.approx(shown(), abs=1e-6)
    tab.wait_platform()
