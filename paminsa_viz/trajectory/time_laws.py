"""Time laws: how a rest-to-rest motion runs from 0 to 1 in unit time.

A law is a piecewise polynomial, so its derivatives are exact. Scaled to a duration T, speeds divide
by T, accelerations by T^2, jerks by T^3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paminsa_viz.checks import check_fields, kinds_checked, require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array

if TYPE_CHECKING:
    from scipy.interpolate import PPoly


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
        InvalidInput: If the profile is none, or a share is out of its range.
    """

    profile: Profile = Profile.QUINTIC
    ramp: float = 0.3
    blend: float = 0.4

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("ramp", "blend"):
            value = getattr(self, name)
            if not (0 < value <= 0.5):
                raise InvalidInput(name, f"a share above 0 and up to 1/2 is needed, not {value!r}")

    @property
    def breaks(self) -> Array:
        """Instants in [0, 1], ends included, between which the law is one polynomial."""
        return _derivatives(self.profile, self.ramp, self.blend)[0].x

    @property
    def coefficients(self) -> Array:
        """Coefficients (m, n) of the n polynomials between `breaks`, the highest power first.

        They are in the time since the break before.
        """
        return _derivatives(self.profile, self.ramp, self.blend)[0].c

    @property
    def bounded_jerk(self) -> bool:
        """Whether the acceleration never jumps, also against the rest before and after."""
        return self.profile is not Profile.TRAPEZOID

    def __call__(self, u: Array, order: int = 0) -> Array:
        """Return the law or a derivative of it, up to the third, at instants u (n,).

        Outside [0, 1] it is at rest. At a jump it is the value after it, at 1 that before it.
        """
        inside = _derivatives(self.profile, self.ramp, self.blend)[order](np.clip(u, 0.0, 1.0))
        if order == 0:
            return inside
        # The speed at the end is zero but for rounding, which would be a motion with a direction.
        resting = (u < 0.0) | (u >= 1.0 if order == 1 else u > 1.0)
        return np.where(resting, 0.0, inside)


@lru_cache(maxsize=256)
def _derivatives(profile: Profile, ramp: float, blend: float) -> tuple[PPoly, ...]:
    """Return a law and its first three derivatives."""
    from scipy.interpolate import PPoly  # slow to load

    if profile is Profile.QUINTIC:
        law = PPoly([[6.0], [-15.0], [10.0], [0.0], [0.0], [0.0]], [0.0, 1.0])
    else:
        if profile is Profile.TRAPEZOID:
            ends = [0.0, ramp, 1.0 - ramp, 1.0]
            values, integrations = [1.0, 0.0, -1.0], 2
        else:
            rise = blend * ramp
            ends = [0.0, rise, ramp - rise, ramp]
            ends += [1.0 - end for end in reversed(ends)]
            values, integrations = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0], 3
        kept = [i for i, value in enumerate(values) if ends[i + 1] - ends[i] > 1e-15]
        breaks = [0.0, *(ends[i + 1] for i in kept)]
        law = PPoly([[values[i] for i in kept]], breaks).antiderivative(integrations)
        law = PPoly(law.c / law(1.0), law.x)
    return law, law.derivative(1), law.derivative(2), law.derivative(3)


@kinds_checked
def fit_law(
    law: TimeLaw, speed: float = math.inf, acceleration: float = math.inf, jerk: float = math.inf
) -> tuple[TimeLaw, float] | None:
    """Return the fastest law of the shape of another within limits, and its duration [s].

    Limits are those of the law scaled to its duration [1/s, 1/s^2, 1/s^3]; infinite where there is
    none. The law uses them fully: it runs at the speed limit as long as it can and reaches it with
    the full acceleration, for the S-curve with the full jerk.

    Returns:
        None where limits do not make a shape: for the quintic law, and without a limit that keeps
        ramps finite. An S-curve keeps its ``blend`` where no jerk is given.

    Raises:
        InvalidInput: If a limit is not positive.
    """
    limits = {"speed": speed, "acceleration": acceleration, "jerk": jerk}
    for argument, value in limits.items():
        require_positive(value, argument, finite=False)
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
    return TimeLaw(Profile.S_CURVE, ramp / duration, min(rise / ramp, 0.5)), duration
