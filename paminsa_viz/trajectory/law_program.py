"""The conic program of the time-optimal law on a path without singularities.

The unknown is z(s) = s'^2, a quadratic spline, so that s'' = dz/2 is continuous but at breaks of
the motion. Speeds and torques are linear in z and dz, lengths of accelerations are cones, and so is
the duration (Verscheure et al. 2009): the integral of d with d c >= 1 and c <= sqrt(z).

Viscous friction and the fall of a torque with the speed go with s' = sqrt(z). Where they leave less
room they are not convex; there the tangent at the law before is taken, which lies above: every law
of the series keeps the limits and is at least as fast as the one before it.

Coulomb friction fades with the speed. Limits hold with all of it, wherever an actuator moves, and
with that of the law before: a law brakes by no more than there is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES
from paminsa_viz.model.jacobians import actuator_acceleration, actuator_velocity
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.durations import (
    coulomb_friction,
    coulomb_share,
    drive_lines,
    needed_durations,
    torque_parts,
)
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import TimedPath, TracedPath
from paminsa_viz.trajectory.planners import PLACE

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

_NODES = 2
"""Points of a piece at which its time is counted."""

_INSIDE = 1e-6
"""Share of a piece by which its ends are looked at from inside: directions may change there."""

_AT_REST = 2e-6
"""Share of the longest piece below which a place is at a stop: a side of a piece, no node."""

LOOKED_AT = 14
"""Points of a piece, besides its ends, at which a law is looked at afterwards."""

_SLOWEST = 1e-18
"""Least z of a law at which tangents are taken."""


class LawProgramFailed(PaminsaError):
    """The conic solver found no law."""


class Terms(NamedTuple):
    """Limits growth dz + square z + rate sqrt(z) + constant <= 1, each of them (n, columns)."""

    growth: Array
    square: Array
    rate: Array
    constant: Array


Law = Callable[[Array], tuple[Array, Array]]
"""z and dz of a law at places s (n,)."""


class LawProgram:
    """The program of one path between the knots given.

    Args:
        path: The path.
        knots: (n + 1,) places s in (0, 1), ends and stops among them.
        bends: (n + 1,) at which of them dz may jump: breaks of the motion, stops among them.
        limits: Limits; those of jerk are left out.
        design: The robot.
        unit: Time in which all is counted; about the duration, so that numbers are near 1 [s].
        drives: Whether to keep the limits of the design's drives.

    Attributes:
        points: Places s at which limits are kept; `tighten` adds some.
    """

    def __init__(
        self,
        path: TracedPath,
        knots: Array,
        bends: NDArray[np.bool_],
        limits: MotionLimits,
        design: Design,
        unit: float,
        *,
        drives: bool = True,
    ) -> None:
        self._path, self._limits, self._design, self._unit = path, limits, design, unit
        self._driven = drives and any(design.drives)
        self._rubs = any(design.actuator_friction.coulomb)
        self._places = np.sort(np.concatenate([[0.0, 1.0], knots, knots[bends]]))
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        steps = np.diff(knots)[:, None]
        base = (knots[:-1, None] + steps * 0.5 * (1.0 + nodes)).ravel()
        self._weights = (steps * 0.5 * weights).ravel()
        self._longest = float(steps.max())
        sides = np.concatenate(
            [knots[:-1] + _INSIDE * steps[:, 0], knots[1:] - _INSIDE * steps[:, 0]]
        )
        self.points = np.concatenate([base, sides])
        # the coefficients that are z at the stops
        at = np.searchsorted(self._places, path.place(path.rests), "left")
        self._free = np.ones(len(self._places) - 3, dtype=bool)
        self._free[np.maximum(at - 1, 0)] = False

    def solve(self, before: Law) -> BSpline:
        """Return z by s, no slower than a law that keeps the limits [1/unit^2].

        Raises:
            LawProgramFailed: If the solver finds none.
        """
        from scipy import sparse  # slow to load
        from scipy.interpolate import BSpline

        z, dz = self._rows(self.points)
        m, points, timed = z.shape[1], len(self.points), len(self._weights)
        size = m + points + timed  # coefficients of z, c at the points, d at the nodes
        limits, right = self._limit_rows(before, z, dz)
        one, zero = np.ones(points), np.zeros(points)
        # c, d, and z here in parts of what they are by the law before
        rate = np.sqrt(np.maximum(before(self.points)[0], _SLOWEST))
        part = sparse.hstack(
            [sparse.diags(rate**-2.0) @ z, sparse.csr_matrix((points, points + timed))]
        )
        # c <= sqrt(z), as |(2 c, z - 1)| <= z + 1
        roots = _interleaved(
            [(-part, one), (-2.0 * sparse.eye(points, size, m), zero), (-part, -one)]
        )
        # d c >= 1 at the nodes, as |(2, c - d)| <= c + d
        c, d = sparse.eye(timed, size, m), sparse.eye(timed, size, m + points)
        none = sparse.csr_matrix((timed, size))
        times = _interleaved(
            [(-c - d, zero[:timed]), (none, np.full(timed, 2.0)), (d - c, zero[:timed])]
        )
        cones = self._cones(z, dz, points + timed)
        sides = [
            (sparse.vstack([limits, -sparse.eye(m, size)]), np.concatenate([right, np.zeros(m)])),
            roots,
            times,
        ]
        sides += cones
        cost = np.concatenate([np.zeros(m + points), self._weights / rate[:timed]])
        clarabel: Any = import_module("clarabel")  # compiled, without types
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        found: Any = clarabel.DefaultSolver(
            sparse.csc_matrix((len(cost), len(cost))), cost,
            sparse.csc_matrix(sparse.vstack([side for side, _ in sides])),
            np.concatenate([side for _, side in sides]),
            [clarabel.NonnegativeConeT(len(sides[0][1])),
             *[clarabel.SecondOrderConeT(3)] * (points + timed),
             *[clarabel.SecondOrderConeT(4)] * (points * len(cones))],
            settings,
        ).solve()  # fmt: skip
        if "Solved" not in str(found.status):
            raise LawProgramFailed(f"the conic solver returned {found.status}")
        coefficients = np.zeros(len(self._free))
        coefficients[self._free] = np.maximum(np.array(found.x)[:m], 0.0)
        return BSpline(self._places, coefficients, 2)

    def _rows(self, s: Array) -> tuple[Any, Any]:
        """Return z and dz at places (n,) as rows on the free coefficients."""
        from scipy import sparse
        from scipy.interpolate import BSpline

        t = self._places
        count = len(self._free)
        apart = 2.0 / (t[3 : count + 2] - t[1:count])
        shape = (count - 1, count)
        change = sparse.diags(apart, 1, shape=shape) - sparse.diags(apart, 0, shape=shape)
        z = sparse.csr_matrix(BSpline.design_matrix(s, t, 2))
        dz = sparse.csr_matrix(BSpline.design_matrix(s, t[1:-1], 1)) @ change
        return z[:, self._free], sparse.csr_matrix(dz)[:, self._free]

    def _limit_rows(self, before: Law, z: Any, dz: Any) -> tuple[Any, Array]:
        """Return the linear limits, A and b of A x <= b; x has coefficients, c, d."""
        from scipy import sparse

        s, timed = self.points, len(self._weights)
        law, slope = before(s)
        tangent = np.sqrt(np.maximum(law, _SLOWEST))[:, None]
        terms = self._terms(s, law, slope)
        if self._rubs:
            faded = self._terms(s, law, slope, faded=True)
            terms = Terms(*(np.hstack(pair) for pair in zip(terms, faded, strict=True)))
        eased = terms.rate <= 0.0
        above = np.where(eased, 0.0, terms.rate)
        square = terms.square + above / (2.0 * tangent)
        right = 1.0 - terms.constant - 0.5 * above * tangent
        kept = np.where(eased, terms.rate, 0.0) * tangent
        # all of the first limit, then of the next
        rows = _strictest(right.T, terms.growth.T, square.T, kept.T)
        growth, square, kept, right = (
            each.T.ravel()[rows] for each in (terms.growth, square, kept, right)
        )
        at, falls = rows % len(s), np.flatnonzero(kept)
        left = sparse.hstack(
            [
                sparse.diags(growth) @ dz[at] + sparse.diags(square) @ z[at],
                sparse.csr_matrix(
                    (kept[falls], (falls, at[falls])), shape=(len(rows), len(s) + timed)
                ),
            ],
            "csr",
        )
        return left, right

    def _resting(self, s: Array) -> NDArray[np.bool_]:
        """Return which places (n,) are at a stop."""
        away = np.abs(s[:, None] - self._path.place(self._path.rests)).min(axis=1)
        return np.asarray(away < _AT_REST * self._longest)

    def _cones(self, z: Any, dz: Any, others: int) -> list[tuple[Any, Array]]:
        """Return the limits of the acceleration's length as cones of four rows each."""
        from scipy import sparse

        most = self._limits.rates[1, 0] * self._unit**2
        if not np.isfinite(most):
            return []
        s = self.points
        along, bent = (self._path(s, order)[:, PLACE] / most for order in (1, 2))
        none = sparse.csr_matrix((len(s), others))
        rows = [(sparse.hstack([0 * z, none]), np.ones(len(s)))]
        for axis in range(3):
            row = sparse.diags(0.5 * along[:, axis]) @ dz + sparse.diags(bent[:, axis]) @ z
            rows.append((sparse.hstack([-row, none]), np.zeros(len(s))))
        return [_interleaved(rows)]

    def _terms(self, s: Array, law: Array, slope: Array, *, faded: bool = False) -> Terms:
        """Return the limits at places (n,), where the law before has z and dz (n,).

        ``faded`` is with the Coulomb friction of the law before, instead of all of it.
        """
        duration = None
        if faded:
            slowness = self._unit / np.sqrt(np.maximum(law, _SLOWEST))
            duration = np.where(self._resting(s), np.inf, slowness)[:, None]
        along = self._path(s, 1)
        rates = self._limits.rates[:2] * self._unit ** np.array([[1.0], [2.0]])
        none = np.zeros_like(s)
        found: list[tuple[Array, Array, Array, Array]] = []
        for size, most in zip(
            (np.linalg.norm(along[:, PLACE], axis=1), along[:, 2]), rates[0], strict=True
        ):
            if np.isfinite(most):
                found.append((none, (size / most) ** 2, none, none))
        if np.isfinite(most := rates[1, 1]):
            turn, bent = 0.5 * along[:, 2] / most, self._path(s, 2)[:, 2] / most
            found += [(turn, bent, none, none), (-turn, -bent, none, none)]
        if self._limits.needs_torques:
            found += self._torque_terms(s, duration)
        if self._driven:
            found += self._drive_terms(s, law, slope, duration)
        if not found:
            found.append((none, none, none, none))
        return Terms(*(np.stack(column, axis=1) for column in zip(*found, strict=True)))

    def _torque_parts(
        self, s: Array, design: Design, duration: Array | None
    ) -> tuple[Array, Array, Array, Array]:
        """Return the torques' factors of dz, z and sqrt(z), and their constants, (n, 4) each.

        Coulomb friction is that of durations (n, 1) of the path, see `coulomb_friction`.
        """
        constant, rate, square = torque_parts(self._path, design, Misprint.NONE, s)
        constant = constant + coulomb_friction(self._path, design, s, duration)

        def pushed(places: Array, order: int) -> Array:
            return self._path(places, 1 if order == 2 else order) * (order != 1)

        growth = 0.5 * torque_parts(pushed, design, Misprint.NONE, s)[2]
        return growth / self._unit**2, square / self._unit**2, rate / self._unit, constant

    def _torque_terms(
        self, s: Array, duration: Array | None
    ) -> list[tuple[Array, Array, Array, Array]]:
        """Return the limits of torques on both sides, those that are finite."""
        most = self._limits.actuators
        parts = self._torque_parts(s, self._design, duration)
        return [
            tuple(sign * part[:, j] / most[j] for part in parts)
            for j in np.flatnonzero(np.isfinite(most))
            for sign in (1.0, -1.0)
        ]

    def _drive_terms(
        self, s: Array, law: Array, slope: Array, duration: Array | None
    ) -> list[tuple[Array, Array, Array, Array]]:
        """Return the limits of the drives: top speeds and lines of torque-speed envelopes."""
        design, unit, resting = self._design, self._unit, self._resting(s)
        pose, along, bent = (self._path(s, order) for order in range(3))
        speed = actuator_velocity(design, pose, along)
        pushed = actuator_acceleration(design.geometry, pose, np.zeros_like(along), along)
        turned = actuator_acceleration(design.geometry, pose, along, bent)
        load = self._torque_parts(s, replace(design, drives=NO_DRIVES), duration)
        acting = coulomb_share(design, speed, duration)
        none = np.zeros_like(s)
        found: list[tuple[Array, Array, Array, Array]] = []
        for j, drive in enumerate(design.drives):
            if drive is None:
                continue
            top = drive.output_limits.speed * unit
            if np.isfinite(top):
                found.append((none, (speed[:, j] / top) ** 2, none, none))
            viscous, coulomb = drive.reflected_friction
            inertia = drive.reflected_inertia / unit**2
            own = (
                0.5 * inertia * pushed[:, j], inertia * turned[:, j],
                viscous * speed[:, j] / unit, coulomb * acting[:, j],
            )  # fmt: skip
            factors = [part[:, j] for part in load]
            now = factors[0] * slope + factors[1] * law + factors[2] * np.sqrt(law) + factors[3]
            for limit, fall, shares, counted in drive_lines(drive, speed[:, j]):
                for sign in (1.0, -1.0):
                    least = np.where(
                        sign * now >= 0, np.min(shares, axis=0), np.max(shares, axis=0)
                    )
                    # of the smaller share, concave in the load, the tangent at the law before is
                    # above; at a stop the gear takes none, which is more than while it is driven
                    driven = np.where(resting, 1.0, least)
                    for share in shares:
                        # the larger one limits a motor that drives: both of them do
                        chosen = np.where(np.sign(speed[:, j]) == sign, share, driven)
                        row = [
                            sign * (chosen * part + counted * mine) / limit
                            for part, mine in zip(factors, own, strict=True)
                        ]
                        row[2] = row[2] + fall * np.abs(speed[:, j]) / (limit * unit)
                        found.append((row[0], row[1], row[2], row[3]))
        return found

    def needed(
        self, curve: TimedPath, count: int = LOOKED_AT
    ) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return what a law needs between its knots: instants, shares of its duration, limits.

        Args:
            curve: The law on the path.
            count: Points of a piece, besides its ends.

        Returns:
            Instants of unit time (pieces, n), the duration that is needed there in parts of the
            law's (pieces, n), and which of `limits.LIMITED` needs it (pieces, n).
        """
        breaks = curve.breaks
        share = np.concatenate([[_INSIDE], (np.arange(count) + 0.5) / count, [1.0 - _INSIDE]])
        u = breaks[:-1, None] + np.diff(breaks)[:, None] * share
        each = needed_durations(curve, self._limits, self._design, self._driven)(u.ravel())
        each /= curve.duration
        return u, each.max(axis=1).reshape(u.shape), each.argmax(axis=1).reshape(u.shape)

    def tighten(self, curve: TimedPath, tolerance: float) -> bool:
        """Keep the limits where a law exceeds them most in each piece; whether there are such."""
        u, needed, _ = self.needed(curve)
        worst = np.argmax(needed, axis=1)
        pieces = np.flatnonzero(needed[np.arange(len(needed)), worst] > 1.0 + tolerance)
        more = curve.place_at(u[pieces, worst[pieces]] * curve.duration)
        self.points = np.concatenate([self.points, more])
        return bool(pieces.size)


def _strictest(right: Array, *left: Array) -> NDArray[np.intp]:
    """Return which rows count of those with the same left side: that of the least right side.

    Args:
        right: (limits, points).
        left: Factors of the row of each limit at each point, of the same shape.

    Returns:
        Indices into the flat arrays. A limit without factors that leaves room has no row.
    """
    point = np.broadcast_to(np.arange(right.shape[1]), right.shape)
    keys = [right, *left, point]
    order = np.lexsort([key.ravel() for key in keys])
    differ = [np.diff(key.ravel()[order], prepend=np.nan) != 0.0 for key in keys[1:]]
    first = order[np.any(differ, axis=0)]
    bare = ~np.any([factor.ravel()[first] for factor in left], axis=0)
    return np.sort(first[~(bare & (right.ravel()[first] >= 0.0))])


def _interleaved(rows: list[tuple[Any, Array]]) -> tuple[Any, Array]:
    """Return the rows of many cones alike: first all of the first cone, then of the next."""
    from scipy import sparse

    count, size = len(rows[0][1]), len(rows)
    order = np.arange(size * count).reshape(size, count).T.ravel()
    matrix = sparse.csr_matrix(sparse.vstack([row for row, _ in rows]))[order]
    return matrix, np.stack([side for _, side in rows], axis=1).ravel()
