"""The durations that limits require of a motion at each of its instants.

Stretched in time, a motion keeps its poses: speeds divide by the duration T, accelerations by T^2,
jerks by T^3. The actuators' torques are exactly

    Q(u; T) = gravity(u) + friction(u; T) + dynamic(u) / T^2,

where gravity includes the design's load, the dynamic part holds inertia and velocity terms, both of
second order in 1/T, and viscous friction is of first order. So with a given Coulomb friction every
instant u has its own shortest duration in closed form. Coulomb friction fades with the speed
(`Friction.transition_speed`): where it adds to a torque it is counted in full, where it takes some
off, as much as there is in that duration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES, Drive
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.jacobians import actuator_acceleration, actuator_velocity
from paminsa_viz.model.load import NO_LOAD
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.limits import LIMITED, MotionLimits
from paminsa_viz.trajectory.plan import UnitCurve
from paminsa_viz.trajectory.planners import PLACE

_FADED = 8
"""Times that friction is worked out for the duration it leaves, the first without any."""

_INSTANT = 1e-300
"""Least duration that a speed is divided by."""

Derivatives = Callable[[Array, int], Array]
"""A motion in unit time: the pose, order 0, or a derivative of it at instants (n,), as (n, 4)."""

_Rows = NDArray[np.intp] | slice
"""Which of the instants."""

_Needed = Callable[[Array | None, _Rows], Array]
"""Durations that are needed at some instants, with the friction that there is in given ones."""


def limit_of(column: int, limits: MotionLimits, design: Design | None) -> float:
    """Return a limit by its place in `limits.LIMITED`, in its unit."""
    rows = [
        *limits.rates.ravel(), *limits.actuators, *[1.0] * 4, *_motor_speeds(design),
        *_gear_peaks(design),
    ]  # fmt: skip
    return float(rows[column])


def needed_durations(
    curve: UnitCurve,
    limits: MotionLimits,
    design: Design | None,
    drives: bool,
    misprints: Misprint = Misprint.NONE,
) -> Callable[[Array], Array]:
    """Return what gives the durations that limits require at instants (n,), (n, columns) [s].

    The columns are those of `limits.LIMITED`, as far as a design is given and its drives are kept.
    """
    parts: list[Callable[[Derivatives, Array], Array]] = [partial(_rate_durations, limits.rates)]
    driven = drives and design is not None and any(design.drives)
    if design is not None and (driven or limits.needs_torques):
        parts.append(partial(_torque_durations, limits.actuators, design, misprints))
    if design is not None and driven:
        parts.append(_drive_durations(design, misprints))

    def needed(u: Array) -> Array:
        at = _each_once(curve)
        return np.concatenate([part(at, u) for part in parts], axis=1)

    return needed


def _each_once(curve: UnitCurve) -> Derivatives:
    """Return a curve that works out each derivative once, for instants that are always the same."""
    known: dict[int, Array] = {}

    def at(u: Array, order: int) -> Array:
        if order not in known:
            known[order] = curve(u, order)
        return known[order]

    return at


def _rate_durations(limits: Array, curve: Derivatives, u: Array) -> Array:
    """Return the durations that limits (3, 2) require at instants (n,), (n, 6) [s]."""
    found = []
    for order in (1, 2, 3):
        if np.isinf(limits[order - 1]).all():
            found.append(np.zeros((len(u), 2)))
            continue
        rate = curve(u, order)
        size = np.stack([np.linalg.norm(rate[:, PLACE], axis=1), abs(rate[:, 2])], axis=1)
        found.append((size / limits[order - 1]) ** (1.0 / order))
    return np.concatenate(found, axis=1)


def torque_parts(
    curve: Derivatives, design: Design, misprints: Misprint, u: Array
) -> tuple[Array, Array, Array]:
    """Return the torques' parts of order 0, 1 and 2 in 1/T along a curve, each (n, 4).

    They are without Coulomb friction.
    """
    plain = design.without_friction()
    pose, rate, growth = curve(u, 0), curve(u, 1), curve(u, 2)
    still = np.zeros_like(pose)
    gravity = inverse_dynamics(plain, pose, still, still, misprints).torque
    weightless = replace(plain, gravity=0.0, load=NO_LOAD)
    dynamic = inverse_dynamics(weightless, pose, rate, growth, misprints).torque
    viscous = np.array(design.actuator_friction.viscous)
    return gravity, viscous * actuator_velocity(design, pose, rate), dynamic


def coulomb_friction(
    curve: Derivatives, design: Design, u: Array, duration: Array | None = None
) -> Array:
    """Return Coulomb friction along a curve that takes durations (n, 1) or (n, 4), as (n, 4).

    Without a duration it is counted in full wherever an actuator moves.
    """
    speed = actuator_velocity(design, curve(u, 0), curve(u, 1))
    return _coulomb_friction(design, speed, duration)


def _coulomb_friction(design: Design, speed: Array, duration: Array | None) -> Array:
    """Return Coulomb friction by the actuators' speeds (n, 4), see `coulomb_friction`."""
    return np.array(design.actuator_friction.coulomb) * coulomb_share(design, speed, duration)


def coulomb_share(design: Design, speed: Array, duration: Array | None) -> Array:
    """Return the share of Coulomb friction that acts, -1 to 1, see `coulomb_friction`."""
    if duration is None:
        return np.sign(speed)
    return np.tanh(speed / np.maximum(duration * design.friction.transition_speed, _INSTANT))


def _where_friction_fades(needed: _Needed, design: Design) -> Array:
    """Return the durations that are needed with the friction that there is in them.

    ``needed`` gives those (n, columns) of some instants with the friction of durations (n, 4); the
    first and the last four columns are those of torques of M1 to M4. A longer duration has less
    friction, so that from those without any on each is one that will do.
    """
    full = needed(None, slice(None))
    if not any(design.actuator_friction.coulomb):
        return full
    longest, changing = np.full_like(full, np.inf), np.arange(len(full))
    for _ in range(_FADED):
        before = longest[changing]
        faded = needed(np.maximum(before[:, :4], before[:, -4:]), changing)
        longest[changing] = np.maximum(full[changing], faded)
        changing = changing[(longest[changing] != before).any(axis=1)]
        if not changing.size:
            break
    return longest


FIRST_OF_DRIVES = LIMITED.index("torque-speed envelope of M1")
"""Place of the drives' limits among the columns of durations."""


def _motor_speeds(design: Design | None) -> list[float]:
    """Return the top speeds of the drives' motors, (4,) [rad/s]; infinite where there is none."""
    if design is None:
        return [np.inf] * 4
    return [
        np.inf if drive is None else one.speed * drive.ratio
        for drive, one in zip(design.drives, design.output_limits, strict=True)
    ]


def _gear_peaks(design: Design | None) -> list[float]:
    """Return the peak loads of the drives' gears, at the actuators, (4,); infinite without one."""
    drives = NO_DRIVES if design is None else design.drives
    return [np.inf if drive is None else drive.gear_limits.peak for drive in drives]


def standstill_peaks(design: Design) -> Array:
    """Return what drives and their gears give at no speed, at the actuators, (4,) [N m, N]."""
    gears = _gear_peaks(design)
    return np.array(
        [
            gear if one is None else min(gear, one.corners[0][1] * one.ratio * one.total_efficiency)
            for one, gear in zip(design.drives, gears, strict=True)
        ]
    )


def _drive_durations(design: Design, misprints: Misprint) -> Callable[[Derivatives, Array], Array]:
    """Return the durations that the drives require, as a function (n,) -> (n, 12) [s].

    The columns are envelopes, speeds and gears of M1 to M4. With w = 1/T the load, the motor's own
    torque and its speed are polynomials in w, and so is each line of the envelope; see `_longest`.
    """
    plain = replace(design, drives=NO_DRIVES)
    speeds = np.array([one.speed for one in design.output_limits])

    def durations(curve: Derivatives, u: Array) -> Array:
        still, *others = torque_parts(curve, plain, misprints, u)
        pose, rate, growth = curve(u, 0), curve(u, 1), curve(u, 2)
        speed = actuator_velocity(design, pose, rate)
        turned = actuator_acceleration(design.geometry, pose, rate, growth)
        sides = _sides(design, others, speed, turned)

        def needed(duration: Array | None, rows: _Rows) -> Array:
            load = still[rows] + _coulomb_friction(plain, speed[rows], duration)
            acting = coulomb_share(design, speed[rows], duration)
            found = np.zeros((len(load), 12))
            found[:, 4:8] = np.abs(speed[rows]) / speeds
            for side in sides:
                least = side.durations(load, acting, rows)
                found[:, side.column] = np.maximum(found[:, side.column], least)
            return found

        return _where_friction_fades(needed, design)

    return durations


class _Side(NamedTuple):
    """A line of a drive's limits for torques of one sign, at instants (n,).

    Attributes:
        column: Its place among those of `_drive_durations`.
        actuator: Which one.
        sign: The sign, 1 or -1.
        along: Where such a torque drives.
        limit: The limit at no speed.
        coulomb: The motor's own Coulomb friction, as far as it counts.
        parts: Shares (n,) of the load, with the factors of 1/T and of 1/T^2 that they make.
    """

    column: int
    actuator: int
    sign: float
    along: NDArray[np.bool_]
    limit: float
    coulomb: float
    parts: list[tuple[Array, Array, Array]]

    def durations(self, load: Array, acting: Array, rows: _Rows) -> Array:
        """Return the durations (m,) that it requires at some instants [s].

        Args:
            load: The loads at rest there, friction included, (m, 4) [N m; N].
            acting: The shares of Coulomb friction that act, (m, 4).
            rows: Which instants of the n.
        """
        own, load = self.coulomb * acting[:, self.actuator], load[:, self.actuator]
        needed = [
            _longest(self.limit - self.sign * (share[rows] * load + own), first[rows], second[rows])
            for share, first, second in self.parts
        ]
        if len(needed) == 1:
            return needed[0]
        # that is the larger of the two at a positive speed: below a limit if both are
        return np.where(self.along[rows], np.maximum(*needed), np.minimum(*needed))


def _sides(design: Design, others: list[Array], speed: Array, turned: Array) -> list[_Side]:
    """Return both sides of all limits of the drives by the torques' parts of order 1 and 2."""
    found = []
    for j, drive in enumerate(design.drives):
        if drive is None:
            continue
        viscous, coulomb = drive.reflected_friction
        own = viscous * speed[:, j], drive.reflected_inertia * turned[:, j]
        for limit, fall, lossy, counted in drive_lines(drive, speed[:, j]):
            for sign in (1.0, -1.0):
                parts = []
                for share in lossy:
                    first, second = (
                        sign * (share * part[:, j] + counted * mine)
                        for part, mine in zip(others, own, strict=True)
                    )
                    parts.append((share, first + fall * np.abs(speed[:, j]), second))
                column, along = j if counted else 8 + j, sign * speed[:, j] > 0
                found.append(_Side(column, j, sign, along, limit, counted * coulomb, parts))
    return found


def drive_lines(
    drive: Drive, speed: Array
) -> Iterator[tuple[float, float, tuple[Array, ...], float]]:
    """Yield the limits of a drive, |share load + counted own| + fall |speed| <= limit.

    Args:
        drive: The drive.
        speed: (n,) of the actuator; its sign matters.

    Yields:
        Limit and fall at the actuator, the shares (n,) of which the larger one counts at a positive
        speed and the smaller one at a negative, and whether the motor's own torque counts.
    """
    # behind the gear the load is T/eta where the motor drives and T eta where the load does
    eta = np.where(speed == 0, 1.0, drive.total_efficiency)
    shares = (1 / eta, eta) if drive.total_efficiency < 1 else (eta,)
    lines = [(a * drive.ratio, s * drive.ratio**2, shares, 1.0) for a, s in drive.lines]
    lines.append((drive.gear_limits.peak, 0.0, (np.ones_like(eta),), 0.0))
    yield from (line for line in lines if not np.isinf(line[0]))


def _longest(room: Array, first: Array, second: Array) -> Array:
    """Return 1/w for the smallest w > 0 with first w + second w^2 = room; infinite without room."""
    with np.errstate(all="ignore"):
        square = first**2 + 4.0 * second * room
        needed = np.where(square >= 0, (first + np.sqrt(square)) / (2.0 * room), 0.0)
    return np.where(room > 0, np.maximum(needed, 0.0), np.inf)


def _torque_durations(
    limits: Array, design: Design, misprints: Misprint, curve: Derivatives, u: Array
) -> Array:
    """Return the durations that limits (4,) require at instants (n,), (n, 4) [s].

    With w = 1/T a torque is constant + first w + second w^2. It starts within its limit at w = 0
    and first leaves it at the smallest positive root w of limit -+ torque = 0; T = 1/w.
    """
    if np.isinf(limits).all():
        return np.zeros((len(u), 4))
    still, first, second = torque_parts(curve, design, misprints, u)
    speed = actuator_velocity(design, curve(u, 0), curve(u, 1))

    def needed(duration: Array | None, rows: _Rows) -> Array:
        constant = still[rows] + _coulomb_friction(design, speed[rows], duration)
        longest = np.zeros_like(constant)
        for sign in (1.0, -1.0):
            each = _longest(limits - sign * constant, sign * first[rows], sign * second[rows])
            longest = np.maximum(longest, np.where(np.isinf(limits), 0.0, each))
        return longest

    return _where_friction_fades(needed, design)
