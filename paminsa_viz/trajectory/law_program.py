"""The conic program of the time-optimal law on a path without singularities.

The unknown is z(s) = s'^2, linear between knots, so that s'' = dz/2 is constant there and a piece
of length h takes 2 h / (s'_0 + s'_1), exactly. Speeds and torques are linear in z and dz, lengths
of accelerations are cones (Verscheure et al. 2009), and the duration is convex:
it is the sum of 2 h d with c <= sqrt(z) at the knots and d >= 1 / (c_0 + c_1) in the pieces.

Viscous friction and the fall of a torque with the speed go with s' = sqrt(z). Where they leave less
room they are not convex; there the tangent at the law before is taken, which lies above: every law
of the series keeps the limits and is at least as fast as the one before it.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES
from paminsa_viz.model.jacobians import actuator_acceleration, actuator_velocity
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import SteppedPath, TracedPath
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.trajectory.timing import drive_lines, needed_durations, torque_parts

_INSIDE = 1e-6
"""Share of a piece by which its ends are looked at from inside: directions may change there."""

LOOKED_AT = 14
"""Points of a piece, besides its ends, at which a law is looked at afterwards."""

_SLOWEST = 1e-9
"""Least s' of a law at which tangents are taken, in parts of 1 over the duration."""


class LawProgramFailed(PaminsaError):
    """The conic solver found no law."""


class Points(NamedTuple):
    """Points at which limits are kept.

    Attributes:
        piece: (n,) the piece that a point is in.
        share: (n,) where in it, 0 to 1.
    """

    piece: NDArray[np.intp]
    share: Array


class Terms(NamedTuple):
    """Limits growth dz + square z + rate sqrt(z) + constant <= 1, each of them (n, columns)."""

    growth: Array
    square: Array
    rate: Array
    constant: Array


class LawProgram:
    """The program of one path between the knots given.

    Args:
        path: The path.
        knots: (n + 1,) places s in (0, 1), ends and stops among them.
        rests: (n + 1,) at which of them the motion stops.
        limits: Limits; those of jerk are left out.
        design: The robot.
        unit: Time in which all is counted; about the duration, so that numbers are near 1 [s].
        drives: Whether to keep the limits of the design's drives.
    """

    def __init__(
        self,
        path: TracedPath,
        knots: Array,
        rests: NDArray[np.bool_],
        limits: MotionLimits,
        design: Design,
        unit: float,
        *,
        drives: bool = True,
    ) -> None:
        self._driven = drives and any(design.drives)
        self._path, self._limits, self._design, self._unit = path, limits, design, unit
        self.knots, self._steps = knots, np.diff(knots)
        self._column = np.where(rests, -1, np.cumsum(~rests) - 1)
        self._moving = int((~rests).sum())
        pieces = np.arange(len(knots) - 1)
        ends = [Points(pieces, np.full(len(pieces), share)) for share in (0.0, 1.0)]
        self._points = Points(*map(np.concatenate, zip(*ends, strict=True)))

    def solve(self, before: Array) -> Array:
        """Return z at the knots, (n + 1,), no slower than a law that keeps the limits [1/unit^2].

        Raises:
            LawProgramFailed: If the solver finds none.
        """
        from scipy import sparse  # slow to load

        m, pieces = self._moving, len(self._steps)
        rows, right, cones = self._limit_rows(before)
        sides = [(rows, right)]
        # c <= sqrt(z), as |(2 c, z - 1)| <= z + 1
        z, c = np.arange(m), m + np.arange(m)
        one = np.ones(m)
        sides.append(
            _interleaved(
                [[(z, -one)], [(c, -2 * one)], [(z, -one)]], [one, 0 * one, -one], 2 * m + pieces
            )
        )
        # d (c_0 + c_1) >= 1, as |(2, c_0 + c_1 - d)| <= c_0 + c_1 + d
        d, one = 2 * m + np.arange(pieces), np.ones(pieces)
        first, last = self._column[:-1], self._column[1:]
        both = [(np.where(at < 0, 0, m + at), np.where(at < 0, 0.0, -1.0)) for at in (first, last)]
        sides.append(
            _interleaved(
                [[*both, (d, -one)], [], [*both, (d, one)]], [0 * one, 2 * one, 0 * one],
                2 * m + pieces,
            )
        )  # fmt: skip
        sides.append(cones)
        cost = np.concatenate([np.zeros(2 * m), 2.0 * self._steps])
        clarabel: Any = import_module("clarabel")  # compiled, without types
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        found: Any = clarabel.DefaultSolver(
            sparse.csc_matrix((len(cost), len(cost))), cost,
            sparse.csc_matrix(sparse.vstack([side for side, _ in sides])),
            np.concatenate([side for _, side in sides]),
            [clarabel.NonnegativeConeT(len(right)),
             *[clarabel.SecondOrderConeT(3)] * (m + pieces),
             *[clarabel.SecondOrderConeT(4)] * (len(cones[1]) // 4)],
            settings,
        ).solve()  # fmt: skip
        if "Solved" not in str(found.status):
            raise LawProgramFailed(f"the conic solver returned {found.status}")
        out = np.zeros(len(self.knots))
        out[self._column >= 0] = np.maximum(np.array(found.x)[:m], 0.0)
        return out

    def _limit_rows(self, before: Array) -> tuple[Any, Array, tuple[Any, Array]]:
        """Return the linear limits, and the cones of accelerations, both A x and b of A x <= b."""
        from scipy import sparse

        piece, share = self._points
        inside = np.clip(share, _INSIDE, 1.0 - _INSIDE)
        s = self.knots[piece] + inside * self._steps[piece]
        law = (1.0 - share) * before[piece] + share * before[piece + 1]
        fixed = (law <= 0.0)[:, None]  # a stop, where sqrt(z) is zero
        tangent = np.sqrt(np.maximum(law, _SLOWEST**2))[:, None]
        slope = (before[piece + 1] - before[piece]) / self._steps[piece]
        terms = self._terms(s, law, slope)
        eased = terms.rate <= 0.0
        above = np.where(eased | fixed, 0.0, terms.rate)
        square = terms.square + above / (2.0 * tangent)
        right = 1.0 - terms.constant - 0.5 * above * tangent
        left = self._place_rows(piece, share, terms.growth, square)
        rates = np.where(eased, terms.rate, 0.0)
        for offset, weight in ((0, 1.0 - share), (1, share)):
            left += self._columns(piece + offset, rates * weight[:, None], self._moving)
        left = sparse.vstack([left, -sparse.eye(2 * self._moving, left.shape[1])])
        right = np.concatenate([right.ravel(), np.zeros(2 * self._moving)])
        return left, right, self._cones(piece, share, s)

    def _place_rows(self, piece: Any, share: Array, growth: Array, square: Array) -> Any:
        """Return growth dz + square z as rows, (n, columns) of them each after the other."""
        slope = growth / self._steps[piece][:, None]
        begin = square * (1.0 - share)[:, None] - slope
        end = square * share[:, None] + slope
        return self._columns(piece, begin, 0) + self._columns(piece + 1, end, 0)

    def _columns(self, knot: Any, factors: Array, offset: int) -> Any:
        """Return rows with factors (n, columns) at the unknowns of knots (n,), and nothing else."""
        from scipy import sparse

        column = self._column[knot]
        moves = (column >= 0)[:, None]
        shape = (factors.size, 2 * self._moving + len(self._steps))
        places = np.broadcast_to(np.maximum(column, 0)[:, None] + offset, factors.shape)
        values = np.where(moves, factors, 0.0)
        return sparse.csr_matrix(
            (values.ravel(), (np.arange(factors.size), places.ravel())), shape=shape
        )

    def _cones(self, piece: Any, share: Array, s: Array) -> tuple[Any, Array]:
        """Return the limits of the acceleration's length as cones of four rows each."""
        from scipy import sparse

        most = self._limits.rates[1, 0] * self._unit**2
        width = 2 * self._moving + len(self._steps)
        if not np.isfinite(most):
            return sparse.csr_matrix((0, width)), np.zeros(0)
        along, bent = self._path(s, 1)[:, PLACE], self._path(s, 2)[:, PLACE]
        none = np.zeros((len(s), 1))
        growth = np.concatenate([none, -0.5 * along / most], axis=1)
        square = np.concatenate([none, -bent / most], axis=1)
        right = np.zeros((len(s), 4))
        right[:, 0] = 1.0
        return self._place_rows(piece, share, growth, square), right.ravel()

    def _terms(self, s: Array, law: Array, slope: Array) -> Terms:
        """Return the limits at places (n,), where the law before has z and dz (n,)."""
        along = self._path(s, 1)
        rates, none = self._limits.rates * self._unit ** np.array([[1.0], [2.0], [3.0]]), 0.0 * s
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
            found += self._torque_terms(s, self._design, self._limits.actuators)
        if self._driven:
            found += self._drive_terms(s, law, slope)
        if not found:
            found.append((none, none, none, none))
        return Terms(*(np.stack(column, axis=1) for column in zip(*found, strict=True)))

    def _torque_parts(self, s: Array, design: Design) -> tuple[Array, Array, Array, Array]:
        """Return the torques' factors of dz, z and sqrt(z), and their constants, (n, 4) each."""
        constant, rate, square = torque_parts(self._path, design, Misprint.NONE, s)

        def pushed(places: Array, order: int) -> Array:
            return self._path(places, 1 if order == 2 else order) * (order != 1)

        growth = 0.5 * torque_parts(pushed, design, Misprint.NONE, s)[2]
        return growth / self._unit**2, square / self._unit**2, rate / self._unit, constant

    def _torque_terms(
        self, s: Array, design: Design, most: Array
    ) -> list[tuple[Array, Array, Array, Array]]:
        """Return the limits of torques on both sides, those that are finite."""
        parts = self._torque_parts(s, design)
        return [
            tuple(sign * part[:, j] / most[j] for part in parts)  # type: ignore[misc]
            for j in np.flatnonzero(np.isfinite(most))
            for sign in (1.0, -1.0)
        ]

    def _drive_terms(
        self, s: Array, law: Array, slope: Array
    ) -> list[tuple[Array, Array, Array, Array]]:
        """Return the limits of the drives: top speeds and lines of torque-speed envelopes."""
        design, unit = self._design, self._unit
        pose, along, bent = (self._path(s, order) for order in range(3))
        speed = actuator_velocity(design, pose, along)
        pushed = actuator_acceleration(design.geometry, pose, 0.0 * along, along)
        turned = actuator_acceleration(design.geometry, pose, along, bent)
        load = self._torque_parts(s, replace(design, drives=NO_DRIVES))
        none = 0.0 * s
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
                viscous * speed[:, j] / unit, coulomb * np.sign(speed[:, j]),
            )  # fmt: skip
            factors = [part[:, j] for part in load]
            now = factors[0] * slope + factors[1] * law + factors[2] * np.sqrt(law) + factors[3]
            for limit, fall, shares, counted in drive_lines(drive, speed[:, j]):
                for sign in (1.0, -1.0):
                    least = np.where(
                        sign * now >= 0, np.min(shares, axis=0), np.max(shares, axis=0)
                    )
                    for share in shares:
                        # the larger one limits a motor that drives, or starts: both of them do; of
                        # the smaller, concave in the load, the tangent at the law before is above
                        chosen = np.where((sign * speed[:, j] > 0) | (law <= 0.0), share, least)
                        row = [
                            sign * (chosen * part + counted * mine) / limit
                            for part, mine in zip(factors, own, strict=True)
                        ]
                        row[2] = row[2] + fall * np.abs(speed[:, j]) / (limit * unit)
                        found.append((row[0], row[1], row[2], row[3]))
        return found

    def needed(self, curve: SteppedPath, count: int = LOOKED_AT) -> tuple[Array, Array, Array]:
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
        durations = needed_durations(curve, self._limits, self._design, self._driven)
        each = durations(u.ravel()) / curve.duration
        return u, each.max(axis=1).reshape(u.shape), each.argmax(axis=1).reshape(u.shape)

    def tighten(self, curve: SteppedPath, tolerance: float) -> bool:
        """Keep the limits where a law exceeds them most in each piece; whether there are such."""
        u, needed, _ = self.needed(curve)
        worst = np.argmax(needed, axis=1)
        pieces = np.flatnonzero(needed[np.arange(len(needed)), worst] > 1.0 + tolerance)
        s = curve.place_at(u[pieces, worst[pieces]] * curve.duration)
        more = Points(pieces, (s - self.knots[pieces]) / self._steps[pieces])
        self._points = Points(*map(np.concatenate, zip(self._points, more, strict=True)))
        return bool(pieces.size)


def _interleaved(
    rows: list[list[tuple[Array, Array]]], right: list[Array], width: int
) -> tuple[Any, Array]:
    """Return the rows of many cones alike: first all of the first cone, then of the next."""
    from scipy import sparse

    count, size = len(right[0]), len(rows)
    places, columns, values = [], [], []
    for row, entries in enumerate(rows):
        for column, value in entries:
            places.append(size * np.arange(count) + row)
            columns.append(column)
            values.append(value)
    matrix = sparse.csr_matrix(
        (np.concatenate(values), (np.concatenate(places), np.concatenate(columns))),
        shape=(size * count, width),
    )
    return matrix, np.stack(right, axis=1).ravel()
