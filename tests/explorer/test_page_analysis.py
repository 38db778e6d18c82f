"""Tabs that analyze and search, in a browser: loads, stiffness, identification, requirements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import paminsa_viz.files
from paminsa_viz.blocks.kinds import shown
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.features.requirements import actions as requirements
from paminsa_viz.explorer.features.stiffness.layers import MODE_NODE
from paminsa_viz.explorer.features.synthesis import cases, solving
from paminsa_viz.explorer.state.synthesis import EffortChoice
from paminsa_viz.files.example_logs import ExampleLog
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, WorkspaceShape
from paminsa_viz.synthesis.search.case import Effort
from paminsa_viz.units import number
from tests.support.chromium import COMPUTING, Tab, until

pytestmark = pytest.mark.browser


def test_tables_follow_the_pose_and_the_motion(tab: Tab) -> None:
    tab.open_tab("Loads")
    tab.session.dispatch(
        "test", lambda state: actions.move(actions.set_layers(state, joint_forces=True), x=0.05)
    )
    until(lambda: tab.state.document.pose[0] == 0.05, "the pose")
    forces = joint_forces(APPENDIX_4, tab.state.document.pose)
    joints = tab.page.get_by_test_id("loads-joints")
    joints.get_by_text(number(float(forces.of("4")[0, 2]), 3)).first.wait_for()
    nodes = "() => Boolean(window.__viserMutable.nodeRefFromName['/joint_forces/arrows'])"
    until(lambda: tab.page.evaluate(nodes), "arrows")

    tab.page.get_by_label("Along the motion").check(force=True)
    until(lambda: tab.state.loads.outcome is not None, "loads of the motion", COMPUTING)
    outcome = tab.state.loads.outcome
    assert outcome is not None
    assert outcome.result is not None
    peak = number(float(outcome.result.peak[0, 8]), 3)
    tab.page.get_by_test_id("loads-motion").get_by_text(peak).first.wait_for()
    with tab.page.expect_download() as download:
        tab.page.get_by_role("button", name="Bearings").click()
    assert download.value.suggested_filename.endswith(".csv")


WEIGHT = """name => {
  let weight = null;
  window.__viserMutable.nodeRefFromName[name]?.traverse(node => {
    weight = node.morphTargetInfluences?.[0] ?? weight;
  });
  return weight;
}"""


def test_a_mode_is_animated_and_a_diameter_changes_its_frequency(tab: Tab) -> None:
    tab.open_tab("Stiffness")
    until(lambda: bool(tab.state.stiffness.result), "a result")
    before = tab.state.stiffness.result
    assert before is not None
    result = tab.page.get_by_test_id("stiffness-result")
    result.get_by_text(shown(before.frequencies[0], "Hz", 4)).first.wait_for()
    weights = "rows => rows.map(row => getComputedStyle(row.cells[0]).fontWeight)"
    modes = result.get_by_role("table").nth(1).locator("tr").evaluate_all(weights)
    assert [weight == "600" for weight in modes[1:]] == [True, *[False] * 5]  # the chosen one

    tab.page.get_by_label("Animate mode").check(force=True)
    seen: set[float] = set()

    def moves() -> bool:
        weight = tab.page.evaluate(WEIGHT, MODE_NODE)
        if weight is not None:
            seen.add(round(weight, 2))
        return len(seen) > 4

    until(moves, "the mode swings")
    assert all(-1 <= weight <= 1 for weight in seen)
    tab.unfold("Tubes")
    field = tab.number_box("B4 outer ⌀ [mm]")
    field.fill("60")
    field.press("Tab")
    until(
        lambda: tab.state.stiffness.result.frequencies[0] > 1.02 * before.frequencies[0],  # type: ignore[union-attr]
        "a stiffer robot",
    )
    after = tab.state.stiffness.outcome
    assert after is not None
    assert after.job.design.elastic.b4_outer == 0.06


LOG = Path(paminsa_viz.files.__file__).parent / ExampleLog.BEST.value


def test_log_is_identified_drawn_and_used_and_a_wrong_one_changes_nothing(tab: Tab) -> None:
    tab.open_tab("Logs")
    tab.upload("Open a log…", "log.csv", LOG.read_bytes())
    until(lambda: tab.state.identification.result is not None, "the log is identified", COMPUTING)
    numbers = tab.page.get_by_test_id("identify-numbers")
    numbers.wait_for()
    unknown = tab.state.identification.result.identification.unknown
    assert numbers.locator("tr.pv-muted").count() == len(unknown) > 0
    assert tab.page.locator(".uplot canvas").count() >= 2
    tab.click("Use as design")
    until(lambda: tab.state.document.design != APPENDIX_4, "its numbers are the design's")
    findings = tab.state.identification.result
    wrong = LOG.read_bytes().replace(b"torque1_Nm", b"torque9_Nm")
    tab.upload("Open a log…", "wrong.csv", wrong)
    tab.page.get_by_text("there is no such column").first.wait_for()
    assert tab.state.identification.result is findings
    assert tab.errors == []


def ask(tab: Tab) -> None:
    """Require a small cylinder with a bound on the condition number."""

    def asked(state):  # type: ignore[no-untyped-def]
        state = requirements.choose_shape(state, WorkspaceShape.CYLINDER)
        state = requirements.set_workspace(state, size=(0.16, 0.16, 0.1))
        bounds = (Requirement("condition", high=6.0),)
        return requirements.change(state, bounds=bounds, theta=(-0.3, 0.3))

    tab.dispatch(asked)


def test_a_mark_turns_when_a_length_breaks_its_requirement_and_a_click_leads_there(
    tab: Tab,
) -> None:
    tab.open_tab("Requirements")
    tab.click("Suggested set")
    row = tab.page.get_by_test_id("requirement-0")
    row.get_by_text("✓").wait_for()
    assert "✗" not in tab.text("requirements-strip")
    tab.open_tab("Masses")
    tab.open_tab("Lengths")
    tab.type_number("R_b leg axes [mm]", 240)
    strip = tab.page.get_by_test_id("requirements-strip")
    strip.get_by_text("✗").first.wait_for()
    tab.open_tab("Requirements")
    row.get_by_text("✗").wait_for()
    before = tab.state.document.pose
    row.get_by_role("button").last.click()
    until(lambda: tab.state.document.pose != before, "the robot is at the worst pose")
    condition = tab.session.state.document.requirements.bounds[0]
    assert condition.quantity == "condition"
    until(lambda: tab.state.requirements.fine is not None, "the fine volume")
    tab.page.get_by_test_id("requirements-volume").get_by_text("dm³").first.wait_for()


def test_bounds_are_typed_in_the_table(tab: Tab) -> None:
    tab.open_tab("Requirements")
    tab.click("Suggested set")
    boxes = tab.page.get_by_test_id("requirements-list").get_by_role("textbox")
    boxes.nth(3).wait_for()

    def high(index: int) -> float | None:
        one = tab.state.document.requirements.bounds[index]
        return None if one.high is None else one.entry.display.from_si(one.high)

    before = high(0)
    boxes.first.click()
    tab.page.keyboard.type("8.")
    # The table is made anew meanwhile; what is typed goes on in its new box.
    tab.dispatch(lambda state: requirements.edit(state, theta=(-0.2, 0.2)))
    tab.page.get_by_test_id("requirement-0").get_by_text("for θ").wait_for()
    assert high(0) == before
    assert boxes.first.input_value() == "8."
    tab.page.keyboard.type("25")
    tab.page.keyboard.press("Enter")  # which goes to the next row
    until(lambda: high(0) == 8.25, "a bound is set")
    tab.page.wait_for_function("() => document.activeElement?.dataset.paminsaValue === '1 high'")
    tab.page.keyboard.type("3*4")
    tab.page.keyboard.press("Tab")
    until(lambda: high(1) == 12, "the next one is")
    until(lambda: boxes.nth(1).input_value() == "12", "it is shown")
    boxes.nth(2).fill("5 mm")
    boxes.nth(2).press("Enter")
    tab.page.get_by_text("the field is in N, “mm” is not").wait_for()
    boxes.nth(0).press("Control+z")
    until(lambda: high(1) != 12, "it is undone")
    assert high(0) == 8.25


def test_the_largest_workspace_is_proven_and_used(tab: Tab) -> None:
    ask(tab)
    tab.open_tab("Requirements")
    tab.unfold("Largest workspace")
    tab.click("Find the largest")
    until(lambda: tab.state.requirements.largest.outcome is not None, "a proof", COMPUTING)
    proven = tab.state.requirements.largest.proven
    assert proven is not None
    tab.page.get_by_test_id("largest-result").get_by_text("largest proven workspace").wait_for()
    assert proven[1][0] > 0.16
    tab.click("Use as required workspace")
    until(
        lambda: tab.state.document.requirements.workspace.size == proven[1],
        "it is the required workspace",
    )


def test_a_search_is_adopted_with_the_design_before_as_reference(
    tab: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(cases.EFFORTS, EffortChoice.QUICK, Effort(4, 6))
    monkeypatch.setattr(solving, "BUILT", 10)
    ask(tab)
    tab.open_tab("Synthesis")
    tab.page.get_by_test_id("synthesize-intro").get_by_text("160").wait_for()
    tab.click("Search")
    until(lambda: tab.state.synthesis.outcome is not None, "an answer", COMPUTING)
    tab.page.get_by_test_id("synthesis-result").get_by_text("footprint").wait_for()
    found = tab.state.synthesis.answer
    assert found is not None
    tab.click("Open as current design")
    until(lambda: tab.state.document.design == found.design, "the robot that was found")
    assert tab.state.document.reference == replace(APPENDIX_4)
    assert "✗" not in tab.text("requirements-strip")
