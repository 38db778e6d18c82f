"""Springs as tendons of MuJoCo against the formulas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.balancing import (
    Spring,
    at_joint,
    on_bar,
    on_guide,
    on_slider,
    spring_torques,
)
from paminsa_viz.engines.mujoco_model import SprungMujocoRobot
from paminsa_viz.model import APPENDIX_4, LoadCase, static_torques

SPRINGS = (
    Spring(on_slider(0.3), at_joint(9), 150.0, 0.1),
    Spring(on_guide(0.1, 0.2), at_joint(4), 80.0),
    Spring(on_bar("b8", 8, 0.15), at_joint(3), 200.0, 0.3),
    Spring(on_bar("b4", 9, 0.1), on_guide(-0.05, -0.3), 90.0, 0.05),
    Spring(at_joint(7), at_joint(5), 60.0, 0.2),
)


@pytest.mark.slow
def test_mujoco_holds_the_same_against_springs():
    """Each alone, and all of them with a load."""
    pose = np.array([[0.0, 0.0, 0.0, -0.5], [0.1, -0.05, 0.4, -0.6], [-0.12, 0.08, -0.5, -0.4]])
    loaded = replace(APPENDIX_4, load=LoadCase(force_x=5.0, moment_z=1.0))
    for design, springs in (*((APPENDIX_4, (one,)) for one in SPRINGS), (loaded, SPRINGS)):
        found = SprungMujocoRobot(design, springs).static_torques(pose)
        expected = static_torques(design, pose) + spring_torques(design.geometry, springs, pose)
        scale = np.abs(expected).max(axis=0)
        np.testing.assert_array_less(np.abs(found - expected) / scale, 1e-6)
        assert np.abs(found - static_torques(design, pose)).max() > 0.1
