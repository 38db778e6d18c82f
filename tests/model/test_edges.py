"""Where the formulas change their mind: at a bound, one step before it and one behind it.

Numbers are powers of two and sums of few of them, so that a bound is met to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.kinematic_formulas import Heading, closing_angles
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.leg import (
    ROUNDING,
    SINGULAR,
    Mechanism,
    leg_vector,
    mechanism,
    mechanism_of_lengths,
)
from paminsa_viz.model.measures import (
    _largest_eigenvalue,
    dexterity,
    least_margin,
    leg_margins,
    singular_distances,
    workspace_circle,
)
from paminsa_viz.model.robot import acceleration_of_force, platform_determinant

EPSILON = float(np.finfo(float).eps)
ROOMY = mechanism_of_lengths(3.0, 1.0, 0.5, 0.25, 0.5, 4.0, 6.0, 16.0, 0.0, 1.0)
"""A robot whose lengths are round in binary, with limits that are far away."""


def test_a_singularity_is_where_rounding_of_a_pose_leaves_few_digits() -> None:
    """`ROUNDING` is 16 units of the last place, and `SINGULAR` 256 times that."""
    assert ROUNDING == 16 * EPSILON
    assert SINGULAR == 256 * ROUNDING


def test_limits_are_drawn_in_by_what_counts_as_singular() -> None:
    """By 2^-40 of the lengths that they are differences of; the guide's end is no singularity."""
    k, rb, rp, crank, coupler, stroke = 3.0, 1.0, 0.5, 4.0, 6.0, 16.0
    axis = SINGULAR * (rb + rp)
    for clearance, least in ((0.0, axis), (0.5 * axis, axis), (2 * axis, 2 * axis), (0.25, 0.25)):
        m = mechanism_of_lengths(k, rb, rp, 0.0, 0.0, crank, coupler, stroke, clearance, 1.0)
        assert m.rho2_min == least * least
    span = SINGULAR * (crank + coupler) + axis * k / (k - 1)
    for longer, shorter in ((crank, coupler), (coupler, crank)):
        m = mechanism_of_lengths(k, rb, rp, 0.0, 0.0, longer, shorter, stroke, 0.0, 1.0)
        assert m.reach2_min == (2.0 + span) ** 2
        assert m.reach2_max == (10.0 - span) ** 2
    assert m.rho2_max == (stroke * (k - 1)) ** 2


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_determinant_is_zero_within_the_bound_and_closed_form_beyond(sign: float) -> None:
    size = 1.5  # R_b + R_pl
    for share, singular in ((1.0, True), (1.0 + 2**-8, False)):
        off = sign * share * SINGULAR * size
        turned = platform_determinant(ROOMY, 0.0, 0.0, 0.5 + off)
        assert (turned == 0.0) == singular
        # r_s^2 = 1.25 - cos theta, with the center at a distance of 1
        on_circle = platform_determinant(ROOMY, 1.0, 0.0, 0.25 - size * off)
        assert (on_circle == 0.0) == singular
        if not singular:
            factor = -1.5 * np.sqrt(3.0) * 0.5
            assert turned == pytest.approx(factor * off * (1.25 - 0.5), rel=1e-9)
            assert on_circle == pytest.approx(factor * (0.25 - 0.5) * size * off, rel=1e-9)


def of_first_leg(m: Mechanism, x: float, z: float) -> Any:
    """Margins of a leg whose axis is along x, by the distance and height of its joint 5."""
    v = leg_vector(m, 1.0, 0.0, x, 0.0, 1.0, 0.0)
    height = z + m.joint_height
    reach2 = m.span_ratio * m.span_ratio * v.rho2 + height * height
    return leg_margins(m, 1.0, 0.0, x, 0.0, 1.0, 0.0, z), reach2, v.rho2


def test_a_margin_that_may_be_one_of_rounding_is_zero() -> None:
    """At its bound and beyond; what is negative stays, and so does the room before the bound."""
    x, z = 0.125, -3.0
    free, reach2, rho2 = of_first_leg(ROOMY, x, z)
    assert min(free) > 0
    for name, at, before in (
        ("reach2_max", reach2, reach2 * (1 + EPSILON)),
        ("reach2_min", reach2, reach2 * (1 - EPSILON)),
        ("rho2_min", rho2, rho2 * (1 - EPSILON)),
    ):
        kind = {"reach2_max": 0, "reach2_min": 1, "rho2_min": 3}[name]
        for bound, margin in ((at, 0.0), (before, free[kind])):
            found, _, _ = of_first_leg(ROOMY._replace(**{name: bound}), x, z)
            assert found[kind] == margin
            assert np.delete(found, kind).tolist() == np.delete(free, kind).tolist()
    beyond, _, _ = of_first_leg(ROOMY._replace(crank=1.0, coupler=1.0, clearance=1.0), x, z)
    assert (beyond.stretch, beyond.axis) == (2.0 - np.sqrt(reach2), np.sqrt(rho2) - 1.0)
    short = ROOMY._replace(crank=1.0, coupler=9.0, reach2_min=64.0)
    assert of_first_leg(short, x, z)[0].fold == np.sqrt(reach2) - 8.0


def test_of_equal_margins_that_of_the_first_leg_counts() -> None:
    """With x = 0 and theta = 0 legs 1 and 2 are mirror images to the last bit."""
    m = mechanism(APPENDIX_4.geometry)
    folding = mechanism_of_lengths(3.0, 0.35, 0.1, 0.0, 0.4, 0.4, 0.8, 9.0, 0.0, 1.0)
    near_axis = m._replace(clearance=0.2)
    for limit, of, y, z in (
        (0, m, 0.1, -0.9), (1, folding, -0.05, -0.3), (2, m, 0.1, -0.3), (3, near_axis, -0.1, -0.5),
    ):  # fmt: skip
        found = least_margin(of._replace(stroke=0.2 if limit == 2 else 9.0), 0.0, y, 1.0, 0.0, z)
        assert found.which == limit


@pytest.mark.parametrize("leg", range(3))
def test_a_guide_may_be_used_to_its_end_and_other_limits_may_not(leg: int) -> None:
    m = mechanism(APPENDIX_4.geometry)
    angle = AXIS_ANGLES[leg]

    def at(distance: float, of: Mechanism) -> tuple[Any, Any]:
        place = of, distance * np.cos(angle), distance * np.sin(angle), 1.0, 0.0, -0.5
        return least_margin(*place), dexterity(*place)

    away, _ = at(-0.1, m._replace(stroke=0.0))
    for less, finite in ((0.0, True), (EPSILON, False)):
        found, measured = at(-0.1, m._replace(stroke=-away.margin * (1 - less)))
        assert found.which == 4 * leg + 2
        assert (found.margin == 0.0) == finite
        assert np.isfinite(measured).all() == finite
        assert np.isnan(measured).all() == (not finite)
    toward, _ = at(0.1, m._replace(stroke=9.0))
    assert toward.which == 4 * leg + 3
    found, measured = at(0.1, m._replace(stroke=9.0, clearance=toward.margin))
    assert found == (0.0, 4 * leg + 3)
    assert np.isnan(measured).all()


def test_lines_of_legs_count_as_parallel_up_to_a_size() -> None:
    """Lines of headings 0, 0 and a small angle; what is left of the closure has its size."""
    for angle, known in ((1e-12, False), (1.05e-12, True)):
        found = closing_angles(
            ROOMY,
            Heading(1.0, 0.0, 1.0, 0.0), Heading(1.0, 0.0, 0.0, 0.0), Heading(1.0, angle, 0.0, 0.0),
        )  # fmt: skip
        assert np.isfinite(found).all() == known
        assert np.isnan(found).all() == (not known)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_double_root_is_found_though_rounding_puts_it_a_little_beyond(sign: float) -> None:
    """By four times `ROUNDING`: the cosine of half the distance of the roots is 1 or -1 then."""
    headings = (
        Heading(1.0, 0.0, 0.0, -sign),
        Heading(1.0, 0.0, 0.0, 0.0),
        Heading(0.0, 1.0, 0.0, 0.0),
    )
    for beyond, known in ((0.0, True), (4 * ROUNDING, True), (4 * ROUNDING + EPSILON, False)):
        m = ROOMY._replace(base_radius=1.0 + beyond, platform_radius=1.0)
        found = closing_angles(m, *headings)
        assert (found.c, found.s) == (sign, 0.0)
        assert np.isfinite(found.half_c) == known
        if known:
            assert (found.half_c, found.half_s) == (sign, 0.0)
    # away from it the cosine is the ratio of both radii
    m = ROOMY._replace(base_radius=0.6, platform_radius=1.0)
    assert closing_angles(m, *headings)[2:] == pytest.approx((0.6 * sign, 0.8))


def test_accelerations_solve_the_equations_and_the_least_pivot_says_whether_they_can() -> None:
    """Pivots are the ratios of leading minors; each of them is the least in some matrices."""
    rng = np.random.default_rng(0)
    roots = rng.normal(size=(200, 4, 4)) * 10 ** rng.uniform(-1, 1, (200, 4, 1))
    matrix, force = roots @ roots.swapaxes(1, 2), rng.normal(size=(200, 4))
    matrix[0] = np.diag([1.0, 0.0, 2.0, 3.0])
    rows, columns = np.triu_indices(4)
    with np.errstate(all="ignore"):
        found = acceleration_of_force(*matrix[:, rows, columns].T, *force.T)
    expected = np.linalg.solve(matrix[1:], force[1:, :, None])[..., 0]
    got = np.stack(found[:4], axis=-1)[1:]
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())
    minors = np.stack([np.linalg.det(matrix[1:, :n, :n]) for n in range(5)], axis=-1)
    pivots = minors[:, 1:] / minors[:, :-1]
    assert set(pivots.argmin(axis=-1)) == {0, 1, 2, 3}
    np.testing.assert_allclose(found.pivot[1:], pivots.min(axis=-1), rtol=1e-6)
    assert not found.pivot[0] > 0.0


def test_largest_eigenvalues_are_those_of_lapack() -> None:
    """Also where two or all three are the same, and rounding puts the cosine beyond its range."""
    rng = np.random.default_rng(0)
    turn, _ = np.linalg.qr(rng.normal(size=(300, 3, 3)))
    values = rng.uniform(0.1, 2.0, (300, 3))
    values[100:150, 1] = values[100:150, 0]
    values[150:200] = np.sort(values[150:200])
    values[150:200, 1] = values[150:200, 2]
    values[200:250, 1:] = 0.0
    matrix = np.einsum("nij,nj,nkj->nik", turn, values, turn)
    matrix[250:] = np.eye(3) * values[250:, :1, None]
    xx, yy, zz = np.moveaxis(np.diagonal(matrix, axis1=1, axis2=2), -1, 0)
    with np.errstate(all="ignore"):
        found = _largest_eigenvalue(xx, yy, zz, matrix[:, 0, 1], matrix[:, 1, 2], matrix[:, 0, 2])
    np.testing.assert_allclose(found, np.linalg.eigvalsh(matrix)[:, 2], rtol=1e-7)


def test_a_circle_that_shrinks_to_the_center_is_no_less_than_a_point() -> None:
    """R_b and R_pl that differ by rounding alone: its squared radius may come out below zero."""
    below = 0
    for number in range(1, 200):
        base = 0.25 + number / 1024
        m = ROOMY._replace(base_radius=base, platform_radius=base * (1 + 3 * EPSILON))
        below += base * base + m.platform_radius**2 - 2.0 * base * m.platform_radius < 0.0
        with np.errstate(invalid="ignore"):  # no turn is singular everywhere
            found = singular_distances(m, 0.125, 0.0, 1.0, 0.0)
        assert found.position == pytest.approx(-0.125, abs=1e-7)
    assert below > 0


def test_the_workspace_circle_is_as_far_as_three_discs_have_places_in_common() -> None:
    """Discs of what guide or bars allow: the borders of two meet, on the third one's side."""
    for stroke, crank, coupler, longest in ((0.5, 4.0, 6.0, 1.0), (16.0, 0.5, 1.0, 1.0)):
        m = mechanism_of_lengths(3.0, 1.0, 0.5, 0.0, 0.0, crank, coupler, stroke, 0.0, 1.0)
        radius = workspace_circle(m)
        angle = np.radians([210.0, -30.0])
        centers = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        meeting = np.array([0.0, radius])
        np.testing.assert_allclose(np.hypot(*(meeting - centers).T), longest, rtol=1e-12)
    for stroke in (0.25, 0.2):  # discs that have the center alone in common, or no place
        far = mechanism_of_lengths(3.0, 1.0, 0.5, 0.0, 0.0, 4.0, 6.0, stroke, 0.0, 1.0)
        assert workspace_circle(far) == 0.0
