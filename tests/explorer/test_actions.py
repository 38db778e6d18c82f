"""Actions: pure functions from a state to the next."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Health, compute
from paminsa_viz.explorer.panels.file_panel import uploaded_design
from paminsa_viz.explorer.state import Document, initial_state
from paminsa_viz.files.design_file import write_design
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    InvalidDesign,
    InvalidInput,
    KneeBranch,
)
from tests.support.documents import assert_same, standing_state
from tests.support.samples import random_design


@given(seed=st.integers(0, 10**6))
def test_changing_the_knee_twice_changes_nothing_and_once_turns_the_torques_round(
    seed: int,
) -> None:
    state = standing_state(seed)
    once = actions.set_knee(state, KneeBranch.UPPER)
    twice = actions.set_knee(once, KneeBranch.LOWER)
    assert twice.document.design.geometry.knee is state.document.design.geometry.knee
    assert twice.document.pose == pytest.approx(state.document.pose, abs=1e-15)
    assert once.standing.pose == once.document.pose  # the mirrored pose is within reach as well
    np.testing.assert_allclose(
        compute(once).torques[:3], -compute(state).torques[:3], rtol=1e-9, atol=1e-9
    )
    assert actions.set_knee(state, KneeBranch.LOWER) is state


def test_a_design_with_the_other_knee_turns_the_machine_over() -> None:
    state = actions.pin_reference(actions.move(initial_state(), x=0.03))
    upper = APPENDIX_4.vary({"links.b3": 0.5}).with_knee(KneeBranch.UPPER)
    loaded = actions.load_design(state, upper).document
    assert (loaded.design, loaded.pose) == (
        upper,
        actions.set_knee(state, KneeBranch.UPPER).document.pose,
    )
    assert loaded.reference == APPENDIX_4.with_knee(KneeBranch.UPPER)


@pytest.mark.parametrize("knee", KneeBranch, ids=lambda knee: knee.name)
def test_an_opened_file_decides_on_the_knee_whatever_it_was(knee: KneeBranch) -> None:
    state = actions.pin_reference(actions.set_knee(initial_state(), KneeBranch.UPPER))
    text = write_design(APPENDIX_4.with_knee(knee))
    assert ("knee =" in text) == (knee is KneeBranch.UPPER)  # the lower knee is not written
    opened = actions.load_design(state, uploaded_design("robot.toml", text.encode()))
    assert opened.document.design == APPENDIX_4.with_knee(knee)
    assert opened.document.reference == APPENDIX_4.with_knee(knee)
    assert opened.standing.geometry.knee is knee


def test_home_is_within_reach_with_both_knees() -> None:
    for knee in KneeBranch:
        home = actions.go_home(actions.set_knee(initial_state(), knee))
        assert home.standing.pose == home.document.pose
        assert compute(home).health is Health.OK


def test_another_design_keeps_the_pose_if_it_can_and_goes_home_if_not() -> None:
    state = actions.move(initial_state(), x=0.1)
    heavier = APPENDIX_4.vary({"payload.mass": 2.0})
    assert actions.load_design(state, heavier).document.pose == state.document.pose
    rng = np.random.default_rng(4)
    small = random_design(rng).vary({"geometry.guide_stroke": 0.09, "geometry.base_radius": 0.2})
    moved = actions.load_design(actions.move(state, x=0.15, y=0.1), small)
    assert moved.document.pose[:3] == (0, 0, 0)
    assert moved.standing.geometry == small.geometry


def test_values_reset_to_appendix_4_and_the_stroke_follows_its_guide_again() -> None:
    state = actions.vary(initial_state(), {"links.b3": 2.0, "geometry.guide_stroke": 0.3})
    partly = actions.reset_values(state, ("geometry.guide_stroke",))
    assert partly.document.design.geometry.guide_stroke is None
    assert partly.document.design.links.b3 == 2.0
    assert actions.reset_values(partly, ("links.b3",)).document.design == APPENDIX_4


def test_a_changed_design_is_not_called_appendix_4() -> None:
    changed = actions.vary(initial_state(), {"links.b3": 2.0})
    assert changed.document.design.name == actions.CHANGED_NAME != APPENDIX_4.name
    assert actions.vary(changed, {"links.b4": 2.0}).document.design.name == actions.CHANGED_NAME
    back = actions.reset_values(changed, ("links.b3",))
    assert back.document.design.name == APPENDIX_4.name
    mine = actions.vary(actions.rename(initial_state(), "mine"), {"links.b3": 2.0})
    assert mine.document.design.name == "mine"


def test_a_name_that_no_file_can_hold_is_refused() -> None:
    for name in ("two\nlines", "bell\a", "x" * 201):
        with pytest.raises(InvalidInput, match="name"):
            actions.rename(initial_state(), name)


@given(path=st.sampled_from([p.path for p in PARAMETERS]), factor=st.floats(1.0001, 1e300))
def test_no_number_beyond_any_machine_is_taken(path: str, factor: float) -> None:
    state = initial_state()
    huge = min(PARAMETER[path].largest * factor, 1e308)
    with pytest.raises(InvalidDesign):
        actions.vary(state, {path: huge})


@given(
    changes=st.dictionaries(
        st.sampled_from([p.path for p in PARAMETERS]), st.floats(0, 1e4), max_size=8
    ),
    pose=st.tuples(*[st.floats(-1e6, 1e6)] * 4),
)
def test_every_size_that_is_taken_can_be_drawn(
    changes: dict[str, float | None], pose: tuple[float, float, float, float]
) -> None:
    state = initial_state()
    try:
        state = actions.vary(state, changes)
    except InvalidDesign:
        return
    x, y, theta, z = pose
    for asked in (state, actions.go_home(state), actions.move(state, x=x, y=y, theta=theta, z=z)):
        frame = compute(asked)
        assert np.isfinite(frame.torques).all()
        assert frame.explanation


def test_swapping_with_the_reference_twice_changes_nothing() -> None:
    state = actions.pin_reference(initial_state())
    state = actions.vary(state, {"links.b3": 2.0})
    once = actions.swap_reference(state)
    assert once.document.design == APPENDIX_4
    assert once.document.reference == state.document.design
    assert_same(actions.swap_reference(once).document, state.document)
    plain = initial_state()
    assert actions.swap_reference(plain) is plain


def test_without_a_reference_maps_show_no_difference() -> None:
    state = actions.pin_reference(initial_state()).updated("map_view", difference=True)
    assert not actions.unpin_reference(state).map_view.difference
    assert not actions.restore(state, Document()).map_view.difference
    assert actions.restore(state, Document(reference=APPENDIX_4)).map_view.difference
