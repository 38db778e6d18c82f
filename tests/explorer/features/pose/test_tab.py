"""The sliders of the pose: their ranges, and how they show poses beyond them."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.pose.tab import (
    GRAIN,
    POSE,
    actuators_html,
    heights,
    holding,
    load_html,
    pose_limits,
    pose_line_html,
    quality_html,
    status_html,
    status_line_html,
    summary_html,
    torques_html,
)
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.entries import given as given_in
from paminsa_viz.explorer.kit.inputs import Slider
from paminsa_viz.explorer.kit.robot_texts import gauge_html, line_texts
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.page import opening_state
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model import APPENDIX_4, KneeBranch, check_reach
from paminsa_viz.model.reach import home_pose, workspace_radius
from tests.support.desk import Desk
from tests.support.raw_page import RawPage
from tests.support.samples import enlarged, prototype_times, random_design, with_knee

PANEL = POSE
HOME = -552.0
ENDS = (-830.0, -230.0)


@given(seed=st.integers(0, 10**6), knee=st.sampled_from(KneeBranch))
def test_heights_are_clear_of_the_frame_or_next_to_home(seed: int, knee: KneeBranch) -> None:
    geometry = with_knee(random_design(np.random.default_rng(seed)).geometry, knee)
    low, high = heights(geometry)
    place, home = layout(geometry), 1e3 * home_pose(geometry)[3]
    clear = 1e3 * place.platform_low, 1e3 * place.platform_high
    assert low <= home <= high
    assert high - low >= GRAIN
    assert low > min(clear[0], home) - 2 * GRAIN
    assert high < max(clear[1], home) + 2 * GRAIN
    if clear[0] + 2 * GRAIN < home < clear[1] - 2 * GRAIN:
        assert clear[0] <= low < high <= clear[1]


@pytest.mark.parametrize("knee", KneeBranch)
def test_ends_of_the_sliders_are_within_reach_at_the_center(knee: KneeBranch) -> None:
    geometry = with_knee(APPENDIX_4.geometry, knee)
    _, _, turns, lifts = pose_limits(geometry)
    poses = [(0.0, 0.0, np.radians(theta), 1e-3 * z) for theta in turns for z in lifts]
    assert check_reach(geometry, poses).ok.all()


@given(value=st.floats(-1e9, 1e9, allow_subnormal=False))
def test_range_grows_to_the_value_and_no_further(value: float) -> None:
    low, high = holding(ENDS, value)
    assert low <= value <= high
    assert low == ENDS[0] or value - GRAIN <= low < ENDS[0]
    assert high == ENDS[1] or ENDS[1] < high <= value + GRAIN
    assert holding((low, high), value) == (low, high)


def shown(desk: Desk, name: str = "z") -> tuple[float, float, float]:
    """Return value and ends of a slider, in mm."""
    slider = desk.handle(f"pose.{name}")
    return slider.value, slider.min, slider.max


def test_sliders_of_a_small_robot_are_as_fine_as_it_is() -> None:
    """They went to ±50 mm in steps of a millimeter for a workspace of ±13 mm."""
    small = enlarged(APPENDIX_4, 0.04)
    (_, x), _, _, (low, high) = pose_limits(small.geometry)
    assert 0.9e3 * workspace_radius(small.geometry) < x < 1.5e3 * workspace_radius(small.geometry)
    place = layout(small.geometry)
    assert [low, high] == pytest.approx(
        [1e3 * place.platform_low, 1e3 * place.platform_high], abs=1
    )
    state = initial_state(small)
    steps = [given_in(entry.step, state) for entry in POSE if isinstance(entry, Slider)]
    assert steps == [0.1, 0.1, 0.5, 0.1]
    margin = 1e3 * compute(state).configuration.reach.margins.min()
    assert f"margin {margin:.1f} mm to the nearest limit" in status_line_html(compute(state))


def test_margins_are_amber_beside_the_robots_own_lengths() -> None:
    texts = []
    for factor in (1.0, 0.1):
        text = quality_html(compute(initial_state(prototype_times(factor))))
        texts.append(re.findall('"pv-(ok|warn|bad)"', text))
    assert texts == [["ok"] * 12] * 2


def test_pose_of_a_design_that_reaches_nothing_is_not_called_reachable() -> None:
    nothing = APPENDIX_4.vary({"geometry.guide_stroke": 0.001})
    assert ">Pose (" in pose_line_html(compute(opening_state(nothing)))
    beyond = compute(actions.move(initial_state(), x=0.9))
    assert ">Last reachable pose (" in pose_line_html(beyond)


def test_places_have_as_many_digits_in_a_robot_of_a_few_millimeters() -> None:
    for factor, pose, margin, lift in (
        (0.01, "(0.500 mm, 0.300 mm, 20.1°, −5.500 mm)", 3, 3),
        (1.0, "(50.0 mm, 30.0 mm, 20.1°, −550.0 mm)", 1, 1),
        (10.0, "(500.0 mm, 300.0 mm, 20.1°, −5500.0 mm)", 1, 1),
    ):
        at = (0.05 * factor, 0.03 * factor, 0.35, -0.55 * factor)
        frame = compute(actions.move_to(initial_state(enlarged(APPENDIX_4, factor)), at))
        assert pose in pose_line_html(frame)
        margins = re.findall(r"<td class=\"pv-ok\">([\d.]+)<i", quality_html(frame))
        assert {len(one.partition(".")[2]) for one in margins} == {margin}
        found = re.search(r"Z = [\d.]+?\.(\d+) mm", actuators_html(frame))
        assert found is not None
        assert len(found[1]) == lift


LONG_BARS = {"geometry.crank_length": 1.3, "geometry.coupler_length": 1.6}


def numbers_in(text: str) -> list[str]:
    """Return the numbers in bold of a text, without their signs."""
    return re.findall("<b>.*?([0-9.]+)</", text)


def test_torques_and_forces_have_as_many_digits_in_a_robot_of_any_size() -> None:
    """With masses and inertias in proportion: torques are as the lengths to the fourth."""
    for factor, torques, force, balance in (
        (0.1, ["0.0000923", "0.0000898", "0.0000966"], "0.23875", "0.009100"),
        (1.0, ["0.923", "0.898", "0.966"], "238.75", "9.100"),
        (10.0, ["9235", "8975", "9657"], "238752", "9100.4"),
    ):
        at = (0.05 * factor, 0.03 * factor, 0.35, -0.55 * factor)
        frame = compute(actions.move_to(initial_state(prototype_times(factor)), at))
        for text in (load_html, actuators_html, torques_html):
            assert numbers_in(text(frame)) == [*torques, force]
        for text in (gauge_html, summary_html, quality_html):
            assert f">{balance}<" in text(frame)


def test_changes_from_the_reference_have_their_sign() -> None:
    pinned = actions.pin_reference(actions.move(initial_state(), x=0.08, y=0.05, theta=1.0))
    heavier = actions.vary(pinned, {"links.b4": 1.0})
    for text, change in ((actuators_html, r"<td>(.)[0-9.]+</td>\n</tr>"), (torques_html, "Δ (.)")):
        assert re.findall(change, text(compute(heavier))) == ["+"] * 4


def test_torques_of_a_robot_whose_bars_alone_are_long_keep_their_digits() -> None:
    """Its masses are the prototype's: torques of some N m had one decimal."""
    frame = compute(opening_state(APPENDIX_4.vary(LONG_BARS)))
    assert all(len(text.partition(".")[2]) == 3 for text in numbers_in(torques_html(frame))[:3])


def test_large_torques_make_their_line_no_longer() -> None:
    """Next to a singularity, where they grow without bound."""
    for torques, texts in (
        ((9.9994, -10.006, 0.0, 999.994), ["9.999", "−10.01", "0.000", "999.99"]),
        ((-367.833, 4321.5, 98765.4, -1234.56), ["−367.8", "4322", "98765", "−1234.6"]),
    ):
        assert line_texts(APPENDIX_4, np.array(torques)) == texts
    tiny = line_texts(prototype_times(0.1), np.array((9.23e-5, -0.012345, 0.1, 0.5)))
    assert tiny == ["0.0000923", "−0.01235", "0.1000", "0.50000"]
    assert line_texts(APPENDIX_4, np.array([np.nan, np.inf, 0.0, 0.0]))[3] == "0.00"


def test_page_opens_where_gravity_loads_the_actuators_of_a_robot_of_any_size() -> None:
    for factor in (0.01, 0.1, 1.0, 10.0):
        x, y, theta, _ = opening_state(prototype_times(factor)).document.pose
        assert (x, y) == pytest.approx((0.08 * factor, 0.05 * factor))
        assert theta == pytest.approx(np.pi / 3)
    long = opening_state(APPENDIX_4.vary(LONG_BARS))
    assert np.abs(compute(long).torques[:3]).min() > 0.1


def test_height_beyond_the_slider_can_be_typed(desk: Desk) -> None:
    desk.until(lambda: shown(desk) == (HOME, *ENDS))
    desk.set("pose.z", -904.5)
    desk.until(lambda: desk.state.last_reachable.pose[3] == pytest.approx(-0.9045))
    desk.until(lambda: shown(desk)[1:] == (-910.0, ENDS[1]))
    desk.set("pose.z", -600.0)  # still dragged: the range stays as it is
    desk.until(lambda: desk.state.last_reachable.pose[3] == pytest.approx(-0.6))
    assert shown(desk)[1:] == (-910.0, ENDS[1])
    desk.dispatch(actions.go_home)
    desk.until(lambda: shown(desk) == (HOME, *ENDS))


def test_poses_from_elsewhere_are_shown(desk: Desk) -> None:
    far = replace(desk.state.document, pose=(2.0, -3.0, 4.0, 5.0))
    desk.dispatch(lambda s: actions.restore(s, far))
    desk.until(lambda: shown(desk)[0] == 5000.0 <= shown(desk)[2])  # the ends come after it
    for name in ("x", "y", "theta", "z"):
        value, low, high = shown(desk, name)
        assert low <= value <= high
    desk.session.undo()
    desk.until(lambda: shown(desk) == (HOME, *ENDS))
    assert shown(desk, "x") == (0.0, -550.0, 550.0)


def test_range_follows_knee_and_lengths(desk: Desk) -> None:
    desk.set("pose.knee", "upper knee (mirrored)")
    mirrored = heights(with_knee(APPENDIX_4.geometry, KneeBranch.UPPER))
    desk.until(lambda: shown(desk)[1:] == mirrored)
    assert mirrored[0] <= shown(desk)[0] <= mirrored[1]
    desk.dispatch(lambda s: actions.vary(s, {"geometry.crank_length": 0.5}))
    longer = heights(desk.design.geometry)
    assert longer != mirrored
    desk.until(lambda: shown(desk)[1:] == longer)


def test_pose_that_other_lengths_put_out_of_range_is_kept(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.move(s, z=-0.82))
    desk.dispatch(lambda s: actions.vary(s, {"geometry.shaft_length": 0.4}))
    low, high = heights(desk.design.geometry)
    assert low > -820.0
    desk.until(lambda: shown(desk) == (-820.0, -820.0, high))


def test_in_a_closed_tab_only_jobs_follow_a_drag(server: viser.ViserServer) -> None:
    """What is shown there waits until the page is idle, or the tab is opened."""
    session = Session(RawPage(server).client, initial_state())
    asked: list[Frame] = []
    job = Follower(Place(lambda state: state.engine_answer), asked.append, lambda job, _: job)
    panel = Panel(session, (*POSE, job.worker), "Pose")
    x = panel.handles["pose.x"]

    def shown(place: float, *, dragging: bool) -> float:
        panel.draw(compute(actions.move(session.state, x=1e-3 * place)), dragging)
        return x.value

    assert shown(1.0, dragging=True) == 1.0  # the page has not said what is open
    session.open_tabs = frozenset({"Design"})
    assert shown(2.0, dragging=True) == 1.0
    assert shown(3.0, dragging=False) == 3.0
    session.open_tabs = frozenset({"Pose", "Torque maps"})
    assert shown(4.0, dragging=True) == 4.0
    assert len(asked) == 4


def test_why_a_pose_cannot_be_taken_is_a_sentence() -> None:
    text = status_html(compute(actions.move(initial_state(), x=0.5)))
    assert ">The pantograph is over-stretched" in text
