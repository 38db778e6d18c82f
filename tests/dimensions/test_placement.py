"""Bodies are where the mechanism's joints are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.dimensions.placement import BODIES, Placement, about_z, elevated, place_parts
from paminsa_viz.model.design import APPENDIX_4, Geometry, KneeBranch
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from tests.support.samples import random_design, random_poses, with_knee

seeds = st.integers(0, 10_000)
knees = st.sampled_from(KneeBranch)


def solved(seed: int, knee: KneeBranch, n: int) -> tuple[Geometry, Configuration]:
    rng = np.random.default_rng(seed)
    design = with_knee(random_design(rng) if seed % 2 else APPENDIX_4, knee)
    return design.geometry, inverse_kinematics(design.geometry, random_poses(rng, design, n))


@pytest.mark.slow
@given(seeds, knees)
def test_bodies_stand_at_their_joints(seed: int, knee: KneeBranch) -> None:
    g, many = solved(seed, knee, 4)
    together = place_parts(many)
    assert tuple(together) == BODIES
    k = g.magnification
    bars = {  # joints on each bar, and how far along it they are from its origin
        "b3": {4: -g.crank_length * (1 - 1 / k), 3: 0.0, 7: g.crank_length / k},
        "b4": {9: 0.0, 4: g.coupler_length / k, 5: g.coupler_length},
        "b7": {8: 0.0, 7: g.short_coupler_length},
        "b8": {8: 0.0, 9: g.crank_length},
    }
    upright = {"shaft": {3: 0.0, 2: g.shaft_length}, "slider": {8: 0.0}, "swivel": {5: 0.0}}
    for i, pose in enumerate(many.pose):
        one = inverse_kinematics(g, pose)
        places = place_parts(one)
        for body in BODIES:  # a batch is its poses one by one
            assert together[body].position[i] == pytest.approx(places[body].position, abs=1e-14)
            assert together[body].wxyz[i] == pytest.approx(places[body].wxyz, abs=1e-14)
        for leg in range(3):
            beta = one.beta[leg]
            for bar, joints in bars.items():
                matrix = places[f"leg{leg + 1}/{bar}"].matrix
                for joint, along in joints.items():
                    point = matrix @ [along, 0.0, 0.0, 1.0]
                    assert point[:3] == pytest.approx(one.points[joint][leg], abs=1e-12)
                # Level and across the leg plane: layers stay next to each other.
                assert matrix[:3, 1] == pytest.approx([-np.sin(beta), np.cos(beta), 0], abs=1e-12)
            for body, joints in (upright | {"guide": {}}).items():
                matrix = places[f"leg{leg + 1}/{body}"].matrix
                assert matrix[:3, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
                toward = one.points[5][leg] - one.points[3][leg]
                across = np.cross(matrix[:3, 0], [*toward[:2], 0.0])
                assert across == pytest.approx(np.zeros(3), abs=1e-12)
                for joint, height in joints.items():
                    point = matrix @ [0.0, 0.0, height, 1.0]
                    assert point[:3] == pytest.approx(one.points[joint][leg], abs=1e-12)
            axis = [*one.points[3][leg, :2], 0.0]
            assert places[f"leg{leg + 1}/guide"].position == pytest.approx(axis, abs=1e-15)
        assert places["carriage"].position == pytest.approx([0.0, 0.0, one.actuators[3]])
        assert places["carriage"].matrix[:3, :3].tolist() == np.eye(3).tolist()
        matrix = places["platform"].matrix
        for leg, angle in enumerate(np.radians([210.0, -30.0, 90.0])):
            r = g.platform_radius
            local = [r * np.cos(angle), r * np.sin(angle), g.platform_joint_height, 1.0]
            assert (matrix @ local)[:3] == pytest.approx(one.points[5][leg], abs=1e-12)


def test_an_open_pantograph_has_no_place() -> None:
    places = place_parts(inverse_kinematics(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -1.5]))
    assert np.isnan(places["leg1/b4"].position).any()
    assert np.isfinite(places["platform"].position).all()


@given(st.floats(-10, 10), st.floats(-10, 10))
def test_quaternions_turn_as_named(heading: float, elevation: float) -> None:
    turned = Placement(np.zeros(3), about_z(np.array(heading))).matrix
    assert turned[:2, 0] == pytest.approx([np.cos(heading), np.sin(heading)], abs=1e-12)
    lifted = Placement(np.zeros(3), elevated(np.array(elevation))).matrix
    assert lifted[[0, 2], 0] == pytest.approx([np.cos(elevation), np.sin(elevation)], abs=1e-12)
