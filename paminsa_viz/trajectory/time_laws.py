"""Time laws: how a rest-to-rest motion runs from 0 to 1 in unit time.

A law is a piecewise polynomial, so its derivatives are exact. Scaled to a duration T, speeds divide
by T, accelerations by T^2, jerks by T^3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.errors import InvalidInput


class Profile(Enum):
    """Shape of a rest-to-rest motion in time."""

    QUINTIC = "quintic"
    """Fifth-degree polynomial: speed and acceleration vanish at both ends."""
    TRAPEZOID = "trapezoid"
    """Constant acceleration, constant speed, constant deceleration: the acceleration jumps."""
    S_CURVE = "s-curve"
    """The trapezoid with ramps of constant jerk in place of the jumps."""


@dataclass(frozen=True)
class TimeLaw:
    """A rest-to-rest law from 0 to 1 in unit time.

    Attributes:
        profile: Its shape.
        ramp: Share of the time spent speeding up, and as much slowing down; 0 < ramp <= 1/2. The
            quintic law has none.
        blend: Share of a ramp in which the acceleration builds up, and as much in which it goes
            down again; 0 < blend <= 1/2. Of the S-curve alone.

    Raises:
        InvalidInput: If a share is out of its range.
    """

    profile: Profile = Profile.QUINTIC
    ramp: float = 0.3
    blend: float = 0.4

    def __post_init__(self) -> None:
        for name in ("ramp", "blend"):
            value = getattr(self, name)
            if not (0 < value <= 0.5):
                raise InvalidInput(name, f"a share above 0 and up to 1/2 is needed, not {value!r}")

    @property
    def breaks(self) -> Array:
        """Instants in [0, 1], ends included, between which the law is one polynomial."""
        return _polynomial(self.profile, self.ramp, self.blend).breaks

    @property
    def bounded_jerk(self) -> bool:
        """Whether the acceleration never jumps, also against the rest before and after."""
        return self.profile is not Profile.TRAPEZOID

    def __call__(self, u: Array, order: int = 0) -> Array:
        """Return the law or a derivative of it, up to the third, at instants u (n,).

        Outside [0, 1] it is at rest. At a jump it is the value after it.
        """
        inside = _polynomial(self.profile, self.ramp, self.blend)(np.clip(u, 0.0, 1.0), order)
        if order == 0:
            return inside
        return np.where((u < 0.0) | (u > 1.0), 0.0, inside)


class _Piecewise:
    """A polynomial on each of some pieces, in powers of the distance from the piece's begin."""

    def __init__(self, breaks: Array, coefficients: Array) -> None:
        """Take breaks (m + 1,) and coefficients (m, degree + 1), the constant first."""
        self.breaks = breaks
        self.coefficients = [coefficients]
        for _ in range(3):
            powers = np.arange(1, self.coefficients[-1].shape[1])
            self.coefficients.append(self.coefficients[-1][:, 1:] * powers)

    @classmethod
    def integrated(cls, breaks: Array, highest: Array, times: int) -> _Piecewise:
        """Integrate a piecewise constant (m,) from 0, and scale it to be 1 at the end."""
        coefficients = highest[:, None]
        spans = np.diff(breaks)
        for _ in range(times):
            raised = coefficients / np.arange(1, coefficients.shape[1] + 1)
            growth = (raised * spans[:, None] ** np.arange(1, raised.shape[1] + 1)).sum(axis=1)
            begin = np.concatenate([[0.0], np.cumsum(growth)[:-1]])
            coefficients = np.column_stack([begin, raised])
        end = (coefficients[-1] * spans[-1] ** np.arange(coefficients.shape[1])).sum()
        return cls(breaks, coefficients / end)

    def __call__(self, u: Array, order: int) -> Array:
        """Return a derivative at u in [0, 1]; at a break the one after it."""
        last = len(self.breaks) - 2
        piece = np.minimum(np.searchsorted(self.breaks, u, "right") - 1, last)
        rest = u - self.breaks[piece]
        value = np.zeros_like(rest)
        for column in self.coefficients[order].T[::-1]:
            value = value * rest + column[piece]
        return value


@lru_cache(maxsize=256)
def _polynomial(profile: Profile, ramp: float, blend: float) -> _Piecewise:
    if profile is Profile.QUINTIC:
        return _Piecewise(np.array([0.0, 1.0]), np.array([[0.0, 0.0, 0.0, 10.0, -15.0, 6.0]]))
    if profile is Profile.TRAPEZOID:
        ends = [0.0, ramp, 1.0 - ramp, 1.0]
        values, integrations = [1.0, 0.0, -1.0], 2
    else:
        rise = blend * ramp
        ends = [0.0, rise, ramp - rise, ramp]
        ends += [1.0 - end for end in reversed(ends)]
        values, integrations = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0], 3
    kept = [i for i, value in enumerate(values) if ends[i + 1] - ends[i] > 1e-15]
    breaks = np.array([0.0, *(ends[i + 1] for i in kept)])
    return _Piecewise.integrated(breaks, np.array([values[i] for i in kept]), integrations)


def fit_law(
    law: TimeLaw,
    speed: float = math.inf,
    acceleration: float = math.inf,
    jerk: float = math.inf,
) -> tuple[TimeLaw, float] | None:
    """Return the fastest law of the shape of another within limits, and its duration [s].

    Limits are those of the law scaled to its duration [1/s, 1/s^2, 1/s^3]; infinite where there is
    none. The law uses them fully: it runs at the speed limit as long as it can and reaches it with
    the full acceleration, for the S-curve with the full jerk.

    Returns:
        None where limits do not make a shape: for the quintic law, and without a limit that keeps
        ramps finite. An S-curve keeps its ``blend`` where no jerk is given.
    """
    if law.profile is Profile.QUINTIC:
        return None
    if law.profile is Profile.S_CURVE and math.isfinite(jerk):
        return _fit_s_curve(speed, acceleration, jerk)
    if not math.isfinite(acceleration):
        return None
    if law.profile is Profile.S_CURVE:
        acceleration *= 1.0 - law.blend  # the mean of a ramp
    ramp = speed / acceleration
    if speed * ramp >= 1.0:  # no time at constant speed
        return replace(law, ramp=0.5), 2.0 / math.sqrt(acceleration)
    duration = 1.0 / speed + ramp
    return replace(law, ramp=ramp / duration), duration


def _fit_s_curve(speed: float, acceleration: float, jerk: float) -> tuple[TimeLaw, float]:
    """See `fit_law`. ``rise`` is the time of constant jerk, ``ramp`` that of speeding up [s]."""
    rise = min(acceleration / jerk, math.sqrt(speed / jerk), (1.0 / (2.0 * jerk)) ** (1 / 3))
    if rise < acceleration / jerk:  # the acceleration limit is not reached
        ramp = 2.0 * rise
        top = jerk * rise * rise
    else:
        # without constant speed: top * ramp = 1 with ramp = top / acceleration + rise
        alone = acceleration * (-rise + math.sqrt(rise * rise + 4.0 / acceleration)) / 2.0
        top = min(speed, alone)
        ramp = top / acceleration + rise
    duration = max(1.0 / top + ramp, 2.0 * ramp)
    return TimeLaw(Profile.S_CURVE, min(ramp / duration, 0.5), min(rise / ramp, 0.5)), duration
