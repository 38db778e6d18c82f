"""Truncated Taylor series in one variable: exact derivatives for the tests' own mechanics."""

from __future__ import annotations

from typing import Any

import numpy as np


class Jet:
    """a + b t + c t^2, where a, b and c are numbers or arrays and higher powers of t are dropped.

    Functions written with ``+ - * /`` and this module's `sqrt`, `sin` and `cos` give their first
    and second derivatives along a line or curve to rounding, without a step size.
    """

    __array_ufunc__ = None

    def __init__(self, a: Any, b: Any = 0.0, c: Any = 0.0) -> None:
        self.a, self.b, self.c = a, b, c

    @property
    def rate(self) -> Any:
        """First derivative in t at t = 0."""
        return self.b

    @property
    def second(self) -> Any:
        """Second derivative in t at t = 0."""
        return 2.0 * self.c

    def __neg__(self) -> Jet:
        return Jet(-self.a, -self.b, -self.c)

    def __add__(self, o: Any) -> Jet:
        if not isinstance(o, Jet):
            return Jet(self.a + o, self.b, self.c)
        return Jet(self.a + o.a, self.b + o.b, self.c + o.c)

    __radd__ = __add__

    def __sub__(self, o: Any) -> Jet:
        if not isinstance(o, Jet):
            return Jet(self.a - o, self.b, self.c)
        return Jet(self.a - o.a, self.b - o.b, self.c - o.c)

    def __rsub__(self, o: Any) -> Jet:
        return Jet(o - self.a, -self.b, -self.c)

    def __mul__(self, o: Any) -> Jet:
        if not isinstance(o, Jet):
            return Jet(self.a * o, self.b * o, self.c * o)
        return Jet(
            self.a * o.a, self.a * o.b + self.b * o.a, self.a * o.c + self.b * o.b + self.c * o.a
        )

    __rmul__ = __mul__

    def __truediv__(self, o: Any) -> Jet:
        if not isinstance(o, Jet):
            return Jet(self.a / o, self.b / o, self.c / o)
        a = self.a / o.a
        b = (self.b - a * o.b) / o.a
        return Jet(a, b, (self.c - a * o.c - b * o.b) / o.a)

    def __rtruediv__(self, o: Any) -> Jet:
        return Jet(o) / self


def sqrt(x: Any) -> Any:
    """Square root of a number, array (real or complex) or jet."""
    if not isinstance(x, Jet):
        return np.sqrt(x)
    a = np.sqrt(x.a)
    b = x.b / (2 * a)
    return Jet(a, b, (x.c - b * b) / (2 * a))


def sin(x: Any) -> Any:
    """Sine of a number, array (real or complex) or jet."""
    if not isinstance(x, Jet):
        return np.sin(x)
    s, c = np.sin(x.a), np.cos(x.a)
    return Jet(s, c * x.b, c * x.c - s * x.b * x.b / 2)


def cos(x: Any) -> Any:
    """Cosine of a number, array (real or complex) or jet."""
    if not isinstance(x, Jet):
        return np.cos(x)
    s, c = np.sin(x.a), np.cos(x.a)
    return Jet(c, -s * x.b, -s * x.c - c * x.b * x.b / 2)
