"""States: what actions change, the last reachable pose, undo and redo."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Health, compute
from paminsa_viz.explorer.core.history import DEPTH, PAUSE, History, Snapshot
from paminsa_viz.explorer.kit.design_numbers import GROUPS, slider
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.files.design_file import read_content, write_design
from paminsa_viz.files.design_writer import NAME_CHARACTERS
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    InvalidDesign,
    InvalidInput,
    KneeBranch,
    check_reach,
)
from paminsa_viz.model.design import CHANGED_NAME
from tests.support.documents import COORDINATE, assert_same, documents, state_at_random_pose
from tests.support.samples import random_design

PATHS = st.sampled_from(sorted(PARAMETER))


@given(seed=st.integers(0, 10**6))
def test_other_knee_mirrors_the_torques_and_twice_changes_nothing(seed: int) -> None:
    state = state_at_random_pose(seed)
    once = actions.set_knee(state, KneeBranch.UPPER)
    twice = actions.set_knee(once, KneeBranch.LOWER)
    assert twice.document.design == state.document.design
    assert twice.document.pose == pytest.approx(state.document.pose, abs=1e-15)
    assert (
        once.last_reachable.pose == once.document.pose
    )  # the mirrored pose is within reach as well
    np.testing.assert_allclose(
        compute(once).torques[:3], -compute(state).torques[:3], rtol=1e-9, atol=1e-9
    )
    assert actions.set_knee(state, KneeBranch.LOWER) is state


@pytest.mark.parametrize("before", KneeBranch, ids=lambda knee: f"from {knee.name}")
@pytest.mark.parametrize("knee", KneeBranch, ids=lambda knee: f"to {knee.name}")
def test_opened_design_decides_on_the_knee(before: KneeBranch, knee: KneeBranch) -> None:
    state = actions.set_knee(actions.move(initial_state(), x=0.03), before)
    state = actions.pin_reference(state)
    wanted = APPENDIX_4.vary({"links.b3": 0.5}).with_knee(knee)
    text = write_design(wanted)
    assert ("knee =" in text) == (knee is KneeBranch.UPPER)  # the lower knee is not written
    opened = actions.load_design(state, read_content(text.encode(), "robot.toml").design)
    assert opened.document.design == wanted
    assert opened.document.pose == actions.set_knee(state, knee).document.pose
    assert opened.document.reference == APPENDIX_4.with_knee(knee)
    assert opened.last_reachable.geometry.knee is knee


@pytest.mark.parametrize("knee", KneeBranch)
def test_home_is_within_reach(knee: KneeBranch) -> None:
    home = actions.go_home(actions.set_knee(initial_state(), knee))
    assert home.last_reachable.pose == home.document.pose
    assert compute(home).health is Health.OK


def test_opened_design_keeps_the_pose_or_goes_home_where_it_cannot() -> None:
    state = actions.move(initial_state(), x=0.1)
    heavier = APPENDIX_4.vary({"payload.mass": 2.0})
    assert actions.load_design(state, heavier).document.pose == state.document.pose
    small = random_design(np.random.default_rng(4))
    small = small.vary({"geometry.guide_stroke": 0.09, "geometry.base_radius": 0.2})
    moved = actions.load_design(actions.move(state, x=0.15, y=0.1), small)
    assert moved.document.pose[:3] == (0, 0, 0)
    assert moved.last_reachable.geometry == small.geometry


def test_values_are_reset_to_appendix_4() -> None:
    state = actions.vary(initial_state(), {"links.b3": 2.0, "geometry.guide_stroke": 0.3})
    partly = actions.reset_values(state, ("geometry.guide_stroke",))
    assert partly.document.design.geometry.guide_stroke is None
    assert partly.document.design.links.b3 == 2.0
    assert actions.reset_values(partly, ("links.b3",)).document.design == APPENDIX_4


def test_changed_design_is_renamed_unless_it_has_a_name_of_its_own() -> None:
    def name_after(name: str, **changes: float) -> str:
        state = actions.vary(actions.rename(initial_state(), name), dict(changes))
        return state.document.design.name

    change = {"links.b3": 2.0}
    assert name_after(APPENDIX_4.name, **change) == CHANGED_NAME != APPENDIX_4.name
    assert name_after(CHANGED_NAME, **change) == CHANGED_NAME
    assert name_after("mine", **change) == "mine"
    back = actions.reset_values(actions.vary(initial_state(), dict(change)), ("links.b3",))
    assert back.document.design.name == APPENDIX_4.name


@pytest.mark.parametrize("name", ["two\nlines", "bell\a", "x" * 201], ids=len)
def test_name_that_no_file_can_hold_is_refused(name: str) -> None:
    with pytest.raises(InvalidInput) as error:
        actions.rename(initial_state(), name)
    assert "name" in error.value.argument


@given(path=PATHS, factor=st.floats(1.0001, 1e300))
def test_number_beyond_any_machine_is_refused(path: str, factor: float) -> None:
    with pytest.raises(InvalidDesign):
        actions.vary(initial_state(), {path: min(PARAMETER[path].largest * factor, 1e308)})


@given(
    changes=st.dictionaries(PATHS, st.floats(0, 1e4), max_size=8),
    pose=st.tuples(*[st.floats(-1e6, 1e6)] * 4),
)
def test_every_accepted_design_has_finite_torques_at_any_pose(
    changes: dict[str, float | None], pose: tuple[float, float, float, float]
) -> None:
    try:
        state = actions.vary(initial_state(), changes)
    except InvalidDesign:
        return
    x, y, theta, z = pose
    for each in (state, actions.go_home(state), actions.move(state, x=x, y=y, theta=theta, z=z)):
        frame = compute(each)
        assert np.isfinite(frame.torques).all()
        assert frame.explanation


def test_swapping_with_the_reference_twice_changes_nothing() -> None:
    state = actions.vary(actions.pin_reference(initial_state()), {"links.b3": 2.0})
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


@given(seed=st.integers(0, 10**6), x=COORDINATE, theta=COORDINATE)
def test_last_reachable_pose_is_the_pose_wherever_it_is_reachable(
    seed: int, x: float, theta: float
) -> None:
    state = actions.move(actions.move(state_at_random_pose(seed), x=x), theta=theta)
    assert check_reach(state.last_reachable.geometry, state.last_reachable.pose).ok.all()
    reachable = check_reach(state.document.design.geometry, state.document.pose).ok.all()
    assert (state.last_reachable.pose == state.document.pose) == bool(reachable)


def test_unreachable_pose_keeps_the_last_reachable_one_until_it_is_left() -> None:
    good = actions.move(initial_state(), x=0.05, theta=0.3)
    far = actions.move(actions.move(good, x=5.0), y=0.01)
    assert far.document.pose[:2] == (5.0, 0.01)
    assert far.last_reachable is good.last_reachable
    assert compute(far).health is Health.UNREACHABLE
    back = actions.move(far, x=0.02)
    assert (
        back.last_reachable.pose == back.document.pose == (0.02, 0.01, 0.3, good.document.pose[3])
    )


def test_impossible_geometry_keeps_the_last_possible_one_and_takes_the_masses() -> None:
    good = initial_state()
    stuck = actions.vary(good, {"geometry.guide_stroke": 0.01})
    heavier = actions.vary(stuck, {"links.b4": 3.0})
    assert stuck.last_reachable is heavier.last_reachable is good.last_reachable
    assert compute(heavier).torques[3] > compute(good).torques[3]


@pytest.mark.slow
@given(steps=st.lists(documents(), min_size=2, max_size=8, unique_by=lambda d: d.pose))
def test_undo_and_redo_go_through_every_step(steps: list[Document]) -> None:
    taken = [Snapshot(step, 5.0 + number) for number, step in enumerate(steps)]
    history, current = History(), taken[-1]
    for number, (before, after) in enumerate(pairwise(taken)):
        history.record(before, after, f"control {number}", float(number))
    for back, others in ((True, taken[-2::-1]), (False, taken[1:])):
        for expected in others:
            found = history.travel(current, back=back)
            assert found is expected
            current = found
        assert history.travel(current, back=back) is None


def test_drag_is_one_step_and_a_pause_or_another_control_starts_a_new_one() -> None:
    history, start = History(), Snapshot(Document())
    at = [Snapshot(Document(pose=(0.0, 0.0, 0.0, float(i)))) for i in range(6)]
    history.record(start, at[0], "z", 0.0)
    history.record(at[0], at[1], "z", 0.9 * PAUSE)
    history.record(at[1], at[2], "z", 1.8 * PAUSE)
    assert history.past == [start]
    history.record(at[2], at[3], "z", 3 * PAUSE)
    history.record(at[3], at[4], "x", 3 * PAUSE)
    assert history.past == [start, at[2], at[3]]
    assert history.travel(at[4], back=True) is at[3]
    history.record(at[3], at[5], "x", 3.1 * PAUSE)  # after undo, a new step
    assert history.past[-1] is at[3]
    assert history.travel(at[5], back=False) is None


def test_history_is_bounded_and_has_no_step_without_a_change() -> None:
    history = History()
    history.record(Snapshot(Document()), Snapshot(Document()), "nothing", 0.0)
    assert history.past == []
    renamed = replace(Document(), design=replace(APPENDIX_4, name="mine"))
    history.record(Snapshot(Document()), Snapshot(renamed), "name", 0.0)
    assert len(history.past) == 1  # a name is a change, though equality leaves it out
    for i in range(DEPTH + 10):
        a, b = (Snapshot(Document(pose=(float(i + j), 0.0, 0.0, 0.0))) for j in (0, 1))
        history.record(a, b, str(i), 0.0)
    assert len(history.past) == DEPTH
    assert history.past[-1].document.pose[0] == DEPTH + 9


def test_changed_design_and_its_reference_have_different_names() -> None:
    own = actions.load_design(initial_state(), replace(APPENDIX_4, name="arm"))
    state = actions.pin_reference(own)
    assert state.document.design.name == "arm"  # it is the same design
    names = []
    for mass in (0.5, 0.6, 0.7):
        state = actions.pin_reference(actions.vary(state, {"joints.j7": mass}))
        names.append(state.document.design.name)
        changed = actions.vary(state, {"joints.j2": mass})
        assert changed.document.reference is not None
        assert changed.document.design.name != changed.document.reference.name
    assert names == ["arm, changed", "arm, changed 2", "arm, changed 3"]
    assert len(actions.another_name("a" * NAME_CHARACTERS)) == NAME_CHARACTERS
    same = actions.rename(actions.vary(own, {"joints.j7": 1.0}), "arm")
    pinned = actions.pin_reference(same)
    assert actions.swap_reference(pinned).document == pinned.document


def test_setting_a_number_to_what_it_is_changes_nothing() -> None:
    state = initial_state()
    for path in (p.path for group in GROUPS for p in group.parameters):
        value = state.document.design.value(path)
        entry = slider(PARAMETER[path])
        shown = entry.parse(state, entry.shown(state))
        assert entry.apply(state, shown).document == state.document
        assert entry.apply(state, value).document.design.geometry.guide_stroke is None
