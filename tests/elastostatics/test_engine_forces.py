"""The constraint forces of MuJoCo and Pinocchio in the legs' planes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.engines.pinocchio_model import PinocchioRobot
from paminsa_viz.model.design import Design
from tests.elastostatics.engine_reactions import reactions
from tests.elastostatics.test_joint_forces import LOAD, WEIGHTS
from tests.support import samples


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
@samples.each_robot(range(2))
def test_joint_forces_are_the_engines_constraint_forces(engine: str, design: Design) -> None:
    pytest.importorskip(engine, reason=f"{engine} comes with the extra 'verify'")
    design = replace(design, load=LOAD, counterweights=WEIGHTS)
    motion = samples.random_states(np.random.default_rng(3), design, 4)
    robot = (MujocoRobot if engine == "mujoco" else PinocchioRobot)(design)
    force, moment = reactions(robot, motion)
    found = joint_forces(design, *motion)
    largest = found.magnitude.max()
    assert np.abs(found.force[..., [0, 2]] - force).max() < 1e-9 * largest
    expected = found.moment.copy()
    expected[..., JOINT_INDEX["5"]] = found.of("5")[..., 1]
    assert np.abs(expected - moment).max() < 1e-9 * largest
