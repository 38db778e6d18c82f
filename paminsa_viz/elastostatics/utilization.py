"""Stress of the bars in their legs' planes over the yield stress, from N and M of `bar_loads`.

Along a bar it is |N|/A + |M| c/I, with c the outer radius and I for bending in the plane; shear is
left out, as in slender bars, and so is buckling. The statically indeterminate sideways shares are
not in it: it is a lower bound, and what the loads of a leg's own plane use of the material.
"""

from __future__ import annotations

import numpy as np

from paminsa_viz.elastostatics.bar_diagram import BarLoads, largest_value
from paminsa_viz.elastostatics.bar_loads import arm_tip, bar_loads
from paminsa_viz.elastostatics.joint_forces import JointForces
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS


def bar_stress(forces: JointForces, loads: BarLoads) -> Array:
    """Return the largest stress along a bar of every leg, (..., 3 legs) [Pa].

    For B1 the bending in the horizontal plane that the leg's plane causes is added at its largest.
    """
    section = forces.design.elastic.section(loads.bar)
    normal = loads.coefficients[..., 0, :] / section.area
    bending = loads.coefficients[..., 2, :] * (section.radius / section.inertia_in)
    # |N| and |M| together are the larger one of |N + M| and |N - M|
    found = np.maximum(
        *(np.abs(largest_value(loads.places, normal + sign * bending)[0]) for sign in (1.0, -1.0))
    )
    if loads.bar == "b1":
        sideways = np.abs(arm_tip(forces).sideways).reshape(found.shape) * loads.length
        found = found + sideways * (section.radius / section.inertia_out)
    return np.asarray(found)


def utilization(forces: JointForces, bars: tuple[str, ...] = BARS) -> Array:
    """Return the largest stress of bars over the yield stress, (..., 3 legs, len(bars)) [1]."""
    strength = forces.design.elastic.yield_stress
    stress = [bar_stress(forces, bar_loads(forces, bar)) / strength for bar in bars]
    return np.stack(stress, axis=-1)
