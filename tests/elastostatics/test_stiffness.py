"""Stiffness of the platform: two independent routes, limits, symmetry, energy, singular poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.elastostatics.drive_stiffness import drive_stiffness
from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.elastostatics.leg_matrices import Structure, structure
from paminsa_viz.elastostatics.leg_model import CARRIAGE, RETAINED
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.elastostatics.stiffness import (
    SHARE_LABELS,
    SHARES,
    _inverse,
    compensate,
    leg_compliance,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singularity import singular_radius, singular_rotation
from tests.elastostatics.robots import POSE, elastic_design, poses_of

SEEDS = range(8)
ACTUATED = [0, 1, 5, 2]
RIGID = {"elastic.young_modulus": 1e18, "elastic.shear_modulus": 1e18}


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    scale = np.abs(expected).max(axis=(-1, -2), keepdims=True)
    return float((np.abs(found - expected) / scale).max())


@pytest.mark.parametrize("shear", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_force_method_agrees_with_the_assembled_structure(seed: int, shear: bool) -> None:
    """Equilibrium and Castigliano against displacements of 151 freedoms."""
    design = elastic_design(seed)
    poses = poses_of(design, 4, seed)
    built = structure(design, poses, shear=shear)
    frame = leg_frame(design.geometry, poses)
    leg = leg_compliance(frame, design.elastic, shear=shear)
    inverse = np.linalg.inv(built.condensed()[..., 1:3, 1:3])
    assert relative(leg.matrix, inverse) < 1e-9
    assert leg.redundant.shape == (4, 3, 5, 2)
    found = platform_stiffness(design, poses, shear=shear)
    assert relative(found.matrix, built.platform_stiffness()) < 1e-9


@pytest.mark.parametrize("seed", SEEDS)
def test_matrix_is_symmetric_positive_definite_and_inverts(seed: int) -> None:
    design = elastic_design(seed)
    found = platform_stiffness(design, poses_of(design, 6, seed))
    np.testing.assert_array_equal(found.matrix, np.swapaxes(found.matrix, -1, -2))
    length = design.geometry.platform_radius
    scale = np.array([1, 1, 1, length, length, length])
    values = np.linalg.eigvalsh(found.matrix / scale / scale[:, None])
    assert (values > 0).all()
    identity = (found.matrix / scale[:, None]) @ (found.compliance * scale)
    np.testing.assert_allclose(identity, np.broadcast_to(np.eye(6), identity.shape), atol=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_turning_the_pose_by_120_degrees_turns_the_stiffness(seed: int) -> None:
    design = elastic_design(seed)
    poses = poses_of(design, 4, seed)
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = poses.copy()
    turned[:, :2] = poses[:, :2] @ turn[:2, :2].T
    both = np.kron(np.eye(2), turn)
    expected = both @ platform_stiffness(design, poses).matrix @ both.T
    assert relative(platform_stiffness(design, turned).matrix, expected) < 1e-9


def test_bars_deform_by_shear_only_if_it_is_said() -> None:
    design = APPENDIX_4.vary({"payload.mass": 5.0, "load.force_y": 30.0})
    frame = leg_frame(design.geometry, POSE)
    for found in (
        lambda **how: platform_stiffness(design, POSE, **how).matrix,
        lambda **how: structure(design, POSE, **how).stiffness,
        lambda **how: leg_compliance(frame, design.elastic, **how).matrix,
        lambda **how: strain_shares(design, POSE, **how).energy,
        lambda **how: compensate(design, POSE, **how).deflection,
        lambda **how: sideways_forces(design, POSE, **how).force,
    ):
        usual = found()
        np.testing.assert_array_equal(found(shear=False), usual)
        assert np.abs(found(shear=True) - usual).max() > 1e-4 * np.abs(usual).max()


def test_centered_robot_is_isotropic() -> None:
    k = platform_stiffness(APPENDIX_4, (0.0, 0.0, 0.4, -0.6)).matrix
    assert k[0, 0] == pytest.approx(k[1, 1], rel=1e-10)
    assert abs(k[0, 1]) < 1e-8 * k[0, 0]
    assert np.abs(k[2, [0, 1, 3, 4]]).max() < 1e-8 * k[2, 2]


@pytest.mark.parametrize("knee", KneeBranch)
def test_mirrored_robot_has_the_mirrored_stiffness(knee: KneeBranch) -> None:
    """With l_B5 = l_B2 = 0 and rigid arms, standing is the mirror image of hanging."""
    changes = {"geometry.platform_joint_height": 0.0, "geometry.shaft_length": 0.0}
    design = APPENDIX_4.vary(changes).with_knee(knee)
    other = design.with_knee(KneeBranch.UPPER if knee is KneeBranch.LOWER else KneeBranch.LOWER)
    height = -0.6 * knee.sign
    k = platform_stiffness(design, (0.04, -0.02, 0.3, height)).matrix
    mirrored = platform_stiffness(other, (0.04, -0.02, 0.3, -height)).matrix
    flip = np.diag([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
    assert relative(flip @ mirrored @ flip, k) < 1e-10


def drive_of(built: Structure) -> int:
    """Return the freedom that the drive of M_k turns."""
    springs = built.matrices.model.springs
    return next(spring.second for spring in springs if spring.stiffness == "drive_rotary")


@pytest.mark.parametrize("seed", SEEDS[:4])
@pytest.mark.parametrize("young", [1e9, 1e13])
def test_drive_torques_are_those_of_statics_at_any_young_modulus(seed: int, young: float) -> None:
    """The drives of the assembled structure carry J^T w, and M4 its force."""
    design = elastic_design(seed).vary({"elastic.young_modulus": young})
    poses = poses_of(design, 3, seed)
    built = structure(design, poses)
    wrench = np.random.default_rng(seed).normal(size=(3, 6))
    twist = np.linalg.solve(built.platform_stiffness(), wrench[..., None])[..., 0]
    moved = built.displacements(twist)
    rotary = design.elastic.drive_rotary * moved[..., drive_of(built)]
    lift = design.elastic.drive_linear * moved[:, 0, CARRIAGE]
    carried = np.concatenate([rotary, lift[:, None]], axis=-1)
    j = jacobian(design.geometry, poses)
    expected = np.einsum("nij,ni->nj", j, wrench[:, ACTUATED])
    size = np.abs(expected).max(axis=-1, keepdims=True)
    np.testing.assert_allclose(carried / size, expected / size, atol=2e-7)


@pytest.mark.parametrize("seed", SEEDS)
def test_rigid_bars_leave_the_stiffness_of_the_drives(seed: int) -> None:
    design = elastic_design(seed, soft_joints=False)
    poses = poses_of(design, 4, seed)
    alone = np.linalg.inv(drive_stiffness(design, poses, loaded=False))
    errors = []
    for young in (1e15, 1e16):
        stiff = design.vary(dict.fromkeys(RIGID, young))
        c = platform_stiffness(stiff, poses).compliance
        errors.append(relative(c[:, ACTUATED][:, :, ACTUATED], alone))
    assert np.abs(c[:, 3:5]).max() < 1e-3 * np.abs(c).max()
    assert errors[0] < 2e-2
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.05)


@pytest.mark.parametrize("radius", [0.0, 1e-9])
def test_singular_poses_have_a_reason_and_no_number(radius: float) -> None:
    geometry = APPENDIX_4.geometry
    theta, fold = 0.3, singular_rotation(geometry)
    on_circle = float(singular_radius(geometry, theta)) - radius
    poses = [(on_circle, 0.0, theta, -0.5), (0.0, 0.02, fold, -0.5), (3.0, 0.0, 0.0, -0.5), POSE]
    poses[1] = (0.0, 0.02, fold - radius, -0.5)
    found = platform_stiffness(APPENDIX_4, poses)
    assert [Limit(value) for value in found.status] == [
        Limit.SINGULAR, Limit.SINGULAR, Limit.STRETCHED, Limit.OK
    ]  # fmt: skip
    assert np.isnan(found.compliance[:3]).all()
    assert np.isnan(found.along(0)[:3]).all()
    assert np.isnan(found.tilt[:3]).all()
    assert np.isnan(found.deflection(np.ones(6))[:3]).all()
    assert np.isfinite(found.matrix[[0, 1, 3]]).all()
    assert np.isfinite(found.compliance[3]).all()
    axes, directions = found.ellipsoid()
    assert np.isnan(axes[:3]).all()
    assert np.isfinite(directions[3]).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_energy_of_the_parts_is_half_the_work(seed: int) -> None:
    design = elastic_design(seed)
    poses = poses_of(design, 3, seed)
    wrench = np.random.default_rng(seed).normal(size=(3, 6))
    shares = strain_shares(design, poses, wrench)
    twist = platform_stiffness(design, poses).deflection(wrench)
    np.testing.assert_allclose(shares.total, 0.5 * (wrench * twist).sum(axis=-1), rtol=1e-8)
    np.testing.assert_allclose(shares.share.sum(axis=-1), 1.0)
    assert (shares.energy >= 0).all()


def test_share_of_a_part_is_what_stiffening_it_gains() -> None:
    """Energy is a sum of terms 1/E_i: its derivative by a part's stiffness is minus its share."""
    renamed = [name for name, label in zip(SHARES, SHARE_LABELS, strict=True) if name != label]
    assert renamed == ["drive"]  # after its motors
    design = elastic_design(3)
    wrench = np.array([3.0, -2.0, 5.0, 0.1, 0.2, -0.3])
    pose = poses_of(design, 1, 3)[0]
    shares = dict(zip(SHARES, strain_shares(design, pose, wrench).share, strict=True))

    def energy(**changes: float) -> float:
        changed = design.vary({f"elastic.{name}": value for name, value in changes.items()})
        return float(wrench @ platform_stiffness(changed, pose).deflection(wrench))

    for part, names in (("drive", ("drive_rotary",)), ("M4", ("drive_linear",))):
        step = 1e-5
        more, less = (
            energy(**{n: design.value(f"elastic.{n}") * f for n in names})
            for f in (1 + step, 1 - step)
        )
        assert -(more - less) / (2 * step * energy()) == pytest.approx(shares[part], abs=1e-6)
    section = design.elastic.section("b4")
    values = {"area": section.area, "inertia_in": section.inertia_in,
              "inertia_out": section.inertia_out, "torsion": section.torsion}  # fmt: skip
    more, less = (
        energy(**{f"b4_{name}": value * f for name, value in values.items()})
        for f in (1 + 1e-5, 1 - 1e-5)
    )
    assert -(more - less) / (2e-5 * energy()) == pytest.approx(shares["B4"], rel=1e-5)


def test_deflection_of_a_payload_and_its_compensation() -> None:
    """Some half a millimeter under 10 kg; the motors bring back all but the tilt."""
    design = APPENDIX_4.vary({"payload.mass": 10.0})
    pose = np.array(POSE)
    np.testing.assert_allclose(load_wrench(design, pose), [0, 0, -98.1, 0, 0, 0])
    load = LoadCase(4.0, -7.0, 11.0, 2.0, 3.0, -5.0, 0.1, 0.2, -0.3, LoadFrame.PLATFORM)
    turn = Rotation.from_rotvec([0.0, 0.0, pose[2]])
    moment = load.wrench[3:] + np.cross(load.point, load.wrench[:3])
    expected = [*turn.apply(load.wrench[:3]) - [0.0, 0.0, 98.1], *turn.apply(moment)]
    np.testing.assert_allclose(load_wrench(replace(design, load=load), pose), expected)
    found = compensate(design, pose)
    assert -0.7e-3 < found.deflection[2] < -0.3e-3
    moved = jacobian(design.geometry, pose) @ found.actuators
    np.testing.assert_allclose(moved, -found.deflection[ACTUATED], rtol=1e-10)
    assert found.tilt == pytest.approx(np.hypot(*found.deflection[3:5]))
    assert found.tilt > 1e-6


def test_moved_motors_strain_no_bar() -> None:
    """Turning M_k and lifting M4 with the platform free moves it as the rigid robot."""
    design = elastic_design(4)
    pose = poses_of(design, 1, 4)[0]
    built = structure(design, pose)
    k = built.stiffness
    # the base's side of a drive is fixed: turning the motor by d loads the leg with k d
    motors = np.array([1e-3, -2e-3, 5e-4])
    inner, kept = slice(RETAINED, None), slice(0, RETAINED)
    pull = np.zeros(k.shape[:2])
    pull[:, drive_of(built)] = design.elastic.drive_rotary * motors
    bent = np.linalg.solve(k[:, inner, inner], pull[:, inner, None])
    kept_force = -(k[:, kept, inner] @ bent)[..., 0]
    right = np.einsum("kij,ki->j", built.frame.shared_map, kept_force)
    twist = np.linalg.solve(built.joined(), right)
    expected = jacobian(design.geometry, pose)[:, :3] @ motors
    np.testing.assert_allclose(twist[ACTUATED], expected, atol=1e-7 * np.abs(expected).max())
    assert np.abs(twist[[3, 4, 6]]).max() < 1e-7 * np.abs(expected).max()


def test_ellipsoid_bounds_what_unit_forces_do() -> None:
    found = platform_stiffness(APPENDIX_4, POSE)
    axes, directions = found.ellipsoid()
    force = np.random.default_rng(0).normal(size=(200, 3))
    force /= np.linalg.norm(force, axis=-1, keepdims=True)
    moved = np.linalg.norm(force @ found.compliance[:3, :3], axis=-1)
    assert moved.max() <= axes[-1]
    assert moved.max() > 0.9 * axes[-1]
    assert moved.min() >= axes[0]
    softest = directions[:, -1]
    np.testing.assert_allclose(found.compliance[:3, :3] @ softest, axes[-1] * softest)


def test_maps_of_joint5_are_transposed_equilibrium() -> None:
    frame = leg_frame(APPENDIX_4.geometry, POSE)
    force = np.random.default_rng(1).normal(size=3)
    for leg, g in enumerate(frame.joint5_map):
        world = frame.axes[leg].T @ force
        np.testing.assert_allclose(g.T @ force, [*world, *np.cross(frame.platform[leg], world)])


def test_no_direction_is_softest_in_the_middle_where_three_legs_are_alike() -> None:
    poses = np.array([POSE, [0.0, 0.0, 0.0, POSE[3]]])
    np.testing.assert_array_equal(
        np.isnan(platform_stiffness(APPENDIX_4, poses).softest_direction), [False, True]
    )


def test_softest_directions_are_the_least_of_all_and_axes_lie_between() -> None:
    found = platform_stiffness(APPENDIX_4, POSE)
    angle = np.linspace(0, np.pi, 2001)
    around = np.stack([np.cos(angle), np.sin(angle)])
    for rows, value, axes in (([0, 1], found.horizontal, (0, 1)), ([3, 4], found.tilt, (3, 4))):
        c = found.compliance[np.ix_(rows, rows)]
        every = 1 / np.einsum("in,ij,jn->n", around, c, around)
        assert value == pytest.approx(every.min(), rel=1e-5)
        if axes[0] == 0:
            assert found.softest_direction == pytest.approx(angle[every.argmin()], abs=0.002)
        for axis, place in zip(axes, (0, 1000), strict=True):
            assert found.along(axis) == pytest.approx(every[place], rel=1e-9)
            assert found.along(axis) > value


def test_displacement_under_a_force_is_force_over_stiffness() -> None:
    found = platform_stiffness(APPENDIX_4, POSE)
    for axis in range(6):
        wrench = 3.0 * np.eye(6)[axis]
        twist = np.linalg.solve(found.matrix, wrench)
        np.testing.assert_allclose(found.deflection(wrench), twist, rtol=1e-7, atol=1e-15)
        assert twist[axis] == pytest.approx(3.0 / float(found.along(axis)), rel=1e-7)


@pytest.mark.parametrize("axis", range(6))
def test_a_stiffness_is_singular_from_a_share_of_the_largest_on(axis: int) -> None:
    """1e-12 of it, whatever the axis; a turn counts as the way of a point half a meter away."""
    units = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    shares = np.full((4, 6), 1.0)
    shares[:, (axis + 1) % 6] = 100.0  # the largest
    shares[:, axis] = np.array([0.98, 1.0, 1.02, 50.0]) * 1e-10
    matrices = shares[:, :, None] * np.eye(6) * units**2
    inverse, singular = _inverse(matrices, 0.5)
    assert singular.tolist() == [True, True, False, False]
    np.testing.assert_allclose(inverse[2:] @ matrices[2:], np.tile(np.eye(6), (2, 1, 1)), atol=1e-9)


def test_a_matrix_that_has_no_inverse_is_told_by_its_largest_part() -> None:
    plain = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    none = np.diag([1e-20, 1e-20, 1e-20, 1.0, 1.0, 1.0])
    inverse, singular = _inverse(np.array([plain, none, np.full((6, 6), np.nan)]), 0.5)
    assert singular.tolist() == [False, True, False]
    np.testing.assert_allclose(inverse[0] @ plain, np.eye(6), atol=1e-12)
    assert np.isnan(inverse[1:]).any(axis=(1, 2)).all()
