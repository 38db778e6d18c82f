"""The Pareto front point by point, and the sensitivity to each number of the design."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import OUTPUTS
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.balance.charts import (
    clicked_point,
    front_figure,
    shown_front,
    shown_tornado,
    tornado_figure,
)
from paminsa_viz.explorer.features.balance.solving import middle, run, static_torque
from paminsa_viz.explorer.features.balance.tab import FRONT, SETTINGS
from paminsa_viz.explorer.features.balance.texts import front_html, sensitivity_html
from paminsa_viz.explorer.kit.entries import given
from paminsa_viz.explorer.kit.inputs import Slider
from paminsa_viz.explorer.state.balance import BalanceKind, Goal, MassFront
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    check_reach,
    measure_singularity,
    static_imbalance,
)
from paminsa_viz.trajectory import analyze
from tests.explorer.features.balance.balanced import START, solved, started
from tests.support.entries import inputs_in
from tests.support.tasks import delivered

(POINT,) = (entry for entry in inputs_in(FRONT) if isinstance(entry, Slider))
"""The slider that goes through the points of the front."""


@pytest.mark.slow
def test_points_of_the_front_are_designs_with_the_torques_they_say() -> None:
    steps: list[float] = []
    running, job = started(START, BalanceKind.FRONT)
    outcome: Any = solve(run, job, lambda done: bool(steps.append(done)))
    assert steps == sorted(steps)
    assert steps[-1] == 1
    after = delivered(balancing.FRONT, running, outcome)
    assert after.document == START.document
    points = outcome.result.front.points
    assert len(outcome.result.designs) == len(points) > 5
    assert (POINT.read(after), given(POINT.range, after)) == ((0, (0, len(points))))
    for index in (0, 4, len(points) - 1):
        first, second = points[index].first, points[index].second
        after = POINT.apply(after, index + 1)
        assert POINT.read(after) == index + 1
        assert after.document.reference == START.document.design
        assert job.trajectory is not None
        torque = analyze(after.document.design, job.trajectory).torque[:, :3]
        assert np.abs(torque).max() == pytest.approx(first, rel=1e-6)
        still = static_torque(job, after.document.design)
        assert still == pytest.approx(second, rel=1e-6, abs=1e-7)
        assert clicked_point({"x": first, "y": second}, after) == index
        shown = front_figure(*drawn(shown_front(after)))
        marks = shown["data"][0]["marker"]["size"]
        assert marks.index(max(marks)) == index
        legend = shown["layout"]["legend"]  # over no point
        assert (legend["y"] > 1, legend["yanchor"]) == (True, "bottom")
    after = POINT.apply(after, 0)
    assert (POINT.read(after), after.document.design) == (0, START.document.design)
    with pytest.raises(InvalidInput, match="no such point"):
        balancing.choose_point(after, len(points))
    for elsewhere in ({"x": 1e6, "y": 0}, {"x": "1", "y": 0}, [1]):
        assert clicked_point(elsewhere, after) is None


def test_front_that_is_stopped_stops() -> None:
    _, job = started(START, BalanceKind.FRONT)
    found: Any = run(job, lambda _: True)
    assert len(found.front.points) < 3


def drawn(shown: Any) -> Any:
    assert shown is not None
    return shown


def text(state: State) -> str:
    """Return what the page shows of the sensitivity."""
    return sensitivity_html(compute(state))


@pytest.mark.slow
def test_tornado_is_sorted_and_gives_the_models_numbers() -> None:
    loaded = balancing.add_counterweight(balancing.add_counterweight(START, "b8", 8), "b3", 7)
    after = solved(loaded, BalanceKind.SENSITIVITY)
    outcome = after.balance.tornado
    assert outcome is not None
    assert outcome.result is not None
    for output in range(len(OUTPUTS)):
        shown = drawn(shown_tornado(after.updated("balance", output=output)))
        traces = tornado_figure(*shown)["data"]
        lengths = np.abs([trace["x"] for trace in traces]).max(axis=0)
        assert len(lengths) > 5
        assert (np.diff(lengths) <= 1e-12).all()
        assert len(set(traces[0]["y"])) == len(traces[0]["y"])
    assert "counterweight 2" in str(tornado_figure(*drawn(shown_tornado(after))))
    bar = next(bar for bar in outcome.result.bars if bar.path == "joints.j7")
    more = loaded.document.design.vary({"joints.j7": 1.05 * bar.value})
    assert bar.plus[0] == pytest.approx(static_imbalance(more))
    assert "Changed since: counterweights." in text(actions.change_design(after, counterweights=()))


def test_sensitivity_is_that_of_poses_away_from_limits() -> None:
    poses = middle(balancing.make_job(START, BalanceKind.SENSITIVITY)).poses()
    assert check_reach(APPENDIX_4.geometry, poses).ok.all()
    measured = measure_singularity(APPENDIX_4.geometry, poses)
    assert (measured.condition <= 10).all()
    assert (measured.serial_distance >= 0.01).all()
    far = solved(actions.move(START, z=-3.0), BalanceKind.SENSITIVITY)
    assert "no pose around the middle is clear" in text(far)


def test_without_a_motion_the_sensitivity_is_static() -> None:
    after = solved(motions.choose_kind(START, motions.Kind.TABLE), BalanceKind.SENSITIVITY)
    assert "Nothing to show" not in text(after)
    assert "Nothing to show" in text(after.updated("balance", output=3))


def test_front_and_sensitivity_say_what_has_changed_since() -> None:
    """Both claim to be of this plane and of these bounds."""
    job = balancing.make_job(START, BalanceKind.FRONT)
    point = actions.vary(START, {"links.b4": 0.9}).document.design
    points: Any = SimpleNamespace(points=())
    front = MassFront(points, (point,))
    tornado: Any = SimpleNamespace(bars=(SimpleNamespace(lost=0),), ranked=lambda output: ())
    made = balancing.make_job(START, BalanceKind.SENSITIVITY)
    state = START.updated(
        "balance", front=Outcome(job, front), tornado=Outcome(made, tornado)
    )  # fmt: skip
    for task, page in ((balancing.FRONT, front_html), (balancing.SENSITIVITY, sensitivity_html)):
        assert task.changes(state) == ()
        turned = actions.move(state, theta=0.2, z=-0.52)
        assert task.changes(turned) == ("θ", "z")
        assert "Changed since: θ and z." in page(compute(turned))
    turned = actions.move(state, theta=0.2)
    text = front_html(compute(turned))
    assert "of that time" in text
    assert re.search(r"Changed since: θ\.</b>\s+Here one", text)
    assert "bounds of “Optimization settings”" in front_html(compute(state))  # elsewhere
    bounded = balancing.change_settings(state, max_added=3.0)
    assert balancing.FRONT.changes(bounded) == ("“Max added”",)
    assert balancing.SENSITIVITY.changes(bounded) == ()
    assert balancing.FRONT.changes(balancing.choose_point(state, 0)) == ()


def test_a_balance_is_of_the_design_that_it_made() -> None:
    after = balancing.balance_now(START)
    assert after.document.design != START.document.design
    assert balancing.OPTIMUM.changes(after) == ()
    assert balancing.OPTIMUM.changes(balancing.change_settings(after, max_added=3.0)) == ()
    heavier = actions.vary(after, {"platform.mass": 3.0})
    assert "masses" in balancing.OPTIMUM.changes(heavier)


def test_torques_of_a_balanced_robot_are_zero_on_the_front_and_not_what_rounding_leaves() -> None:
    point = SimpleNamespace(first=1.8, second=4.8e-16)
    front: Any = SimpleNamespace(points=(point,), before=(1.9, 5.1e-16))
    shown = front_figure(front, None)
    assert [trace["y"] for trace in shown["data"]] == [[0.0], [0.0]]
    assert shown["layout"]["yaxis"]["range"] == [0, 1.9]
    loaded: Any = SimpleNamespace(points=(point,), before=(1.9, 5.1))
    shown = front_figure(loaded, None)
    assert [trace["y"] for trace in shown["data"]] == [[0.0], [5.1]]
    assert "range" not in shown["layout"]["yaxis"]


def test_where_zero_added_mass_is_no_limit_the_page_says_so() -> None:
    entries = {entry.key: entry for entry in SETTINGS}
    of_mass = [entries[f"balance.{name}"].visible for name in ("max_added", "unlimited")]
    for goal in Goal:
        state = balancing.choose_goal(START, goal)
        assert [bool(shown and shown(state)) for shown in of_mass] == [not goal.static] * 2
