"""Joint forces and bar loads at rest over a solved grid, for maps."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from paminsa_viz.elastostatics.bar_loads import bar_loads, bar_stress
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JointForces, joint_forces
from paminsa_viz.model.arrays import Array, in_blocks
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import Limit

BLOCK = 2**13
"""Poses worked on at a time; their forces take some 10 MB."""

BAR_MEASURES = ("axial", "bending", "utilization")
"""Results of `field_bar_loads`: largest |N| [N], |M| [N m] of a bar, and its utilization [1]."""


@lru_cache(maxsize=2)
def field_joint_forces(field: Field, design: Design) -> Array:
    """Return the largest force of each of `JOINTS` over the legs, and two moments, (12, ...).

    At rest under the design's load; [N], then the largest moments at M_k and at joint 2 [N m]. NaN
    where there are none.
    """

    def measure(forces: JointForces) -> Array:
        moments = np.abs(forces.moment[..., [JOINT_INDEX["m"], JOINT_INDEX["2"]]])
        return np.concatenate([forces.magnitude, moments], axis=-1).max(axis=1)

    return _over(field, design, measure)


@lru_cache(maxsize=2)
def field_bar_loads(field: Field, design: Design) -> Array:
    """Return `BAR_MEASURES` of the bar and leg where each is largest, (3, ...), at rest."""

    def measure(forces: JointForces) -> Array:
        found = []
        for bar in BARS:
            loads = bar_loads(forces, bar)
            stress = bar_stress(forces, loads) / design.elastic.yield_stress
            inner = np.abs(loads.largest((0, 2))[0])
            found.append(np.concatenate([inner, stress[..., None]], axis=-1))
        return np.stack(found).max(axis=(0, 2))

    return _over(field, design, measure)


def _over(field: Field, design: Design, measure: Callable[[JointForces], Array]) -> Array:
    """Evaluate measures (n, size) of poses (n, 4) over a field, (size, ...)."""
    with np.errstate(invalid="ignore"):
        found = in_blocks(
            lambda poses: [measure(joint_forces(design, poses))], field.grid.poses(), BLOCK
        )[0]
    found[field.status != Limit.OK] = np.nan
    return np.moveaxis(found, -1, 0)
