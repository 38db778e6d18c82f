"""What affine arithmetic keeps for rounding, and how close its lines are, from closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from paminsa_viz.synthesis.proof import affine
from paminsa_viz.synthesis.proof.affine import (
    ROUND,
    Affine,
    box_variables,
    cosine_and_sine,
    lower,
    radius,
    size,
    upper,
)

UNIT = 1e-6
"""A rounding that can be seen, instead of `affine.ROUND`."""

CENTERS = (0.2, -0.2, 5.0)


def number(c: float, *parts: float) -> Affine:
    """A number with parts (x, y, t, z, e), the rest zero."""
    *linear, rest = *parts, *[0.0] * (5 - len(parts))
    return Affine(c, np.array(linear), rest)


def kept(monkeypatch: pytest.MonkeyPatch, operation: Callable[[], Affine]) -> float:
    """What is kept for rounding, in units of it."""
    found = []
    for unit in (UNIT, 0.0):
        monkeypatch.setattr(affine, "ROUND", unit)
        found.append(float(operation().e))
    return (found[0] - found[1]) / UNIT


def test_an_operation_rounds_twenty_times_at_most() -> None:
    assert 20 * np.finfo(float).eps / 2 <= ROUND <= 40 * np.finfo(float).eps / 2


def test_every_field_counts_in_the_size_of_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    a = number(-7.0, -1.0, 0.5, -0.25, 0.125, 0.0625)
    assert radius(a) == 1.875
    assert size(a) == 7 + 1.875 + 0.0625
    for unit in (0.0, 0.1):
        monkeypatch.setattr(affine, "ROUND", unit)
        assert lower(a) == pytest.approx(-7 - 1.9375 - unit * 8.9375)
        assert upper(a) == pytest.approx(-7 + 1.9375 + unit * 8.9375)
        for index in range(1, 5):  # each on its own
            parts = [0.0] * 5
            parts[index - 1] = -2.0
            assert upper(number(1.0, *parts)) == pytest.approx(3 + unit * 3)


@pytest.mark.parametrize("a", CENTERS)
@pytest.mark.parametrize("b", CENTERS)
def test_sums_and_products_round_by_the_sizes_of_what_they_are_of(
    monkeypatch: pytest.MonkeyPatch, a: float, b: float
) -> None:
    first = number(a, 0.1 * a, 0.0, -0.2 * a, 0.0, 0.05 * abs(a))
    second = number(b, 0.0, 0.3 * b, 0.0, 0.1 * b, 0.2 * abs(b))
    p, q = abs(a) * 1.35, abs(b) * 1.6
    for operation, expected in (
        (lambda: first + second, p + q),
        (lambda: first - second, p + q),
        (lambda: first + b, abs(a) + abs(b)),
        (lambda: b - first, abs(a) + abs(b)),
        (lambda: first * b, p * abs(b)),
        (lambda: first * second, p * q),
    ):
        assert kept(monkeypatch, operation) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("c", [0.2, 5.0])
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_reciprocals_and_roots_round_by_their_slope_and_their_line(
    monkeypatch: pytest.MonkeyPatch, c: float, share: float
) -> None:
    """The operand by the slope, chord and tangent four times, and what lies between them."""
    low, high = c * (1 - share), c * (1 + share)
    a = number(c, share * c)
    # the reciprocal: chord and tangent are parallel, of slope -1/(low high)
    chord, tangent = 1 / low + 1 / high, 2 / np.sqrt(low * high)
    half, middle = 0.5 * (chord - tangent), 0.5 * (chord + tangent)
    found = 1.0 / a
    expected = middle - c / (low * high), -share * c / low / high
    assert (found.c, found.p[0]) == pytest.approx(expected)
    assert found.e == pytest.approx(half, rel=1e-9, abs=1e-12)
    assert (1.0 / -a).c == pytest.approx(-found.c)
    assert (1.0 / -a).e == pytest.approx(found.e, abs=1e-15)
    if not share:  # where only rounding is left
        expected = 1 / c + 4 * chord + middle + 1 / c  # the last by the product with 1
        assert kept(monkeypatch, lambda: 1.0 / a) == pytest.approx(expected, rel=1e-4)
    monkeypatch.undo()
    total = np.sqrt(low) + np.sqrt(high)
    chord, tangent = np.sqrt(low * high) / total, total / 4
    half, middle = 0.5 * (tangent - chord), 0.5 * (chord + tangent)
    root: Any = np.sqrt(a)
    assert (root.c, root.p[0]) == pytest.approx((middle + c / total, share * c / total))
    assert root.e == pytest.approx(half, rel=1e-9, abs=1e-12)
    if not share:
        expected = c / total + 4 * total + middle
        assert kept(monkeypatch, lambda: np.sqrt(a)) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("half", [1e-4, 0.3, np.pi])
def test_a_turn_is_bounded_by_what_a_cosine_and_the_chord_of_a_sine_differ(
    monkeypatch: pytest.MonkeyPatch, half: float
) -> None:
    """Over -h..h: 1 - cos h, and h e - sin h within h^3/(9 sqrt 3) of the chord e sin h."""
    cosine, sine = cosine_and_sine(np.array(0.0), np.array(half))
    most = half**3 / (9 * np.sqrt(3))
    assert most <= half**3 * 0.0641501
    low, high = np.cos(half), 1.0
    assert lower(cosine) == pytest.approx(low, abs=1e-12)
    assert upper(cosine) == pytest.approx(high, abs=1e-12)
    assert sine.p[2] == pytest.approx(np.sin(half), abs=1e-15)
    assert sine.e == pytest.approx(most, rel=2e-6, abs=1e-13)
    assert (sine.c, *sine.p[[0, 1, 3]]) == (0.0, 0.0, 0.0, 0.0)
    # each on its own, then the product with 1 and the sum with nothing
    expected = 3.0, 1.0 + 2.0 * (abs(np.sin(half)) + most)
    for index in range(2):
        got = kept(monkeypatch, lambda i=index: cosine_and_sine(np.array(0.0), np.array(half))[i])
        assert got == pytest.approx(expected[index], rel=1e-4)


def test_boxes_become_their_coordinates() -> None:
    middle, half = np.array([[1.0, -2.0, 0.4, -0.5]]), np.array([[0.1, 0.2, 0.0, 0.3]])
    x, y, c, s, z = box_variables(middle, half)
    ends = [(float(lower(a)[0]), float(upper(a)[0])) for a in (x, y, c, s, z)]
    cosine, sine = np.cos(0.4), np.sin(0.4)
    expected = [(0.9, 1.1), (-2.2, -1.8), (cosine, cosine), (sine, sine), (-0.8, -0.2)]
    np.testing.assert_allclose(ends, expected, atol=1e-12)
    assert (x.p[0], y.p[1], z.p[3]) == (0.1, 0.2, 0.3)
