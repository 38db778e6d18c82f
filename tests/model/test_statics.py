"""Static torques against first principles, the energy they come from, and their parts."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    Design,
    KneeBranch,
    inverse_jacobian,
    lift_constant,
    lumped_matrix,
    mass_vector,
    solve_field,
    static_breakdown,
    static_imbalance,
    static_torques,
    unit_torques,
    xy_grid,
)
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.statics import imbalance_parts, shown_imbalance
from paminsa_viz.quantities import QUANTITIES
from tests import oracle
from tests.support.cases import BOTH, Case, assert_close, assert_within, cases
from tests.support.samples import with_knee

BODIES = tuple(p.path for p in PARAMETERS if p.group in ("joints", "links"))


def massless(design: Design, **changes: float) -> Design:
    """The same robot with no mass but a platform of next to nothing, and the changes."""
    values = dict.fromkeys(MASS_PATHS, 0.0) | {"platform.mass": 1e-30}
    return design.vary(values | {key.replace("__", "."): value for key, value in changes.items()})


@pytest.mark.slow
@given(case=cases())
def test_static_torques_are_those_of_first_principles(case: Case) -> None:
    for natural in (False, True):
        got = static_torques(case.design, case.poses(natural=natural))
        assert_close(got, case.static_torques(natural=natural), 1e-11)


@given(case=cases())
def test_static_torques_are_the_slope_of_the_potential_energy(case: Case) -> None:
    """G^T Q = dV/d(x, y, theta, z), by complex steps through the oracle."""
    pose, step = case.poses(), 1e-30
    torque = static_torques(case.design, pose)
    g = inverse_jacobian(case.geometry, pose)
    forces = np.einsum("nji,nj->ni", g, torque)
    exact = np.stack(
        [oracle.potential(case.design, pose + 1j * step * e).imag / step for e in np.eye(4)],
        axis=-1,
    )
    assert_close(forces, exact, 1e-11)


@pytest.mark.slow
@given(case=cases())
def test_torques_of_m1_to_m3_are_one_number_times_a_map_of_the_geometry(case: Case) -> None:
    """Q_j = M_p2 Gamma_j, and F_4 the same plus a constant; Gamma knows no mass."""
    pose, design = case.poses(), case.design
    gamma = unit_torques(case.geometry, pose)
    k, g = case.geometry.magnification, design.gravity
    m, mb = design.joints, design.links
    mp1 = m.j5 + (m.j2 + m.j3 + m.j4 + m.j7) / k + mb.b4 / 2 + (mb.b1 + mb.b7) / (2 * k)
    mp1 += (mb.b2 + mb.b3) / k
    mp2 = ((k - 1) * m.j4 - m.j7 + k * m.j9) / k + ((k - 2) * mb.b3 - mb.b7) / (2 * k)
    mp2 += (mb.b4 + mb.b8) / 2
    carried = design.platform.mass + design.payload.mass
    constant = g * (k * (carried + 3 * mp1) + 3 * mb.b1 / 2)
    assert lift_constant(design) == pytest.approx(constant, rel=1e-13)
    expected = g * mp2 * gamma + np.array([0.0, 0.0, 0.0, constant])
    assert_close(static_torques(design, pose), expected, 1e-13)
    # Gamma is the torque of a robot that has only a knee of 1 N
    knee = massless(design, joints__j9=1 / g)
    assert_close(gamma, oracle.static_torques(knee, pose), 1e-11)


@given(case=cases(), mass=st.just(0.0) | st.floats(1e-30, 5e3))
def test_platform_and_payload_need_no_torque_of_m1_to_m3(case: Case, mass: float) -> None:
    """Eq. 4, to the last bit; M4 carries k times their weight."""
    pose = case.poses()
    light = static_torques(case.design, pose)
    k, g = case.geometry.magnification, case.design.gravity
    for path in ("platform.mass", "payload.mass"):
        heavy = case.design.vary({path: case.design.value(path) + mass})
        torque = static_torques(heavy, pose)
        np.testing.assert_array_equal(torque[:, :3], light[:, :3])
        assert_within(torque[:, 3] - light[:, 3], np.full(8, k * g * mass), 1e-10 * (1 + mass))
    alone = massless(case.design, payload__mass=mass)
    np.testing.assert_array_equal(static_torques(alone, pose)[:, :3], 0.0)


@given(case=cases())
def test_the_parts_add_up(case: Case) -> None:
    pose = case.poses()
    parts = static_breakdown(case.design, pose)
    assert parts.names == BODIES
    assert parts.per_leg.shape == (8, 4, 3, len(BODIES))
    total = static_torques(case.design, pose)
    assert_close(parts.total, total, 1e-11)
    added = parts.per_leg.sum(axis=(-2, -1)) + parts.platform + parts.payload
    np.testing.assert_array_equal(parts.total, added)
    for part in (parts.platform, parts.payload):
        np.testing.assert_array_equal(part[:, :3], 0.0)  # Eq. 4
    kg = case.geometry.magnification * case.design.gravity
    assert_within(parts.platform[:, 3], np.full(8, kg * case.design.platform.mass), 1e-10)
    assert_within(parts.payload[:, 3], np.full(8, kg * case.design.payload.mass), 1e-10)


@given(case=cases())
def test_parts_of_the_imbalance_are_what_is_lost_without_their_mass(case: Case) -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.5), Counterweight("b3", 7, -0.05, 0.4))
    design = replace(case.design, counterweights=weights)
    parts = imbalance_parts(design)
    whole = static_imbalance(design)
    assert sum(parts.values()) == pytest.approx(whole)
    assert set(parts) == {*MASS_PATHS, "counterweights.0.mass", "counterweights.1.mass"}
    for path, part in parts.items():
        if path.startswith(("joints.", "links.", "counterweights.")):
            without = static_imbalance(design.vary({path: 0.0}))
            assert part == pytest.approx(whole - without, abs=1e-9), path
        else:
            assert part == 0.0


@pytest.mark.slow
@settings(max_examples=8)
@given(case=cases())
def test_each_part_of_a_leg_is_the_slope_of_its_height(case: Case) -> None:
    """m g dz/dq_j of one body of one leg, through the oracle's places of the mass centers."""
    pose, step = case.poses(4), 1e-30
    parts = static_breakdown(case.design, pose)
    size = np.abs(static_torques(case.design, pose)).max()
    inverse = np.linalg.inv(oracle.actuator_jacobian(case.design, pose))
    slopes = {}
    for j, e in enumerate(np.eye(4)):
        moved = oracle.bodies(case.design, oracle.split(pose + 1j * step * e))
        for body in moved:
            height = np.broadcast_to(body.center[2], len(pose))
            slopes[body.name, j] = body.mass * case.design.gravity * height.imag / step
    for leg in range(3):
        for number, path in enumerate(BODIES):
            kind = path.partition(".")[2]
            name = f"leg {leg + 1}: " + (f"joint {kind[1:]}" if kind[0] == "j" else kind.upper())
            forces = np.stack([slopes[name, j] for j in range(4)], -1)
            expected = np.einsum("nij,ni->nj", inverse, forces)
            assert_within(parts.per_leg[:, :, leg, number], expected, 1e-11 * size)


ADDED = st.sampled_from(["joints.j7", "links.b7"])
"""Masses on the far side of the leg axis: they have a negative share in M_p2."""


def balanced(design: Design, path: str) -> Design:
    """The design with one mass chosen so that M_p2 = 0.

    Such a mass is never negative: without it M_p2 is positive, for all other shares are, but that
    of B3 at k < 2, which is left out then.
    """
    if design.geometry.magnification < 2:
        design = design.vary({"links.b3": 0.0})
    design = design.vary({path: 0.0, ("joints.j7" if path == "links.b7" else "links.b7"): 0.0})
    share = lumped_matrix(design.geometry, design.gravity)[1, MASS_PATHS.index(path)]
    missing = static_imbalance(design)
    assert share < 0 < missing
    return design.vary({path: -missing / share})


@pytest.mark.slow
@given(case=cases(), path=ADDED)
def test_a_balanced_robot_holds_itself_everywhere(case: Case, path: str) -> None:
    design = balanced(case.design, path)
    weight = design.gravity * mass_vector(design)[:14].sum()
    assert abs(static_imbalance(design)) < 1e-14 * weight
    assert shown_imbalance(design) == 0.0
    heavier = design.vary({path: design.value(path) * (1 + 1e-9)})
    assert shown_imbalance(heavier) == static_imbalance(heavier) != 0.0
    pose = case.poses(32)
    torque = static_torques(design, pose)
    size = np.abs(static_torques(case.design, pose)).max() + weight
    assert_within(torque[:, :3], np.zeros((32, 3)), 1e-13 * size)
    assert_within(torque[:, 3], np.full(32, lift_constant(design)), 1e-13 * size)
    expected = oracle.static_torques(design, pose[:8])
    assert_within(expected[:, :3], np.zeros((8, 3)), 1e-11 * size)
    # every body pulls, and all of them together do not
    parts = static_breakdown(design, pose)
    assert np.abs(parts.per_leg[:, :3]).max() > 1e-3 * weight * case.geometry.crank_length * 0.1
    assert_within(parts.total[:, :3], np.zeros((32, 3)), 1e-11 * size)


@BOTH
def test_the_counterweight_of_appendix_4(knee: KneeBranch) -> None:
    """m_7 that balances: 0.28 kg + 3 * 9.10041/9.81 kg = 3.063 kg, since its share is -g/k."""
    design = APPENDIX_4.vary({"joints.j7": 0.28 + 3 * 9.10041 / 9.81})
    assert abs(static_imbalance(design)) < 1e-14
    assert design.joints.j7 == pytest.approx(3.063, abs=1e-12)
    axis = np.linspace(-0.4, 0.4, 41)
    field = solve_field(with_knee(design.geometry, knee), xy_grid(axis, axis, np.pi / 3, -0.5))
    before = QUANTITIES["max_torque"].over(field, APPENDIX_4)
    after = QUANTITIES["max_torque"].over(field, design)
    assert np.nanmedian(before) > 1.0
    assert np.nanmax(after / before) < 1e-14


def test_balanced_robot_on_the_singular_circle_gives_no_warning() -> None:
    """Zero times an unbounded map has no value there, and is no reason to warn."""
    design = APPENDIX_4.vary(
        {
            "geometry.base_radius": 0.5,
            "geometry.platform_radius": 0.25,
            **{f"joints.{j}": 0.0 for j in ("j4", "j7", "j9")},
            **{f"links.{b}": 0.0 for b in ("b3", "b4", "b7", "b8")},
        }
    )
    assert static_imbalance(design) == 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        torque = static_torques(design, [[0.25, 0.0, 0.0, -0.5], [0.1, 0.0, 0.0, -0.5]])
    assert np.isnan(torque[0, :3]).all()
    np.testing.assert_array_equal(torque[1, :3], 0.0)
    assert np.isfinite(torque[:, 3]).all()
