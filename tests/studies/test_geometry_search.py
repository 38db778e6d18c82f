"""The search for lengths: better, within what is required, and the same wherever it runs."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import count

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    KneeBranch,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.studies import (
    BoxRequirements,
    Measures,
    SearchProgress,
    SearchResult,
    Weights,
    Workers,
    measure,
    processes,
    resized,
    search_geometry,
)
from tests.support.samples import with_knee

pytestmark = pytest.mark.slow


NEEDS = BoxRequirements((-0.08, -0.08, -0.4, -0.6), (0.08, 0.08, 0.4, -0.45), counts=(3, 3, 3, 3))
SHORT = {"generations": 6, "population": 6, "seed": 3}


def same(a: SearchResult, b: SearchResult) -> bool:
    return (a.design, a.cost, a.history, a.trials) == (b.design, b.cost, b.history, b.trials)


def test_search_finds_better_lengths_that_meet_requirements() -> None:
    result = search_geometry(APPENDIX_4, NEEDS, Weights(1.0, 0.1, 1.0), **SHORT)
    assert result.feasible
    weights = Weights(1.0, 0.1, 1.0)
    assert weights.of(result.after) < weights.of(result.before)
    poses = NEEDS.finer().poses()
    reach = check_reach(result.design.geometry, poses)
    assert reach.ok.all()
    assert reach.margins.min() >= NEEDS.margin
    found = measure_singularity(result.design.geometry, poses)
    assert found.position_distance.min() >= NEEDS.radius_clearance
    assert np.abs(static_torques(result.design, poses)[:, :3]).max() == pytest.approx(
        result.after.torque, rel=1e-12
    )
    assert (np.diff(result.history) <= 0).all()


def test_result_does_not_depend_on_the_workers() -> None:
    here = search_geometry(APPENDIX_4, NEEDS, **SHORT)
    with ThreadPoolExecutor(3) as pool:
        assert same(here, search_geometry(APPENDIX_4, NEEDS, workers=Workers(pool, 3), **SHORT))
    with processes(2) as workers:
        assert same(here, search_geometry(APPENDIX_4, NEEDS, workers=workers, **SHORT))
    assert not same(here, search_geometry(APPENDIX_4, NEEDS, **(SHORT | {"seed": 4})))


def test_progress_and_canceling() -> None:
    seen: list[SearchProgress] = []

    def stop(progress: SearchProgress) -> bool:
        seen.append(progress)
        return progress.generation == 2

    result = search_geometry(APPENDIX_4, NEEDS, progress=stop, **SHORT)
    assert result.canceled
    assert [item.generation for item in seen] == [1, 2]
    assert len(result.history) == 2
    assert seen[1].trials == result.trials
    assert seen[-1].cost == result.cost
    assert not search_geometry(APPENDIX_4, NEEDS, progress=lambda p: None, **SHORT).canceled


def test_unreachable_box_is_infeasible() -> None:
    deep = BoxRequirements((0, 0, 0, -9.0), (0, 0, 0, -9.0))
    result = search_geometry(APPENDIX_4, deep, **SHORT)
    assert not result.feasible
    assert result.after.margin < 0


def test_measures_of_appendix_4() -> None:
    found = measure(APPENDIX_4, NEEDS)
    poses = NEEDS.poses()
    assert found.torque == pytest.approx(np.abs(static_torques(APPENDIX_4, poses)[:, :3]).max())
    assert found.margin == pytest.approx(check_reach(APPENDIX_4.geometry, poses).margins.min())
    assert found.condition == pytest.approx(
        measure_singularity(APPENDIX_4.geometry, poses).condition.max()
    )
    # the clearances are those of the whole box, so they hold for any pose inside
    inside = np.random.default_rng(0).uniform(NEEDS.low, NEEDS.high, (5000, 4))
    all_of_them = measure_singularity(APPENDIX_4.geometry, inside)
    assert all_of_them.position_distance.min() >= found.radius_clearance
    assert all_of_them.position_distance.min() < found.radius_clearance + 0.01
    mirrored = BoxRequirements(
        (NEEDS.low[0], NEEDS.low[1], NEEDS.low[2], 0.45 - 0.055), (0.08, 0.08, 0.4, 0.6 - 0.055),
        counts=NEEDS.counts,
    )  # fmt: skip
    other = measure(with_knee(APPENDIX_4, KneeBranch.UPPER), mirrored)
    assert other.torque == pytest.approx(found.torque, rel=1e-10)


def test_violations_add_up() -> None:
    found = Measures(1.0, 2.0, 1.0, 0.005, 0.01, 0.2)
    needs = BoxRequirements((0, 0, 0, -1), (0, 0, 0, -1), 0.01, 0.03, 0.15)
    assert found.broken(needs) == pytest.approx(0.005 + 0.02)


def test_bars_grow_with_their_length() -> None:
    values = {"geometry.crank_length": 0.84, "geometry.magnification": 1.5}
    big = resized(APPENDIX_4, values)
    assert big.links.b8 == pytest.approx(2 * APPENDIX_4.links.b8)
    assert big.inertias.b8_transverse == pytest.approx(8 * APPENDIX_4.inertias.b8_transverse)
    assert big.inertias.b3_axial == pytest.approx(2 * APPENDIX_4.inertias.b3_axial)
    assert big.links.b7 == pytest.approx(2 * APPENDIX_4.links.b7)
    assert big.links.b4 == APPENDIX_4.links.b4
    plain = resized(APPENDIX_4, values, scale_bars=False)
    assert plain == APPENDIX_4.vary(values)


@pytest.mark.parametrize(
    "make",
    [
        lambda: BoxRequirements((0, 0, 0, 1), (0, 0, 0, 0)),
        lambda: BoxRequirements((0, 0, 0, np.nan), (0, 0, 0, 0)),
        lambda: BoxRequirements((0, 0, 0, 0), (0, 0, 0, 0), counts=(0, 1, 1, 1)),
        lambda: search_geometry(APPENDIX_4, NEEDS, ranges={}),
        lambda: search_geometry(APPENDIX_4, NEEDS, ranges={"links.b3": (0, 1)}),
        lambda: search_geometry(APPENDIX_4, NEEDS, ranges={"geometry.base_radius": (1, 1)}),
    ],
    ids=count(),
)
def test_impossible_requests_are_rejected(make) -> None:
    with pytest.raises(InvalidInput):
        make()
