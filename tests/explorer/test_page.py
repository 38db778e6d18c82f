"""The page in a real browser, driven as a person would."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.maps import MapStore
from paminsa_viz.model import APPENDIX_4, inverse_kinematics, static_imbalance, static_torques
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

SLIDERS = ("x  [mm]", "y  [mm]", "θ  [°]", "z  [mm]")


def shown_torques(tab: Tab) -> list[float]:
    """Read the torques of M1..M4 off the page."""
    lines = tab.text("actuators").replace("−", "-").splitlines()
    found = [line for line in lines if "N·m" in line or line.rstrip().endswith(" N")]
    return [float(line.split("\t")[-1].split()[0]) for line in found if line[0] in "M"]


def test_the_page_shows_the_model(tab: Tab) -> None:
    state = tab.state
    expected = static_torques(APPENDIX_4, state.standing.pose)
    until(lambda: np.allclose(shown_torques(tab), expected, atol=6e-3), "the model's torques")
    assert "Reachable" in tab.text("status")


@pytest.mark.parametrize(
    ("index", "node", "others"),
    [
        (0, "/robot/platform", "/robot/carriage"),
        (1, "/robot/platform", "/robot/carriage"),
        (2, "/robot/platform", "/robot/carriage"),
        (3, "/robot/carriage", None),
    ],
)
def test_a_pose_slider_moves_the_right_parts(
    tab: Tab, index: int, node: str, others: str | None
) -> None:
    until(lambda: tab.place(node), "the node is there")
    before = tab.place(node)
    still = None if others is None else tab.place(others)
    start = tab.state.standing.pose[index]
    tab.press(SLIDERS[index], "ArrowRight", 12)
    until(lambda: tab.state.standing.pose[index] > start, "the pose moves")
    until(lambda: tab.place(node) != before, f"{node} moves")
    until(lambda: tab.handle(SLIDERS[index]).value != 0 or index == 3, "the slider holds it")
    settled(tab)
    configuration = inverse_kinematics(APPENDIX_4.geometry, tab.state.standing.pose)
    x, y, theta, z = tab.state.standing.pose
    until(lambda: abs(platform_turn(tab) - theta) < 1e-6, "the platform is turned")
    until(
        lambda: np.allclose(tab.place("/robot/platform")[:3], [x, y, z], atol=1e-6),
        "the platform stands where the slider says",
    )
    assert not np.isnan(configuration.actuators).any()
    if others is not None:
        assert tab.place(others) == still


def platform_turn(tab: Tab) -> float:
    """Return theta of the platform in the scene [rad]."""
    quaternion = tab.place("/robot/platform")[3:]
    return float(2 * np.arctan2(quaternion[2], quaternion[3]))


def settled(tab: Tab) -> None:
    """Wait until the page's inputs and the state agree."""

    def agree() -> bool:
        pose = tab.state.document.pose
        scale = (1e3, 1e3, 180 / np.pi, 1e3)
        return all(
            abs(tab.handle(label).value - pose[i] * scale[i]) < 1e-3
            for i, label in enumerate(SLIDERS)
        )

    until(agree, "inputs and state agree")
    tab.wait_frames(150)
    until(agree, "inputs and state still agree")


def test_a_mass_scales_the_torques_and_the_colors(tab: Tab) -> None:
    tab.session.dispatch("test", lambda s: actions.move(s, x=0.06, y=-0.04, theta=0.5))
    tab.wait_pose(0, 0.06)
    until(lambda: abs(shown_torques(tab)[0]) > 0.1, "the readout follows")
    before = shown_torques(tab)
    colors = model_range(tab)
    until(lambda: color_range(tab) == colors, "the color range of this pose")
    tab.open_tab("Design")
    tab.type_number("m_B4 bar 9–4–5", 2.5)
    until(lambda: tab.state.document.design.links.b4 == 2.5, "the mass is set")
    factor = static_imbalance(tab.state.document.design) / static_imbalance(APPENDIX_4)
    assert factor > 1.9
    tab.open_tab("Pose")
    until(lambda: abs(shown_torques(tab)[0] / before[0] - factor) < 0.02, "τ₁ in proportion")
    np.testing.assert_allclose(shown_torques(tab)[:3], factor * np.array(before[:3]), atol=3e-3)
    # limits of a color range are round numbers, next to the proportional ones
    until(lambda: color_range(tab) == model_range(tab), "colors in proportion")
    assert 0.8 < color_range(tab) / colors / factor < 1.25


def model_range(tab: Tab) -> float:
    """Return the upper end of the torque maps' color range, as the model gives it."""
    store = MapStore()
    return store.scales(tab.state, store.data(tab.state))[0].high


def color_range(tab: Tab) -> float:
    """Return the upper end of the torque maps' color range, as the page shows it."""
    return float(tab.handle("from–to").value[1])


def test_an_unreachable_pose_says_why_and_recovers(tab: Tab) -> None:
    standing = tab.state.standing
    tab.type_number(SLIDERS[0], 520)
    tab.page.get_by_text("Unreachable").wait_for()
    text = tab.text("status")
    assert "leg" in text
    assert "mm" in text
    assert tab.state.standing == standing
    until(
        lambda: np.allclose(tab.place("/robot/platform")[:3], np.array(standing.pose)[[0, 1, 3]]),
        "the platform stands where it stood",
    )
    tab.type_number(SLIDERS[0], 30)
    tab.wait_pose(0, 0.03)
    until(lambda: "Reachable" in tab.text("status"), "reachable again")


def test_two_tabs_do_not_disturb_each_other(open_tab: Callable[..., Tab]) -> None:
    first, second = open_tab(), open_tab()
    first.press(SLIDERS[2], "ArrowRight", 20)
    until(lambda: first.state.standing.pose[2] > 0.05, "the first tab moves")
    settled(first)
    assert second.state.standing.pose[2] == 0.0
    assert second.handle(SLIDERS[2]).value == 0.0
    np.testing.assert_allclose(shown_torques(second)[:3], 0.0, atol=1e-3)


def test_a_reload_finds_its_state_and_another_tab_its_own(open_tab: Callable[..., Tab]) -> None:
    first = open_tab()
    second = open_tab(context=first.page.context)
    for tab, x in ((first, 40), (second, -70)):
        tab.type_number(SLIDERS[0], x)
        tab.wait_pose(0, 1e-3 * x)
        settled(tab)
        tab.wait_saved()
    for tab, x in ((first, 40), (second, -70)):
        tab.reload()
        tab.wait_pose(0, 1e-3 * x)
        until(lambda t=tab, x=x: t.handle(SLIDERS[0]).value == x, "the slider shows it")


def test_undo_redo_home_on_keys(tab: Tab) -> None:
    home = tab.state.document.pose
    tab.type_number(SLIDERS[1], 50)
    tab.wait_pose(1, 0.05)
    tab.page.evaluate("document.activeElement.blur()")
    tab.page.keyboard.press("Control+z")
    tab.wait_pose(1, home[1])
    tab.page.keyboard.press("Control+Shift+z")
    tab.wait_pose(1, 0.05)
    tab.page.keyboard.press("h")
    tab.wait_pose(1, home[1])


def test_a_drag_of_500_events_ends_at_its_last_value(tab: Tab) -> None:
    tab.slider(SLIDERS[2]).focus()
    for step in range(500):
        tab.page.keyboard.press("ArrowRight" if step < 300 else "ArrowLeft")

    def shown() -> float:
        return float(tab.slider(SLIDERS[2]).get_attribute("aria-valuenow") or "nan")

    until(lambda: tab.handle(SLIDERS[2]).value == shown(), "the last value comes to the server")
    settled(tab)
    page_value = shown()
    assert tab.handle(SLIDERS[2]).value == page_value
    assert abs(np.degrees(tab.state.document.pose[2]) - page_value) < 1e-6
    until(lambda: abs(platform_turn(tab) - tab.state.standing.pose[2]) < 1e-6, "the robot as well")
