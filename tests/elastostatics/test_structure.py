"""Beam elements and the structure made of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.elastostatics.beams import beam_stiffness
from paminsa_viz.elastostatics.leg_matrices import structure
from paminsa_viz.elastostatics.leg_model import CARRIAGE, leg_model
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.elastic import BeamSection, Elastic
from tests.elastostatics.robots import POSE, elastic_design, poses_of

SECTION = BeamSection(4e-4, 6e-8, 9e-8, 1.1e-7, 0.54, 0.02)
ELASTIC = Elastic()
LENGTH = 0.63


@pytest.mark.parametrize("shear", [False, True])
def test_cantilever_bends_twists_and_stretches_as_the_handbook_says(shear: bool) -> None:
    tip = np.linalg.inv(beam_stiffness(LENGTH, SECTION, ELASTIC, shear=shear)[6:, 6:])
    young, rigidity = ELASTIC.young_modulus, ELASTIC.shear_modulus
    sheared = LENGTH / (rigidity * SECTION.area * SECTION.shear) if shear else 0.0
    expected = np.diag(
        [
            LENGTH / (young * SECTION.area),
            LENGTH**3 / (3 * young * SECTION.inertia_in) + sheared,
            LENGTH**3 / (3 * young * SECTION.inertia_out) + sheared,
            LENGTH / (rigidity * SECTION.torsion),
            LENGTH / (young * SECTION.inertia_out),
            LENGTH / (young * SECTION.inertia_in),
        ]
    )
    expected[1, 5] = expected[5, 1] = LENGTH**2 / (2 * young * SECTION.inertia_in)
    expected[2, 4] = expected[4, 2] = -(LENGTH**2) / (2 * young * SECTION.inertia_out)
    np.testing.assert_allclose(tip, expected, rtol=1e-12, atol=1e-20)


@pytest.mark.parametrize("shear", [False, True])
def test_rigid_motions_meet_no_force(shear: bool) -> None:
    rng = np.random.default_rng(1)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    axes *= np.sign(np.linalg.det(axes))
    turn = np.kron(np.eye(4), axes)
    k = turn.T @ beam_stiffness(LENGTH, SECTION, ELASTIC, shear=shear) @ turn
    first = rng.normal(size=3)
    second = first + LENGTH * axes[0]
    move, turn = rng.normal(size=(2, 3))
    motion = [*(move + np.cross(turn, first)), *turn, *(move + np.cross(turn, second)), *turn]
    assert np.abs(k @ motion).max() < 1e-9 * np.abs(k).max()
    np.testing.assert_allclose(k, k.T, rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("shear", [False, True])
def test_more_elements_change_nothing_at_rest(seed: int, shear: bool) -> None:
    """Beam elements are exact for loads at their nodes."""
    design = elastic_design(seed)
    poses = poses_of(design, 2, seed)
    one, four = (
        structure(design, poses, divisions=n, shear=shear).platform_stiffness() for n in (1, 4)
    )
    scale = np.abs(one).max(axis=(-1, -2), keepdims=True)
    np.testing.assert_allclose(four / scale, one / scale, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_leg_has_no_radial_stiffness_and_magnifies_the_lift(seed: int) -> None:
    design = elastic_design(seed)
    k = structure(design, poses_of(design, 3, seed)).condensed()
    scale = np.abs(k).max(axis=(-1, -2), keepdims=True)
    np.testing.assert_allclose(k, np.swapaxes(k, -1, -2), atol=1e-9 * scale.max())
    assert (np.abs(k[..., 0, :]) < 1e-9 * scale[..., 0]).all()
    # k dZ lifts joint 5 without a strain
    lift = np.array([0.0, 0.0, design.geometry.magnification, 1.0])
    assert (np.abs(k @ lift) < 1e-9 * scale[..., 0]).all()


def test_freedoms_of_a_leg() -> None:
    """Without drive and M4 a leg of rigid bars has 2 freedoms and 5 redundant constraints."""
    rigid = leg_model(ELASTIC)
    assert (rigid.size, len(rigid.springs)) == (52, 1)
    every = dict.fromkeys(
        ("bearing_radial", "bearing_axial", "bearing_tilt", "ball", "guide", "guide_tilt"), 1e6
    )
    soft = leg_model(replace(ELASTIC, **every))
    # eight revolutes with 5 springs each and a drive, guide 5, ball 3
    assert len(soft.springs) == 8 * 5 + 1 + 5 + 3
    assert soft.size == rigid.size + len(soft.springs) - 1
    for model in (rigid, soft):
        assert all(node.first == node.second for node in model.nodes if not node.share)


def test_unreachable_pose_is_nan_and_spoils_no_other() -> None:
    both = structure(APPENDIX_4, [POSE, (2.0, 0.0, 0.0, -0.6)]).platform_stiffness()
    assert np.isnan(both[1]).all()
    alone = structure(APPENDIX_4, POSE).platform_stiffness()
    np.testing.assert_allclose(both[0], alone, rtol=1e-9)


def test_displacements_agree_with_the_stiffness() -> None:
    """Strain energy of the legs and the drive of M4 is half the work of the wrench."""
    design = elastic_design(2)
    built = structure(design, poses_of(design, 4))
    twist = np.random.default_rng(0).normal(size=(4, 6)) * [1e-3, 1e-3, 1e-3, 0.01, 0.01, 0.01]
    wrench = np.einsum("nij,nj->ni", built.platform_stiffness(), twist)
    moved = built.displacements(twist)
    lift = moved[:, 0, CARRIAGE]
    energy = np.einsum("nki,nkij,nkj->n", moved, built.stiffness, moved)
    energy += design.elastic.drive_linear * lift**2
    np.testing.assert_allclose(energy, (wrench * twist).sum(axis=-1), rtol=1e-9)
    assert not math.isclose(energy[0], energy[1])


def test_bars_without_length_are_refused() -> None:
    with pytest.raises(InvalidInput, match=r"geometry.arm_length.*without length"):
        structure(APPENDIX_4.vary({"geometry.arm_length": 0.0}), POSE)
    with pytest.raises(InvalidInput, match="divisions"):
        structure(APPENDIX_4, POSE, divisions=0)
