"""Springs on the page: fitted in the background, next to a design that does not have them."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import spring_lengths, spring_torques
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.files.examples import EXAMPLES, open_example
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.features.springs.layers import fitted_springs, zigzags
from paminsa_viz.explorer.features.springs.tab import SPRINGS, springs_html
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.springs import SpringsFrom
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, InvalidInput, static_imbalance, static_torques
from tests.support.desk import Desk
from tests.support.samples import prototype_times
from tests.support.tasks import finished

PANEL = SPRINGS


def fitted(state: State) -> State:
    return finished(springs.FIT, springs.FIT.start(state))


@pytest.fixture
def off_center() -> State:
    """A pose at which gravity loads M1 to M3."""
    return actions.move(initial_state(), x=0.08, y=0.05, theta=np.pi / 3)


def test_example_of_springs_holds_itself_anywhere(off_center: State) -> None:
    state = open_example(off_center, "springs")
    assert state.springs.running is not None
    found = solve(springs.fit, state.springs.running).result
    assert found is not None
    (spring,) = found.springs
    # K h = M_p2 for a spring of free length zero from a mast of height h on slider 8
    assert spring.stiffness * 0.1 == pytest.approx(static_imbalance(APPENDIX_4), rel=1e-9)
    poses = np.random.default_rng(0).uniform(
        (-0.1, -0.1, -0.3, -0.6), (0.1, 0.1, 0.3, -0.5), (50, 4)
    )
    held = static_torques(APPENDIX_4, poses) + spring_torques(
        APPENDIX_4.geometry, found.springs, poses
    )
    assert np.abs(held[:, :3]).max() <= 1e-9


def test_text_compares_torques_with_and_without_springs(off_center: State) -> None:
    state = fitted(off_center)
    held = springs.relieved(state, compute(state).torques)
    assert held is not None
    np.testing.assert_allclose(held[:3], 0.0, atol=1e-9)
    text = springs_html(compute(state))
    assert "91 N/m" in text
    assert "4.570" in text
    assert "all other numbers are of the robot without them" in text  # those above are of both
    assert "Changed since" not in text
    changed = actions.vary(state, {"links.b4": 0.9})
    assert "Changed since: masses." in springs_html(compute(changed))
    higher = state.updated("springs.settings", height=0.2)
    assert "Changed since: “Height”." in springs_html(compute(higher))
    assert "Changed since: θ." in springs_html(compute(actions.move(state, theta=0.1)))
    assert "91 N/m" not in springs_html(compute(springs.FIT.forget(state)))
    small = actions.move(initial_state(prototype_times(0.1)), x=0.008, y=0.005, theta=np.pi / 3)
    small = springs_html(compute(fitted(small)))
    assert "<td>0.0004593</td>" in small  # three decimals at Appendix 4's lengths


@pytest.mark.parametrize("start", SpringsFrom)
def test_springs_are_drawn_as_long_as_they_are(start: SpringsFrom, off_center: State) -> None:
    assert not list(fitted_springs(compute(off_center)))
    hidden = actions.set_layers(off_center, springs=False)  # as in tabs that an older page kept
    state = fitted(hidden.updated("springs.settings", start=start, height=0.07))
    assert "springs" in state.layers
    spring, masts = fitted_springs(compute(state))
    drawn = spring.live["points"].reshape(3, -1, 2, 3)
    last = state.last_reachable
    found = state.springs.result
    assert found is not None
    np.testing.assert_allclose(
        np.linalg.norm(drawn[:, -1, 1] - drawn[:, 0, 0], axis=1),
        spring_lengths(last.geometry, found.springs[0], last.pose), atol=1e-6,
    )  # fmt: skip
    np.testing.assert_allclose(drawn[:, -1, 1], compute(state).configuration.points[9], atol=1e-6)
    np.testing.assert_allclose(drawn[:, 0, 0], masts.live["points"][:, 1], atol=1e-6)
    np.testing.assert_allclose(masts.live["points"][..., 2], [[0.0, 0.07]] * 3, atol=1e-6)
    upright = zigzags(np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]]), 0.04)
    assert np.ptp(upright[..., :2].reshape(-1, 2), axis=0).max() == pytest.approx(0.04)
    assert not list(fitted_springs(compute(springs.FIT.forget(state))))


def test_springs_change_nothing_else(off_center: State) -> None:
    state = fitted(off_center)
    np.testing.assert_array_equal(compute(state).torques, compute(off_center).torques)
    assert state.document == off_center.document


def test_a_post_on_the_guide_only_comes_near(off_center: State) -> None:
    state = fitted(off_center.updated("springs.settings", start=SpringsFrom.GUIDE))
    fit = state.springs.result
    assert fit is not None
    assert 0.2 * fit.before < fit.after < fit.before
    assert fit.gap < 1e-6


@pytest.mark.parametrize("changes", [{"height": 0.0}, {"least": 0.2, "most": 0.1}, {"most": 9.0}])
def test_impossible_places_are_refused(changes: dict[str, float]) -> None:
    with pytest.raises(InvalidInput, match=r"possible|end above"):
        initial_state().updated("springs.settings", **changes)


def test_fit_of_another_design_is_dropped(off_center: State) -> None:
    first = springs.FIT.start(off_center)
    assert first.springs.running is not None
    outcome = solve(springs.fit, first.springs.running)
    again = springs.FIT.start(actions.vary(first, {"links.b4": 0.9}))
    assert springs.FIT.deliver(again, first.springs.ticket, outcome) is again


def test_numbers_are_typed_in_millimeters(desk: Desk) -> None:
    desk.set("springs.height", 120.5)
    desk.until(lambda: desk.state.springs.settings.height == 0.1205)
    desk.set("springs.free", (50.0, 150.0))
    desk.until(lambda: desk.state.springs.settings.most == 0.15)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.key)
def test_examples_open_at_a_reachable_pose(example, off_center: State) -> None:
    state = open_example(fitted(off_center), example.key)
    frame = compute(state)
    assert frame.requested.ok.all()
    assert state.springs.outcome is None
    assert state.document.design.name


def test_unknown_examples_are_refused() -> None:
    with pytest.raises(InvalidInput, match="is needed"):
        open_example(initial_state(), "other")
