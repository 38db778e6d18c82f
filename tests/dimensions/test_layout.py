"""The frame is clear of the robot for any design."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions import layout as rules
from paminsa_viz.dimensions.layout import MAST, MAST_ANGLE, layout
from paminsa_viz.model.design import APPENDIX_4, Geometry, KneeBranch
from paminsa_viz.model.kinematics import AXIS_ANGLES, inverse_kinematics
from paminsa_viz.model.reach import workspace_radius
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


def deepest(geometry: Geometry) -> float:
    """Distance of joints 5 from the guides with stretched pantographs, the platform centered."""
    low, high = 0.0, geometry.crank_length + geometry.coupler_length
    for _ in range(60):
        middle = (low + high) / 2
        z = -geometry.knee.sign * middle - geometry.platform_joint_height
        closed = np.isfinite(inverse_kinematics(geometry, [0.0, 0.0, 0.0, z]).phi).all()
        low, high = (middle, high) if closed else (low, middle)
    return low


def drawn(seed: int, knee: KneeBranch) -> Geometry:
    return with_knee(random_design(np.random.default_rng(seed)), knee).geometry


@pytest.mark.slow
@given(seeds, st.sampled_from(KneeBranch))
def test_heights_leave_the_room_that_is_stated(seed: int, knee: KneeBranch) -> None:
    g = drawn(seed, knee)
    place, joint = layout(g), g.platform_joint_height
    deep = max(deepest(g), np.sqrt(rules.LEAST_DEEPEST))
    if knee is KneeBranch.LOWER:
        by_arms = g.magnification * (g.shaft_length - rules.LOWEST_ARM)
        hangs = max(min(deep, by_arms), rules.LEAST_DEPTH)
        ground = min(-hangs - joint - rules.HANG, -deep - rules.STRETCHED)
        assert place.lift_low == rules.LOWEST_ARM
        stroke = max(g.shaft_length - rules.LOWEST_ARM, rules.LEAST_LIFT) + rules.ABOVE_LIFT
        assert place.lift_high - place.lift_low == pytest.approx(stroke)
        above = place.column_top - place.lift_high - at.CARRIAGE_HALF
        assert above == pytest.approx(rules.ABOVE_CARRIAGE)
        assert place.mast_top - at.MOUNT == pytest.approx(0.105)
        assert place.platform_low == pytest.approx(-hangs - joint, abs=1e-6)
    else:
        ground = -max(rules.TABLE, g.crank_length + rules.STRETCHED)
        assert place.lift_low == g.shaft_length
        stroke = deep / g.magnification + rules.ABOVE_RAM
        assert place.lift_high - place.lift_low == pytest.approx(stroke, abs=1e-6)
        bridge = place.column_top - place.lift_high - at.CARRIAGE_HALF
        assert bridge == pytest.approx(rules.BELOW_BRIDGE)
        assert place.mast_top - place.column_top == pytest.approx(rules.ABOVE_BRIDGE)
        assert rules.cylinder_length(place) > stroke + at.CARRIAGE_HALF
    assert -1e-6 <= ground - place.ground < 0.01 + 1e-6  # a full centimeter below it
    assert place.ground * 100 == pytest.approx(round(place.ground * 100), abs=1e-9)


@given(seeds, st.sampled_from(KneeBranch))
def test_joint_7_stays_off_the_base_plate_where_the_platform_is_nearest(
    seed: int, knee: KneeBranch
) -> None:
    """With joint 9 straight below or above the guide, so that z_7 = (z_5 - z_9)/k."""
    g = drawn(seed, knee)
    place, joint = layout(g), g.platform_joint_height
    low, high = (height + joint for height in (place.platform_low, place.platform_high))
    near = -high if knee is KneeBranch.LOWER else low
    room = rules.ROOM_OF_7 - (g.crank_length - near) / g.magnification
    assert near >= rules.LEAST_NEAR - 1e-12 or low == high
    if near > rules.LEAST_NEAR + 1e-9 and low < high:
        assert room == pytest.approx(0.0, abs=1e-12)
    elif low < high:
        assert room >= -1e-12
    if knee is KneeBranch.UPPER:
        # the carriage, at Z = shaft + z_5/k, is above the joints 5 where they are highest
        above = g.shaft_length + high / g.magnification - at.CARRIAGE_HALF - high
        if high > near + 0.01 + 1e-9:
            assert high <= deepest(g) + 1e-6
            assert above >= 0.02 - 1e-9
            assert high == pytest.approx(deepest(g), abs=1e-6) or above == pytest.approx(0.02)
        elif high < deepest(g) - 1e-6:  # a hundredth is left all the same
            assert high - max(near, rules.LEAST_NEAR) == pytest.approx(0.01)
    assert pytest.approx(at.MOUNT - 0.004) == rules.ROOM_OF_7 + at.BARREL_RADIUS


@given(seeds, st.sampled_from(KneeBranch))
def test_mast_is_as_near_as_the_links_allow(seed: int, knee: KneeBranch) -> None:
    g = drawn(seed, knee)
    mast = layout(g).mast_radius * np.exp(1j * MAST_ANGLE)
    nearest = np.abs(g.base_radius * np.exp(1j * np.array(AXIS_ANGLES)) - mast).min()
    stroke = g.guide_link_length if g.guide_stroke is None else g.guide_stroke
    links = max(max(g.guide_link_length, stroke) + at.SLIDER_HALF, rules.BAR_REACH * g.crank_length)
    clear = links + np.hypot(*MAST) / 2 + rules.MAST_GAP
    assert nearest >= clear - 1e-9
    if layout(g).mast_radius > g.base_radius + rules.MAST_ROOM + 1e-9:
        assert nearest == pytest.approx(clear)


@pytest.mark.parametrize(("radius", "beside"), [(0.7, True), (0.3, False)])
def test_mast_of_a_wide_base_stands_beside_the_leg_axes(radius: float, beside: bool) -> None:
    """Where no link reaches across, the room beside an axis is all that it needs."""
    short = {"base_radius": radius, "guide_link_length": 0.3, "crank_length": 0.3}
    g = replace(APPENDIX_4.geometry, **short, coupler_length=0.9)
    near = layout(g).mast_radius == pytest.approx(radius + rules.MAST_ROOM)
    assert near == beside


@given(seeds)
def test_plinth_lies_below_the_workspace_and_carries_the_mast(seed: int) -> None:
    g = drawn(seed, KneeBranch.LOWER)
    outline, radius = rules.plinth_outline(g), rules.plinth_radius(g)
    wanted = max(workspace_radius(g), rules.LEAST_PLINTH) + rules.PLINTH_EDGE
    assert radius == pytest.approx(wanted)
    x, y = outline.T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert area > 0.98 * np.pi * radius**2  # counterclockwise
    c, s = np.cos(MAST_ANGLE), np.sin(MAST_ANGLE)
    ahead, across = outline @ [c, s], outline @ [-s, c]
    end = max(radius, layout(g).mast_radius + rules.TONGUE[0])
    assert ahead.max() == pytest.approx(end, rel=1e-3)
    tongue = np.hypot(x, y) > radius + 1e-9
    assert np.hypot(x, y)[~tongue] == pytest.approx(radius)
    if tongue.any():
        half = min(rules.TONGUE[1], 0.9 * radius)
        assert np.abs(across[tongue]).max() == pytest.approx(half)
        assert across.sum() == pytest.approx(0.0, abs=1e-9)  # even about the mast's direction
        foot = layout(g).mast_radius + size.MAST_FOOT[0] / 2
        assert foot < end


def test_plinth_without_a_tongue_is_an_even_polygon() -> None:
    outline = rules.outline_about(0.5, 0.2)
    sides = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    assert sides == pytest.approx(2 * 0.5 * np.sin(np.pi / len(outline)))
    with_tongue = rules.outline_about(0.5, 0.5 - rules.TONGUE[0] + 1e-3)
    assert np.hypot(*with_tongue.T).max() > 0.5 == pytest.approx(np.hypot(*outline.T).max())


@given(st.floats(0.02, 1.0))
def test_arcs_of_the_ring_end_beside_the_motors(radius: float) -> None:
    arcs = rules.ring_arcs(radius)
    axes = radius * np.exp(1j * np.array(AXIS_ANGLES))
    for ends in arcs:
        assert ends[0] < ends[1]
        points = radius * np.exp(1j * np.array(ends))
        gaps = np.abs(points[:, None] - axes).min(axis=1)
        assert gaps == pytest.approx(size.RING_GAP)
        middle = radius * np.exp(1j * np.mean(ends))
        assert np.abs(middle - axes).min() == pytest.approx(radius)  # 60 degrees from two of them
    assert len(arcs) == (3 if radius > size.RING_GAP + 1e-9 else 0)


@pytest.mark.slow
@given(st.floats(0.03, 0.5))
def test_plate_goes_around_its_corners(radius: float) -> None:
    corners = rules.plate_corners(radius)
    following = np.roll(corners, -1, axis=0)
    joints = radius * np.exp(1j * np.array(AXIS_ANGLES))
    joints = np.stack([joints.real, joints.imag], axis=1)
    along = (following - corners) / np.linalg.norm(following - corners, axis=1)[:, None]
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    inside = np.einsum("ejk,ek->ej", joints - corners[:, None], inward)
    assert inside.min(axis=1) == pytest.approx(size.PLATE_CORNER)  # each edge touches a circle
    assert len(corners) == 3 * rules.CUTS


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_head_of_m4_stands_on_the_column_or_on_its_cylinder(knee: KneeBranch) -> None:
    g = with_knee(APPENDIX_4.geometry, knee)
    place = layout(g)
    below = 0.0 if knee is KneeBranch.LOWER else at.PLATE_OF_BRIDGE + rules.cylinder_length(place)
    assert rules.lift_motor_base(g) == pytest.approx(place.column_top + below)
    above = rules.lift_motor_height(g) - rules.lift_motor_base(g)
    assert above == pytest.approx(at.LIFT_MOTOR_HEIGHT)
    low, high = rules.column_heights(place)
    assert low - at.MOUNT - at.PLATE == pytest.approx(size.COLUMN_INTO[0])
    assert high - place.column_top == pytest.approx(size.COLUMN_INTO[1])
