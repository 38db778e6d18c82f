"""Fronts: monotone, convex, no point dominated by another or by any random design."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import (
    AddedMass,
    Changes,
    InfeasibleBounds,
    MassRange,
    StaticPeak,
    TrajectoryPeak,
    TrajectoryRms,
    pareto_front,
)
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput
from paminsa_viz.trajectory import PRESET, solve_trajectory
from tests.balancing.robots import changes, field, measured, random_measures, solved

TERMS = (TrajectoryPeak(solved()), StaticPeak(field()))


@pytest.mark.slow
@pytest.mark.parametrize("budget", [None, 0.0])
def test_the_front_of_dynamic_and_static_peaks(budget: float | None) -> None:
    limits = [] if budget is None else [(AddedMass(), budget)]
    front = pareto_front(APPENDIX_4, changes(), *TERMS, points=7, limits=limits)
    first = np.array([point.first for point in front.points])
    second = np.array([point.second for point in front.points])
    assert len(first) == 7
    assert (np.diff(first) > 0).all()
    assert (np.diff(second) < 0).all()
    slopes = np.diff(first) / np.diff(second)
    assert (np.diff(slopes) <= 1e-6).all()  # convex
    assert second[-1] < 1e-6
    drawn = random_measures()
    within = drawn["added mass"] <= (np.inf if budget is None else budget)
    x, y = (drawn[term.label][within] for term in TERMS)
    for point in front.points:
        assert not ((x < point.first - 1e-8) & (y <= point.second)).any()
        assert point.optimum.gap <= 1e-7 * max(point.first, 1.0)
        values = measured(point.design)
        assert [values[term.label] for term in TERMS] == pytest.approx(
            [point.first, point.second], rel=1e-7, abs=1e-7
        )


def test_terms_that_agree_give_one_point() -> None:
    what = Changes((MassRange("joints.j9", 0.1, 0.259),))
    front = pareto_front(APPENDIX_4, what, AddedMass(), StaticPeak(field()), points=5)
    (point,) = front.points
    assert point.design.joints.j9 == pytest.approx(0.1)


def test_terms_that_agree_but_for_the_solvers_tolerance_give_one_point() -> None:
    """Before the change no mass is added: its other size is what differences count by."""
    ranges = (MassRange("joints.j9", 0.1, 0.259), MassRange("links.b4", 0.1, 2.0))
    front = pareto_front(
        APPENDIX_4, Changes(ranges), TrajectoryRms(solved()), AddedMass(), points=3
    )
    (point,) = front.points
    assert front.before[1] == 0.0
    assert point.second == pytest.approx(-3 * (0.159 + APPENDIX_4.links.b4 - 0.1), rel=1e-6)


def test_terms_of_one_label_keep_their_own_values() -> None:
    """The same torque on two motions: of a front's two terms, and of one and a limit."""
    motions = [solved()] + [
        solve_trajectory(APPENDIX_4.geometry, PRESET[key].build(APPENDIX_4.geometry).sample(20))
        for key in ("circle", "arch")
    ]
    terms = [TrajectoryPeak(motion) for motion in motions]
    assert len({term.label for term in terms}) == 1

    def peaks(design: Design) -> list[float]:
        return [float(np.abs(motion.torques(design)[:, :3]).max()) for motion in motions]

    now = peaks(APPENDIX_4)
    what = Changes(tuple(MassRange(f"joints.j{i}", 0.1, 2.0) for i in (4, 7, 9)))
    front = pareto_front(APPENDIX_4, what, *terms[:2], points=3, limits=[(terms[2], 1.1 * now[2])])
    assert front.before == pytest.approx(tuple(now[:2]))
    assert len(front.points) == 3
    for point in front.points:
        first, second, other = peaks(point.design)
        assert (point.first, point.second) == pytest.approx((first, second), rel=1e-7)
        assert other <= 1.1 * now[2] * (1 + 1e-7)


@pytest.mark.slow
def test_progress_and_canceling() -> None:
    seen = []

    def stop(done: float) -> bool:
        seen.append(done)
        return done >= 4 / 8

    front = pareto_front(APPENDIX_4, changes(), *TERMS, points=8, progress=stop)
    assert seen[:3] == [2 / 8, 3 / 8, 4 / 8]
    assert 1 < len(front.points) < 8


def test_impossible_fronts() -> None:
    with pytest.raises(InvalidInput, match="points"):
        pareto_front(APPENDIX_4, changes(), *TERMS, points=1)
    with pytest.raises(InfeasibleBounds, match="added mass"):
        pareto_front(APPENDIX_4, changes(), *TERMS, limits=[(AddedMass(), -100.0)])
