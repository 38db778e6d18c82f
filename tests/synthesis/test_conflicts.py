"""Contradictory requirements of volumes, masses and cases: smallest sets, nearest bounds."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import CounterweightRange
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.progress import go_on
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Effort, ObjectiveLimit, Regime, SynthesisCase, synthesize
from paminsa_viz.synthesis.masses.case import InnerCase
from paminsa_viz.synthesis.masses.program import inner_contradiction, inner_program, solve_inner
from paminsa_viz.synthesis.masses.space import InnerInfeasible
from paminsa_viz.synthesis.search.case_conflict import CaseConflict, case_conflict
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.conflict import irreducible_set, smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE
from paminsa_viz.synthesis.volume.solve import solve_volume
from tests.synthesis.inner_cases import MASSES, WEIGHTS, case, poses
from tests.synthesis.robots import needs
from tests.synthesis.search_cases import CYLINDER
from tests.synthesis.test_front import two_numbers


def conflict_of(*texts: str, workspace: Workspace | None = None):  # type: ignore[no-untyped-def]
    volume = solve_volume(APPENDIX_4, needs(*texts), resolution=COARSE)
    return volume, smallest_conflict(volume, workspace)


def test_no_conflict_where_a_volume_is_left() -> None:
    assert conflict_of("condition <= 10", "max_torque <= 15")[1] is None
    assert conflict_of()[1] is None


def test_two_bounds_of_one_quantity_contradict_and_the_others_are_not_named() -> None:
    volume, found = conflict_of(
        "f_4 <= 450", "condition <= 5", "max_torque <= 50", "condition >= 7"
    )
    assert volume.empty
    assert found.requirements == (1, 3)
    # the nearest: somewhere kappa's least and largest over the headings are closest
    least = 7.0 + volume.margins[3]
    largest = 5.0 - volume.margins[1]
    down, up = found.relaxations
    assert down.by == pytest.approx(np.nanmin(np.where(least >= 7.0, largest, np.nan)) - 5.0)
    assert down.relaxed.high == pytest.approx(5.0 + down.by)
    assert up.relaxed.low == pytest.approx(7.0 - up.by)


def test_one_impossible_bound_is_a_conflict_of_its_own() -> None:
    _, found = conflict_of("condition <= 1.2", "max_torque <= 15")
    assert found.requirements == (0,)
    assert found.relaxations[0].relaxed.high == pytest.approx(np.sqrt(2.0))
    assert found.relaxations[0].center[:2] == pytest.approx((0.0, 0.0))


@pytest.mark.parametrize(
    "texts",
    [("condition <= 1.3", "f_4 <= 450"), ("max_torque <= 0.5", "condition >= 4", "f_4 <= 450")],
)
def test_relaxed_requirement_leaves_something(texts: tuple[str, ...]) -> None:
    volume, found = conflict_of(*texts)
    assert found is not None
    for relaxation in found.relaxations:
        assert relaxation.by > 0.0
        bounds = list(volume.requirements.bounds)
        for share, empty in ((1.0 + 1e-9, False), (0.99, True)):
            moved = relaxation.by * share
            bound = volume.requirements.bounds[relaxation.requirement]
            bounds[relaxation.requirement] = replace(
                bound,
                low=None if bound.low is None else bound.low - moved,
                high=None if bound.high is None else bound.high + moved,
            )
            requirements = Requirements(tuple(bounds), volume.requirements.theta)
            assert solve_volume(APPENDIX_4, requirements, resolution=COARSE).empty is empty


def test_side_of_a_two_sided_bound_that_breaks_is_moved() -> None:
    _, found = conflict_of("1 <= condition <= 1.2")
    assert found.relaxations[0].relaxed.low == 1.0
    assert found.relaxations[0].relaxed.high == pytest.approx(np.sqrt(2.0))
    _, found = conflict_of("|tau_1| <= 0.0001", "condition >= 4")
    relaxed = found.relaxations[0].relaxed
    assert relaxed.low == -relaxed.high


def test_nothing_to_reach_is_no_requirement_s_fault() -> None:
    wide = needs("condition <= 10", theta=(-1.5, 1.5))
    found = smallest_conflict(solve_volume(APPENDIX_4, wide, resolution=COARSE))
    assert found is not None
    assert found.requirements == ()


def test_workspace_that_does_not_fit_names_what_keeps_it_out() -> None:
    wide = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.2), (None, None, None))
    volume, found = conflict_of("condition <= 3", "f_4 <= 450", workspace=wide)
    assert not volume.empty
    assert found.requirements == (0,)
    relaxed = (found.relaxations[0].relaxed, volume.requirements.bounds[1])
    eased = Requirements(relaxed, volume.requirements.theta)
    center = found.relaxations[0].center
    # nodes lie within the cylinder, samples up to its boundary: the check needs a little more
    eased = replace(eased, bounds=(replace(relaxed[0], high=1.4 * relaxed[0].high), relaxed[1]))
    placed = replace(eased, workspace=replace(wide, center=center))
    assert check_requirements(APPENDIX_4, placed).holds


def test_workspace_larger_than_the_reach() -> None:
    huge = Workspace(WorkspaceShape.BOX, (0.9, 0.9, 0.9), (0.0, 0.0, None))
    assert conflict_of("condition <= 10", workspace=huge)[1].requirements == ()


def test_the_fewest_are_found_among_many() -> None:
    loose = [f"f_4 <= {500 + index}" for index in range(9)]
    _, found = conflict_of("condition <= 5", *loose, "condition >= 7")
    assert found.requirements == (0, 10)


@pytest.mark.slow
@given(st.lists(st.frozensets(st.integers(0, 5), min_size=1, max_size=4), max_size=4))
def test_sets_are_contradictory_and_irreducible(conflicts):
    def feasible(chosen: tuple[int, ...]) -> bool:
        return not any(conflict <= set(chosen) for conflict in conflicts)

    items = tuple(range(6))
    for few in (0, 6):
        found = irreducible_set(items, feasible, few)
        assert bool(found) == bool(conflicts)
        if found:
            assert not feasible(found)
            assert all(feasible(tuple(x for x in found if x != item)) for item in found)
    if conflicts:
        assert len(irreducible_set(items, feasible, 6)) == min(map(len, conflicts))
    # where not even none of them can be met, none of them is to blame
    assert irreducible_set(items[:1], lambda chosen: False) == ()


def contradictory() -> InnerCase:
    """Return a case in which little torque needs counterweights, and a small force none."""
    return InnerCase(
        "moving_mass", (), MASSES[:2], WEIGHTS[:1],
        bounds=(
            Requirement("tau_1", high=50.0), Requirement("max_torque", high=0.01),
            Requirement("f_4", high=205.0), Requirement("f_4", low=-10.0),
        ),
    )  # fmt: skip


@pytest.mark.slow
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


QUICK = Effort(20, 6)


@pytest.mark.slow
def test_the_limits_that_contradict_are_named_and_no_others():
    case = two_numbers()
    volume = ObjectiveLimit("volume", np.pi * 0.1**2 * 0.35)
    least = synthesize(replace(case, limits=(volume,))).objective
    mass = ObjectiveLimit("moving_mass", least - 0.2)
    footprint = ObjectiveLimit("footprint", 5.0)
    case = replace(case, limits=(footprint, mass, volume))
    found = case_conflict(case, effort=QUICK)
    assert found is not None
    assert found.items == (mass, volume)
    assert not found.proven
    assert not found.canceled
    # what is named contradicts, and each of it alone does not
    assert case_conflict(replace(case, limits=(footprint, volume)), effort=QUICK) is None
    assert case_conflict(replace(case, limits=(footprint, mass)), effort=QUICK) is None


def test_what_closed_forms_refuse_is_proven():
    small = replace(
        CYLINDER, limits=(ObjectiveLimit("moving_mass", 1e3), ObjectiveLimit("footprint", 0.3))
    )
    found = case_conflict(small, effort=Effort(40, 8))
    assert found is not None
    assert [item.objective for item in found.items] == ["footprint"]
    assert found.proven


@pytest.mark.slow
def test_a_workspace_out_of_reach_needs_no_requirement():
    case = two_numbers()
    workspace = replace(case.workspace, center=(0.0, 0.0, -3.0))
    far = replace(case, requirements=replace(case.requirements, workspace=workspace))
    found = case_conflict(far, effort=QUICK)
    assert found is not None
    assert found.items == ()


@pytest.mark.slow
def test_it_can_be_canceled():
    case = replace(
        two_numbers(), limits=(ObjectiveLimit("moving_mass", 1.0),),
    )  # fmt: skip
    bounds = (Requirement("condition", high=30.0), Requirement("f_4", high=1e4))
    case = replace(case, requirements=replace(case.requirements, bounds=bounds))
    found = case_conflict(case, effort=QUICK, progress=lambda done, searches, state: searches >= 2)
    assert found is not None
    assert found.canceled


BOUNDS = (Requirement("condition", high=30.0), Requirement("f_4", high=1e4))
LIMITS = (
    ObjectiveLimit("moving_mass", 1.0), ObjectiveLimit("footprint", 5.0),
    ObjectiveLimit("static_torque", 9.0),
)  # fmt: skip


class Scripted:
    """Searches and closed forms of a case that some of its items, by their places, contradict."""

    def __init__(self, conflict: set[int] | None, refused: set[Any] = frozenset()) -> None:  # type: ignore[assignment]
        plain = two_numbers()
        requirements = replace(plain.requirements, bounds=BOUNDS)
        self.case = replace(plain, requirements=requirements, limits=LIMITS, regimes=tuple(Regime))
        self.conflict, self.refused_in, self.asked = conflict, refused, []  # type: ignore[var-annotated]
        self.workers: Any = object()

    def places(self, case: SynthesisCase) -> set[int]:
        kept = (*case.requirements.bounds, *case.limits)
        assert [item for item in (*BOUNDS, *LIMITS) if item in kept] == list(kept)
        return {place for place, item in enumerate((*BOUNDS, *LIMITS)) if item in kept}

    def contradicts(self, case: SynthesisCase) -> bool:
        return self.conflict is not None and self.conflict <= self.places(case)

    def refusal(self, case: SynthesisCase, regime: Regime) -> str:
        return "none is left" if regime in self.refused_in and self.contradicts(case) else ""

    def synthesize(self, case: SynthesisCase, *, workers: Any, progress: Any, relax: bool) -> Any:
        assert (case.effort, case.allow_overlap, relax) == (QUICK, True, False)
        assert workers is self.workers
        self.asked.append(self.places(case))
        state = SimpleNamespace(feasible=not self.contradicts(case))
        for done in (0.25, 0.5):
            if progress(done, state=state, others=1):
                return SimpleNamespace(feasible=False)
        return SimpleNamespace(feasible=False)

    def run(self, monkeypatch: pytest.MonkeyPatch, progress: Any = go_on) -> CaseConflict | None:
        for name in ("refusal", "synthesize"):
            monkeypatch.setitem(case_conflict.__globals__, name, getattr(self, name))
        return case_conflict(self.case, effort=QUICK, workers=self.workers, progress=progress)


@pytest.mark.parametrize("conflict", [{0}, {1, 3}, {0, 2, 4}, {0, 1, 2, 3, 4}, {4}], ids=str)
def test_bounds_and_limits_are_named_that_contradict_and_each_set_is_searched_once(
    conflict: set[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    for refused, proven in ((set(), False), ({Regime.SMALLER}, False), (set(Regime), True)):
        script = Scripted(conflict, refused)
        found = script.run(monkeypatch)
        assert found is not None
        assert found.items == tuple((*BOUNDS, *LIMITS)[place] for place in sorted(conflict))
        assert (found.proven, found.canceled) == (proven, False)
        assert found.searches == len(script.asked)
        assert all(script.asked.count(chosen) == 1 for chosen in script.asked)
        assert not proven or not any(conflict <= chosen for chosen in script.asked)


def test_nothing_is_named_where_all_can_be_met_or_not_even_the_workspace(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert Scripted(None).run(monkeypatch) is None
    found = Scripted(set()).run(monkeypatch)
    assert found is not None
    assert (found.items, found.searches) == ((), 2)


@pytest.mark.parametrize("last", [0, 1, 3])
def test_where_a_search_is_canceled_what_is_left_is_named(
    last: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None further is searched; of the first search nothing is known of any."""
    script, told = Scripted({1, 3}), []

    def progress(done: float, *, searches: int, state: Any) -> bool:
        assert not state.feasible  # a search that has found one goes on to the next
        told.append((done, searches))
        return searches >= last and done == 0.5

    found = script.run(monkeypatch, progress)
    assert found is not None
    assert found.canceled
    assert found.searches == len(script.asked) == told[-1][1] + 1
    assert {BOUNDS[1], LIMITS[1]} <= set(found.items)
    if last == 0:
        assert found.items == (*BOUNDS, *LIMITS)
