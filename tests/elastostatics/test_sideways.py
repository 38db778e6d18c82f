"""Forces at the joints across the planes, against the assembled structure under its weight."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics.beams import beam_stiffness
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS
from paminsa_viz.elastostatics.leg_frame import leg_frame
from paminsa_viz.elastostatics.leg_matrices import Structure, axes_of, structure
from paminsa_viz.elastostatics.leg_model import FIXED, RETAINED, LegElement
from paminsa_viz.elastostatics.sideways import _redundants, sideways_forces
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.load import center_wrench
from tests.elastostatics.robots import POSE, elastic_design, poses_of

ENDS = {
    "m": ("b10", 0, 1), "guide": ("b10", 8, -1), "8_b8": ("b8", 8, 1), "8_b7": ("b7", 8, 1),
    "9": ("b4", 9, 1), "4": ("b3", 4, -1), "7": ("b3", 7, 1), "3": ("b2", 3, -1),
    "2": ("b1", 2, -1), "5": ("b4", 5, -1),
}  # fmt: skip
"""Which end of which bar ends at a joint alone, and the sign of the force on its first body."""

PIN_MASS = {"j2": ("b2", 2), "j3": ("b3", 3), "j4": ("b4", 4), "j5": ("b4", 5), "j7": ("b7", 7),
            "j8": ("slider", 8), "j9": ("b8", 9)}  # fmt: skip


def along(built: Structure, element: LegElement) -> np.ndarray:
    """Return the way from the first to the second node of an element, (3 legs, 3) [m]."""
    joints = built.frame.joints
    first, second = (
        joints[node.first] + node.share * (joints[node.second] - joints[node.first])
        for node in element[1:]
    )
    return second - first


def weights(design: Design, built: Structure) -> tuple[np.ndarray, list[np.ndarray]]:
    """Loads of the weight on the freedoms (3, size), and equivalent end loads of each element."""
    model = built.matrices.model
    load = np.zeros((3, model.size))
    ends, ways = [], [along(built, element) for element in model.elements]
    lengths = [np.linalg.norm(way, axis=-1) for way in ways]
    for element, way, length in zip(model.elements, ways, lengths, strict=True):
        whole = sum(
            other for e, other in zip(model.elements, lengths, strict=True) if e.bar == element.bar
        )
        mass = design.value(f"links.{element.bar}") * length / whole
        if element.bar == "b10":  # what is beyond the slider does not bend anything
            mass = np.zeros(3)
        force = np.zeros((3, 12))
        force[:, [2, 8]] = -0.5 * (mass * design.gravity)[:, None]
        # end moments of a uniform load: r x F / 12 L at the two ends
        couple = np.cross(way, [0.0, 0.0, -1.0]) * (mass * design.gravity)[:, None] / 12
        force[:, 3:6], force[:, 9:12] = couple, -couple
        ends.append(force)
        for row, target in enumerate(element.freedoms):
            if target != FIXED:
                load[:, target] += force[:, row]
    for joint, place in PIN_MASS.items():
        target = model.node(*place).freedoms[2]
        load[:, target] -= design.value(f"joints.{joint}") * design.gravity
    return load, ends


def reference(design: Design, pose: np.ndarray, *, shear: bool) -> np.ndarray:
    """Forces and moments (3 legs, 10 joints, 6) in leg frames from the assembled structure."""
    built = structure(design, pose, shear=shear)
    model, maps = built.matrices.model, built.frame.shared_map
    load, ends = weights(design, built)
    inner, kept = slice(RETAINED, None), slice(0, RETAINED)
    k = built.stiffness
    kii, kir = k[:, inner, inner], k[:, inner, kept]
    pulled = np.linalg.solve(kii, load[:, inner, None])[..., 0]
    at_kept = load[:, kept] - np.einsum("kir,ki->kr", kir, pulled)
    right = np.einsum("krj,kr->j", maps, at_kept)
    wrench = center_wrench(design.load, pose[2])
    wrench[2] -= (design.payload.mass + design.platform.mass) * design.gravity
    right[:6] += wrench
    twist = np.linalg.solve(built.joined(), right)
    u = np.zeros((3, model.size + 1))  # what the base holds is last
    u[:, :RETAINED] = maps @ twist
    u[:, RETAINED:-1] = pulled - np.linalg.solve(kii, kir @ u[:, :RETAINED, None])[..., 0]
    found = np.zeros((3, len(JOINTS), 6))
    for key, (bar, joint, sign) in ENDS.items():
        for element, load in zip(model.elements, ends, strict=True):
            at = [n.first == joint for n in element[1:]]
            if element.bar != bar or not any(at):
                continue
            length = np.linalg.norm(along(built, element), axis=-1)
            own = design.elastic.section(bar), design.elastic
            turn = np.kron(np.eye(4), axes_of(bar, built.frame))
            block = turn @ beam_stiffness(length, *own, shear=shear) @ np.swapaxes(turn, -1, -2)
            force = np.einsum("kij,kj->ki", block, u[:, element.freedoms]) - load
            half = slice(0, 6) if at[0] else slice(6, 12)
            found[:, JOINT_INDEX[key]] = sign * force[:, half]
    return found


@pytest.mark.parametrize("shear", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_forces_are_those_of_the_assembled_structure_under_its_weight(seed: int, shear) -> None:
    """Across the plane and in it; there equilibrium decides, and the structure has to find it."""
    design = elastic_design(seed).vary(
        {"load.force_x": 12.0, "load.force_y": -7.0, "load.moment_z": 1.5, "load.moment_x": 2.0,
         "load.point_x": 0.05, "payload.mass": 4.0}
    )  # fmt: skip
    pose = poses_of(design, 1, seed)[0]
    found = sideways_forces(design, pose, shear=shear)
    expected = reference(design, pose, shear=shear)
    force = found.whole
    scale = np.abs(force).max()
    expected[:, JOINT_INDEX["5"], 2] -= design.joints.j5 * design.gravity  # m_5 is on B4
    counted = [JOINT_INDEX[key] for key in ENDS if key != "m"]  # of B10's weight
    np.testing.assert_allclose(force[:, counted], expected[:, counted, :3], atol=1e-6 * scale)
    np.testing.assert_allclose(force[..., 1], expected[..., 1], atol=1e-6 * scale)
    moments = expected[..., [3, 5]]
    np.testing.assert_allclose(found.moment, moments, atol=1e-6 * np.abs(moments).max())


def test_sideways_forces_balance_every_body() -> None:
    design = APPENDIX_4.vary({"load.force_y": 30.0})
    given = design, leg_frame(design.geometry, POSE)
    found = sideways_forces(design, POSE)
    f = {joint.key: found.force[..., JOINT_INDEX[joint.key]] for joint in JOINTS}
    for body in (
        f["9"] + f["4"] - f["5"],  # B4
        f["8_b8"] - f["9"],  # B8
        f["8_b7"] - f["7"],  # B7
        f["3"] + f["7"] - f["4"],  # B3
        f["2"] - f["3"],  # shaft
        f["guide"] - f["8_b8"] - f["8_b7"],  # slider
        f["m"] - f["guide"],  # B10
    ):
        np.testing.assert_allclose(body, 0.0, atol=1e-12 * np.abs(found.force).max())
    np.testing.assert_array_equal(found.moment[..., JOINT_INDEX["5"], :], 0.0)
    redundant = _redundants(*given, found.plane, -found.plane.of("5")[..., 1], shear=False)
    at_7 = np.c_[f["7"], found.moment[:, JOINT_INDEX["7"]]]
    np.testing.assert_allclose(redundant[:, 2:], at_7, rtol=1e-9)
    np.testing.assert_allclose(
        redundant[:, :2], np.c_[f["2"], found.moment[:, JOINT_INDEX["2"], 0]]
    )
    # the drive of M_k holds t rho
    torque = found.moment[..., JOINT_INDEX["m"], 1]
    np.testing.assert_allclose(torque, found.plane.torque[:3], rtol=1e-9)


def test_elasticity_decides_what_equilibrium_leaves_open_and_nothing_else() -> None:
    loaded = APPENDIX_4.vary({"load.force_y": 30.0})
    soft, stiff = (
        sideways_forces(loaded.vary({"elastic.b1_outer": outer}), POSE) for outer in (0.03, 0.1)
    )
    np.testing.assert_array_equal(soft.plane.force, stiff.plane.force)
    np.testing.assert_array_equal(soft.plane.torque, stiff.plane.torque)
    for key, changes in (("2", True), ("guide", True), ("5", False)):
        index = JOINT_INDEX[key]
        same = np.allclose(soft.force[..., index], stiff.force[..., index], rtol=0.05)
        assert same != changes


def test_unreachable_pose_is_nan() -> None:
    found = sideways_forces(APPENDIX_4, [POSE, (2.0, 0.0, 0.0, -0.5)])
    assert np.isnan(found.force[1]).all()
    assert np.isnan(found.moment[1]).all()
    assert np.isfinite(found.force[0]).all()
