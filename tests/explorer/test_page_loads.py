"""The tab Loads in a browser: numbers of the pose, the motion table, a file, arrows."""

from __future__ import annotations

import pytest

from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.explorer import actions
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.units import number
from tests.support.chromium import Tab, until

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
    until(lambda: tab.state.loads.outcome is not None, "loads of the motion")
    outcome = tab.state.loads.outcome
    assert outcome is not None
    assert outcome.result is not None
    peak = number(float(outcome.result.peak[0, 8]), 3)
    tab.page.get_by_test_id("loads-motion").get_by_text(peak).first.wait_for()
    with tab.page.expect_download() as download:
        tab.page.get_by_role("button", name="Bearings").click()
    assert download.value.suggested_filename.endswith(".csv")
