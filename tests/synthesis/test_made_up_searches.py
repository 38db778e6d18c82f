"""What is made of the answers of searches, with answers in closed form in place of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.progress import Canceled, go_on
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.studies.executors import here
from paminsa_viz.synthesis import Effort, ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.proof.evidence import Evidence, Method, Verdict
from paminsa_viz.synthesis.search import case_conflict as conflicts
from paminsa_viz.synthesis.search import solve
from paminsa_viz.synthesis.search.case_conflict import CaseConflict, case_conflict
from paminsa_viz.synthesis.search.evaluation import REFUSED, Evaluator
from paminsa_viz.synthesis.search.outer import EXPLORE, RegimeState, search_round
from paminsa_viz.synthesis.search.result import outcomes_of
from paminsa_viz.synthesis.search.solve import SLACK, _Answer, _Run
from tests.synthesis.search_cases import CYLINDER

# ---------------------------------------------------------------- requirements that contradict

ITEMS = (
    Requirement("condition", high=9.0), Requirement("f_4", high=300.0),
    ObjectiveLimit("footprint", 0.5), ObjectiveLimit("moving_mass", 4.0),
)  # fmt: skip


class Asked:
    """Searches that find a robot unless some requirements are all there."""

    def __init__(self, *impossible: set[int], late: bool = False) -> None:
        self.impossible, self.late = impossible, late
        self.sets: list[frozenset[int]] = []
        self.stopped: list[bool] = []

    def __call__(
        self, case: SynthesisCase, *, workers: Any, progress: Any, relax: bool
    ) -> SimpleNamespace:
        assert not relax
        assert case.effort == Effort(7, 5)
        items = (*case.requirements.bounds, *case.limits)
        chosen = frozenset(ITEMS.index(item) for item in items)
        self.sets.append(chosen)
        feasible = not any(one <= chosen for one in self.impossible)
        for generation, cost in enumerate((2 * REFUSED, 0.5 if feasible else REFUSED), 1):
            cost = 2 * REFUSED if self.late else cost
            state = RegimeState(Regime.SMALLER, generation, history=(cost,))
            self.stopped.append(progress(generation / 2, state=state))
            if self.stopped[-1]:
                break
        return SimpleNamespace(feasible=feasible and self.late)


def conflict(
    monkeypatch: pytest.MonkeyPatch, asked: Asked, refused: Any = (), progress: Any = go_on
) -> CaseConflict | None:
    """The conflict; closed forms refuse sets with all of ``refused``, in some regimes."""

    def refusal(case: SynthesisCase, regime: Regime) -> str | None:
        chosen = {ITEMS.index(item) for item in (*case.requirements.bounds, *case.limits)}
        return next(("so it is" for r, one in refused if r is regime and one <= chosen), None)

    monkeypatch.setattr(conflicts, "synthesize", asked)
    monkeypatch.setattr(conflicts, "refusal", refusal)
    required = replace(CYLINDER.requirements, bounds=ITEMS[:2])
    case = replace(CYLINDER, requirements=required, limits=ITEMS[2:])
    return case_conflict(case, effort=Effort(7, 5), progress=progress)


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("impossible", [{1, 2}, {0}, {3}, {0, 1, 2, 3}])
def test_what_contradicts_is_found_with_each_set_asked_once(
    monkeypatch: pytest.MonkeyPatch, impossible: set[int], late: bool
) -> None:
    """Whether a robot comes up on the way, which ends a search, or is its answer."""
    asked = Asked(impossible, late=late)
    found = conflict(monkeypatch, asked)
    assert found == CaseConflict(
        tuple(ITEMS[i] for i in sorted(impossible)), False, len(asked.sets), False
    )
    assert len(set(asked.sets)) == len(asked.sets)
    assert frozenset() in asked.sets
    # a search goes on until it has a robot
    possible = [not impossible <= one and not late for one in asked.sets]
    assert asked.stopped == [stop for one in possible for stop in (False, one)]
    free = Asked(late=late)
    assert conflict(monkeypatch, free) is None
    assert free.sets == [frozenset(range(4))]


def test_what_closed_forms_refuse_in_all_regimes_is_not_searched(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    smaller, larger = Regime
    asked = Asked()
    found = conflict(monkeypatch, asked, [(smaller, {0, 3}), (larger, {0, 3}), (larger, {1})])
    assert found is not None
    assert (found.items, found.proven, found.canceled) == ((ITEMS[0], ITEMS[3]), True, False)
    assert found.searches == len(asked.sets)
    assert not any(one >= {0, 3} for one in asked.sets)
    # one in one regime alone has to be searched, and is not proven
    asked = Asked({1})
    found = conflict(monkeypatch, asked, [(larger, {1})])
    assert found is not None
    assert (found.items, found.proven) == ((ITEMS[1],), False)
    # nothing is possible: no requirement's fault
    found = conflict(monkeypatch, Asked(set()))
    assert found == CaseConflict((), False, 2, False)


@pytest.mark.parametrize(
    ("last", "items"), [(0, {0, 1, 2, 3}), (1, {0, 1, 2, 3}), (2, {0, 1, 2, 3}), (3, {1, 2, 3})]
)
def test_what_was_not_asked_any_more_stays_among_what_may_contradict(
    monkeypatch: pytest.MonkeyPatch, last: int, items: set[int]
) -> None:
    """Searches of all, of none, and without one after the other, ended by the first or a later."""
    seen: list[tuple[float, int]] = []

    def progress(done: float, *, searches: int, state: RegimeState) -> bool:
        assert state.cost >= REFUSED
        seen.append((done, searches))
        return searches == last

    asked = Asked({1, 2})
    found = conflict(monkeypatch, asked, progress=progress)
    assert found == CaseConflict(tuple(ITEMS[i] for i in sorted(items)), False, last + 1, True)
    assert len(asked.sets) == last + 1
    # told before each that is ended, and not of one that has a robot
    possible = [not {1, 2} <= one for one in asked.sets]
    parts = [(0.5, number) for number in range(last + 1)]
    parts += [(1.0, number) for number in range(last) if not possible[number]]
    assert seen == sorted(parts, key=lambda part: part[::-1])


# ---------------------------------------------------------------- an answer on finer poses

BOUNDS = (
    Requirement("condition", high=9.0), Requirement("f_4", low=10.0), Requirement("tau_1", high=4.0)
)  # fmt: skip
FINER = replace(
    CYLINDER, requirements=replace(CYLINDER.requirements, bounds=BOUNDS),
    limits=(ObjectiveLimit("footprint", 0.5),),
)  # fmt: skip


class Repairs:
    """Trials that break more on finer poses, until they are searched for with tighter bounds."""

    def __init__(self, coarse: Sequence[Any], fine: Sequence[Any], last: int) -> None:
        self.coarse, self.fine, self.last = coarse, fine, last
        self.tighter: list[tuple[float, ...]] = []

    def evaluate(self, one: Evaluator, numbers: Any) -> list[Any]:
        finer = one.density != Evaluator(FINER, one.regime).density
        turn = min(len(self.tighter), len(self.fine) - 1)
        values = np.array(self.fine[turn] if finer else self.coarse[turn], float)
        good = len(self.tighter) >= self.last
        return [SimpleNamespace(values=values, feasible=good, trial=None)]

    def searched(
        self, one: Evaluator, state: RegimeState, *_: Any, generations: int
    ) -> RegimeState:
        assert state.history == ()
        assert len(state.population) == 48
        self.tighter.append(one.tighter)
        return replace(state, history=(0.5,))


def repaired(monkeypatch: pytest.MonkeyPatch, made: Repairs, proof: Any = None) -> _Answer:
    monkeypatch.setattr(Evaluator, "evaluate", lambda one, numbers: made.evaluate(one, numbers))
    monkeypatch.setattr(solve, "search_round", made.searched)
    if proof is not None:
        own = _Run._answer
        monkeypatch.setattr(
            _Run, "_answer", lambda *given: replace(own(*given), proof=proof(len(made.tighter)))
        )
    low, high = FINER.bounds.T
    state = RegimeState(
        Regime.SMALLER, 30, 99, ((0.5,) * len(low),) * 48, tuple(0.5 * (low + high)), (0.5,), True
    )
    return _Run(FINER, here, go_on).verify(state)


def test_bounds_are_tightened_by_what_finer_poses_take_from_their_margins(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And a little more; not by what they add, nor where there is no value; never less again."""
    made = Repairs(
        coarse=[(8.0, 12.0, np.nan, 0.45), (8.0, 12.0, 3.0, 0.48)],
        fine=[(8.6, 11.5, 3.5, 0.40), (8.1, 10.0, 3.25, np.nan)],
        last=2,
    )
    answer = repaired(monkeypatch, made)
    assert answer.found.feasible
    assert made.tighter == [
        pytest.approx((SLACK * 0.6, SLACK * 0.5, 0.0, 0.0)),
        pytest.approx((SLACK * 0.6, SLACK * 2.0, SLACK * 0.25, 0.0)),
    ]


def test_a_pose_that_breaks_a_bound_in_a_proof_tightens_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Though the answer holds on all samples; what is proven, or of no bound, does not."""
    found = [
        Evidence("tau_1", Method.CLOSED_FORM, Verdict.REFUTED, -0.2, requirement=BOUNDS[2]),
        Evidence("f_4", Method.CLOSED_FORM, Verdict.UNDECIDED, -0.3, requirement=BOUNDS[1]),
        Evidence("f_4", Method.CLOSED_FORM, Verdict.REFUTED, 0.3, requirement=BOUNDS[1]),
        Evidence("singularity", Method.CLOSED_FORM, Verdict.REFUTED, -0.4),
    ]
    made = Repairs([(8.0, 12.0, 3.0, 0.4)], [(8.0, 12.0, 3.0, 0.4)], last=0)
    repaired(monkeypatch, made, lambda n: SimpleNamespace(evidence=found[n:]))
    assert made.tighter == [pytest.approx((0.0, 0.0, SLACK * 0.2, 0.0))]


@pytest.mark.parametrize(
    ("wanted", "feasible", "inner", "proven"),
    [
        (5.0, True, None, True), (None, True, None, False), (5.0, False, None, False),
        (5.0, True, SimpleNamespace(springs=()), True),
        (5.0, True, SimpleNamespace(springs=("one",)), False),
    ],
)  # fmt: skip
def test_a_proof_is_made_of_what_holds_on_finer_poses_if_it_is_wanted(
    wanted: float | None, feasible: bool, inner: Any, proven: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    space = replace(FINER.workspace, center=(0.0, 0.0, -0.6))
    trial = SimpleNamespace(inner=inner, design=FINER.reference, workspace=space)
    found = SimpleNamespace(feasible=feasible, trial=trial)
    monkeypatch.setattr(Evaluator, "evaluate", lambda *_: [found])
    monkeypatch.setattr(solve, "prove_workspace", lambda *given, **more: (given, more))
    run = _Run(FINER, here, go_on, prove=wanted)
    answer: Any = run._answer(Evaluator(FINER, Regime.SMALLER), RegimeState(Regime.SMALLER))
    required = replace(FINER.requirements, workspace=space)
    expected = ((FINER.reference, required), {"time_limit": wanted})
    assert answer.proof == (expected if proven else None)


@pytest.mark.parametrize(
    ("done", "generations", "asked"),
    [(0, 25, [10, 10, 5]), (20, 23, [3]), (25, 25, [1]), (40, 25, [1]), (0, 10, [10])],
)
def test_a_search_goes_on_in_rounds_to_its_end(
    done: int, generations: int, asked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One more generation where a state is at its end, or beyond, and is not known to be."""
    given: list[int] = []

    def one(evaluator: Evaluator, state: RegimeState, *_: Any, generations: int) -> RegimeState:
        assert evaluator.relaxed == 2
        given.append(generations)
        after = state.generation + generations
        return replace(state, generation=after, done=after >= case.effort.generations)

    monkeypatch.setattr(solve, "search_round", one)
    case = replace(CYLINDER, effort=Effort(generations, 4))
    noted: list[RegimeState] = []
    run = _Run(case, here, go_on, relaxed=2)
    state = run.search(RegimeState(Regime.SMALLER, done), noted.append)
    assert given == asked
    assert noted[-1] is state
    assert len(noted) == len(asked)
    assert run.search(state) is state


def test_states_of_regimes_that_are_not_asked_for_do_not_count() -> None:
    case = replace(CYLINDER, regimes=(Regime.LARGER,), limits=(ObjectiveLimit("footprint", 0.3),))
    found = solve.synthesize(case, states=(RegimeState(Regime.SMALLER, 3),))
    assert found.refused.keys() == {Regime.LARGER}
    assert (found.states, found.canceled, found.feasible) == ((), False, False)
    assert (found.design, found.workspace) == (case.reference, case.workspace)
    assert (found.regime, found.inner, found.proof, found.poses) == (None, None, None, 0)
    assert np.isnan(found.objective)


def test_a_bound_that_is_met_by_exactly_its_share_decides() -> None:
    """A half of a percent of 200 N is one newton, to either side."""
    required = replace(FINER.requirements, bounds=(Requirement("f_4", high=200.0),))
    case = replace(FINER, requirements=required, limits=())
    for value, active in ((198.9, False), (199.0, True), (201.0, True), (201.1, False)):
        found: Any = SimpleNamespace(values=np.array([value]))
        (outcome,) = outcomes_of(case, found)
        assert (outcome.value, outcome.active) == (value, active)
        assert outcome.margin == pytest.approx(200.0 - value)


# ---------------------------------------------------------------- a round of the search


class Costs:
    """A smooth cost with its least value within the ranges."""

    regime = Regime.LARGER

    def __init__(self, case: SynthesisCase, *, cut: bool = False, at: float = 0.3) -> None:
        self.case, self.cut, self.at = case, cut, at
        self.best: list[float] = []
        self.found: list[float] = []

    def costs(self, rows: Any, most: Any, best: float) -> list[float]:
        low, high = self.case.bounds.T
        share = (np.array(rows) - low) / (high - low)
        found = 1.0 + ((share - self.at) ** 2).sum(axis=1)
        self.best.append(best)
        self.found.append(found.min())
        if self.cut:  # as much more as it likes
            found = np.where(found <= most, found, 1e6)
        return found.tolist()


class Seen:
    """What is told of a search."""

    def __init__(self) -> None:
        self.done: list[float] = []
        self.states: list[RegimeState] = []

    def __call__(self, done: float, *, state: RegimeState) -> None:
        self.done.append(done)
        self.states.append(state)


@pytest.mark.parametrize("seed", range(3))
def test_what_a_trial_may_cost_is_told_such_that_nothing_is_lost(seed: int) -> None:
    """The search is the same if all that costs more than it may costs anything."""
    case = replace(CYLINDER, seed=seed, effort=Effort(30, 4))
    whole, cut = Costs(case), Costs(case, cut=True)
    states = [RegimeState(Regime.LARGER)] * 2
    for turn in range(2):
        start, seen = states[0].cost, Seen()
        states = [
            search_round(one, state, here, seen)  # type: ignore[arg-type]
            for one, state in zip((whole, cut), states, strict=True)
        ]
        after = states[1]
        assert states[0] == after
        # the least cost before each generation, or somewhat more in the first
        history, best = after.history[-10:], cut.best[22 * turn :]
        assert best[:2] == [start] * 2
        assert min(cut.found[22 * turn :][:2]) <= min(best[2:4]) < np.inf
        assert best[4:] == np.repeat(history[:-1], 2).tolist()
        numbers = [state.generation for state in seen.states]
        assert numbers == [*range(after.generation - 9, after.generation + 1)] * 2
        assert seen.done == pytest.approx([n / 30 for n in numbers])
        assert [state.cost for state in seen.states[10:]] == list(history)
    assert after.generation == len(after.history) == 20
    assert after.trials == 2 * 11 * 32  # the next power of two above 4 for each of six numbers
    low, high = case.bounds.T
    share = (np.array(after.best) - low) / (high - low)
    assert after.cost == pytest.approx(1.0 + ((share - 0.3) ** 2).sum())
    assert share == pytest.approx(after.population[int(np.argmin(energies(after)))])


def energies(state: RegimeState) -> np.ndarray:
    return ((np.array(state.population) - 0.3) ** 2).sum(axis=1)


@pytest.mark.parametrize(("at", "end"), [(1.4, 1), (-0.4, 0)])
def test_no_trial_is_beyond_the_ranges(at: float, end: int) -> None:
    """Though it would cost less."""
    case = replace(CYLINDER, effort=Effort(30, 4))
    evaluator: Any = Costs(case, at=at)
    state = search_round(evaluator, RegimeState(Regime.LARGER), generations=20)
    rows, best = np.array(state.population), np.array(state.best)
    assert ((rows >= 0.0) & (rows <= 1.0)).all()
    low, high = case.bounds.T
    assert ((best >= low) & (best <= high)).all()
    share = (best - low) / (high - low)
    assert np.abs(share - end).max() < 0.35


def test_trials_are_made_from_the_best_in_the_last_part_of_a_search(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[str] = []

    def evolution(*_: Any, strategy: str, **more: Any) -> None:
        given.append(strategy)
        raise Canceled

    monkeypatch.setattr("scipy.optimize.differential_evolution", evolution)
    case = replace(CYLINDER, effort=Effort(50, 4))
    evaluator: Any = Costs(case)
    turn = round(EXPLORE * 50)
    for generation in (0, turn - 1, turn, 49):
        with pytest.raises(Canceled):
            search_round(evaluator, RegimeState(Regime.LARGER, generation))
    assert ["best" in one for one in given] == [False, False, True, True]


def test_a_search_that_goes_on_beyond_its_end_is_done() -> None:
    """As repairs do; all that is left is then nothing."""
    case = replace(CYLINDER, effort=Effort(5, 4))
    evaluator: Any = Costs(case)
    seen = Seen()
    after = search_round(evaluator, RegimeState(Regime.LARGER, 4), here, seen, generations=3)
    assert seen.done == [1.0] * 3
    assert after.done
    assert after.generation == 7


def test_trials_are_handed_out_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []

    class Counted:
        def in_order(self, call: Any, parts: Iterable[Any]) -> Iterable[Any]:
            for part in parts:
                sizes.append(len(part[0]))
                assert len(part[1]) == len(part[0])
                yield call(part)

    case = replace(CYLINDER, effort=Effort(5, 9))
    evaluator, workers = Costs(case), Counted()
    search_round(evaluator, RegimeState(Regime.LARGER), workers, generations=1)  # type: ignore
    trials = 64  # the next power of two above 9 for each of six numbers
    assert sum(sizes) == 2 * trials
    assert max(sizes) < trials
