"""Bodies are where the mechanism's joints are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.meshes.placement import BODIES, ORIGIN, Placement, about_z, elevated, place_parts
from paminsa_viz.meshes.posed import transform
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from tests.support.samples import random_design, random_poses, with_knee

seeds = st.integers(0, 10_000)
knees = st.sampled_from(KneeBranch)


def solved(seed: int, knee: KneeBranch, n: int = 1) -> tuple[Design, Configuration]:
    rng = np.random.default_rng(seed)
    design = random_design(rng) if seed % 2 else APPENDIX_4
    poses = random_poses(rng, with_knee(design, knee), n)
    return design, inverse_kinematics(
        with_knee(design.geometry, knee), poses if n > 1 else poses[0]
    )


def ends(design: Design) -> dict[str, dict[int, float]]:
    """Joints on each bar, and how far along the bar they are from its origin [m]."""
    g = design.geometry
    k = g.magnification
    return {
        "b3": {4: -g.crank_length * (1 - 1 / k), 3: 0.0, 7: g.crank_length / k},
        "b4": {9: 0.0, 4: g.coupler_length / k, 5: g.coupler_length},
        "b7": {8: 0.0, 7: g.short_coupler_length},
        "b8": {8: 0.0, 9: g.crank_length},
    }


@given(seeds, knees)
def test_bars_end_at_their_joints(seed: int, knee: KneeBranch) -> None:
    design, configuration = solved(seed, knee)
    places = place_parts(configuration)
    for leg in range(3):
        for bar, joints in ends(design).items():
            matrix = transform(places[f"leg{leg + 1}/{bar}"])
            for joint, along in joints.items():
                point = matrix @ [along, 0.0, 0.0, 1.0]
                assert point[:3] == pytest.approx(configuration.points[joint][leg], abs=1e-12)
            # The bar's y axis is level and across the leg plane: layers stay beside each other.
            across = [-np.sin(configuration.beta[leg]), np.cos(configuration.beta[leg]), 0.0]
            assert matrix[:3, 1] == pytest.approx(across, abs=1e-12)


@given(seeds, knees)
def test_bodies_of_the_leg_stand_upright_at_their_joints(seed: int, knee: KneeBranch) -> None:
    design, configuration = solved(seed, knee)
    places = place_parts(configuration)
    for leg in range(3):
        for body in ("shaft", "slider", "swivel", "guide"):
            matrix = transform(places[f"leg{leg + 1}/{body}"])
            assert matrix[:3, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
            toward = configuration.points[5][leg] - configuration.points[3][leg]
            assert np.cross(matrix[:3, 0], [*toward[:2], 0.0]) == pytest.approx(
                np.zeros(3), abs=1e-12
            )
            if body in ORIGIN:
                expected = configuration.points[ORIGIN[body]][leg]
                assert matrix[:3, 3] == pytest.approx(expected, abs=1e-15)
        shaft = transform(places[f"leg{leg + 1}/shaft"])
        top = shaft @ [0.0, 0.0, design.geometry.shaft_length, 1.0]
        assert top[:3] == pytest.approx(configuration.points[2][leg], abs=1e-12)
        guide = transform(places[f"leg{leg + 1}/guide"])
        axis = [*configuration.points[3][leg, :2], 0.0]
        assert guide[:3, 3] == pytest.approx(axis, abs=1e-15)


@given(seeds, knees)
def test_carriage_and_platform_follow_the_pose(seed: int, knee: KneeBranch) -> None:
    design, configuration = solved(seed, knee)
    places = place_parts(configuration)
    assert places["carriage"].position == pytest.approx([0.0, 0.0, configuration.actuators[3]])
    matrix = transform(places["platform"])
    for leg, angle in enumerate(np.radians([210.0, -30.0, 90.0])):
        g = design.geometry
        local = [
            g.platform_radius * np.cos(angle), g.platform_radius * np.sin(angle),
            g.platform_joint_height, 1.0,
        ]  # fmt: skip
        assert (matrix @ local)[:3] == pytest.approx(configuration.points[5][leg], abs=1e-12)


@given(seeds, knees)
def test_a_batch_is_its_poses_one_by_one(seed: int, knee: KneeBranch) -> None:
    _, many = solved(seed, knee, 4)
    together = place_parts(many)
    assert tuple(together) == BODIES
    for i in range(4):
        alone = place_parts(inverse_kinematics(with_knee(many.geometry, knee), many.pose[i]))
        for body in BODIES:
            assert together[body].position[i] == pytest.approx(alone[body].position, abs=1e-14)
            assert together[body].wxyz[i] == pytest.approx(alone[body].wxyz, abs=1e-14)
            assert np.linalg.norm(alone[body].wxyz) == pytest.approx(1.0, abs=1e-14)


def test_an_open_pantograph_has_no_place() -> None:
    places = place_parts(inverse_kinematics(APPENDIX_4.geometry, [0.0, 0.0, 0.0, -1.5]))
    assert np.isnan(places["leg1/b4"].position).any()
    assert np.isfinite(places["platform"].position).all()


@given(st.floats(-10, 10), st.floats(-10, 10))
def test_quaternions_turn_as_named(heading: float, elevation: float) -> None:
    turned = transform(Placement(np.zeros(3), about_z(np.array(heading))))
    assert turned[:2, 0] == pytest.approx([np.cos(heading), np.sin(heading)], abs=1e-12)
    lifted = transform(Placement(np.zeros(3), elevated(np.array(elevation))))
    assert lifted[[0, 2], 0] == pytest.approx([np.cos(elevation), np.sin(elevation)], abs=1e-12)
