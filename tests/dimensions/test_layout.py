"""The frame is clear of the robot for any design."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.layout import MAST, MAST_ANGLE, layout
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES, inverse_kinematics
from tests.support.samples import random_design, random_poses, with_knee

seeds = st.integers(0, 10_000)


@given(seeds)
def test_no_link_reaches_the_mast(seed: int) -> None:
    geometry = random_design(np.random.default_rng(seed)).geometry
    mast = layout(geometry).mast_radius * np.exp(1j * MAST_ANGLE)
    nearest = np.abs(geometry.base_radius * np.exp(1j * np.array(AXIS_ANGLES)) - mast).min()
    room = nearest - np.hypot(*MAST) / 2
    assert room > max(geometry.guide_link_length, geometry.crank_length)


@given(seeds, st.sampled_from(KneeBranch))
def test_the_robot_stays_above_the_ground_and_between_the_stops_of_m4(
    seed: int, knee: KneeBranch
) -> None:
    rng = np.random.default_rng(seed)
    design = with_knee(random_design(rng), knee)
    place = layout(design.geometry)
    poses = random_poses(rng, design, 20)
    for points in inverse_kinematics(design.geometry, poses).points.values():
        assert (points[..., 2] > place.ground).all()
    assert place.ground < place.platform_low - 0.1
    assert place.platform_low <= place.platform_high
    ends = [[0.0, 0.0, 0.0, z] for z in (place.platform_low, place.platform_high)]
    arms = inverse_kinematics(design.geometry, ends).actuators[:, 3]
    g = design.geometry
    if knee is KneeBranch.LOWER and g.magnification * (g.shaft_length - place.lift_low) > 0.1:
        # With a shorter shaft the frame is drawn for a depth of 0.1 m all the same.
        assert (arms >= place.lift_low - 1e-9).all()
    assert (arms + at.CARRIAGE_HALF < place.column_top).all()


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
