"""Actions on requirements: editing, suggestions, the workspace, and what is refused."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.core.requirements import current_check, default_workspace
from paminsa_viz.explorer.core.saved_requirements import MOST_REQUIREMENTS
from paminsa_viz.explorer.features.requirements import actions, suggestions
from paminsa_viz.explorer.features.requirements.actions import End, Side, selected, side_of
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, InvalidInput, home_pose
from paminsa_viz.quantities import QUANTITIES, families
from paminsa_viz.quantities.requirements import WorkspaceShape
from tests.support.samples import prototype_times


@pytest.fixture
def one() -> State:
    """One requirement, on the condition number."""
    return actions.add(initial_state())


def test_an_added_requirement_is_edited_and_a_removed_one_is_not(one: State) -> None:
    two = actions.add(one, "tau_1")
    assert [bound.quantity for bound in two.document.requirements.bounds] == ["condition", "tau_1"]
    found = selected(two)
    assert found is not None
    assert found.quantity == "tau_1"
    left = actions.remove(two)
    assert left.document.requirements == one.document.requirements
    assert selected(left) == selected(one)
    empty = actions.remove(left)
    assert selected(empty) is None
    assert empty.document.requirements.bounds == ()
    assert actions.remove(empty).document == empty.document


@pytest.mark.parametrize("side", Side)
def test_the_side_that_is_chosen_is_the_bounds_and_the_number_stays(one: State, side: Side) -> None:
    found = selected(actions.choose_side(one, side))
    assert found is not None
    assert side_of(found) is side
    assert 10.0 in (found.low, found.high)
    again = selected(actions.choose_side(actions.choose_side(one, side), Side.MOST))
    assert again is not None
    assert again.high == 10.0


def test_numbers_are_set_on_the_side_that_is_bounded(one: State) -> None:
    for side, low, high in (
        (Side.MOST, None, 7.0), (Side.LEAST, 7.0, None), (Side.SIZE, -7.0, 7.0),
    ):  # fmt: skip
        bounded = actions.choose_side(one, side)
        (bound,) = bounded.document.requirements.bounds
        (end,) = actions.ends_of(bound)
        (found,) = actions.set_bound(bounded, 0, end, 7.0).document.requirements.bounds
        assert (found.low, found.high) == (low, high)
        for other in set(actions.End) - {end}:
            assert actions.set_bound(bounded, 0, other, 7.0) is bounded
        assert actions.set_bound(bounded, 1, end, 7.0) is bounded
    with pytest.raises(InvalidInput, match="magnitude"):
        actions.set_bound(actions.choose_side(one, Side.SIZE), 0, End.SIZE, -7.0)


@pytest.mark.slow
@given(st.sampled_from(sorted(QUANTITIES)), st.sampled_from([*Side]), st.floats(0.1, 50), st.data())
def test_numbers_are_read_in_the_unit_in_which_they_are_shown(
    quantity: str, side: Side, value: float, data: st.DataObject
) -> None:
    state = actions.choose_side(actions.add(initial_state(), quantity), side)
    (bound,) = state.document.requirements.bounds
    end = data.draw(st.sampled_from([*actions.ends_of(bound)]))
    shown = value + bound.entry.display.from_si(max(actions.ends_of(bound).values()))
    if end is End.LOW and side is Side.BETWEEN:
        shown = bound.entry.display.from_si(actions.ends_of(bound)[end]) - value
    (found,) = actions.set_bound(state, 0, end, shown).document.requirements.bounds
    ends = actions.ends_of(found)
    assert found.entry.display.from_si(ends[end]) == pytest.approx(shown)
    assert {**ends, end: None} == {**actions.ends_of(bound), end: None}


OF_EACH_FAMILY = {entries[-1].key for entries in families().values()}


@pytest.mark.slow
@pytest.mark.parametrize(
    "quantity", sorted(OF_EACH_FAMILY | {"condition", "tau_1", "reach_margin"})
)
def test_suggested_bounds_are_kept_over_the_workspace(quantity: str) -> None:
    state = actions.change(initial_state(), theta=(-0.5, 0.5))
    one = suggestions.suggested(state.document, quantity)
    entry = QUANTITIES[quantity]
    workspace = default_workspace(state.document)
    design = state.document.design
    values = suggestions.sampled(design, (-0.5, 0.5), workspace, [entry])[quantity]
    margins = one.margin(values)
    known = margins[~(margins != margins)]
    assert (known >= 0).all()


def test_a_cylinder_is_sampled_up_to_its_rim() -> None:
    workspace = default_workspace(initial_state().document)
    assert workspace.shape is WorkspaceShape.CYLINDER
    heading = (0.0, 0.0)
    found = suggestions.sampled(APPENDIX_4, heading, workspace, [QUANTITIES["condition"]])
    shares = np.arange(-3, 4) ** 2
    on_disc = (shares[:, None] + shares <= 9).sum()
    assert np.isfinite(found["condition"]).sum() == on_disc * found["condition"].size // 49


def test_nothing_is_suggested_for_a_design_that_reaches_nothing() -> None:
    """Its worst torque, of no pose, was taken for 1 N m, and its margin was negative."""
    state = initial_state(APPENDIX_4.vary({"geometry.guide_stroke": 0.001}))
    with pytest.raises(InvalidInput, match="reaches nothing of the workspace"):
        actions.suggest(state)


def test_the_suggested_set_has_headings_and_a_workspace() -> None:
    state = actions.suggest(initial_state())
    requirements = state.document.requirements
    assert requirements.theta == (-actions.TURN, actions.TURN)
    assert requirements.workspace is not None
    assert len(requirements.bounds) == 4


def test_of_a_small_robot_is_asked_what_it_can_do() -> None:
    heights = []
    for size, margin in ((0.002, 2e-5), (0.05, 5e-4), (5.0, 0.05), (1.0, actions.REACH_MARGIN)):
        state = actions.suggest(initial_state(prototype_times(size)))
        workspace = state.document.requirements.workspace
        assert workspace is not None
        assert workspace.size == pytest.approx(np.multiply(size, (0.25, 0.25, 0.22)), rel=0.05)
        assert workspace.center == (0.0, 0.0, home_pose(state.document.design.geometry)[3])
        assert state.document.requirements.bounds[-1].low == margin
        check = current_check(state)
        assert check is not None
        assert check.holds
        own = actions.set_own_range(state, "z", True).document.requirements.bounds[0].z
        low, high = own or (0.0, 0.0)
        heights.append(high - low)
    assert heights == pytest.approx([4e-4, 0.01, 1.0, 0.2])


def test_shapes_keep_the_size_as_far_as_they_can() -> None:
    box = actions.choose_shape(initial_state(), WorkspaceShape.BOX)
    wide = actions.set_workspace(box, size=(0.3, 0.2, 0.1))
    cylinder = actions.choose_shape(wide, WorkspaceShape.CYLINDER).document.requirements.workspace
    assert cylinder is not None
    assert cylinder.size == (0.3, 0.3, 0.1)
    with pytest.raises(InvalidInput):
        actions.set_workspace(box, size=(0.3, 0.2, 0.0))
    assert actions.choose_shape(box, None).document.requirements.workspace is None


def test_more_requirements_than_a_page_takes_are_refused(one: State) -> None:
    full = actions.change(one, bounds=one.document.requirements.bounds * MOST_REQUIREMENTS)
    with pytest.raises(InvalidInput, match="at most"):
        actions.add(full)


def test_adding_twice_bounds_two_quantities() -> None:
    twice = actions.add(actions.add(initial_state()))
    keys = [bound.quantity for bound in twice.document.requirements.bounds]
    assert len(set(keys)) == 2


def test_requirements_begin_with_a_range_of_headings_and_keep_one_that_was_set() -> None:
    boxed = partial(actions.choose_shape, shape=WorkspaceShape.BOX)
    for begun in (actions.add, actions.suggest, boxed):
        low, high = begun(initial_state()).document.requirements.theta
        assert low < 0 < high
    one = actions.change(actions.add(initial_state()), theta=(0.0, 0.0))
    assert actions.add(one).document.requirements.theta == (0.0, 0.0)
