"""Tolerances of the balance on the page: masses at the pose, lengths on the map."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing.tolerance import mass_tolerance
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.files.examples import open_example
from paminsa_viz.explorer.features.tolerances import tab as panel
from paminsa_viz.explorer.features.tolerances.actions import DRAW, draw_robots
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State, initial_state
from tests.support.desk import Desk
from tests.support.samples import prototype_times
from tests.support.tasks import delivered

PANEL = panel.TOLERANCES


@pytest.fixture
def state() -> State:
    return actions.move(initial_state(), x=0.08, y=0.05, theta=np.pi / 3)


def test_balanced_robot_still_has_torques_within_tolerances(state: State) -> None:
    balanced = open_example(state, "masses")
    found = mass_tolerance(balanced.document.design, 0.02, balanced.last_reachable.pose)
    text = panel.masses_html(compute(balanced))
    assert found.deviation > 0
    assert f"{found.deviation:.3f}" in text
    for worst in found.torque_worst:
        assert f"{worst:.3f}" in text
    exact = balanced.updated("tolerances.settings", mass=0.0)
    assert panel.masses_html(compute(exact)).count("<td>0.000</td>") >= 4  # no spread
    small = panel.masses_html(compute(initial_state(prototype_times(0.1))))
    assert "<td>0.000</td>" not in small
    assert "<td>0.009100</td>" in small  # M_p2


def test_lengths_are_drawn_on_request_and_go_stale(state: State) -> None:
    asked = DRAW.start(state.updated("tolerances.settings", length=0.01))
    job = asked.tolerances.running
    assert job is not None
    outcome = solve(draw_robots, job)
    assert outcome.result is not None
    done = delivered(DRAW, asked, outcome)
    text = panel.lengths_html(compute(done))
    assert f"{outcome.result.quantile(0.95):.3f}" in text
    assert "Changed since" not in text
    assert "Changed since: masses." in panel.lengths_html(
        compute(actions.vary(done, {"links.b4": 0.9}))
    )
    more = done.updated("tolerances.settings", mass=0.1)  # which plays no part
    assert "Changed since" not in panel.lengths_html(compute(more))
    assert delivered(DRAW, done, outcome) is done


def test_robots_are_drawn_in_the_background(desk: Desk) -> None:
    desk.set("tolerance.length", 0.5)
    desk.until(lambda: desk.state.tolerances.settings.length == 0.005)
    desk.set("tolerance.draw", True)
    desk.until(lambda: desk.state.tolerances.outcome)
    outcome = desk.state.tolerances.outcome
    assert outcome is not None
    assert outcome.result is not None
    assert outcome.result.peaks.size == 200
