"""The frame stands clear of the robot, whatever the design."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.meshes import layers as at
from paminsa_viz.meshes.layout import MAST, MAST_ANGLE, layout
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES, inverse_kinematics
from tests.support.samples import random_design, random_poses, with_knee

seeds = st.integers(0, 10_000)


@given(seeds)
def test_no_link_reaches_the_mast(seed: int) -> None:
    geometry = random_design(np.random.default_rng(seed)).geometry
    place = layout(geometry)
    mast = place.mast_radius * np.array([np.cos(MAST_ANGLE), np.sin(MAST_ANGLE)])
    axes = geometry.base_radius * np.stack([np.cos(AXIS_ANGLES), np.sin(AXIS_ANGLES)], axis=1)
    nearest = np.linalg.norm(axes - mast, axis=1).min()
    assert nearest - np.hypot(*MAST) / 2 > geometry.guide_link_length
    assert nearest - np.hypot(*MAST) / 2 > geometry.crank_length


@given(seeds, st.sampled_from(KneeBranch))
def test_the_ground_is_below_everything(seed: int, knee: KneeBranch) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    place = layout(with_knee(design.geometry, knee))
    configuration = inverse_kinematics(
        with_knee(design.geometry, knee), random_poses(rng, with_knee(design, knee), 20)
    )
    for points in configuration.points.values():
        assert (points[..., 2] > place.ground).all()
    assert place.ground < place.platform_low - 0.1


@given(seeds, st.sampled_from(KneeBranch))
def test_the_arms_move_between_the_stops_of_m4(seed: int, knee: KneeBranch) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    place = layout(with_knee(design.geometry, knee))
    heights = np.array([place.platform_low, place.platform_high])
    poses = np.array([[0.0, 0.0, 0.0, z] for z in heights])
    lift = inverse_kinematics(with_knee(design.geometry, knee), poses).actuators[:, 3]
    assert place.platform_low <= place.platform_high
    if knee is KneeBranch.LOWER and place.lift_low < design.geometry.shaft_length:
        assert (lift >= place.lift_low - 1e-9).all()
    assert (lift + at.CARRIAGE_HALF < place.column_top).all()


def test_heights_of_the_prototype() -> None:
    place = layout(APPENDIX_4.geometry)
    assert place.platform_low == pytest.approx(-0.83, abs=0.02)
    assert place.platform_high == pytest.approx(-0.22, abs=0.02)
    assert place.ground == pytest.approx(-1.06, abs=0.02)
    lowest = inverse_kinematics(APPENDIX_4.geometry, [0.0, 0.0, 0.0, place.platform_low])
    assert lowest.actuators[3] - at.ARM_BEARING_HALF > at.QUILL_TOP


def test_equal_geometries_share_their_layout() -> None:
    geometry = APPENDIX_4.geometry
    assert layout(geometry) is layout(replace(geometry))
    assert layout(geometry) != layout(with_knee(geometry, KneeBranch.UPPER))
