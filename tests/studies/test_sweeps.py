"""Sweeps: the figures of the whole grid, in pieces of any size and bounded memory."""

from __future__ import annotations

import tracemalloc
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Grid,
    Limit,
    backend,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.studies.sweeps import sweep
from tests.support.cases import Case, cases
from tests.support.measured import pointwise

pytestmark = pytest.mark.slow


ALL = tuple(QUANTITIES)
CHEAP = tuple(key for key, quantity in QUANTITIES.items() if quantity.cost <= 1e-6)
AXES = {
    "x": np.linspace(-0.3, 0.3, 7),
    "y": np.linspace(-0.3, 0.25, 6),
    "theta": np.linspace(-1.5, 1.4, 5),
    "z": np.linspace(-0.95, 0.9, 8),
}
FIXED = (0.0, 0.0, 0.0, -0.5)


def at_poses(design: Design, pose: Any) -> tuple[Any, dict[str, Any]]:
    """Status and every quantity at every pose, from the pointwise functions."""
    return check_reach(design.geometry, pose).status, pointwise(design, pose)


@given(
    case=cases(),
    names=st.sampled_from([n for k in range(5) for n in permutations(AXES, k)]),
    block=st.sampled_from([1, 3, 10, 64, 1000, 2**20]),
    threads=st.sampled_from([None, 1, 3]),
)
def test_the_summary_is_that_of_numpy(
    case: Case, names: tuple[str, ...], block: int, threads: int | None
) -> None:
    design = case.design
    size = design.geometry.base_radius / 0.35
    scale = {"x": size, "y": size, "theta": 1.0, "z": design.geometry.coupler_length / 0.6}
    fixed = np.array(FIXED) * [1, 1, 1, scale["z"]]
    # a little off, so that no pose is exactly symmetrical and no two values tie
    axes = {name: (AXES[name][:3] + 0.00123 * (1 + len(name))) * scale[name] for name in names}
    grid = Grid.over(fixed, **axes)
    # every block costs as much as some hundred poses
    keys = ALL if block >= 64 else CHEAP
    summary = sweep(design, grid, keys, block=block, threads=threads)
    pose = grid.poses().reshape(-1, 4)
    status, quantities = at_poses(design, pose)
    assert summary.poses == len(pose) == grid.size
    assert list(summary.counts) == list(Limit)
    for limit in Limit:
        assert summary.counts[limit] == np.count_nonzero(status == limit)
    ok = status == Limit.OK
    for quantity in keys:
        values = quantities[quantity]
        known = ok & np.isfinite(values)
        chosen = values[known]
        if not known.any():
            figures = summary.largest, summary.smallest, summary.mean, summary.rms
            assert all(np.isnan(figure[quantity]) for figure in figures)
            assert np.isnan(summary.largest_at[quantity]).all()
            continue
        largest, smallest = summary.largest[quantity], summary.smallest[quantity]
        spread = 1e-11 * np.abs(chosen).max()
        rough = 1e-9 if quantity == "condition" else 1e-11
        assert largest == pytest.approx(chosen.max(), rel=rough, abs=spread)
        assert smallest == pytest.approx(chosen.min(), rel=rough, abs=spread)
        assert summary.mean[quantity] == pytest.approx(chosen.mean(), rel=rough, abs=spread)
        rms = np.sqrt(np.mean(chosen**2))
        assert summary.rms[quantity] == pytest.approx(rms, rel=rough, abs=spread)
        place = np.array(summary.largest_at[quantity])
        there = np.abs(pose[known] - place).max(axis=-1) == 0
        assert there.sum() == 1
        assert chosen[there] == pytest.approx(largest, rel=rough, abs=spread)


def test_a_sweep_out_of_reach_finds_nothing() -> None:
    summary = sweep(APPENDIX_4, Grid.over((0.0, 0.0, 0.0, -3.0), x=AXES["x"]), ALL)
    assert summary.counts[Limit.STRETCHED] == summary.poses == 7
    for figure in (summary.largest, summary.smallest, summary.mean, summary.rms):
        assert all(np.isnan(value) for value in figure.values())
    assert all(np.isnan(place).all() for place in summary.largest_at.values())


def test_singular_poses_do_not_count() -> None:
    """Lengths that are exact in binary, so that one of the two poses is exactly singular."""
    design = APPENDIX_4.vary({"geometry.base_radius": 0.5, "geometry.platform_radius": 0.25})
    summary = sweep(design, Grid.over(FIXED, x=[0.25, 0.1]))
    assert (summary.counts[Limit.SINGULAR], summary.counts[Limit.OK]) == (1, 1)
    assert summary.largest["max_torque"] < 100
    assert summary.largest_at["max_torque"] == (0.1, 0.0, 0.0, -0.5)


@pytest.mark.parametrize("block", [7, 2**20])
def test_poses_near_a_singularity_do_not_count_if_so_asked(block: int) -> None:
    """A grid through the singular circle; figures and place of those that count by themselves."""
    grid = Grid.over(FIXED, theta=[0.0, 0.4], x=np.linspace(-0.3, 0.31, 20), y=[0.0, 0.1])
    pose = grid.poses().reshape(-1, 4)
    ok = check_reach(APPENDIX_4.geometry, pose).ok
    near = measure_singularity(APPENDIX_4.geometry, pose).condition
    torque = np.abs(static_torques(APPENDIX_4, pose)[:, :3]).max(axis=1)
    counts = ok & (near <= 5.0)
    assert 0 < counts.sum() < ok.sum()
    found = sweep(APPENDIX_4, grid, max_condition=5.0, block=block)
    assert found.counts[Limit.OK] == ok.sum()
    assert found.largest == {"max_torque": pytest.approx(torque[counts].max(), rel=1e-9)}
    assert found.mean["max_torque"] == pytest.approx(torque[counts].mean(), rel=1e-9)
    place = pose[counts][torque[counts].argmax()]
    assert found.largest_at["max_torque"] == tuple(place)


def test_memory_does_not_grow_with_the_sweep() -> None:
    """200,000 poses, 3.2 MB of results if kept, whichever axis is the long one."""
    block, keys = 2**12, ("max_torque", "condition")
    spans = {"x": (-0.3, 0.3), "y": (-0.3, 0.3), "theta": (-1.0, 1.0), "z": (-0.9, -0.2)}
    backend.compile_now()
    sweep(APPENDIX_4, Grid.over(FIXED), keys)  # or the kernels would count
    for sizes in ((200_000, 1, 1, 1), (1, 1, 1, 200_000), (100, 50, 8, 5), (8, 5, 50, 100)):
        axes = {
            name: np.linspace(*spans[name], size) for name, size in zip(spans, sizes, strict=True)
        }
        grid = Grid.over(FIXED, **axes)
        tracemalloc.start()
        try:
            summary = sweep(APPENDIX_4, grid, keys, block=block)
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert summary.poses == 200_000
        assert peak < 400 * block, sizes  # 50 numbers a pose of the block
