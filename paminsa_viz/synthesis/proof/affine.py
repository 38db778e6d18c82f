"""Affine arithmetic: a range of a formula over a box of poses, which bounds it rigorously.

A number that depends on a pose in a box is kept as

    c + x e_x + y e_y + t e_theta + z e_z + e e_0,    every e_i any number from -1 to 1,

where e_x .. e_z are the pose's place in the box and e_0 is unknown: e bounds all that is not
linear, and all rounding. In contrast to plain intervals terms that cancel do so, and the bound of a
box of width w is too wide by no more than a multiple of w^2 (Comba and Stolfi 1993; Stolfi and de
Figueiredo 2003; with a fixed number of terms Messine 2002).

The fields are NumPy arrays, the last index that of the box. A range that an operation is not
defined on, such as the reciprocal of one with zero, is infinite or NaN from there on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from paminsa_viz.model.robot import where

ROUND = 2.0**-48
"""Bound on the rounding of an operation, as a share of the largest size of what it works on.

No operation below rounds more than 20 times in a row, each time by 2^-53 of that or less.
"""


class Affine:
    """A number that depends on the place in a box.

    Attributes:
        c: The number at the center, or an array of them.
        p: (4, ...) parts that are linear in x, y, theta and z; one array, so that an operation on
            the few hundred boxes of a round takes few calls.
        e: Bound on the rest.
    """

    __slots__ = ("_radius", "_size", "c", "e", "p")

    def __init__(self, c: Any, p: Any, e: Any) -> None:
        self.c, self.p, self.e = c, p, e
        self._radius = self._size = None

    def __add__(self, other: Any) -> Affine:
        a, b = self, other
        if not isinstance(b, Affine):
            return Affine(a.c + b, a.p, a.e + ROUND * (np.abs(a.c) + np.abs(b)))
        return Affine(a.c + b.c, a.p + b.p, a.e + b.e + ROUND * (size(a) + size(b)))

    def __sub__(self, other: Any) -> Affine:
        return self + (-other)

    def __rsub__(self, other: Any) -> Affine:
        return -self + other

    def __mul__(self, other: Any) -> Affine:
        if isinstance(other, Affine):
            return _product(self, other)
        e = np.abs(other) * (self.e + ROUND * size(self))
        return Affine(self.c * other, self.p * other, e)

    def __truediv__(self, other: Affine) -> Affine:
        return self * inverted(other)

    def __rtruediv__(self, other: Any) -> Affine:
        return inverted(self) * other

    def __neg__(self) -> Affine:
        return Affine(-self.c, -self.p, self.e)

    __radd__, __rmul__ = __add__, __mul__

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        """Let NumPy's functions and numbers work on ranges, as the model's formulas have them."""
        operation = _UFUNCS.get(ufunc)
        if operation is None or method != "__call__":
            return NotImplemented
        return operation(*inputs)


def radius(a: Any) -> Any:
    """Return the size of the part that is linear in the place."""
    if a._radius is None:
        a._radius = np.add.reduce(np.abs(a.p))
    return a._radius


def size(a: Any) -> Any:
    """Return the largest size that it can have."""
    if a._size is None:
        a._size = np.abs(a.c) + radius(a) + a.e
    return a._size


def lower(a: Any) -> Any:
    """Return a number that it is not below."""
    return a.c - (radius(a) + a.e) - ROUND * size(a)


def upper(a: Any) -> Any:
    """Return a number that it is not above."""
    return a.c + (radius(a) + a.e) + ROUND * size(a)


_FIRST, _SECOND = np.triu_indices(4, 1)
"""The pairs of two of the four places."""


def _product(a: Affine, b: Affine) -> Affine:
    """Return the product of two ranges.

    Of the products of two places, a square lies between 0 and 1, the others between -1 and 1.
    """
    squares = a.p * b.p
    mixed, swapped = a.p.take(_FIRST, 0), a.p.take(_SECOND, 0)
    mixed *= b.p.take(_SECOND, 0)
    swapped *= b.p.take(_FIRST, 0)
    mixed += swapped
    most_a, most_b = np.abs(a.c) + radius(a), size(b)
    rest = 0.5 * np.add.reduce(np.abs(squares)) + np.add.reduce(np.abs(mixed))
    e = rest + most_a * b.e + a.e * most_b + ROUND * size(a) * most_b
    return Affine(a.c * b.c + 0.5 * np.add.reduce(squares), a.c * b.p + b.c * a.p, e)


def _linear(a: Any, slope: Any, middle: Any, half: Any) -> Affine:
    """Return slope a + middle, to which half is the distance of the function that it stands for."""
    e = np.abs(slope) * (a.e + ROUND * size(a)) + half + ROUND * (np.abs(middle) + half)
    return Affine(slope * a.c + middle, slope * a.p, e)


def inverted(a: Any) -> Affine:
    """Return the range of the reciprocals; infinite where zero is among the numbers.

    The line is parallel to the chord, halfway between that and the tangent (Chebyshev).
    """
    low, high = lower(a), upper(a)
    product = where(low * high > 0.0, low * high, np.nan)
    sign = where(low > 0.0, 1.0, -1.0)
    chord = (low + high) / product
    tangent = sign * 2.0 / np.sqrt(product)
    half = 0.5 * np.abs(chord - tangent) + 4.0 * ROUND * np.abs(chord)
    return _linear(a, -1.0 / product, 0.5 * (chord + tangent), half)


def rooted(a: Any) -> Affine:
    """Return the range of the square roots; NaN where a number is negative."""
    low, high = lower(a), upper(a)
    first, second = np.sqrt(where(low > 0.0, low, np.nan)), np.sqrt(high)
    total = first + second
    chord, tangent = first * second / total, 0.25 * total
    half = 0.5 * np.abs(tangent - chord) + 4.0 * ROUND * total
    return _linear(a, 1.0 / total, 0.5 * (chord + tangent), half)


def cosine_and_sine(middle: Any, half: Any) -> tuple[Affine, Affine]:
    """Return the ranges of cosine and sine over angles from middle - half to middle + half [rad].

    With a turn h e_theta from the middle, its cosine is between cos h and 1, and its sine differs
    from e_theta sin h by h^3 / (9 sqrt 3) at most; both hold up to h = pi, and wider ranges have no
    bound.
    """
    none = where(half <= np.pi, 0.0 * half, np.nan)
    cosine = np.cos(half)
    still = np.stack([none] * 4)
    turn_c = Affine(0.5 * (1.0 + cosine), still, 0.5 * (1.0 - cosine) + ROUND)
    most = half * half * half * 0.0641501
    turn_s = Affine(none, np.stack([none, none, np.sin(half), none]), most + ROUND)
    c, s = np.cos(middle), np.sin(middle)
    return turn_c * c - turn_s * s, turn_c * s + turn_s * c


def box_variables(middle: Any, half: Any) -> tuple[Affine, Affine, Affine, Affine, Affine]:
    """Return x, y, cos theta, sin theta and z over boxes (..., 4) of half widths (..., 4)."""
    x, y, t, z = np.moveaxis(np.asarray(middle, np.float64), -1, 0)
    widths = np.moveaxis(np.asarray(half, np.float64), -1, 0)
    none = np.zeros_like(x)

    def along(center: Any, index: int) -> Affine:
        parts = np.zeros(widths.shape)
        parts[index] = widths[index]
        return Affine(center, parts, none)

    return along(x, 0), along(y, 1), *cosine_and_sine(t, widths[2]), along(z, 3)


_UFUNCS: dict[Any, Callable[..., Affine]] = {
    np.add: lambda a, b: b + a,
    np.subtract: lambda a, b: b.__rsub__(a),
    np.multiply: lambda a, b: b * a,
    np.divide: lambda a, b: b.__rtruediv__(a),
    np.sqrt: rooted,
}
"""What NumPy calls for a function of a range, or for a NumPy number with a range to its right."""
