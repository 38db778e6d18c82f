"""Payload and counterweights: as large as their masses, and where they are said to be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import (
    LOAD_DENSITY,
    PAYLOAD_HEIGHT,
    SMALLEST,
    STEEL,
    disc_radius,
    payload_center,
    payload_offset,
    payload_scale,
    place_along,
    stub,
)
from paminsa_viz.dimensions.placement import place_parts
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight
from tests.support.samples import random_design, random_poses, with_knee

masses = st.floats(0.02, 50.0)


@given(masses)
def test_volumes_are_in_proportion_to_masses(mass: float) -> None:
    disc = math.pi * disc_radius(mass) ** 2 * at.BARREL
    assert disc * STEEL == pytest.approx(mass)
    height = PAYLOAD_HEIGHT * payload_scale(mass)
    drum = math.pi * (height / size.PAYLOAD_RATIO) ** 2 * height
    assert drum * LOAD_DENSITY == pytest.approx(mass)


def test_nothing_is_drawn_smaller_than_ten_grams() -> None:
    assert disc_radius(0.0) == disc_radius(-1.0) == disc_radius(0.01) == SMALLEST
    assert math.pi * SMALLEST**2 * at.BARREL * STEEL == pytest.approx(0.01, rel=0.05)
    assert payload_scale(-1.0) == payload_scale(0.0) == 0.0


@given(masses, st.sampled_from(KneeBranch))
def test_payload_touches_the_platform_on_its_side(mass: float, knee: KneeBranch) -> None:
    """It hangs from the flange below the plate, or stands on the plate's ring."""
    geometry = with_knee(APPENDIX_4.geometry, knee)
    x, y, top = payload_offset(geometry)
    assert (x, y) == (0.0, 0.0)
    plate = geometry.platform_joint_height - at.PLATE_BELOW_5
    below = plate - size.PLATE_THICKNESS - size.FLANGE_TIP_DEPTH
    assert top == pytest.approx(below if knee is KneeBranch.LOWER else plate + size.PLATE_RING)
    center = payload_center(geometry, mass)
    away = -1 if knee is KneeBranch.LOWER else 1
    half = away * PAYLOAD_HEIGHT * np.cbrt(mass) / 2
    assert center == pytest.approx([0.0, 0.0, top + half])


@given(st.integers(0, 10_000), st.sampled_from(sorted(BAR_ENDS)), st.booleans(), st.booleans())
def test_counterweights_are_beyond_their_joint_on_the_bars_line(
    seed: int, bar: str, second: bool, far: bool
) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    g = design.geometry
    found = inverse_kinematics(g, random_poses(rng, design, 1)[0])
    joint, other = BAR_ENDS[bar][:: -1 if second else 1]
    beyond = at.BARREL_RADIUS * (rng.uniform(1.01, 9.0) if far else rng.uniform(0.0, 1.0))
    weight = Counterweight(bar, joint, beyond=beyond, mass=1.0)
    ends = [found.points[number][0] for number in (joint, other)]
    outward = (ends[0] - ends[1]) / np.linalg.norm(ends[0] - ends[1])
    matrix = place_parts(found)[f"leg1/{bar}"].matrix
    x = place_along(g, weight)
    assert (matrix @ [x, 0, 0, 1])[:3] == pytest.approx(ends[0] + beyond * outward, abs=1e-12)
    piece = stub(g, weight)
    assert (piece is not None) == far
    if piece is not None:
        assert piece[0] < piece[1]
        assert piece[1] - piece[0] == pytest.approx(beyond)
        assert x in piece
        start = piece[1] if x == piece[0] else piece[0]
        assert (matrix @ [start, 0, 0, 1])[:3] == pytest.approx(ends[0], abs=1e-12)


def test_a_weight_at_a_barrels_edge_needs_no_stub() -> None:
    weight = Counterweight("b8", 8, beyond=at.BARREL_RADIUS, mass=1.0)
    assert stub(APPENDIX_4.geometry, weight) is None
