"""Designs with random elastic data, and poses, for the tests of elastostatics."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.elastostatics.leg_model import JOINT_STIFFNESSES
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.elastic import BARS
from tests.support.samples import random_design, random_poses

POSE = (0.05, 0.02, 0.5, -0.6)
"""A pose without any symmetry."""


def elastic_design(seed: int, *, soft_joints: bool = True) -> Design:
    """Draw a robot with random tubes, some with given section values, drives and joints."""
    rng = np.random.default_rng(seed)
    changes: dict[str, float | None] = {}
    for bar in BARS:
        outer = rng.uniform(0.02, 0.06)
        changes[f"elastic.{bar}_outer"] = outer
        changes[f"elastic.{bar}_inner"] = outer * rng.uniform(0.0, 0.95)
        if rng.uniform() < 0.3:
            changes[f"elastic.{bar}_inertia_out"] = rng.uniform(1e-8, 1e-7)
            changes[f"elastic.{bar}_torsion"] = rng.uniform(1e-8, 1e-7)
    changes["elastic.drive_rotary"] = 10 ** rng.uniform(3, 5)
    changes["elastic.drive_linear"] = 10 ** rng.uniform(6, 8)
    for name in JOINT_STIFFNESSES if soft_joints else ():
        if rng.uniform() < 0.5:
            tilt = name.endswith("tilt")
            changes[f"elastic.{name}"] = 10 ** (rng.uniform(3, 5) if tilt else rng.uniform(6, 8))
    robot = APPENDIX_4 if seed == 0 else random_design(rng)
    return robot.vary(changes)


def poses_of(design: Design, n: int, seed: int = 0) -> Any:
    """Draw n poses (n, 4) that keep off every limit."""
    return random_poses(np.random.default_rng(seed), design, n)
