"""The least value within a workspace against a search of the nodes one by one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume.workspace import least_within

CELL = 0.1


def nodes(rng: np.random.Generator) -> tuple[Any, np.ndarray]:
    """The grid of a volume, and values on it of which some are missing."""
    shape = rng.integers(5, 9, 3)
    axes = [CELL * (np.arange(n) - n // 2) for n in shape]
    values = rng.normal(size=shape)
    values[rng.uniform(size=shape) < 0.02] = np.nan
    return SimpleNamespace(x=axes[0], y=axes[1], z=axes[2], cell=CELL), values


@pytest.mark.slow
@pytest.mark.parametrize("shape", list(WorkspaceShape))
@pytest.mark.parametrize("fixed", [True, False])
def test_least_within_a_workspace_is_that_of_its_nodes(shape: WorkspaceShape, fixed: bool) -> None:
    """Without a value, or beyond the nodes, it is minus infinite."""
    rng = np.random.default_rng(5)
    finite = 0
    for _ in range(12):
        volume, values = nodes(rng)
        half = CELL * rng.integers(0, 3, 3)
        if shape is WorkspaceShape.CYLINDER:
            half[1] = half[0]
        center = (0.0, CELL, None) if fixed else (None, None, None)
        size = cast(tuple[float, float, float], tuple(2.0 * half + 0.1 * CELL))
        found = least_within(values, Workspace(shape, size, center), volume)
        x, y, z = np.meshgrid(volume.x, volume.y, volume.z, indexing="ij")
        for place, least in np.ndenumerate(found):
            at = [
                axis[index] if given is None else given
                for axis, index, given in zip(
                    (volume.x, volume.y, volume.z), place, center, strict=True
                )
            ]
            off = [np.abs(axis - middle) for axis, middle in zip((x, y, z), at, strict=True)]
            held = off[2] <= half[2] + 1e-9
            if shape is WorkspaceShape.CYLINDER:
                held &= np.hypot(off[0], off[1]) <= half[0] + 0.06 * CELL
            else:
                held &= (off[0] <= half[0] + 1e-9) & (off[1] <= half[1] + 1e-9)
            sticks_out = any(
                middle - h < axis[0] - 1e-9 or middle + h > axis[-1] + 1e-9
                for middle, h, axis in zip(at, half, (volume.x, volume.y, volume.z), strict=True)
            )
            missing = sticks_out or np.isnan(values[held]).any()
            assert least == (-np.inf if missing else values[held].min())
            finite += not missing
    assert finite > 30
