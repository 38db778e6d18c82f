"""The search for an excitation: how motions are drawn, shrunk and improved, and when it ends."""

from __future__ import annotations

import contextlib
import time
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from paminsa_viz.identification import (
    ExcitationSettings,
    NoExcitation,
    excitation,
    excitation_search,
    optimize_excitation,
)
from paminsa_viz.identification.excitation import amplitudes
from paminsa_viz.identification.excitation_search import (
    BEYOND,
    GROUP,
    MOST_OUTSIDE,
    ROUNDING,
    STAGES,
    TOLERANCE,
    Search,
    _Outside,
    random_motions,
    shrunk,
)
from paminsa_viz.identification.information import (
    LIMITED,
    Evaluation,
    Information,
)
from paminsa_viz.identification.multi_sine import MultiSineFamily
from paminsa_viz.model import Friction, backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import WorkClock
from paminsa_viz.model.reach import workspace_height
from paminsa_viz.progress import Canceled, go_on
from paminsa_viz.trajectory import preset_center
from tests.identification.test_excitation import PERIOD, ROBOT, information, limits_of, some_motion
from tests.support.documentation import missing


@pytest.mark.slow
def test_search_is_reproducible_by_its_seed() -> None:
    def poses(seed: int):
        settings = ExcitationSettings(
            period=PERIOD, evaluations=6, random=3, seconds=1e4, seed=seed
        )
        return optimize_excitation(ROBOT, limits_of(ROBOT), settings).plan.sample(50.0).pose

    backend.compile_now()  # kernels that are loaded between the two round otherwise
    first, again, other = (poses(seed) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_search_can_be_stopped_and_reports() -> None:
    shares: list[float] = []

    def progress(share: float) -> bool:
        shares.append(share)
        return len(shares) == 3

    began = time.monotonic()
    found = optimize_excitation(
        ROBOT, limits_of(ROBOT), ExcitationSettings(random=12), progress=progress
    )
    assert 0.0 < found.seconds <= time.monotonic() - began
    assert len(shares) == 3
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] < 0.5  # of a minute
    assert found.gain >= 0.0
    assert found.plan.duration == 20.0


def test_a_stage_brings_back_the_best_allowed_motion_and_its_worth() -> None:
    info = information(samples=64)
    start = 0.05 * some_motion(info)
    search = Search(info, ExcitationSettings(period=PERIOD, random=1), WorkClock(), go_on)
    assert not info.sharp  # of a step there is no slope
    worth, best = search._improve(start, 20.0, 3)
    assert worth > info.evaluate(start, 20.0).value + 1.0
    assert (worth, best.tolist()) == (search.best_value, search.best.tolist())
    assert worth == pytest.approx(info.evaluate(best, 20.0).value)
    assert info.evaluate(best, 20.0).worst >= -TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("evaluations", [20, 300])
def test_the_last_motion_of_a_stage_counts_even_beyond_the_limits(
    evaluations: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the budget ends the stage, too; nothing else is kept here."""
    monkeypatch.setattr(excitation_search, "TOLERANCE", -np.inf)
    info = information(ROBOT)
    start = 0.5 * random_motions(info, 3, 1)[0]
    settings = ExcitationSettings(period=PERIOD, evaluations=evaluations, seconds=1e4)
    search = Search(info, settings, WorkClock(), go_on)
    with contextlib.suppress(Canceled):
        search._improve(start, 20.0, 10)
    assert search.best_value == pytest.approx(float(info.log_det(search.best)))
    assert search.best_value > float(info.log_det(start)) + 5.0
    assert info.worst_room(search.best) >= 0.0


def test_a_stage_that_leaves_the_workspace_is_tried_again_within_a_quarter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Down to 0.02 at least; each stage begins as if no step had been outside."""
    info = information(samples=64)
    start, seen = some_motion(info), []
    search = Search(info, ExcitationSettings(period=PERIOD, random=1), WorkClock(), go_on)

    def minimize(function, x, bounds, **others) -> None:
        seen.append((search._last, search._outside, search._value))
        assert x is start
        np.testing.assert_allclose(bounds.T, [start - reach, start + reach])
        search._outside, search._value = 7, 3.0
        raise _Outside

    monkeypatch.setattr("scipy.optimize.minimize", minimize)
    reaches = iter((3.0, 0.75, 0.1875, 0.046875))
    stage = search._stage

    def counted(*given: float) -> None:
        nonlocal reach
        reach = next(reaches)
        stage(*given)  # type: ignore[arg-type]

    reach = 0.0
    monkeypatch.setattr(search, "_stage", counted)
    worth, best = search._improve(start, 20.0, 3)
    assert (worth, best.tolist()) == (float(info.log_det(start)), start.tolist())
    assert next(reaches, None) is None
    assert seen == [(None, 0, 0.0)] * 4


def test_a_motion_that_is_too_large_is_shrunk_to_where_a_limit_is_reached() -> None:
    info = information(samples=64)
    small = 0.2 * some_motion(info)
    assert info.worst_room(small) > ROUNDING
    assert shrunk(info, small) is small
    large = 20.0 * small
    found = shrunk(info, large)
    share = found / large
    assert np.ptp(share) < 1e-12
    assert ROUNDING <= info.worst_room(found) < 1e-3
    assert info.worst_room(1.001 * found) < ROUNDING


def test_random_motions_are_halved_a_dozen_times_up_to_four_deviations() -> None:
    """Of the first harmonic's sines only 0.3; a motion for which there is no size is left out."""
    looked: list[int] = []
    family = SimpleNamespace(size=8)

    def room(motions: Array) -> Array:
        looked.append(len(motions))
        return np.ones(len(motions))

    every = SimpleNamespace(family=family, worst_room=room)
    found = random_motions(every, 4000, 3)  # type: ignore[arg-type]
    assert sum(looked) == 12 * 4000
    deviation = found.std(axis=0) / (4.0 * (1 - 2.0**-12))
    np.testing.assert_allclose(deviation, [0.3] * 4 + [1.0] * 4, rtol=0.05)
    some = SimpleNamespace(family=family, worst_room=lambda x: np.where(x[:, 5] > 0, 1.0, 0.0))
    half = random_motions(some, 4000, 3)  # type: ignore[arg-type]
    np.testing.assert_array_equal(half, found[found[:, 5] > 0])


REMEDY = "; raise it, or give the design a drive that has more"


def refusal(room: Array, count: int = 3) -> tuple[str, int]:
    """Return why no motion is found where home is first of a room (motions, 1, 22), and its cost.

    The cost is how many motions were looked at.
    """
    looked: list[int] = []

    def worst(motions: Array) -> Array:
        looked.append(len(motions))
        return np.full(len(motions), -1.0)

    made_up = SimpleNamespace(
        family=SimpleNamespace(size=8), worst_room=worst, states=lambda x: x,
        at=lambda states: SimpleNamespace(room=room[: len(states)]),
    )  # fmt: skip
    with pytest.raises(NoExcitation) as refused:
        random_motions(made_up, count, 0)  # type: ignore[arg-type]
    return str(refused.value), sum(looked)


@pytest.mark.parametrize("worst", [-1.0, np.nan])
def test_the_limit_that_is_named_is_the_one_beyond_which_home_is_farthest(worst: float) -> None:
    """Or of which it has no number; reach has twelve values."""
    for place in range(22):
        room = np.full((4, 1, 22), -0.5)
        room[0, :, place] = worst
        named = LIMITED[min(place, 10)]
        by = ", 2 times as large" if place < 9 and worst == -1.0 else ""
        way = REMEDY if place < 8 else ""
        assert refusal(room)[0].endswith(f"the {named} is beyond its limit at rest there{by}{way}")


def test_a_limit_that_leaves_home_alone_is_that_of_the_motion_nearest_to_it() -> None:
    """And not the one that home has least room to."""
    room = np.full((4, 1, 22), 0.1)
    room[1, 0, 2], room[2, 0, 5], room[3, 0, 7] = -2.0, -0.2501, -0.5  # told as 1.26: enough
    words = f"the {LIMITED[5]} is beyond its limit even in the smallest motions that were tried"
    assert refusal(room)[0].endswith(f"{words}, 1.26 times as large{REMEDY}")


def test_a_few_motions_that_no_size_makes_possible_are_enough() -> None:
    room = np.full((1 + excitation_search.RANDOM_STARTS, 1, 22), -1.0)
    assert refusal(room, excitation_search.RANDOM_STARTS)[1] <= 12 * 2 * excitation_search.CHUNK


def test_a_motion_is_shrunk_by_twenty_halvings_from_below() -> None:
    motion = np.array([1.0, -2.0])
    for share, wanted in ((0.7, np.floor(0.7 * 2**20) / 2**20), (2.0, 1.0)):
        info = SimpleNamespace(
            worst_room=lambda x, share=share: ROUNDING if np.abs(x).max() <= 2 * share else 0.0
        )
        np.testing.assert_array_equal(shrunk(info, motion), wanted * motion)  # type: ignore[arg-type]


def test_a_motion_keeps_limits_that_it_stays_below_by_a_thousand_millionth() -> None:
    motion = np.array([1.0, -2.0])
    for room, kept in ((1e-9, True), (0.95e-9, False)):
        info = SimpleNamespace(worst_room=lambda x, room=room: room)
        assert (shrunk(info, motion) is motion) == kept  # type: ignore[arg-type]


@pytest.mark.slow
def test_motions_are_improved_the_best_random_one_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what they tell at the noise of the first 32 of them; results are of finer samples.

    And of the friction's own step: where M4 starts from rest, a soft one takes less of its limit.
    """
    robot = replace(ROBOT, friction=Friction(0.4, 0.6, 20.0, 40.0))
    limits = limits_of(robot)
    limits.torque[3] = 321.0  # 282 hold it, 40 rub
    settings = ExcitationSettings(period=PERIOD, evaluations=5, random=34, seconds=1e4)
    drawn = np.stack([0.4 * some_motion(information(), seed) for seed in range(34)])
    order: list[np.ndarray] = []
    monkeypatch.setattr(Search, "run", lambda _, starts: order.append(starts))
    monkeypatch.setattr(excitation, "random_motions", lambda *_: drawn)
    found = optimize_excitation(robot, limits, settings)
    center, scale = preset_center(ROBOT.geometry), amplitudes(ROBOT)
    g = ROBOT.geometry
    wanted = [0.3 * g.base_radius] * 2 + [0.4, 0.1 * workspace_height(g)]
    np.testing.assert_allclose(scale, wanted, rtol=1e-12)
    said = "multiples of 0.3 R_b, 0.4 rad and 0.1 of the workspace's height"
    assert missing("identification", [said]) == []
    family = MultiSineFamily(5, center, scale)
    info = Information(robot, limits, family, PERIOD, settings.samples)
    info.noise = 0.02 * info.torque_rms(drawn[:32]).mean(axis=0)
    worth = info.log_det(order[0])
    assert (np.diff(worth) <= 1e-9).all()
    assert len(worth) == len(drawn) == found.random
    fine = Information(robot, limits, family, PERIOD, 4 * settings.samples)
    fine.noise, fine.sharp = info.noise, True
    best = float(fine.log_det(shrunk(fine, order[0][0])))
    fine.sharp = False
    assert fine.log_det(shrunk(fine, order[0][0])) > best + 1e-3
    assert found.random_log_det == pytest.approx(best, abs=1e-6)
    assert found.log_det == found.random_log_det  # nothing has been improved


def test_a_search_without_time_has_spent_all_of_it() -> None:
    shares: list[float] = []
    settings = ExcitationSettings(period=PERIOD, evaluations=3, random=3, seconds=0.0)
    found = optimize_excitation(
        ROBOT, limits_of(ROBOT), settings, progress=lambda done: shares.append(done)
    )
    assert set(shares) == {1.0}
    assert len(shares) == 2  # after the random motions and before a stage
    assert found.evaluations == 0


def clock_at(spent: float) -> WorkClock:
    """Return a clock at which so much of the time is spent [s], and which stands still."""
    return cast("WorkClock", SimpleNamespace(elapsed=spent))


def test_nothing_goes_on_when_no_evaluation_or_no_time_is_left() -> None:
    info = information(samples=64)
    start = 0.05 * some_motion(info)

    def evaluations(settings: ExcitationSettings, spent: float = 0.0) -> int:
        search = Search(info, settings, clock_at(spent), go_on)
        search.run(np.array([start]))
        assert search.over
        return search.evaluations

    few = ExcitationSettings(period=PERIOD, evaluations=7, random=1)
    assert evaluations(few) == 7
    assert evaluations(replace(few, evaluations=0)) == 0
    assert evaluations(replace(few, seconds=5.0), spent=5.1) == 0


def test_a_search_says_every_four_evaluations_how_much_of_its_budget_is_spent() -> None:
    """Of evaluations or of the time, of which more is spent; and begins with no motion at all."""
    info = information(samples=64)

    def shares(seconds: float, spent: float = 0.0) -> list[float]:
        found: list[float] = []
        settings = ExcitationSettings(period=PERIOD, evaluations=10, seconds=seconds, random=1)
        search = Search(info, settings, clock_at(spent), lambda done: found.append(done))
        assert not search.best.any()
        assert search.best_value == -np.inf
        with contextlib.suppress(Canceled):
            while True:
                search._spend()
        return found

    assert shares(1e5) == pytest.approx([0.0, 0.4, 0.8], abs=1e-6)
    assert shares(1e4, spent=6e3)[:2] == pytest.approx([0.6, 0.6], abs=1e-3)
    assert shares(5.0, spent=6.0) == [1.0]


def test_stages_go_on_with_the_best_motions_of_those_before() -> None:
    """Of each group the best are improved further; the next group is near the best of all.

    But one, the next of those that were drawn; those near have the numbers of the seed.
    """
    info = information(samples=64)
    settings = ExcitationSettings(period=PERIOD, random=1, seed=5)
    stages: list[tuple[float, np.ndarray]] = []
    each = GROUP + sum(kept for _, _, kept in STAGES[:-1])

    class Scripted(Search):
        def _improve(self, start, sharpness, iterations):
            if len(stages) == 3 * each:
                raise Canceled
            stages.append((sharpness, start))
            worth = -abs(float(start[0]) - 7.0)
            if worth > self.best_value:
                self.best_value, self.best = worth, start
            return worth, start

    starts = np.zeros((GROUP + 4, info.family.size))
    starts[:, 0] = [0.0, 1.0, 2.0, 3.0, 2.5, 3.5, 0.5, 0.2]  # the best come last
    search = Scripted(info, settings, WorkClock(), go_on)
    search.run(starts)
    assert search.over
    drawn = np.random.default_rng(5)
    for number in range(3):
        left = starts[:GROUP, 0]
        if number:
            best = max((x for _, x in stages[: number * each]), key=lambda x: x[0])
            near = 0.85 * best + 0.05 * drawn.standard_normal((3, best.size))
            group = [x for _, x in stages[number * each :][:GROUP]]
            np.testing.assert_allclose(group, [*near, starts[GROUP + number - 1]], rtol=1e-12)
            left = np.array(group)[:, 0]
        for sharpness, _, kept in STAGES:
            tried = [x[0] for own, x in stages[number * each :][:each] if own == sharpness]
            assert tried == list(left)
            left = np.array(sorted(left, key=lambda first: abs(first - 7.0))[:kept])


def test_steps_out_of_the_workspace_are_worse_than_the_last_one_inside_and_end_a_stage() -> None:
    """What is kept is the best motion that exceeds no limit by more than the tolerance."""
    answers: list[Evaluation] = []

    class Scripted:
        family = SimpleNamespace(size=2)

        def evaluate(self, x, sharpness):
            return answers.pop(0)

    def inside(value: float, worst: float = 0.0) -> Evaluation:
        return Evaluation(value, np.ones(11), np.array([1.0, 2.0]), np.ones((11, 2)), worst)

    outside = Evaluation(-np.inf, -np.ones(11), np.zeros(2), np.zeros((11, 2)), -np.inf)
    search = Search(Scripted(), ExcitationSettings(), WorkClock(), go_on)  # type: ignore[arg-type]
    places = iter(np.arange(-1.0, 100.0))

    def step(answer: Evaluation):
        answers.append(answer)
        return search._evaluated(np.full(2, next(places)), 1.0)

    assert step(outside)[0] == BEYOND  # nothing has been inside yet
    value, slope, room, _ = step(inside(5.0))
    assert (value, slope.tolist(), room.tolist()) == (-5.0, [-1.0, -2.0], [1.0] * 11)
    assert (search.best_value, search.best.tolist()) == (5.0, [0.0, 0.0])
    step(inside(9.0, worst=-1.001 * TOLERANCE))  # better, but not allowed
    assert search.best_value == 5.0
    step(inside(4.0))
    assert search.best_value == 5.0
    step(inside(6.0, worst=-TOLERANCE))
    step(inside(6.0))  # as good, but later
    assert (search.best_value, search.best.tolist()) == (6.0, [3.0, 3.0])
    assert search._kept[1].tolist() == [3.0, 3.0]
    for _ in range(MOST_OUTSIDE):
        value, slope, room, _ = step(outside)
        assert (value, slope.tolist(), room.tolist()) == (-6.0 + BEYOND, [0.0, 0.0], [-1.0] * 11)
    step(inside(3.0))  # the count begins anew
    for _ in range(MOST_OUTSIDE):
        assert step(outside)[0] == -3.0 + BEYOND
    with pytest.raises(_Outside):
        step(outside)
    spent = search.evaluations
    step(inside(2.0))
    again = search._evaluated(np.full(2, next(places) - 1.0), 1.0)  # the last place once more
    assert (again[0], search.evaluations) == (-2.0, spent + 1)
