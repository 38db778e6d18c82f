"""Affine arithmetic: every number that an operation can give is within its range, at its place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.synthesis.proof.affine import Affine, cosine_and_sine, lower, upper
from paminsa_viz.synthesis.proof.enclosures import block_condition

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
    return Affine(center, *linear, rest)


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
    line = found.c + PLACES @ [found.x, found.y, found.t, found.z]
    rounding = 1e-14 * np.abs(exact).max()  # of this test
    assert (np.abs(exact - line[:, None, None]) <= found.e + rounding).all()
    assert exact.max() <= upper(found) + rounding
    assert exact.min() >= lower(found) - rounding


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
    across = Affine(*(np.array([v]) for v in (0.1, 0.2, 0.0, 0.0, 0.0, 0.0)))
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
            assert not (np.abs(value - (found.c + found.t * share)) > found.e).any()
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
    entries = (Affine(center[i, j], *linear[:, i, j], 0.0) for i in range(3) for j in range(3))
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
                Affine(center[i, j], linear[i, j], 0.0, 0.0, 0.0, 0.0)
                for i in range(3)
                for j in range(3)
            )
        )
    found = max(np.linalg.cond(center + linear), np.linalg.cond(center - linear))
    assert found > 2.5
    assert found <= bound <= 1.05 * found
