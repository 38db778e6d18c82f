"""Requirements and synthesis in a browser: live marks, the proven workspace, an adopted search."""

from __future__ import annotations

from dataclasses import replace

import pytest

from paminsa_viz.explorer.requirements import actions
from paminsa_viz.explorer.synthesis import cases
from paminsa_viz.explorer.synthesis.jobs import EffortChoice
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, WorkspaceShape
from paminsa_viz.synthesis.search.case import Effort
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser


def ask(tab: Tab) -> None:
    """Require a small cylinder with a bound on the condition number."""

    def asked(state):  # type: ignore[no-untyped-def]
        state = actions.choose_shape(state, WorkspaceShape.CYLINDER)
        state = actions.set_workspace(state, size=(0.16, 0.16, 0.1))
        bounds = (Requirement("condition", high=6.0),)
        return actions.change(state, bounds=bounds, theta=(-0.3, 0.3))

    tab.dispatch(asked)


def test_a_mark_turns_when_a_length_breaks_its_requirement_and_a_click_leads_there(
    tab: Tab,
) -> None:
    tab.open_tab("Requirements")
    tab.click("Suggested set")
    row = tab.page.get_by_test_id("requirement-0")
    row.get_by_text("✓").wait_for()
    assert "✗" not in tab.text("requirements-strip")
    tab.open_tab("Design")
    tab.open_tab("Geometry")
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
    until(lambda: tab.state.requiring.fine is not None, "the fine volume")
    tab.page.get_by_test_id("requirements-volume").get_by_text("dm³").first.wait_for()


def test_the_largest_workspace_is_proven_and_used(tab: Tab) -> None:
    ask(tab)
    tab.open_tab("Requirements")
    tab.page.get_by_text("Largest workspace", exact=True).click()
    tab.click("Find the largest")
    until(lambda: tab.state.requiring.largest.outcome is not None, "a proof")
    proven = tab.state.requiring.largest.proven
    assert proven is not None
    tab.page.get_by_test_id("largest-result").get_by_text("Proven").wait_for()
    assert proven[1][0] > 0.16
    tab.click("Use as required workspace")
    until(
        lambda: tab.state.document.requirements.workspace.size == proven[1],
        "it is the required workspace",
    )


def test_a_search_is_adopted_with_the_design_before_as_reference(
    tab: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(cases.EFFORTS, EffortChoice.QUICK, Effort(12, 6))
    ask(tab)
    tab.open_tab("Synthesize")
    tab.page.get_by_test_id("synthesize-intro").get_by_text("160").wait_for()
    tab.click("Search")
    until(lambda: tab.state.synthesizing.outcome is not None, "an answer")
    tab.page.get_by_test_id("synthesis-result").get_by_text("footprint").wait_for()
    found = tab.state.synthesizing.answer
    assert found is not None
    tab.click("Open as current design")
    until(lambda: tab.state.document.design == found.design, "the robot that was found")
    assert tab.state.document.reference == replace(APPENDIX_4)
    assert "✗" not in tab.text("requirements-strip")
