"""The tab of drives: search, lists, the chart, the choice, and what it says when it is stale."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks.drives import RPM, selection_blocks
from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.features.compare.tab import differences_html
from paminsa_viz.explorer.features.drives import tab as panel
from paminsa_viz.explorer.features.drives.solving import LISTED
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.drive_catalog import read_catalog
from paminsa_viz.model import InvalidInput
from paminsa_viz.progress import Canceled
from paminsa_viz.trajectory import analyze
from tests.support.tables import assert_parts
from tests.support.tasks import finished

WEAK = """kind,name,source,rotor_inertia_kg_cm2,rated_torque_Nm,peak_torque_Nm,rated_speed_rpm,\
top_speed_rpm,gear_ratio,efficiency,lead_mm,lead_efficiency
motor,weak,test,0.001,0.002,0.004,3000,6000,,,,
gear,box,test,,,,,,50,0.8,,
screw,<b>spindle</b>,test,,,,,,,,10,0.9
"""


def searched(state: State) -> State:
    return finished(panel.SEARCH, panel.SEARCH.start(state))


@pytest.fixture(scope="module")
def found() -> State:
    return searched(initial_state())


@pytest.mark.slow
def test_lists_name_feasible_drives_and_their_margins(found: State) -> None:
    text = panel.list_html(compute(found))
    assert "M1 to M3" in text
    assert "Changed since" not in text
    assert text.count("<tr") == 1 + LISTED
    assert all(one.feasible for row in found.drives.result.rows for one in row)  # type: ignore[union-attr]
    assert "RMS torque" in panel.facts_html(compute(found))
    lists = found.drives.result
    assert lists is not None
    design, catalog = found.document.design, lists.selection
    blocks = selection_blocks(design, catalog, LISTED, lists.advice)
    assert_parts(text, blocks)
    assert ("<th>Mass [kg]</th>" in text, "Cost" in text) == (True, False)
    outcome = found.drives.outcome
    assert outcome is not None
    job = replace(outcome.job, settings=replace(outcome.job.settings, order="cost"))
    cheapest = found.updated("drives", outcome=replace(outcome, job=job))
    by_cost = panel.list_html(compute(cheapest))
    assert ("Mass" in by_cost, "<th>Cost</th>" in by_cost) == (False, True)
    chosen = panel.choose(found, None)
    own = selection_blocks(chosen.document.design, catalog, LISTED, lists.advice)
    assert_parts(panel.own_html(compute(chosen)), own)


@pytest.mark.slow
def test_the_choice_is_the_designs_and_can_be_undone_and_shared(found: State) -> None:
    chosen = panel.choose(found, None)
    drives = chosen.document.design.drives
    assert all(drives)
    assert drives[0] == drives[1] == drives[2]
    assert persistence.load(persistence.dump(chosen.document)).design == chosen.document.design
    text = panel.own_html(compute(chosen))
    assert text.count("pv-good-text") == 4
    assert "Changed since" not in panel.list_html(compute(chosen))
    unmeasured = panel.own_html(compute(chosen.updated("drives", outcome=None)))
    assert ("measures them" in unmeasured, "measures them" in text) == (True, False)
    one = panel.choose(found.updated("drives", actuator=3, row=1), 1)
    assert [drive is not None for drive in one.document.design.drives] == [False] * 3 + [True]
    assert not any(actions.change_design(chosen, drives=(None,) * 4).document.design.drives)


def test_lists_say_when_they_are_of_something_else(found: State) -> None:
    for other in (
        actions.vary(found, {"payload.mass": 1.0}),
        found.updated("drives.settings", dwell=1.0),
    ):
        assert "Changed since" in panel.list_html(compute(other))
    assert set(panel._choices(found)) == {"Use for M1 to M3", "First of each list"}
    assert "Remove" in panel._choices(panel.choose(found, None))


def drawn(state: State) -> Any:
    shown = panel.shown_drive(state)
    assert shown is not None
    return panel.chart_figure(*shown)


def test_the_chart_holds_the_motion_inside_the_envelope(found: State) -> None:
    figure = drawn(found)
    traces = {trace["name"]: trace for trace in figure["data"]}
    for name in ("M1", "M2", "M3"):
        assert np.abs(traces[name]["x"]).max() < np.max(traces["envelope"]["x"])
        assert np.abs(traces[name]["y"]).max() < np.max(traces["envelope"]["y"])
    lift = drawn(found.updated("drives", actuator=3))
    assert {"M4", "M1"} & {trace["name"] for trace in lift["data"]} == {"M4"}
    other = found.updated("drives", row=1)
    assert panel.shown_drive(found) != panel.shown_drive(other)
    assert panel.shown_drive(initial_state()) is None


def test_the_piece_of_time_that_is_plotted_stands_out_if_its_motion_is_in_the_cycle(
    found: State,
) -> None:
    (duty,) = found.drives.result.selection.cycle.duties  # type: ignore[union-attr]
    motion = duty.trajectory
    start, end = motion.t[0] + 0.25 * motion.duration, motion.t[0] + 0.5 * motion.duration
    plotted = motions.show_piece(found, (float(start), float(end)))
    traces = {trace["name"]: trace for trace in drawn(plotted)["data"]}
    inside = (motion.t >= start) & (motion.t <= end)
    speed = analyze(found.document.design, motion).solved.speed[inside, 0]
    shown = np.array(traces["M1, plotted"]["x"])
    ratio = RPM * plotted.drives.shown.drive.ratio  # type: ignore[union-attr]
    assert shown.min() == pytest.approx(ratio * speed.min(), rel=1e-3, abs=1e-6)
    assert shown.max() == pytest.approx(ratio * speed.max(), rel=1e-3, abs=1e-6)
    times = np.array(traces["M1, plotted"]["customdata"], float)
    assert (times >= start).all()
    assert (times <= end).all()
    np.testing.assert_allclose(np.interp(times, motion.t, analyze(
        found.document.design, motion).solved.speed[:, 0]) * ratio, shown, atol=1e-9)  # fmt: skip
    other = drawn(motions.choose_preset(plotted, "circle"))["data"]
    assert not any("plotted" in trace["name"] for trace in other)
    assert all(time is None for trace in other for time in trace.get("customdata", ()))


@pytest.mark.slow
def test_a_catalog_without_a_feasible_drive_shows_the_nearest_and_advice() -> None:
    catalog = read_catalog(WEAK, "weak.csv")
    asked = initial_state().updated("drives.settings", catalog=catalog)
    told: list[float] = []
    panel.SEARCH.find(panel.SEARCH.job(asked), lambda done, /, **_: told.append(done))
    assert told == sorted(told)
    assert told[:4] == [0.0625, 0.1875, 0.3125, 0.4375]  # each actuator's; no winding is looked at
    assert len(told) > 20  # slower motions that were tried
    assert told[-1] < 1.0
    with pytest.raises(Canceled):
        panel.SEARCH.find(panel.SEARCH.job(asked), lambda done, /, **_: done > 0.7)
    state = searched(asked)
    text = panel.list_html(compute(state))
    assert "0 feasible" in text
    assert "no drive fits" in text
    assert "pv-bad-text" in text
    lift = panel.list_html(compute(state.updated("drives", actuator=3)))
    assert "&lt;b&gt;spindle" in lift
    assert "<b>spindle" not in lift
    with pytest.raises(InvalidInput):
        panel.choose(initial_state(), None)


@pytest.mark.slow
def test_the_shortest_motion_keeps_the_chosen_drives(found: State) -> None:
    chosen = panel.choose(found, None)
    motion = replace(chosen.document.motion, kind=Kind.MOVE, timing=Timing.SHORTEST)
    bare = planned(motion, found.document.design)
    driven = planned(motion, chosen.document.design)
    assert bare.trajectory is not None
    assert driven.trajectory is not None
    assert driven.trajectory.duration > bare.trajectory.duration


def test_uploaded_catalog_is_read_or_refused_with_its_row() -> None:
    actions_: list[Any] = []
    notices: list[str] = []
    session: Any = SimpleNamespace(
        dispatch=lambda key, action, then: (actions_.append(action), then()),
        notify=lambda title, body: notices.append(body),
    )
    panel._open(session, "weak.csv", WEAK.encode())
    assert notices == ["weak.csv: 1 motor, 1 gear, 1 screw or belt"]
    state = actions_[0](initial_state())
    assert state.drives.settings.parts.name == "weak.csv"
    lost = "A catalog of your own is not kept over a reload."
    assert [lost in panel.intro_html(compute(one)) for one in (state, initial_state())] == [
        True, False,
    ]  # fmt: skip
    for content, problem in ((b"", "no rows"), (WEAK.replace("0.8", "1.8").encode(), "row 3")):
        with pytest.raises(ValueError, match=problem):
            panel._open(session, "bad.csv", content)


def test_the_comparison_names_the_actuators_whose_drives_differ(found: State) -> None:
    design = panel.choose(found, None).document.design
    text = differences_html(design, found.document.design, "App. 4")
    assert "4 numbers differ" in text
    assert text.count("no drive") == 4
    assert "No number differs" in differences_html(design, design, "same")


def test_a_cycle_of_several_motions_is_searched_as_a_whole(found: State) -> None:
    state = found.updated("drives.settings", count=3.0, dwell=0.5)
    state = panel.add_motion(state)
    state = panel.add_motion(state.updated("drives.settings", count=1.0, dwell=10.0))
    intro = panel.intro_html(compute(state))
    assert "3 ×, dwell 0.5 s" in intro
    assert "A cycle is not kept over a reload." in intro
    assert "Changed since" in panel.list_html(compute(state))
    searched_again = searched(state)
    outcome = searched_again.drives.outcome
    assert outcome is not None
    assert outcome.result is not None
    load = outcome.result.selection.cycle.loads[0]
    duration = outcome.job.duties[0].trajectory.duration
    assert load.period == pytest.approx(4 * duration + 3 * 0.5 + 10.0)
    assert "Changed since" not in panel.list_html(compute(searched_again))
    assert "Clear" in panel._cycle_choices(state)
    full = state.updated("drives.settings", cycle=state.drives.settings.cycle * 6)
    with pytest.raises(InvalidInput, match="at most 12"):
        panel.add_motion(full)


def test_a_search_without_a_motion_says_once_what_is_missing() -> None:
    state = motions.choose_kind(initial_state(), Kind.WAYPOINTS)
    with pytest.raises(InvalidInput, match=r"^waypoints: two or more are needed"):
        panel.SEARCH.start(state)
