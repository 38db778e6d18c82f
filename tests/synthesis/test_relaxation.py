"""Contradictory requirements: the smallest set, its irreducibility, the nearest bounds."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import CounterweightRange
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.case import InnerCase
from paminsa_viz.synthesis.masses.contradiction import inner_contradiction
from paminsa_viz.synthesis.masses.program import inner_program, solve_inner
from paminsa_viz.synthesis.masses.space import InnerInfeasible
from paminsa_viz.synthesis.volume.conflict import irreducible_set, smallest_set
from tests.synthesis.inner_cases import MASSES, WEIGHTS, case, poses


@given(st.lists(st.frozensets(st.integers(0, 5), min_size=1, max_size=4), max_size=4))
def test_sets_are_contradictory_and_irreducible(conflicts):
    def feasible(chosen: tuple[int, ...]) -> bool:
        return not any(conflict <= set(chosen) for conflict in conflicts)

    items = tuple(range(6))
    for find in (irreducible_set, smallest_set):
        found = find(items, feasible)
        assert bool(found) == bool(conflicts)
        if found:
            assert not feasible(found)
            assert all(feasible(tuple(x for x in found if x != item)) for item in found)
    if conflicts:
        assert len(smallest_set(items, feasible)) == min(map(len, conflicts))


def contradictory() -> InnerCase:
    """Return a case in which little torque needs counterweights, and a small force none."""
    return InnerCase(
        "moving_mass", (), MASSES[:2], WEIGHTS[:1],
        bounds=(
            Requirement("tau_1", high=50.0), Requirement("max_torque", high=0.01),
            Requirement("f_4", high=205.0), Requirement("f_4", low=-10.0),
        ),
    )  # fmt: skip


def test_the_two_limits_that_contradict_are_named_with_their_nearest_bounds():
    program = inner_program(APPENDIX_4, contradictory(), poses())
    found = inner_contradiction(program)
    names = [(item.requirement.quantity, item.side) for item in found.limits]
    assert names == [("max_torque", "high"), ("f_4", "high")]
    for number, nearest in enumerate(found.relax):
        assert nearest.gap <= 1e-6 * nearest.bound
        requirement = found.limits[number].requirement
        for factor, possible in ((1 + 1e-6, True), (1 - 1e-4, False)):
            bounds = tuple(
                replace(b, high=nearest.bound * factor) if b == requirement else b
                for b in contradictory().bounds
            )
            relaxed = replace(contradictory(), bounds=bounds)
            if possible:
                solve_inner(APPENDIX_4, relaxed, poses())
            else:
                with pytest.raises(InnerInfeasible):
                    solve_inner(APPENDIX_4, relaxed, poses())


def test_moved_bounds_of_masses_make_it_possible():
    light = replace(
        contradictory(), masses=(), bounds=(Requirement("max_torque", high=0.01),),
        counterweights=(CounterweightRange("b8", 8, 0.3, 0.3, 0.5),),
    )  # fmt: skip
    found = inner_contradiction(inner_program(APPENDIX_4, light, poses()))
    (moved,) = found.masses
    assert moved.side == "high"
    enough = replace(WEIGHTS[0], nearest=0.3, farthest=0.3, high=moved.needed * (1 + 1e-6))
    solve_inner(APPENDIX_4, replace(light, counterweights=(enough,)), poses())
    too_little = replace(enough, high=moved.needed * 0.99)
    with pytest.raises(InnerInfeasible):
        solve_inner(APPENDIX_4, replace(light, counterweights=(too_little,)), poses())


def test_what_can_be_met_has_no_contradiction():
    assert inner_contradiction(inner_program(APPENDIX_4, case(springs=True), poses())) is None
