"""Affine arithmetic, and the bounds over boxes made with it, contain all values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    measure_singularity,
    singular_radius,
    static_torques,
)
from paminsa_viz.model.leg import mechanism
from paminsa_viz.synthesis.proof import enclosures
from paminsa_viz.synthesis.proof.affine import (
    Affine,
    box_variables,
    cosine_and_sine,
    lower,
    size,
    upper,
)
from paminsa_viz.synthesis.proof.enclosures import (
    block_condition,
    condition_bounds,
    determinant_bounds,
    inverse_jacobian_rows,
    static_bounds,
    static_ranges,
    static_terms,
)
from tests.synthesis.certificate_robots import boxes, poses_of_boxes, robots

PLACES = np.stack(np.meshgrid(*[[-1.0, -0.3, 1.0]] * 4), axis=-1).reshape(-1, 4)
UNKNOWN = np.array([-1.0, 0.4, 1.0])

OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: a - b,
    "product": lambda a, b: a * b,
    "square": lambda a, b: a * a,
    "quotient": lambda a, b: b / a,
    "reciprocal": lambda a, b: 1.0 / a,
    "negative reciprocal": lambda a, b: 3.0 / -a,
    "root": lambda a, b: np.sqrt(a),
    "opposite": lambda a, b: -a,
    "shift": lambda a, b: 0.25 - a,
    "scale": lambda a, b: -1.7 * a,
    "number of NumPy": lambda a, b: np.float64(2.5) * a + np.float64(1.0),
    "difference from NumPy": lambda a, b: np.float64(2.5) - a,
    "quotient of NumPy": lambda a, b: np.float64(2.5) / a,
}


@st.composite
def ranges(draw: st.DrawFn, widest: float) -> tuple[float, Any, float]:
    """Draw a range of positive numbers: center, linear parts (4,), the rest."""
    parts = np.array(draw(st.lists(st.floats(-1, 1), min_size=5, max_size=5)))
    total = np.abs(parts).sum()
    scale = draw(st.floats(0.0, widest)) / total if total > 1e-6 else 0.0
    center = draw(st.floats(0.1, 10.0))
    parts = center * scale * parts
    return center, parts[:4], abs(parts[4])


def made(part: tuple[float, Any, float]) -> Affine:
    center, linear, rest = part
    return Affine(center, linear, rest)


def values(part: tuple[float, Any, float]) -> Any:
    """All combinations of places and unknowns, (places, unknowns)."""
    center, linear, rest = part
    return center + (PLACES @ linear)[:, None] + rest * UNKNOWN


@pytest.mark.parametrize("name", list(OPERATIONS))
@given(a=ranges(0.95), b=ranges(2.0))
def test_every_value_is_as_near_to_the_line_as_it_says(name: str, a: Any, b: Any) -> None:
    operation = OPERATIONS[name]
    found = operation(made(a), made(b))
    # the unknowns of two ranges are independent
    exact = operation(values(a)[:, :, None], values(b)[:, None, :])
    line = found.c + PLACES @ found.p
    rounding = 1e-14 * np.abs(exact).max()  # of this test
    assert (np.abs(exact - line[:, None, None]) <= found.e + rounding).all()
    assert exact.max() <= upper(found) + rounding
    assert exact.min() >= lower(found) - rounding


def test_squares_and_mixed_products_of_a_place_have_their_own_ranges() -> None:
    """A square of -1..1 is 0..1, and a product of two places -1..1: none is wider than that."""
    for place in np.eye(4):
        square = Affine(0.0, place, 0.0) * Affine(0.0, place, 0.0)
        assert (lower(square), upper(square)) == pytest.approx((0.0, 1.0), abs=1e-12)
        for other in np.eye(4)[place == 0.0]:
            mixed = Affine(0.0, place, 0.0) * Affine(0.0, other, 0.0)
            assert (lower(mixed), upper(mixed)) == pytest.approx((-1.0, 1.0), abs=1e-12)
    rest = Affine(2.0, np.zeros(4), 0.5) * Affine(3.0, np.zeros(4), 0.25)
    assert (lower(rest), upper(rest)) == pytest.approx((6.0 - 2.125, 6.0 + 2.125), abs=1e-12)


@given(a=ranges(0.2))
def test_roots_and_reciprocals_are_nearly_lines(a: Any) -> None:
    width = np.abs(a[1]).sum() + a[2]
    for operation in (lambda v: 1.0 / v, np.sqrt):
        found, exact = operation(made(a)), operation(values(a))
        # beyond what is unknown, the square of the relative width
        slope = (operation(a[0] + 1e-6) - operation(a[0] - 1e-6)) / 2e-6
        curved = (width / a[0]) ** 2 * exact.max()
        assert found.e <= 1.6 * abs(slope) * a[2] + curved + 1e-12


@pytest.mark.parametrize("operation", [np.sqrt, lambda a: 1.0 / a])
def test_functions_without_a_value_have_no_bound(operation: Callable[[Any], Any]) -> None:
    across = Affine(np.array([0.1]), np.array([[0.2], [0.0], [0.0], [0.0]]), np.array([0.0]))
    with np.errstate(all="ignore"):
        found = operation(across)
    assert not (upper(found) <= 1e300).any()


@pytest.mark.parametrize("half", [1e-3, 0.4, 2.0, 3.1, 4.0])
def test_cosine_and_sine_are_within_their_ranges(half: float) -> None:
    share = np.linspace(-1, 1, 2001)
    for middle in (-2.0, 0.0, 0.3, 1.5):
        for found, function in zip(
            cosine_and_sine(np.array(middle), np.array(half)), (np.cos, np.sin), strict=True
        ):
            value = function(middle + half * share)
            assert not (np.abs(value - (found.c + found.p[2] * share)) > found.e).any()
            # wider than half a turn there is no bound
            assert np.isnan(upper(found)) == (half > np.pi)
            assert half > 0.1 or found.e < 1.1e-3 * half


@given(
    middle=st.tuples(st.floats(0.5, 1.0), st.floats(0.05, 0.49)),
    width=st.floats(0.0, 0.1),
    seed=st.integers(0, 999),
)
def test_condition_of_nearly_diagonal_matrices(
    middle: tuple[float, float], width: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    center = np.diag([1.0, *middle])
    linear = width * middle[1] * rng.uniform(-1, 1, (4, 3, 3)) * (rng.random((4, 3, 3)) < 0.5)
    entries = (Affine(center[i, j], linear[:, i, j], 0.0) for i in range(3) for j in range(3))
    with np.errstate(all="ignore"):
        bound = block_condition(*entries)
    found = np.linalg.cond(center + np.tensordot(PLACES, linear, 1))
    assert not found.max() > bound
    assert bound <= found.max() * (1 + 20 * width) + 1e-9


@pytest.mark.parametrize("middle", [0.999, 0.9])
@pytest.mark.parametrize("place", [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)])
def test_every_entry_off_the_diagonal_counts(place: tuple[int, int], middle: float) -> None:
    # Each on its own raises the condition number; the bound is little above it.
    center = np.diag([1.0, middle, 0.4])
    linear = np.zeros((3, 3))
    linear[place] = 0.05
    with np.errstate(all="ignore"):
        bound = block_condition(
            *(
                Affine(center[i, j], linear[i, j] * np.eye(4)[0], 0.0)
                for i in range(3)
                for j in range(3)
            )
        )
    found = max(np.linalg.cond(center + linear), np.linalg.cond(center - linear))
    assert found > 2.5
    assert found <= bound <= 1.05 * found


@pytest.mark.parametrize("skew", [0.0, 1e-3])
def test_sizes_norms_and_bounds_are_widened_by_what_the_vectors_are_off(
    monkeypatch: pytest.MonkeyPatch, skew: float
) -> None:
    """Each by the same share; of an upper triangle of numbers the bound then has a closed form."""
    assert 450 * 2.0**-53 <= enclosures.SKEW <= 910 * 2.0**-53
    monkeypatch.setattr(enclosures, "SKEW", skew)
    a = Affine(-2.0, np.array([0.5, 0.0, 0.0, -0.25]), 0.125)
    assert enclosures._most(a) == pytest.approx(2.875 * (1 + skew), rel=1e-12)
    for row in ((1.0, 0.2, -0.3, 0.5), (0.1, 2.0, 1.0, 0.3), (1.0, 0.0, 0.0, 1.0)):
        norm = np.linalg.norm(np.reshape(row, (2, 2)), 2)
        assert enclosures._norm(*row) == pytest.approx(norm * (1 + skew), rel=1e-12)
    middle, last, beside = 0.9, 0.3, 0.2
    most, rest = beside * (1 + skew), middle * (1 + skew)
    more = np.linalg.norm([[1.0, most], [0.0, rest]], 2) * (1 + skew) - 1.0
    entries = (1.0, beside, 0.0, 0.0, middle, 0.0, 0.0, 0.0, last)
    found = block_condition(*(Affine(c, np.zeros(4), 0.0) for c in entries))
    expected = (1.0 + more * (1 + skew)) / last * (1 + skew) ** 2
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, -1)])
def test_the_condition_number_of_a_block_beside_a_one_is_met(
    monkeypatch: pytest.MonkeyPatch, signs: tuple[int, int]
) -> None:
    """Its inverse is that of the complement of its first entry, of which nothing is lost."""
    monkeypatch.setattr(enclosures, "SKEW", 0.0)
    right, left = 0.2 * signs[0], 0.15 * signs[1]
    center = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, right], [0.0, left, 0.3]])
    bound = block_condition(*(Affine(c, np.zeros(4), 0.0) for c in center.ravel()))
    # of the product of both the size alone counts
    worst = center * [[1, 1, 1], [1, 1, 1], [1, signs[0] * signs[1], 1]]
    assert bound == pytest.approx(np.linalg.cond(worst), rel=1e-12)
    assert bound >= np.linalg.cond(center) * (1 - 1e-12)


def test_a_leg_without_direction_leaves_no_bound_and_spoils_no_other() -> None:
    """Joint 5 on its leg axis: 3/8 - 1/8 m from the center, exact in binary numbers."""
    design = APPENDIX_4.vary({"geometry.base_radius": 0.375, "geometry.platform_radius": 0.125})
    middle = np.array([[0.0, 0.25, 0.0, -0.6], [0.0, 0.0, 0.0, -0.6]])
    bound = condition_bounds(design, middle, np.zeros((2, 4)))
    assert np.isfinite(bound).tolist() == [False, True]


SEEDS = st.integers(0, 2**16)


@pytest.mark.slow
@given(design=robots(), seed=SEEDS)
def test_static_torques_of_every_pose_are_within_their_bounds(design: Design, seed: int) -> None:
    middle, half = boxes(design, seed, 60)
    low, high = static_bounds(design, middle, half)
    for again in range(4):
        torque = static_torques(design, poses_of_boxes(middle, half, seed + again))
        # where a range has no bound it says so, and nothing is claimed
        assert not (torque < low[:, :4]).any()
        assert not (torque > high[:, :4]).any()
        assert not ((torque[:, :3] ** 2).mean(axis=1) > high[:, 4] * (1 + 1e-12)).any()
    assert np.isfinite(high[half.max(axis=1) < 1e-4 * design.geometry.base_radius]).mean() > 0.5


@given(design=robots(), seed=SEEDS)
def test_condition_and_determinant_of_every_pose_are_within_their_bounds(
    design: Design, seed: int
) -> None:
    middle, half = boxes(design, seed, 60)
    most = condition_bounds(design, middle, half)
    low, high = determinant_bounds(design, middle, half)
    for again in range(4):
        poses = poses_of_boxes(middle, half, seed + again)
        found = measure_singularity(design.geometry, poses)
        assert not (found.condition > most * (1 + 1e-12)).any()
        assert not (found.determinant < low[:, 0]).any()
        assert not (found.determinant > high[:, 0]).any()


@pytest.mark.slow
@given(design=robots(), seed=SEEDS)
def test_bounds_of_single_poses_hold_what_rounding_changes(design: Design, seed: int) -> None:
    # A box without width has a range of rounding alone. Extended precision is within it.
    middle, half = boxes(design, seed, 40)
    assume(len(middle) > 9)
    long = middle.astype(np.longdouble)
    x, y, theta, z = long.T
    m = mechanism(design.geometry)
    exact = static_ranges(m, static_terms(design), x, y, np.cos(theta), np.sin(theta), z)
    with np.errstate(all="ignore"):
        ranges = static_ranges(m, static_terms(design), *box_variables(middle, 0 * half))
        for value, held in zip(exact, ranges, strict=True):
            assert not (value < lower(held)).any()
            assert not (value > upper(held)).any()
            assert np.median((upper(held) - lower(held)) / size(held)) < 1e-8


@pytest.mark.slow
@given(seed=SEEDS)
def test_bounds_shrink_as_the_square_of_a_box(seed: int) -> None:
    middle, half = boxes(APPENDIX_4, seed, 80, widest=0.01)
    wide = np.full_like(half, 0.004)
    m = mechanism(APPENDIX_4.geometry)
    with np.errstate(all="ignore"):

        def errors(width: Any) -> Any:
            found = static_ranges(m, static_terms(APPENDIX_4), *box_variables(middle, width))
            return np.stack([part.e for part in found[:4]])

        ratio = errors(wide) / errors(0.25 * wide)
    assert 14 < np.nanmedian(ratio) < 24


@pytest.mark.parametrize("theta", [0.0, 0.3, -0.9])
def test_the_condition_number_at_the_center_has_a_closed_form(theta: float) -> None:
    # X_1/(sqrt2 |R_b cos theta - R_pl|), where it is above 1
    g = APPENDIX_4.geometry
    expected = singular_radius(g, theta) / (
        np.sqrt(2) * abs(g.base_radius * np.cos(theta) - g.platform_radius)
    )
    expected = max(expected, 1 / expected)
    # Two singular values are equal there: rounding errors count as their square root.
    for width, wide in ((0.0, 1e-7), (1e-4, 5e-3)):
        bound = condition_bounds(
            APPENDIX_4, np.array([[0, 0, theta, -0.6]]), np.full((1, 4), width)
        )
        assert expected * (1 - 1e-12) <= bound[0] <= expected * (1 + wide)


def test_rows_are_those_of_the_inverse_jacobian() -> None:
    from paminsa_viz.model import inverse_jacobian

    pose = np.array([0.05, -0.03, 0.4, -0.6])
    g = inverse_jacobian(APPENDIX_4.geometry, pose)[:3, :3]
    x, y, theta, _ = pose
    rows = inverse_jacobian_rows(mechanism(APPENDIX_4.geometry), x, y, np.cos(theta), np.sin(theta))
    scale = [1, 1, 1 / APPENDIX_4.geometry.platform_radius]
    np.testing.assert_allclose(np.reshape(rows, (3, 3)), g * scale, rtol=1e-12)


def test_without_weight_the_torques_are_those_of_the_load_alone() -> None:
    design = replace(APPENDIX_4, gravity=0.0)
    low, high = static_bounds(design, np.array([[0.02, 0.01, 0.2, -0.6]]), np.full((1, 4), 1e-3))
    np.testing.assert_allclose(low[:, :4], 0.0, atol=1e-9)
    np.testing.assert_allclose(high[:, :4], 0.0, atol=1e-9)
