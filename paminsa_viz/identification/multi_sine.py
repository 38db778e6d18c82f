"""Periodic motions: sums of sines and cosines of the pose that begin and end at rest.

Swevers et al. (1997) move each joint by a finite Fourier series. Here the coordinates of the pose
are moved, and the coefficients keep to sum k s_k = 0 and sum k^2 c_k = 0, so that velocity and
acceleration vanish where a period begins: a robot can start it from standstill.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array

HARMONICS = (3, 20)
"""Fewest and most harmonics: two of each kind of coefficients hold the ends at rest."""


@dataclass(frozen=True, eq=False)
class MultiSine:
    """center + sum_k s_k sin(2 pi k P u) + c_k cos(2 pi k P u): a curve in unit time.

    Attributes:
        center: (4,) mean pose [m, m, rad, m].
        sine: (harmonics, 4) coefficients s_k.
        cosine: (harmonics, 4) coefficients c_k.
        periods: P, how often it is run.
        bounded_jerk: Whether the acceleration never jumps: that of sines does not.
    """

    center: Array
    sine: Array
    cosine: Array
    periods: int
    bounded_jerk = True

    @property
    def breaks(self) -> Array:
        """Instants in [0, 1], ends included, between which all derivatives are continuous."""
        return np.linspace(0.0, 1.0, self.periods + 1)

    def __call__(self, u: Array, order: int = 0) -> Array:
        """Return the pose or a derivative by u at instants u (n,), (n, 4)."""
        waves = fourier(len(self.sine), np.asarray(u, float) * self.periods, order)
        value = waves @ np.concatenate([self.sine, self.cosine]) * float(self.periods) ** order
        return value + self.center if order == 0 else value


def fourier(harmonics: int, u: Array, order: int) -> Array:
    """Return a derivative of all sines and cosines of a period in unit time, (n, 2 harmonics)."""
    rate = 2.0 * np.pi * np.arange(1, harmonics + 1)
    phase = u[..., None] * rate + 0.5 * np.pi * order
    waves = np.hstack([np.sin(phase), np.cos(phase)])
    return np.asarray(waves * np.tile(rate, 2) ** order, np.float64)


class MultiSineFamily:
    """All multi-sines of some harmonics as points of a linear space, (size,).

    Attributes:
        size: Number of variables: the center, then the coefficients of x, y, theta, z.
        center: (4,) pose that the variables' first four are added to.
        scale: (4,) what a variable of 1 is [m, m, rad, m].
    """

    def __init__(self, harmonics: int, center: Array, scale: Array) -> None:
        """Find the coefficients that begin and end at rest.

        Raises:
            InvalidInput: If there are too few or too many harmonics.
        """
        low, high = HARMONICS
        if not low <= harmonics <= high:
            raise InvalidInput("harmonics", f"{low} to {high} are possible, not {harmonics!r}")
        self.center, self.scale = np.asarray(center, float), np.asarray(scale, float)
        k = np.arange(1.0, harmonics + 1)
        self._harmonics = harmonics
        self._free = np.zeros((2 * harmonics, 2 * harmonics - 2))
        self._free[:harmonics, : harmonics - 1] = _null_space(k)
        self._free[harmonics:, harmonics - 1 :] = _null_space(k**2)
        self.size = 4 + 4 * self._free.shape[1]

    def curve(self, variables: Array, periods: int = 1) -> MultiSine:
        """Return the motion of some variables (size,)."""
        center, parts = variables[:4], variables[4:].reshape(4, -1)
        coefficients = (self._free @ parts.T) * self.scale
        half = self._harmonics
        return MultiSine(
            self.center + center * self.scale, coefficients[:half], coefficients[half:], periods
        )

    def waves(self, u: Array, period: float) -> list[Array]:
        """Return what a coordinate's own variables do to it and its rates at u (n,) of a period.

        Three arrays (n, 1 + variables): of the pose, per [s] and per [s^2], the center first. All
        coordinates have the same.
        """
        found = []
        for order in range(3):
            shape = fourier(self._harmonics, u, order) @ self._free / period**order
            found.append(np.hstack([np.full((len(u), 1), float(order == 0)), shape]))
        return found

    def by_coordinate(self, variables: Array) -> Array:
        """Return variables (..., size) as they multiply `waves`, (..., 4, 1 + variables) [SI]."""
        shape = variables.shape[:-1]
        parts = variables[..., 4:].reshape(*shape, 4, -1)
        whole = np.concatenate([variables[..., :4, None], parts], axis=-1)
        return whole * self.scale[:, None]

    def from_coordinates(self, parts: Array) -> Array:
        """Return a gradient by `by_coordinate` (4, 1 + variables) as one by the variables."""
        own = parts * self.scale[:, None]
        return np.concatenate([own[:, 0], own[:, 1:].ravel()])


def _null_space(row: Array) -> Array:
    """Return an orthonormal basis of what a row (n,) maps to zero, (n, n - 1)."""
    return np.linalg.svd(row[None])[2][1:].T
