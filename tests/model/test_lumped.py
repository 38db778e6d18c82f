"""The lumped coefficients: what the paper prints, rigid bodies, linearity; bars that grow."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    COEFFICIENTS,
    PARAMETER,
    PARAMETERS,
    Design,
    KneeBranch,
    Misprint,
    kinetic_energy,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
    potential_energy,
)
from paminsa_viz.model.leg_points import PointWeights
from paminsa_viz.model.lumped import (
    MASS_PATHS,
    EnergyTerms,
    energy_terms,
    point_mass_column,
    potential_constant,
    term_matrix,
)
from tests import oracle
from tests.model import paper
from tests.support import samples
from tests.support.cases import BOTH, Case, cases
from tests.support.samples import possible_values, with_knee

GOLDEN = {
    # Appendix 2 [N]
    "Mp1": Fraction(1566984, 100000),  # 9.81 (0.233 + 1.094/3 + 0.672/2 + 1.328/6 + 1.327/3)
    "Mp2": Fraction(910041, 100000),  # 9.81 ((0.524 - 0.28 + 0.777)/3 + 0.299/6 + 1.075/2)
    "Mp3": Fraction(5989005, 1000000),  # 9.81 * 1.221/2
    # Appendix 3 [kg]; M_c4 with 2 m_7 (as published it is 0.28/36 less)
    "Mc1": Fraction(79781, 288000),
    "Mc2": Fraction(3181, 9000),
    "Mc3": Fraction(3103, 9000),
    "Mc4": Fraction(2923, 14400),
    "Mc5": Fraction(7729, 36000),
    "Mc6": Fraction(1221, 8000),  # 1.221/8
    "Mc7": Fraction(1221, 12000),  # 1.221/12
    # [kg m^2]
    "Mc8": Fraction(57609661, 8000000000),  # 0.436 * 0.3635^2 / 8
    "Mc9": Fraction(51, 2000),  # (0.048 + 0.003)/2
    "Mc10": Fraction(1, 1000),  # (0.0012 + 0.0008)/2
    "Mc11": Fraction(1, 50),  # (0.02 + 0.02)/2
    "Mc12": Fraction(31, 10000),  # (0.0038 + 0.0024)/2
    "Mc13": Fraction(23, 2000),  # (0.003 + 0.02)/2
    "m_pl": Fraction(2301, 1000),
    "I_pl": Fraction(15, 1000),
}
"""c of Appendix 4: the paper's appendices 2 to 4 put through exact rational arithmetic by hand."""


def test_appendix_4_gives_the_numbers_of_the_paper() -> None:
    assert tuple(GOLDEN) == COEFFICIENTS
    expected = [float(value) for value in GOLDEN.values()]
    np.testing.assert_allclose(lumped_coefficients(APPENDIX_4), expected, rtol=4e-16)
    np.testing.assert_allclose(potential_constant(APPENDIX_4), 5.5717857, rtol=4e-16)


def test_the_misprint_of_appendix_3_is_half_of_one_term() -> None:
    printed = lumped_coefficients(APPENDIX_4, Misprint.ALL)
    difference = lumped_coefficients(APPENDIX_4) - printed
    np.testing.assert_allclose(difference[6], float(Fraction(28, 3600)), rtol=1e-14)
    assert np.count_nonzero(difference) == 1
    for flag in Misprint:
        changed = lumped_coefficients(APPENDIX_4, flag) != lumped_coefficients(APPENDIX_4)
        assert changed.any() == (flag is Misprint.APP3_MC4)


@given(case=cases())
def test_every_design_gives_the_numbers_of_the_appendices(case: Case) -> None:
    """Against the paper's text typed a second time (`tests.model.paper`)."""
    for misprints in (Misprint.NONE, Misprint.ALL):
        c = dict(zip(COEFFICIENTS, lumped_coefficients(case.design, misprints), strict=True))
        for typed in (paper.appendix_2(case.design), paper.appendix_3(case.design, misprints)):
            constant = typed.pop("e3", None)
            for name, value in typed.items():
                assert c[name] == pytest.approx(value, rel=1e-14, abs=1e-16)
            if constant is not None:
                assert potential_constant(case.design) == pytest.approx(constant, rel=1e-14)
        assert c["m_pl"] == case.design.platform.mass + case.design.payload.mass
        assert c["I_pl"] == case.design.platform.inertia + case.design.payload.inertia


@pytest.mark.slow
@given(case=cases(), flags=st.sampled_from([Misprint.NONE, Misprint.ALL]))
def test_the_matrix_maps_masses_to_coefficients(case: Case, flags: Misprint) -> None:
    design = case.design
    matrix = lumped_matrix(design.geometry, design.gravity, flags)
    assert matrix.shape == (18, 28)
    np.testing.assert_allclose(
        matrix @ mass_vector(design), lumped_coefficients(design, flags), rtol=1e-13, atol=1e-15
    )
    for path, column in zip(MASS_PATHS, matrix.T, strict=True):
        alone = lumped_coefficients(only(design, path), flags)
        np.testing.assert_allclose(column, alone, rtol=1e-14, atol=1e-29)


def test_masses_are_every_mass_and_inertia_of_a_design() -> None:
    assert list(MASS_PATHS) == [p.path for p in PARAMETERS if p.unit in ("kg", "kg m^2")]
    assert mass_vector(APPENDIX_4).tolist() == [APPENDIX_4.value(path) for path in MASS_PATHS]


@given(case=cases(), gravity=possible_values(PARAMETER["gravity"]))
def test_gravity_scales_the_weights_alone(case: Case, gravity: float) -> None:
    c = lumped_coefficients(case.design)
    other = lumped_coefficients(case.design.vary({"gravity": gravity}))
    np.testing.assert_allclose(
        other[:3], c[:3] / case.design.gravity * gravity, rtol=1e-14, atol=1e-300
    )
    np.testing.assert_array_equal(other[3:], c[3:])


@given(case=cases(), share=st.floats(0.1, 0.9))
def test_limits_of_reach_and_the_arm_are_no_part_of_the_coefficients(
    case: Case, share: float
) -> None:
    """B10's mass center is at l_B10 / 2 whatever the stroke; B1 rises alike wherever it is."""
    design = case.design.vary(
        {
            "geometry.guide_stroke": share * case.geometry.guide_link_length,
            "geometry.axis_clearance": 0.01,
            "geometry.arm_length": share * case.geometry.arm_length,
        }
    )
    np.testing.assert_array_equal(lumped_coefficients(design), lumped_coefficients(case.design))


def only(design: Design, path: str) -> Design:
    """The same robot with one unit mass or inertia and no other."""
    values = dict.fromkeys(MASS_PATHS, 0.0) | {"platform.mass": 1e-30}
    return design.vary(values | {path: 1.0})


@pytest.mark.slow
@settings(max_examples=3)
@given(case=cases())
def test_each_mass_alone_has_the_energies_of_its_rigid_body(case: Case) -> None:
    """One unit mass or inertia at a time, placed and moved by first principles."""
    geometry = case.geometry
    pose, velocity, _ = case.states(4)
    height = case.design.gravity * (geometry.coupler_length + geometry.shaft_length)
    for path in MASS_PATHS:
        design = only(case.design, path)
        expected = oracle.kinetic(design, pose, velocity)
        got = kinetic_energy(design, pose, velocity)
        size = np.sum(velocity**2, axis=-1).max()
        np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-13 * size, err_msg=path)
        expected = np.broadcast_to(oracle.potential(design, pose), got.shape)
        got = potential_energy(design, pose)
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * height, err_msg=path)


@pytest.mark.parametrize("misprints", [*Misprint, Misprint.NONE, Misprint.ALL], ids=str)
def test_energy_terms_are_linear_in_the_coefficients(misprints: Misprint) -> None:
    c: Any = np.random.default_rng(0).normal(size=(18, 5))
    terms = energy_terms(c, misprints)
    assert len(terms) == len(EnergyTerms._fields)
    matrix = term_matrix(misprints)
    np.testing.assert_array_equal(matrix @ c, np.array(terms))
    assert set(np.unique(matrix)) <= {-1.0, 0.0, 1.0}
    assert (np.abs(matrix).sum(axis=0) > 0).all() or misprints & Misprint.EQ14_PHI_SPEED


@BOTH
def test_energies_scale_with_the_unit_of_length(knee: KneeBranch) -> None:
    """In centimeters T and V are 10,000 times larger, if inertias are kg cm^2.

    Appendix 4 prints kg/m^2; with such a unit the numbers would have to become smaller instead.
    """
    rng = np.random.default_rng(5)
    pose, velocity, _ = samples.random_states(rng, with_knee(APPENDIX_4, knee), 20)
    scale = np.array([1e2, 1e2, 1.0, 1e2])
    changes = {p.path: p.default * {"m": 1e2, "m/s^2": 1e2}.get(p.unit, 1.0) for p in PARAMETERS}
    power = {}
    for exponent in (2, -2):
        inertia = {p.path: p.default * 1e2**exponent for p in PARAMETERS if p.unit == "kg m^2"}
        centimeters = APPENDIX_4.vary(changes | inertia)
        power[exponent] = kinetic_energy(
            with_knee(centimeters, knee), pose * scale, velocity * scale
        )
    meters = kinetic_energy(with_knee(APPENDIX_4, knee), pose, velocity)
    np.testing.assert_allclose(power[2], 1e4 * meters, rtol=1e-12)
    assert np.abs(power[-2] / (1e4 * meters) - 1).min() > 1e-3


def test_a_mass_at_a_point_has_half_the_square_of_its_speed_and_the_height_of_its_weight() -> None:
    """For any speeds of the joints 5 and 9, along the leg and upward, and any weights of them."""
    rng = np.random.default_rng(8)
    r5, r9, z5, *speeds = rng.normal(size=(7, 20))
    along5, along9, up5, up9 = speeds
    column = point_mass_column(PointWeights(r5, r9, z5), 9.81)
    np.testing.assert_allclose(column[:2], 9.81 * np.array([z5, r9]), rtol=1e-14)
    squares = column[3] * along5**2 + column[6] * along5 * along9 + column[5] * along9**2
    np.testing.assert_allclose(squares, 0.5 * (r5 * along5 + r9 * along9) ** 2, atol=1e-14)
    squares = column[4] * up5**2 + column[7] * up5 * up9 + column[5] * up9**2
    np.testing.assert_allclose(squares, 0.5 * (z5 * up5 + r9 * up9) ** 2, atol=1e-14)
    assert not np.delete(column, [0, 1, 3, 4, 5, 6, 7], axis=0).any()
