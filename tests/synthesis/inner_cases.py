"""What the tests of masses and springs share: a workspace, a motion, and what is free."""

from __future__ import annotations

from functools import cache

import numpy as np

from paminsa_viz.balancing import SpringPlace, at_joint, beyond, on_slider
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.trajectory import PRESET, Trajectory

MASSES = tuple(MassFactor(f"links.{bar}", 0.5, 2.0) for bar in ("b3", "b4", "b8"))
WEIGHTS = (beyond("b8", 8, 0.3, 3.0), beyond("b4", 9, 0.2, 2.0))
SPRING = SpringPlace(on_slider(0.3), at_joint(9), 2000.0, 0.0, 0.2)


@cache
def poses() -> Array:
    """Return poses of a box of Appendix 4's robot, (n, 4)."""
    side = np.linspace(-0.1, 0.1, 4)
    axes = (side, side, np.linspace(-0.5, 0.5, 4), np.linspace(-0.6, -0.4, 3))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)


@cache
def motion() -> Trajectory:
    """Return a pick-and-place arch."""
    return PRESET["arch"].build(APPENDIX_4.geometry).sample(40)


def case(goal: str = "peak_torque", *, springs: bool = False) -> InnerCase:
    """Return a case with limits that matter."""
    return InnerCase(
        goal, (motion(),), MASSES, WEIGHTS, (SPRING,) if springs else (),
        bounds=(Requirement("max_torque", high=1.0), Requirement("f_4", high=225.0)),
        motion_force=240.0,
    )  # fmt: skip
