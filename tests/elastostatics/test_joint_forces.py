"""Joint forces: equilibrium, power, symmetry, linearity, and poses without numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.load import LoadCase, LoadFrame, center_wrench
from paminsa_viz.model.parameters import Counterweight, Friction
from paminsa_viz.model.reach import Limit, home_pose
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.model.statics import static_torques
from tests import oracle
from tests.elastostatics.leg_residuals import body_residuals
from tests.support import samples

EACH = samples.each_robot(range(3))
LOAD = LoadCase(30, -20, 15, 4, -3, 2, 0.02, -0.03, 0.1, LoadFrame.PLATFORM)
WEIGHTS = (
    Counterweight("b3", 7, 0.1, 0.5), Counterweight("b4", 9, 0.12, 0.8),
    Counterweight("b7", 8, -0.05, 0.7), Counterweight("b8", 9, 0.02, 0.4),
)  # fmt: skip


def loaded(design: Design) -> Design:
    return replace(design, load=LOAD, counterweights=WEIGHTS)


def states(design: Design, n: int = 40) -> tuple[Any, Any, Any]:
    return samples.random_states(np.random.default_rng(7), design, n)


@EACH
def test_every_body_of_a_leg_is_in_equilibrium(design: Design) -> None:
    design = loaded(design)
    motion = states(design)
    forces = joint_forces(design, *motion)
    assert (forces.status == Limit.OK).all()
    largest = forces.magnitude.max()
    residual = body_residuals(forces, motion)
    assert np.abs(residual).max() < 1e-12 * largest


@EACH
def test_the_platform_is_in_equilibrium(design: Design) -> None:
    design = loaded(design)
    motion = pose, _, acceleration = states(design)
    forces = joint_forces(design, *motion)
    # by leg: the force on the platform in base axes, and where it acts from P
    world, moment = np.zeros((len(pose), 3)), np.zeros((len(pose), 3))
    for leg in range(3):
        solved = oracle.leg(design, oracle.split(pose), leg)
        u, w = (np.stack(np.broadcast_arrays(*v), -1) for v in (solved.heading, solved.normal))
        r, t, z = np.moveaxis(forces.of("5")[:, leg], -1, 0)[..., None]
        force = r * u + t * w + z * np.array(oracle.UP)
        arm = np.stack(np.broadcast_arrays(*solved.points[5]), -1) - pose[:, [0, 1, 3]]
        world += force
        moment += np.cross(arm, force)
    wrench = center_wrench(design.load, pose[:, 2])
    mass = design.platform.mass + design.payload.mass
    inertia = design.platform.inertia + design.payload.inertia
    world += wrench[:, :3] - mass * (acceleration[:, [0, 1, 3]] + [0, 0, design.gravity])
    moment += wrench[:, 3:] - acceleration[:, 2:3] * [0, 0, inertia]
    inertial = design.payload.mass * acceleration[:, [0, 1, 3]]
    moment -= np.cross([0, 0, design.payload.height], inertial)
    largest = forces.magnitude.max()
    assert np.abs(world).max() < 1e-12 * largest
    assert np.abs(moment).max() < 1e-12 * largest


@EACH
def test_drives_equal_inverse_dynamics_and_statics(design: Design) -> None:
    drives = (Drive(rotor_inertia=1e-4, gear_ratio=50.0), None, None, None)
    friction = Friction(0.1, 0.2, 3.0, 4.0)
    design = replace(loaded(design), friction=friction, drives=drives)
    motion = states(design)
    expected = inverse_dynamics(design, *motion).torque
    found = joint_forces(design, *motion)
    size = np.abs(expected).max(axis=0)
    assert (np.abs(found.torque - expected) / size).max() < 1e-12
    at_rest, expected = joint_forces(design, motion[0]), static_torques(design, motion[0])
    assert (np.abs(at_rest.torque - expected) / np.abs(expected).max(axis=0)).max() < 1e-12
    np.testing.assert_allclose(at_rest.axial, expected[:, 3], rtol=1e-12)


@EACH
def test_power_of_drives_and_load_becomes_energy(design: Design) -> None:
    """Drive and external power minus dT/dt and dV/dt is zero; energies from first principles."""
    design = replace(design, load=LOAD)
    pose, velocity, acceleration = states(design)
    step = 1e-4
    ahead = np.array([-3, -2, -1, 1, 2, 3])[:, None, None] * step
    weights = np.array([-1, 9, -45, 45, -9, 1]) / (60 * step)
    p = pose + velocity * ahead + 0.5 * acceleration * ahead**2
    energy = oracle.kinetic(design, p, velocity + acceleration * ahead) + oracle.potential(
        design, p
    )
    growth = weights @ energy
    forces = joint_forces(design, pose, velocity, acceleration)
    drives = (forces.torque * oracle.actuator_rates(design, pose, velocity)).sum(axis=-1)
    wrench = center_wrench(design.load, pose[:, 2])
    given = (wrench[:, [0, 1, 5, 2]] * velocity).sum(axis=-1)
    assert np.abs(drives + given - growth).max() < 1e-9 * np.abs(drives).max()


@EACH
def test_a_third_of_a_turn_permutes_the_legs(design: Design) -> None:
    design = replace(design, counterweights=WEIGHTS)
    motion = states(design)
    third = 2 * np.pi / 3
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(third), -np.sin(third)], [np.sin(third), np.cos(third)]]
    one = joint_forces(design, *motion)
    other = joint_forces(design, *(part @ turn.T for part in motion))
    size = one.magnitude.max()
    moved = np.roll(one.force, 1, axis=1)
    np.testing.assert_allclose(other.force, moved, rtol=0, atol=1e-11 * size)
    moved = np.roll(one.moment, 1, axis=1)
    np.testing.assert_allclose(other.moment, moved, rtol=0, atol=1e-11 * size)


def test_forces_are_linear_in_the_masses() -> None:
    paths = ("joints.j9", "links.b3", "inertias.b4_transverse", "links.b10", "payload.mass")
    motion = states(APPENDIX_4)
    zero = joint_forces(APPENDIX_4, *motion).force
    parts = [{path: APPENDIX_4.value(path) + 0.5} for path in paths]
    grown = sum(joint_forces(APPENDIX_4.vary(part), *motion).force - zero for part in parts)
    every = {path: value for part in parts for path, value in part.items()}
    together = joint_forces(APPENDIX_4.vary(every), *motion).force - zero
    known = np.isfinite(zero)
    np.testing.assert_allclose(together[known], grown[known], rtol=0, atol=1e-11 * 1e3)


def test_a_weight_on_the_platform_at_home_by_hand() -> None:
    """Of a weight P the legs' joints 5 carry a third each, and the shafts, by k, their arms."""
    weight = 30.0
    load = LoadCase(force_z=-weight)
    pose = (0.0, 0.0, 0.0, -0.5)
    grown = (
        joint_forces(replace(APPENDIX_4, load=load), pose).force
        - joint_forces(APPENDIX_4, pose).force
    )
    k = APPENDIX_4.geometry.magnification
    for joint, share in (("5", 1.0), ("3", k), ("2", k), ("guide", 1 - k)):
        np.testing.assert_allclose(grown[:, JOINT_INDEX[joint], 2], share * weight / 3, rtol=1e-12)
        np.testing.assert_allclose(grown[:, JOINT_INDEX[joint], 0], 0.0, atol=1e-12)


def test_poses_without_forces_have_a_reason_and_no_numbers() -> None:
    radius = float(singular_radius(APPENDIX_4.geometry, 0.2))
    poses = np.array(
        [[0, 0, 0, -0.5], [radius, 0, 0.2, -0.5], [5, 0, 0, -0.5], [np.nan, 0, 0, 0]]
    )  # fmt: skip
    forces = joint_forces(APPENDIX_4, poses)
    assert forces.status[0] == Limit.OK
    assert forces.status[1] == Limit.SINGULAR
    assert forces.status[3] == Limit.NOT_FINITE
    assert (forces.status[1:] != Limit.OK).all()
    for part in (forces.force, forces.moment, forces.torque, forces.axial):
        assert np.isnan(part[1:]).all()
    five = JOINT_INDEX["5"]
    assert np.isnan(np.delete(forces.force[0, :, :, 1], five, axis=-1)).all()
    assert np.isfinite(forces.force[0, :, five]).all()


def test_what_is_no_number_or_too_large_for_one_is_no_force() -> None:
    pose, velocity, acceleration = states(APPENDIX_4, 3)
    velocity[0, 1], acceleration[1, 3] = np.nan, np.nan
    wrench = np.zeros((3, 6))
    wrench[2, 4] = np.nan
    found = joint_forces(APPENDIX_4, pose, velocity, acceleration, load=wrench)
    assert (found.status == Limit.NOT_FINITE).all()
    # a drive's inertia, and what turns the guide links alone, are beyond the largest number
    drive = Drive(rotor_inertia=1.0, gear_ratio=1e4)
    driven = replace(APPENDIX_4, drives=(drive, None, None, None))
    home, zero = home_pose(APPENDIX_4.geometry), np.zeros(4)
    for design, v, a in (
        (driven, zero, [1e302, 0.0, 0.0, 0.0]),
        (APPENDIX_4.vary({"links.b10": 100.0}), [0.0, 0.0, 1e154, 0.0], zero),
    ):
        lost = joint_forces(design, home, v, a)
        known = joint_forces(APPENDIX_4, home, v, a)
        assert (lost.status, known.status) == (Limit.SINGULAR, Limit.OK)
        assert np.isnan(lost.torque).all()
        assert np.isfinite(known.magnitude).all()


def test_shapes_follow_the_batch_and_scalars_are_the_same() -> None:
    pose, velocity, acceleration = (part.reshape(2, 3, 4) for part in states(APPENDIX_4, 6))
    forces = joint_forces(APPENDIX_4, pose, velocity, acceleration)
    assert forces.force.shape == (2, 3, 3, 10, 3)
    assert forces.moment.shape == (2, 3, 3, 10)
    one = joint_forces(APPENDIX_4, pose[1, 2], velocity[1, 2], acceleration[1, 2])
    assert one.force.shape == (3, 10, 3)
    np.testing.assert_allclose(one.force, forces.force[1, 2], rtol=1e-12, atol=1e-12)


def test_a_further_wrench_adds_to_the_load_and_is_checked() -> None:
    pose = states(APPENDIX_4, 3)[0]
    wrench = np.array(LOAD.wrench)
    world = replace(LOAD, frame=LoadFrame.WORLD, point_x=0, point_y=0, point_z=0)
    one = joint_forces(APPENDIX_4, pose, load=wrench)
    other = joint_forces(replace(APPENDIX_4, load=world), pose)
    np.testing.assert_allclose(one.force, other.force, rtol=1e-12, atol=1e-12)
    with pytest.raises(InvalidInput, match="load"):
        joint_forces(APPENDIX_4, pose, load=np.zeros((2, 6)))
