"""The tab of accuracy, errors by manufacture: tolerances, shares, random robots, unequal legs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import viser

from paminsa_viz.blocks.accuracy import LEAST_SHARE
from paminsa_viz.explorer.core import actions, persistence
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.accuracy import manufacture as panel
from paminsa_viz.explorer.features.accuracy import monte_carlo as robots
from paminsa_viz.explorer.features.accuracy.monte_carlo import draw_robots
from paminsa_viz.explorer.kit.inputs import Number
from paminsa_viz.explorer.state.monte_carlo import NAMES
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, singular_rotation
from paminsa_viz.model.accuracy import NO_DEVIATIONS, NO_TOLERANCES, Tolerances
from paminsa_viz.precision.manufacture import manufactured_pose, monte_carlo, tolerance_errors
from paminsa_viz.units import ARCSEC, number
from tests.explorer.kit.test_inputs import inputs_in
from tests.support.desk import desk_with
from tests.support.tasks import delivered

POSE = (0.05, 0.0, 0.3, -0.5)


@pytest.fixture(scope="module")
def moved() -> State:
    x, y, theta, z = POSE
    return actions.move(initial_state(), x=x, y=y, theta=theta, z=z)


def deviation() -> Number:
    entry = next(e for e in inputs_in(panel.MANUFACTURE) if e.key == "manufacture.deviation")
    assert isinstance(entry, Number)
    return entry


def test_errors_by_tolerances_are_listed_with_the_tilt(moved: State) -> None:
    text = panel.tolerances_html(compute(moved))
    found = tolerance_errors(APPENDIX_4, POSE)
    assert f">{1e6 * found.worst[3]:.0f}</button></b>" in text
    assert f">{np.degrees(found.tilt) * 3600:.0f}</button></b>" in text
    assert text.count("<tr>") == 9


def test_bars_are_the_shares_of_the_chosen_coordinate(moved: State) -> None:
    shares = tolerance_errors(APPENDIX_4, POSE).shares
    for index, name in enumerate(NAMES):
        text = panel.shares_html(compute(moved.updated("monte_carlo.settings", coordinate=index)))
        assert f"{100 * shares[index].max():.1f} %" in text.partition("</tr>")[0]
        assert text.count("<tr") == (shares[index] >= LEAST_SHARE).sum()
        assert name in text
    exact = actions.change_design(moved, tolerances=NO_TOLERANCES)
    assert "No tolerance has a part" in panel.shares_html(compute(exact))


def test_a_singular_pose_has_no_numbers() -> None:
    angle = singular_rotation(APPENDIX_4.geometry)
    state = actions.move(initial_state(), theta=angle, z=-0.3)
    assert "the pose is singular, or" in panel.tolerances_html(compute(state))


def test_random_robots_come_from_the_seed_and_go_stale(moved: State) -> None:
    started = robots.DRAW.start(moved.updated("monte_carlo.settings", robots=300, seed=7))
    job = started.monte_carlo.running
    assert job is not None
    done = delivered(robots.DRAW, started, solve(draw_robots, job))
    expected = monte_carlo(APPENDIX_4, POSE, robots=300, seed=7)
    outcome = done.monte_carlo.outcome
    assert outcome is not None
    assert outcome.result is not None
    np.testing.assert_array_equal(outcome.result.errors, expected.errors)
    text = robots.monte_carlo_html(compute(done))
    assert "300 robots, seed 7" in text
    assert "Changed since" not in text
    heavier = actions.vary(done, {"links.b3": 1.0})
    assert "Changed since" not in robots.monte_carlo_html(compute(heavier))
    for changed in (
        actions.move(done, x=0.02),
        actions.vary(done, {"tolerances.bar": 1e-5}),
        actions.vary(done, {"leg2.shaft": 1e-5}),
    ):
        assert "Changed since" in robots.monte_carlo_html(compute(changed))


def test_a_job_reports_progress_and_can_be_stopped(moved: State) -> None:
    job = robots.DRAW.start(moved).monte_carlo.running
    assert job is not None
    parts: list[float] = []

    def stop_at_once(done: float) -> bool:
        parts.append(done)
        return True

    outcome = solve(draw_robots, replace(job, robots=5000), stop_at_once)
    assert len(parts) == 1
    assert 0 < parts[0] < 1
    assert outcome.result is not None
    assert outcome.result.canceled


def test_too_many_robots_are_a_problem_and_no_failure(moved: State) -> None:
    job = robots.DRAW.start(moved).monte_carlo.running
    assert job is not None
    outcome = solve(draw_robots, replace(job, robots=10**8))
    assert "Robots" in outcome.problem
    shown = moved.updated("monte_carlo", outcome=outcome)
    assert "Robots" in robots.monte_carlo_html(compute(shown))


def test_a_deviation_is_set_in_its_unit_saved_and_tilts_the_platform(moved: State) -> None:
    assert "All legs have" in panel.legs_html(compute(moved))
    entry = deviation()
    state = entry.apply(moved.updated("monte_carlo.settings", leg=1, length=6), 0.2)  # shaft, mm
    state = entry.apply(
        state.updated("monte_carlo.settings", leg=2, length=10), 0.05
    )  # axis angle, degrees
    design = state.document.design
    assert design.leg2.shaft == pytest.approx(2e-4)
    assert design.leg3.axis_angle == pytest.approx(np.radians(0.05))
    assert entry.shown(state) == 0.05
    assert persistence.load(persistence.dump(state.document)).design == design
    found, text = manufactured_pose(design, POSE), panel.legs_html(compute(state))
    assert f"tilt about x {number(ARCSEC * found.tilt[0], 3)}″" in text
    assert (
        panel._leg_choices(state)["All legs alike"](state).document.design.deviations
        == NO_DEVIATIONS
    )


@pytest.mark.slow
def test_legs_that_cannot_close_say_so(moved: State) -> None:
    state = deviation().apply(moved.updated("monte_carlo.settings", leg=0, length=5), 900.0)
    assert "have no position: the bars" in panel.legs_html(compute(state))


def test_buttons_set_all_tolerances(moved: State) -> None:
    assert set(panel._tolerance_choices(moved)) == {"None"}
    none = panel._tolerance_choices(moved)["None"]
    assert callable(none)
    exact = none(moved)
    assert exact.document.design.tolerances == NO_TOLERANCES
    assert set(panel._tolerance_choices(exact)) == {"Default"}
    assert Tolerances() == moved.document.design.tolerances


def test_the_button_draws_robots_on_the_page(server: viser.ViserServer) -> None:
    with desk_with(server, panel.MANUFACTURE) as desk:
        desk.dispatch(lambda s: s.updated("monte_carlo.settings", robots=50))
        desk.dispatch(robots.DRAW.start)
        desk.until(lambda: desk.state.monte_carlo.outcome is not None)
        assert desk.state.monte_carlo.running is None
        desk.until(lambda: "50 robots" in desk.handle("manufacture.found").content)


def test_too_many_robots_are_refused_in_one_line(server: viser.ViserServer) -> None:
    with desk_with(server, panel.MANUFACTURE) as desk:
        desk.dispatch(lambda s: s.updated("monte_carlo.settings", robots=50))
        desk.set("manufacture.robots", 1e9)
        desk.noticed("Robots: 1 to 200000 is possible, not 1e+09")
        assert desk.state.monte_carlo.settings.robots == 50
