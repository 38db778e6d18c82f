"""The tab Synthesis: what is asked, what is missing, a search that is adopted, what is shown."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks.answer_checks import price_blocks
from paminsa_viz.blocks.synthesis import buildability_table, synthesis_blocks
from paminsa_viz.explorer.core import actions as designs
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.requirements import current_check
from paminsa_viz.explorer.features.clearance.actions import OF_POSE
from paminsa_viz.explorer.features.clearance.tab import clearance_html
from paminsa_viz.explorer.features.requirements import actions as requirements
from paminsa_viz.explorer.features.stiffness.tab import ANALYSIS, result_html
from paminsa_viz.explorer.features.synthesis import actions, cases, solving
from paminsa_viz.explorer.features.synthesis import texts as text
from paminsa_viz.explorer.features.synthesis.charts import clicked_point, front_figure, shown_front
from paminsa_viz.explorer.features.synthesis.layers import best_robot
from paminsa_viz.explorer.features.synthesis.solving import search
from paminsa_viz.explorer.features.synthesis.tab import RANGES, SYNTHESIZE
from paminsa_viz.explorer.kit.task import NOT_OF_PREVIEW, FollowerRunner
from paminsa_viz.explorer.scene.mechanism import sticks
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.synthesis import BestSoFar, EffortChoice, SearchResult, Shown
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.quantities.requirements import Requirement, WorkspaceShape
from paminsa_viz.synthesis.answer.prices import RequirementPrice
from paminsa_viz.synthesis.search.case import DEFAULT_PATHS, Effort, Regime
from paminsa_viz.synthesis.search.front import DesignFront, FrontPoint
from paminsa_viz.synthesis.search.result import SynthesisResult
from tests.support.desk import Desk
from tests.support.samples import enlarged, prototype_times
from tests.support.tables import assert_parts, tables_in
from tests.support.tasks import delivered

pytestmark = pytest.mark.usefixtures("built_in_few_rounds")

PANEL = SYNTHESIZE

EASY = (Requirement("condition", high=10.0),)


@pytest.fixture
def asked() -> State:
    """A small cylinder about home with a bound on the condition number."""
    state = requirements.choose_shape(initial_state(), WorkspaceShape.CYLINDER)
    state = requirements.change(state, bounds=EASY, theta=(-0.3, 0.3))
    return requirements.set_workspace(state, size=(0.1, 0.1, 0.1))


def test_what_is_missing_is_said_before_the_search() -> None:
    bare = initial_state()
    assert ">A required workspace is needed; choose one" in text.intro_html(compute(bare))
    with pytest.raises(InvalidInput, match="workspace"):
        actions.start(bare)


def test_ranges_are_about_the_design_and_equal_ends_hold_a_length(asked: State) -> None:
    path = "geometry.base_radius"
    held = actions.set_range(asked, path, (0.3, 0.3))
    document, settings = held.document, held.synthesis.settings
    case = cases.case_of(settings, document.design, document.requirements)
    assert path not in case.paths
    assert case.reference.geometry.base_radius == 0.3
    other = cases.case_of(asked.synthesis.settings, document.design, document.requirements)
    low, high = other.bounds[other.paths.index(path)]
    assert low < APPENDIX_4.geometry.base_radius < high
    with pytest.raises(InvalidInput):
        actions.set_range(asked, path, (0.3, 0.2))


def test_ranges_are_shown_of_what_is_searched(asked: State) -> None:
    """Sizes of the workspace are where its volume is one of the objectives, and there is one."""
    sizes = {cases.WIDTH, cases.TALL}
    for state, more in (
        (asked, set[str]()),
        (asked.updated("synthesis.settings", objective="volume"), sizes),
        (asked.updated("synthesis.settings", against="volume"), sizes),
        (initial_state().updated("synthesis.settings", objective="volume"), set[str]()),
    ):
        shown = {one.key for one in RANGES if one.visible is None or one.visible(state)}
        paths = {path for path in {*DEFAULT_PATHS, *sizes} if f"synthesize.{path}" in shown}
        assert paths == {*DEFAULT_PATHS, *more}
        if state.document.requirements.workspace is not None:
            assert paths >= set(actions.search_job(state).case.paths)


def test_least_distances_are_those_of_a_robot_of_the_size(asked: State) -> None:
    """A millimeter is a tenth of a small robot's platform, and nothing to a large one's tubes."""
    settings, required = asked.synthesis.settings, asked.document.requirements
    for design, clearance, margin in (
        (APPENDIX_4, 1e-3, 1e-3), (enlarged(APPENDIX_4, 0.05), 5e-5, 5e-5),
        (enlarged(APPENDIX_4, 10.0), 0.01, 0.01), (prototype_times(10.0), 1e-3, 0.01),
    ):  # fmt: skip
        case = cases.case_of(settings, design, required)
        assert (case.clearance, case.margin) == (clearance, margin)


@pytest.mark.slow
def test_a_short_search_is_adopted_with_the_design_before_as_reference(
    asked: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(cases.EFFORTS, EffortChoice.QUICK, Effort(10, 6))
    monkeypatch.setattr(solving, "BUILT", 10)
    started = actions.start(asked)
    job = started.synthesis.running
    assert job is not None
    seen: list[BestSoFar] = []
    done: list[float] = []

    def report(part: float, /, **known: Any) -> bool:
        done.append(part)
        seen.extend(known.values())
        return False

    outcome = solve(search, job, report)
    assert outcome.problem == ""
    assert done == sorted(done)
    # looking at whether it can be built is told of too
    assert sum(solving.SEARCH_SHARE < part < done[-1] for part in done) > 20
    assert seen
    state = delivered(actions.SEARCH, told(started, seen[-1]), outcome)
    found = outcome.result.answer  # type: ignore[union-attr]
    assert found.feasible
    shown = text.result_html(compute(state))
    assert "footprint" in shown
    assert "Built within tolerances" in shown
    assert "Least clearance as drawn" in shown
    assert "Overlap was allowed" not in shown
    opened = actions.open_result(state)
    assert opened.document.design == found.design
    assert opened.document.reference == APPENDIX_4
    assert opened.last_reachable.geometry == found.design.geometry
    check = current_check(opened)
    assert check is not None
    assert check.holds


def told(state: State, best: BestSoFar) -> State:
    """Return the state once its search has told of the best robot so far."""
    return actions.SEARCH.report(state, state.synthesis.ticket, 0.5, best=best)


def answer(state: State, radius: float, objective: float) -> SynthesisResult:
    """Return an answer of a made-up search."""
    job = actions.start(state).synthesis.running
    assert job is not None
    return SynthesisResult(
        case=job.case, design=APPENDIX_4.vary({"geometry.base_radius": radius}),
        workspace=replace(job.case.workspace, center=(0.0, 0.0, -0.55)), regime=Regime.SMALLER,
        feasible=True, objective=objective, outcomes=(), states=(), refused={}, relaxed=(),
        canceled=False, poses=1,
    )  # fmt: skip


@pytest.mark.slow
def test_a_front_is_chosen_from_and_its_robot_opened(asked: State) -> None:
    with pytest.raises(InvalidInput, match="different"):
        actions.start(asked.updated("synthesis.settings", against="footprint"))
    started = actions.start(asked.updated("synthesis.settings", against="moving_mass"))
    job = started.synthesis.running
    assert job is not None
    assert shown_front(started) is None
    points = tuple(
        FrontPoint((size, mass), answer(asked, radius, size))
        for size, mass, radius in ((0.4, 20.0, 0.36), (0.5, 18.0, 0.33), (0.6, 17.0, 0.3))
    )
    front = DesignFront(("footprint", "moving_mass"), points, 0, 4, 0, canceled=False)
    state = delivered(
        actions.SEARCH, started, Outcome(job, SearchResult(points[0].result, front=front))
    )
    shown = shown_front(state)
    assert shown is not None
    figure = front_figure(*shown)
    x, y = (figure["data"][0][axis] for axis in "xy")
    assert np.allclose(x, [400.0, 500.0, 600.0])
    assert clicked_point({"x": x[1], "y": y[1]}, state) == 1
    assert clicked_point({"x": 1e9, "y": y[1]}, state) is None
    assert clicked_point({"x": "no"}, state) is None
    chosen = actions.choose_point(state, 1)
    assert shown_front(chosen) != shown_front(state)
    shown = text.result_html(compute(chosen))
    assert "moving mass 18 kg" in shown
    lengths = shown[shown.index('data-testid="lengths"') :]
    assert re.findall("<th[^>]*>(.*?)</th>", lengths) == ["Symbol", "Before", "Found", "Change"]
    assert re.findall("<b>(.*?)</b>", lengths) == ["330"]
    opened = actions.open_result(chosen)
    assert opened.document.design == points[1].result.design
    assert "Changed since" not in text.result_html(compute(opened))
    assert "Changed since" not in text.result_html(compute(actions.choose_point(opened, 2)))
    assert actions.SEARCH.changes(designs.vary(opened, {"gravity": 9.0})) != ()
    other = chosen.updated("synthesis.settings", seed=5)
    assert "Changed since: seed." in text.result_html(compute(other))
    assert actions.choose_point(state, 99) is state


@pytest.mark.slow
def test_adopted_robot_is_said_to_have_the_design_of_the_start_as_reference(
    desk: Desk, asked: State
) -> None:
    """The design may have been changed while the search ran."""
    started = actions.start(asked)
    job = started.synthesis.running
    assert job is not None
    found = Outcome(job, SearchResult(answer(asked, 0.3, 0.4)))
    state = delivered(actions.SEARCH, designs.vary(started, {"payload.mass": 2.0}), found)
    desk.dispatch(lambda _: state)
    desk.set("synthesize.open", True)
    desk.noticed("the design that the search began with is the reference")
    assert desk.state.document.reference == job.reference == APPENDIX_4


@pytest.mark.slow
def test_answer_stays_and_can_be_opened_while_another_search_runs(asked: State) -> None:
    started = actions.start(asked)
    job = started.synthesis.running
    assert job is not None
    first = delivered(actions.SEARCH, started, Outcome(job, SearchResult(answer(asked, 0.3, 0.4))))
    again = told(actions.start(first), BestSoFar(10, 0.4, True, APPENDIX_4, (0.0, 0.0, -0.5)))
    for state in (again, again.updated("document", design=APPENDIX_4.vary({"gravity": 9.0}))):
        shown = text.result_html(compute(state))
        assert "footprint" in shown
        assert text.ANOTHER in shown
        assert "Changed since" not in shown
    assert text.has_robot(again)
    assert not text.can_price(again)
    adopted = actions.open_result(again)
    assert adopted.document.design.geometry.base_radius == 0.3
    assert adopted.synthesis.running is not None
    assert text.ANOTHER not in text.result_html(compute(first))
    failed = delivered(
        actions.SEARCH, actions.start(first), Outcome(job, None, InvalidInput("a", "b"))
    )
    assert text.ANOTHER in text.result_html(compute(actions.start(failed)))


def test_robot_that_is_opened_leaves_requirements_that_were_changed_since(asked: State) -> None:
    job = actions.start(asked).synthesis.running
    assert job is not None
    found = answer(asked, 0.3, 0.4)
    state = delivered(actions.SEARCH, actions.start(asked), Outcome(job, SearchResult(found)))
    unchanged = actions.open_result(state).document.requirements
    assert unchanged == replace(asked.document.requirements, workspace=found.workspace)
    held = asked.document.requirements
    assert held.workspace is not None
    for changed in (
        replace(held, bounds=held.bounds[1:]),
        replace(held, theta=(held.theta[0], held.theta[1] + 0.1)),
        replace(held, workspace=replace(held.workspace, size=(0.011, 0.011, 0.013))),
        replace(held, workspace=None),
    ):
        meanwhile = replace(state, document=replace(state.document, requirements=changed))
        opened = actions.open_result(meanwhile).document
        assert opened.design == found.design
        assert opened.requirements.bounds == changed.bounds
        assert opened.requirements.theta == changed.theta
        kept = changed.workspace == held.workspace
        assert opened.requirements.workspace == (found.workspace if kept else changed.workspace)


@pytest.mark.slow
def test_answer_says_beside_the_reference_whether_it_can_be_built(asked: State) -> None:
    started = actions.start(asked.updated("synthesis.settings", allow_overlap=True))
    job = started.synthesis.running
    assert job is not None
    found = answer(started, 0.4, 0.4)
    found = replace(found, design=found.design.vary({"geometry.guide_link_length": 0.1}))
    state = delivered(actions.SEARCH, started, Outcome(job, SearchResult(found)))
    shown = text.result_html(compute(state))
    assert "Overlap was allowed" in shown
    marks = re.sub(r'<td class="pv-mark">.*?</td>', "", shown)
    assert_parts(marks, synthesis_blocks(found))
    table = shown[shown.index('<table class="pv-table pv-drawn" data-testid="drawn">') :]
    cells = tables_in(table)[0][1:]
    assert found.buildability is not None
    rows = buildability_table(*found.buildability).rows
    assert cells == [list(row.cells) for row in rows]
    red = re.findall(r'<td class="pv-bad-text">(.*?)</td>', html.unescape(table))
    assert red == [row.cells[1] for row in rows if row.kind == "marked"]
    told_of = {label: (own, reference) for label, own, reference in cells}
    own, reference = told_of["Guide B10"]
    assert own.startswith("100 mm, needed ")
    assert reference.startswith("363.5 mm, needed ")
    assert own in red
    assert {
        "Least clearance as drawn", "Between", "Poses that overlap", "Least horizontal stiffness",
        "Least first natural frequency", "Shaft B2", "Moving mass",
    } <= set(told_of)  # fmt: skip


def test_prices_are_of_the_answer_that_is_shown(asked: State) -> None:
    started = actions.start(asked)
    job = started.synthesis.running
    assert job is not None
    state = delivered(actions.SEARCH, started, Outcome(job, SearchResult(answer(asked, 0.3, 0.4))))
    pricing = actions.PRICES.start(state)
    price_job = pricing.synthesis.prices.running
    assert price_job is not None
    found = RequirementPrice("κ ≤ 10", "1", 10.0, 0.2, 0.42, 0.39, 0.075)
    priced = delivered(actions.PRICES, pricing, Outcome(price_job, (found,)))
    shown = text.prices_html(compute(priced))
    assert_parts(shown, price_blocks(pricing.synthesis.answer, (found,)))  # type: ignore[arg-type]
    assert "−10 mm" in shown  # relaxed
    assert "20 mm" in shown  # tightened
    again = priced.updated("synthesis", running=job)
    other = delivered(actions.SEARCH, again, Outcome(job, SearchResult(answer(asked, 0.31, 0.41))))
    assert text.prices_html(compute(other)) == ""
    with pytest.raises(InvalidInput):
        actions.PRICES.start(asked)


def test_a_search_without_an_answer_says_why_and_cannot_be_opened(asked: State) -> None:
    # No robot with R_pl < R_b can turn by 90 degrees.
    state = requirements.change(asked, theta=(-1.6, 1.6))
    state = state.updated("synthesis.settings", regimes="R_pl < R_b")
    started = actions.start(state)
    job = started.synthesis.running
    assert job is not None
    received = delivered(actions.SEARCH, started, solve(search, job))
    shown = text.result_html(compute(received))
    assert "No robot meets all requirements" in shown
    assert "is excluded" in shown
    with pytest.raises(InvalidInput, match="no robot"):
        actions.open_result(received)


def test_the_best_robot_has_one_pose_as_a_ghost_as_the_robot_and_opened(asked: State) -> None:
    """Its heading is the middle of the required ones, whether it is drawn, shown or opened."""
    theta = (0.2, 0.6)
    turned = asked.updated("document.requirements", theta=theta)
    best = BestSoFar(10, 0.4, True, APPENDIX_4, (0.01, 0.0, -0.5))
    ghost = told(actions.start(turned), best)
    (node,) = best_robot(compute(ghost))
    drawn = node.live["points"].reshape(3, 9, 2, 3)
    pose = (0.01, 0.0, 0.4, -0.5)
    expected = sticks(inverse_kinematics(APPENDIX_4.geometry, pose))
    np.testing.assert_allclose(drawn, expected.reshape(drawn.shape), atol=1e-6)
    shown = actions.previewed(ghost.updated("synthesis.settings", shown=Shown.ROBOT))
    assert shown.document.pose == pytest.approx(pose)
    assert shown.last_reachable.pose == pytest.approx(pose)


def test_nothing_follows_the_robots_of_a_preview_and_texts_say_so(asked: State) -> None:
    started = actions.start(asked.updated("synthesis.settings", shown=Shown.ROBOT))
    best = BestSoFar(10, 0.4, True, APPENDIX_4, (0.0, 0.0, -0.5))
    shown = actions.previewed(told(started, best))
    session: Any = SimpleNamespace(closed=True)
    for follower in (OF_POSE, ANALYSIS):
        runner = FollowerRunner(session, follower)
        for state, is_preview in ((shown, True), (asked, False)):
            runner.draw(compute(state, is_preview=is_preview), False)
            assert (runner.background.wanted is None) is is_preview
    preview = compute(shown, is_preview=True)
    for shown_text in (clearance_html(preview), result_html(preview)):
        assert NOT_OF_PREVIEW in shown_text


def test_the_best_so_far_takes_the_robots_place_only_while_it_is_asked_for(asked: State) -> None:
    started = actions.start(asked.updated("synthesis.settings", shown=Shown.ROBOT))
    job = started.synthesis.running
    assert job is not None
    assert actions.previewed(started) is started
    design = APPENDIX_4.vary({"geometry.base_radius": 0.4})
    best = BestSoFar(10, 0.4, True, design, (0.0, 0.0, -0.5))
    searching = told(started, best)
    shown = actions.previewed(searching)
    assert shown.document.design == design
    assert shown.last_reachable.pose == (0.0, 0.0, 0.0, -0.5)
    assert searching.document == started.document
    changed = designs.vary(searching, {"payload.mass": 1.0})
    assert actions.previewed(changed) is changed
    ghost = searching.updated("synthesis.settings", shown=Shown.GHOST)
    assert actions.previewed(ghost) is ghost
    stopped = actions.SEARCH.stop(searching)
    assert actions.previewed(stopped) is stopped
    assert actions.SEARCH.report(stopped, stopped.synthesis.ticket, 0.5, best=best) is stopped
    assert np.isnan(replace(best, cost=np.nan).cost)


@pytest.mark.slow
def test_settings_are_set_on_the_page_and_a_search_can_be_stopped(desk: Desk, asked: State) -> None:
    desk.dispatch(lambda state: replace(state, document=asked.document))
    desk.set("synthesize.seed", 3)
    desk.until(lambda: desk.state.synthesis.settings.seed == 3)
    desk.set("synthesize.geometry.base_radius", [200.0, 300.0])
    desk.until(lambda: ("geometry.base_radius", (0.2, 0.3)) in desk.state.synthesis.settings.ranges)
    desk.set("synthesize", True)
    desk.until(lambda: desk.state.synthesis.running is not None)
    desk.set("synthesize.stop", True)
    desk.until(lambda: desk.state.synthesis.running is None)
    assert not desk.notices


@pytest.mark.slow
def test_a_stopped_search_gives_the_best_robot_so_far(
    desk: Desk, asked: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solving, "PERIOD", 0.0)
    monkeypatch.setitem(cases.EFFORTS, EffortChoice.QUICK, Effort(200, 4))
    desk.dispatch(lambda state: replace(state, document=asked.document))
    desk.set("synthesize", True)
    desk.until(lambda: (best := desk.state.synthesis.best) and best.feasible)
    desk.set("synthesize.stop", True)
    desk.until(lambda: desk.state.synthesis.running is None)
    answer = desk.state.synthesis.answer
    assert answer is not None
    assert answer.canceled
    assert np.isfinite(answer.objective)
    assert "before it was stopped" in text.result_html(compute(desk.state))


def test_a_search_without_a_robot_so_far_is_stopped_at_once(asked: State) -> None:
    started = actions.start(asked)
    assert actions.stop(started).synthesis.running is None
    found = started.updated("synthesis", best=BestSoFar(feasible=True))
    tried = found.updated("synthesis", best=BestSoFar(trials=1))
    assert "1 robot tried;" in text.best_html(compute(tried))
    once = actions.stop(found)
    assert once.synthesis.running is found.synthesis.running
    assert "Stopping" in text.best_html(compute(once))
    assert actions.stop(once).synthesis.running is None
    again = actions.start(actions.stop(once))
    assert "Starting" in text.best_html(compute(again))
