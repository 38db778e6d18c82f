"""The tab of loads: tables, diagrams, the motion table, files, and poses without numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.loads import charts as chart
from paminsa_viz.explorer.features.loads import tab
from paminsa_viz.explorer.features.loads.solving import ALONG_MOTION, find_loads, instant
from paminsa_viz.explorer.kit.chart import chart as plotly
from paminsa_viz.explorer.kit.chart import figure
from paminsa_viz.explorer.page import opening_state
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.units import number, tied_html
from tests.support.desk import desk_with
from tests.support.samples import prototype_times


def known(shown: tuple[Any, ...] | None) -> tuple[Any, ...]:
    assert shown is not None
    return shown


def along() -> State:
    state = motions.choose_kind(initial_state().updated("loads.settings", along=True), Kind.ARCH)
    analysis = compute(state).analysis
    assert analysis is not None
    return ALONG_MOTION.deliver(state, solve(find_loads, analysis))


def test_columns_stand_closer_where_numbers_of_a_small_robot_are_long() -> None:
    for factor, tight in ((1.0, False), (0.1, True)):
        state = opening_state(prototype_times(factor))
        text = tab.joints(compute(state))
        assert ("pv-tight" in text) is tight
        assert "pv-scrolled" in text  # by itself, not with all of the dock


def test_tables_are_those_of_the_pose_and_the_leg() -> None:
    state = actions.move(initial_state(), x=0.05, theta=0.3).updated("loads.settings", leg=2)
    frame = compute(state)
    forces = joint_forces(APPENDIX_4, state.document.pose)
    text = tab.joints(frame)
    assert number(float(forces.of("4")[2, 2]), 3) in text
    assert number(float(forces.of("5")[2, 1]), 3) in text
    sideways = sideways_forces(APPENDIX_4, state.document.pose).force
    assert f"<td>{number(float(sideways[2, JOINT_INDEX['9']]), 3)}</td>" in text
    assert text.count("<td>–</td>") == 0
    assert number(float(forces.axial), 3) in text
    assert "statically indeterminate" in tab.intro(frame)
    assert tab.bars(frame).count("<tr") == 8
    data = chart.section_figure(*known(chart.shown_section(state)))["data"]
    assert [trace["yaxis"] for trace in data] == ["y", "y2", "y3"]
    assert data[0]["x"][-1] > 100
    for trace in data:  # under the mouse as everywhere else, with a true minus sign
        assert trace["customdata"] == [number(value, 3) for value in trace["y"]]
        assert "%{customdata}" in trace["hovertemplate"]


def test_poses_without_numbers_say_why() -> None:
    theta = singular_rotation(APPENDIX_4.geometry)
    for changed in (
        actions.move(initial_state(), x=0.9),
        actions.move(initial_state(), theta=theta),
    ):
        frame = compute(changed)
        assert "There are no joint forces" in tab.intro(frame)
        assert not tab.joints(frame) + tab.bars(frame)
        assert chart.shown_section(changed) is None
        with pytest.raises(InvalidInput, match="pose"):
            tab.file(changed, "Joints")


def test_axes_of_charts_have_no_commas_and_no_prefixes_beside_the_unit() -> None:
    """What Plotly makes of this is seen in a browser: 20000 and −2×10⁶, not 20k or −2M."""
    layout = figure([], "t [s]", "F [N]", "M [N·m]")["layout"]
    assert layout["separators"] == "."
    for axis in ("xaxis", "yaxis", "yaxis2"):
        assert layout[axis]["exponentformat"] == "power"
        (stop,) = layout[axis]["tickformatstops"]
        assert stop == {"dtickrange": [1e-5, 3e4], "value": "~f"}


def test_a_motion_that_is_followed_shows_its_instant() -> None:
    state = motions.scrub(motions.choose_kind(initial_state(), Kind.ARCH), 0.3)
    at = instant(state)
    assert at.time == pytest.approx(0.3)
    assert np.abs(at.velocity).max() > 0.01
    assert "0.30 s" in tab.intro(compute(state))
    assert tab.joints(compute(state)).count("<td>–</td>") == 9
    moved = actions.move(state, x=0.02)
    assert instant(moved).time is None


@pytest.mark.slow
def test_motion_played_for_ever_takes_numbers_and_charts_along(server: viser.ViserServer) -> None:
    """What waits for an idle page follows the motion, the design and the theme all the same."""
    drawn: list[str] = []

    def line() -> Any:
        drawn.append("")
        return figure([], "t [s]", "F [N]")

    def play(state: State, speed: float) -> State:
        state = motions.choose_kind(state, Kind.ARCH).updated("playback", loop=True, speed=speed)
        return motions.play(state)

    entries = (*tab.LOADS, plotly("line", lambda state: (), line, 1.0))
    with desk_with(server, entries) as desk:
        intro, joints = desk.handle("loads.intro"), desk.handle("loads.joints")
        desk.until(lambda: "at rest" in intro.content and drawn)
        desk.dispatch(lambda state: play(state, 1.0))
        desk.until(lambda: "of the motion" in intro.content)
        first = intro.content
        desk.until(lambda: intro.content != first)
        desk.dispatch(lambda state: play(state, 1e-9))  # it stays where it is, to be compared
        desk.dispatch(lambda state: actions.vary(state, {"payload.mass": 2.0}))
        desk.until(lambda: joints.content == tied_html(tab.joints(compute(desk.state))))
        drawn.clear()
        desk.dispatch(lambda state: replace(state, appearance=Appearance.DARK))
        desk.until(lambda: drawn)
        assert desk.state.playback.playing


def test_the_motion_table_is_of_the_current_motion() -> None:
    state = along()
    frame = compute(state)
    loads = state.loads.outcome.result  # type: ignore[union-attr]
    assert loads is not None
    text = tab.motion(frame)
    assert number(float(loads.peak[0, 8]), 3) in text
    assert number(float(loads.equivalent[0, 8]), 3) in text
    curves = chart.curves_figure(*known(chart.shown_curves(state)))
    assert len(curves["data"]) == 3
    assert curves["layout"]["yaxis"]["title"]["text"] == "F at joint 2 [N]"
    heavier = actions.vary(state, {"payload.mass": 2.0})
    assert "Computing" in tab.motion(compute(heavier))
    assert chart.shown_curves(heavier) is None
    assert not tab.motion(compute(state.updated("loads.settings", along=False)))


@pytest.mark.parametrize("name", ["Joints", "Bar"])
def test_file_of_an_instant_of_a_motion_says_so(name: str) -> None:
    state = motions.scrub(motions.choose_kind(initial_state(), Kind.ARCH), 0.2)
    resting = actions.move_to(state, state.document.pose)
    moving, rest = tab.file(state, name), tab.file(resting, name)
    assert rest.name == moving.name.replace("_t200ms", "") != moving.name
    assert b"# motion: at rest\n" in rest.content
    head = moving.content.decode()
    assert f"# motion: {instant(state).motion}\n# time [s]: 0.2\n# velocity [" in head
    assert "\n# acceleration [" in head


@pytest.mark.slow
def test_files_hold_what_is_shown() -> None:
    state = along()
    names = [*tab.POSE_TABLES, *tab.MOTION_TABLES]
    files = [tab.file(state, name) for name in names]
    assert len({file.name for file in files}) == 4
    for file, word in zip(files, ("vertical_N", "leg2_M_Nm", "equivalent_N", "t_s"), strict=True):
        assert file.name.endswith(".csv")
        assert word in file.content.decode()
    with pytest.raises(InvalidInput, match="motion"):
        tab.file(initial_state(), "Bearings")
