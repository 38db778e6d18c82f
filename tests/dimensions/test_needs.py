"""What drawn bodies need of the lengths, against the joints' places and against sampled bars."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import PAYLOAD_HEIGHT, payload_center, payload_scale
from paminsa_viz.dimensions.needs import (
    SPARE,
    bar_distance,
    joint_3_from_guides,
    missing_room,
    needed_guide,
    needed_shaft,
)
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from tests.support.samples import random_design, random_poses, with_knee

seeds = st.integers(0, 10_000)
knees = st.sampled_from(KneeBranch)


@given(seeds, knees)
def test_distance_of_b4_and_b7_is_that_of_their_middle_lines(seed: int, knee: KneeBranch) -> None:
    rng = np.random.default_rng(seed)
    design = with_knee(random_design(rng), knee)
    g = design.geometry
    points = inverse_kinematics(g, random_poses(rng, design, 3)).points
    share = np.linspace(0.0, 1.0, 2001)[:, None]
    for pose, leg in np.ndindex(3, 3):
        p5, p7, p8, p9 = (points[number][pose, leg] for number in (5, 7, 8, 9))
        along = (p5 - p9) / np.linalg.norm(p5 - p9)
        b4 = p9 + share * (p5 - p9)
        on = np.clip((b4 - p8) @ along, 0.0, np.linalg.norm(p7 - p8))
        expected = np.linalg.norm(b4 - p8 - on[:, None] * along, axis=1).min()
        found = bar_distance(
            g.crank_length, g.coupler_length, g.magnification, np.linalg.norm(p5 - p8)
        )
        assert found == pytest.approx(expected, abs=1e-6)


def test_bars_on_one_line_are_apart_by_their_ends() -> None:
    """Stretched, B4 begins where B8 ends; folded, B7 lies on B4, or beyond its end."""
    stretched = bar_distance(0.5, 0.3, 2.0, 0.8)
    assert stretched == pytest.approx(0.5 - 0.3 / 2.0)
    assert bar_distance(0.5, 0.7, 2.0, 0.2) == pytest.approx(0.0, abs=1e-9)
    assert bar_distance(0.8, 0.3, 2.0, 0.5) == pytest.approx(0.5)
    assert np.isfinite(bar_distance(0.5, 0.3, 2.0, 0.8 + 1e-12))


@given(seeds, knees, st.floats(0.0, 0.02))
def test_missing_room_is_that_between_the_joints_and_what_is_drawn_at_them(
    seed: int, knee: KneeBranch, clearance: float
) -> None:
    """For any extremes of the poses, in which joints 2 and 3 are at shaft - zeta/k and zeta/k."""
    rng = np.random.default_rng(seed)
    geometries = [with_knee(random_design(rng), knee).geometry for _ in range(6)]
    slider = rng.uniform(0.0, 0.12, 6)
    most = [[1.3 * g.shaft_length * g.magnification] for g in geometries]  # joint 2 below the quill
    zeta = np.sort(rng.uniform(0.0, 1.0, (6, 2)) * most, axis=1)
    bars = np.array([[g.crank_length, g.coupler_length] for g in geometries])
    least = np.abs(bars @ [1.0, -1.0])[:, None]
    share = np.sort(rng.uniform(0.0, 1.0, (6, 2)) ** 3, axis=1)
    diagonal = least + share * (bars.sum(axis=1)[:, None] - least)
    found = missing_room(geometries, slider, zeta, diagonal, clearance)
    expected = []
    for g, away, (shallow, deep), ends in zip(geometries, slider, zeta, diagonal, strict=True):
        # the slider, half as long as drawn, and the block about the leg axis
        beside = away - at.SLIDER_HALF + size.QUILL_BLOCK[0]
        # the block at joint 3, and the lower face of the quill that holds the guide
        upward = size.SHAFT_NECK_TOP if knee is KneeBranch.LOWER else -size.SHAFT_BLOCK_HEIGHTS[0]
        joint_3 = shallow / g.magnification - upward + size.QUILL_LOW
        assert upward - size.QUILL_LOW == pytest.approx(joint_3_from_guides(knee))
        # the bearing at joint 2 is above the quill's key in all poses, or below its lower end
        bearing = at.ARM_BEARING_HALF + size.ARM_BEARING_CAP
        lowest, highest = g.shaft_length - np.array([deep, shallow]) / g.magnification
        above = lowest - bearing - at.QUILL_TOP - size.QUILL_KEY
        below = size.QUILL_LOW - (highest + bearing)
        quill = max(above, below) if knee is KneeBranch.LOWER else np.inf
        lengths = g.crank_length, g.coupler_length, g.magnification
        apart = min(float(bar_distance(*lengths, end)) for end in ends)
        tubes = apart - at.TUBE_RADIUS["b4"] - at.TUBE_RADIUS["b7"]
        expected.append([max(clearance - room, 0.0) for room in (beside, joint_3, quill, tubes)])
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_guide_carries_the_whole_slider() -> None:
    np.testing.assert_allclose(needed_guide(np.array([0.1, 0.3])), [0.123, 0.323])


@given(seeds, st.sampled_from([0.0, 0.01, 0.7, 3.0]))
def test_needed_shaft_keeps_the_bearing_above_the_quill_and_the_carriage_above_the_payload(
    seed: int, mass: float
) -> None:
    rng = np.random.default_rng(seed)
    drawn = random_design(rng)
    zeta, k = rng.uniform(0.2, 0.8), drawn.geometry.magnification
    lower = with_knee(drawn, KneeBranch.LOWER)
    shaft = float(needed_shaft(lower, zeta, k))
    # joint 2 of a shaft so long, where joints 5 hang lowest
    bearing = shaft - zeta / k - at.ARM_BEARING_HALF - size.ARM_BEARING_CAP
    assert bearing == pytest.approx(at.QUILL_TOP + size.QUILL_KEY)
    upper = with_knee(replace(drawn, payload=replace(drawn.payload, mass=mass)), KneeBranch.UPPER)
    shaft = float(needed_shaft(upper, zeta, k))
    carriage = shaft + zeta / k - at.CARRIAGE_HALF - max(size.CARRIAGE_CAP, size.RAM_COLLAR[0])
    tops = [at.BARREL_RADIUS]  # above joints 5
    if mass > 0:
        half = PAYLOAD_HEIGHT * payload_scale(mass) / 2
        center = payload_center(upper.geometry, mass)[2] - upper.geometry.platform_joint_height
        tops.append(center + half)
    assert carriage - zeta - max(tops) == pytest.approx(SPARE)


def test_needed_lengths_take_arrays() -> None:
    zeta, k = np.array([0.3, 0.5]), np.array([2.0, 3.0])
    for knee in KneeBranch:
        design = with_knee(APPENDIX_4, knee)
        both = needed_shaft(design, zeta, k)
        single = [needed_shaft(design, *pair) for pair in zip(zeta, k, strict=True)]
        np.testing.assert_allclose(both, single)
