"""Position and tilt of a platform on three legs with lengths of their own.

With locked actuators the nine closure equations have nine unknowns: x, y, theta, z, the tilt
(t_x, t_y) and the sliders' places s_1..s_3. Ball joints assemble without strain. For a wanted
(x, y, theta, z) the tilt, the sliders and the actuators are unknown. Both are solved by Newton's
method from the nominal robot, in stages where bars do not meet there; derivatives by all lengths
and actuators follow from the same matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.kinematics import LEG_AXES, Configuration, inverse_kinematics
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.robot import platform_determinant
from paminsa_viz.model.status import Status, WithStatus
from paminsa_viz.precision.closure_equations import ACTUATORS, SLIDES, STATE, closure_equations
from paminsa_viz.precision.leg_lengths import INDEX, as_lengths, nominal_lengths

SIX_COORDINATES = (*COORDINATES, "tilt_x", "tilt_y")
"""Names of the platform's six coordinates [m, m, rad, m, rad, rad]."""

ERRORS = (
    ("x", "m:um", "x"), ("y", "m:um", "y"), ("θ", "rad:arcsec", "theta"), ("z", "m:um", "z"),
    ("tilt about x", "rad:arcsec", ""), ("tilt about y", "rad:arcsec", ""),
)  # fmt: skip
"""Names and units of errors in `SIX_COORDINATES`, and endings of the keys of quantities."""

ORDER = (0, 1, 3, 2, 4, 5)
"""The order that they are shown in: lengths, then angles."""

_FORWARD = np.arange(9, dtype=np.intp)
_INVERSE = np.arange(4, 13, dtype=np.intp)

_MOST_STEPS = 40
_LAST_STEP = 1e-9
"""Step [m, rad] after which Newton's method is done: the next one would be its square."""

_LARGEST_STEP = 0.1
"""Largest step [m, rad]: farther away than that the equations are other ones."""

_SHORTEST_STAGE = 2.0**-8
"""Share of a robot's deviations by which a stage is given up."""

_MOST_CONDITION = 1e13
"""Condition number of a pose that counts as singular: rounding decides over what is found."""


class Closure(Status):
    """Whether the loops of the three legs close."""

    OK = 0, "the loops close"
    NOT_FINITE = 1, "an input is not a finite number"
    OPEN = 2, "the bars of a leg cannot close with these lengths"
    SINGULAR = 3, "a singular pose lies in between, so no assembly can be told from the other"
    DIVERGED = 4, "no solution was found near the nominal pose"


@dataclass(frozen=True, eq=False)
class UnequalPose(WithStatus):
    """Solutions of batch shape (...); NaN where there is none.

    Attributes:
        pose: (..., 4) = (x, y, theta, z) [m, m, rad, m].
        tilt: (..., 2) = (t_x, t_y) in the platform's axes [rad].
        slides: (..., 3) places of the sliders, negative beyond the leg axis [m].
        actuators: (..., 4) = (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m].
        status: (...) values of `Closure`: whether there is a solution, or why not.
    """

    pose: Array
    tilt: Array
    slides: Array
    actuators: Array
    status: NDArray[np.uint8]

    KINDS = Closure

    @property
    def coordinates(self) -> Array:
        """The platform's six coordinates (..., 6), see `SIX_COORDINATES`."""
        return np.concatenate([self.pose, self.tilt], axis=-1)


@of_geometry
@np.errstate(all="ignore")
def solve_pose(
    geometry: Geometry, lengths: ArrayLike, actuators: ArrayLike, near: ArrayLike
) -> UnequalPose:
    """Solve the forward kinematics with unequal legs.

    Args:
        geometry: Nominal lengths and the branch of the knee.
        lengths: (..., 3, 14) lengths of the legs, see `leg_lengths`.
        actuators: (..., 4) = (theta_1, theta_2, theta_3, Z) [rad, rad, rad, m].
        near: (..., 4) pose that Newton's method starts from, the nominal one.

    Raises:
        InvalidInput: If a shape is unusable.
    """
    lengths, actuators, near = _together(lengths, actuators=actuators, near=near)
    x, y, theta, _ = np.moveaxis(near, -1, 0)
    # The determinant of the nine equations has the sign of the platform's own.
    side = np.sign(platform_determinant(mechanism(geometry), x, y, np.cos(theta)))
    return _solve(geometry, lengths, _start(geometry, near), actuators, _FORWARD, side)


@of_geometry
def solve_actuators(geometry: Geometry, lengths: ArrayLike, pose: ArrayLike) -> UnequalPose:
    """Solve the inverse kinematics with unequal legs: actuators and tilt for wanted poses (..., 4).

    Other arguments as in `solve_pose`.
    """
    lengths, pose = _together(lengths, pose=pose)
    # It is positive wherever no leg is stretched or on its axis.
    side = np.ones(pose.shape[:-1])
    return _solve(geometry, lengths, _start(geometry, pose), pose, _INVERSE, side)


class Sensitivities(NamedTuple):
    """Derivatives of the platform's coordinates at poses (...), with locked actuators.

    Times small deviations they are errors of the pose to first order.

    Attributes:
        lengths: (..., 6, 3 legs, 14) derivatives of `SIX_COORDINATES` by the lengths.
        actuators: (..., 6, 4) derivatives by theta_1..3 and Z; with equal legs the first four rows
            are the robot's Jacobian.
    """

    lengths: Array
    actuators: Array


def nominal_pose(geometry: Geometry, pose: ArrayLike) -> UnequalPose:
    """Return the solution for nominal lengths at poses (..., 4), in closed form."""
    pose = as_vectors(pose, "pose")
    found = inverse_kinematics(geometry, pose)
    finite = np.isfinite(pose).all(axis=-1)
    closed = np.asarray(np.isfinite(found.points[9]).all(axis=(-1, -2)))
    state = np.where(closed[..., None], _state(pose, found, geometry), np.nan)
    status = np.where(closed, Closure.OK, np.where(finite, Closure.OPEN, Closure.NOT_FINITE))
    return UnequalPose(
        state[..., :4], state[..., 4:6], state[..., SLIDES], state[..., ACTUATORS],
        status.astype(np.uint8),
    )  # fmt: skip


@of_geometry
def sensitivities(geometry: Geometry, lengths: ArrayLike, solution: UnequalPose) -> Sensitivities:
    """Return the derivatives of the platform's coordinates for legs (..., 3, 14) at solved poses.

    NaN where the bars cannot close or the pose is singular.
    """
    state = np.concatenate([solution.coordinates, solution.slides, solution.actuators], axis=-1)
    lengths = np.broadcast_to(as_lengths(lengths), (*state.shape[:-1], 3, len(INDEX)))
    return _sensitivities(geometry, lengths, state)


def _together(lengths: ArrayLike, **vectors: ArrayLike) -> list[Array]:
    """Broadcast lengths (..., 3, 14) and vectors (..., 4) against each other, as copies."""
    given = {name: as_vectors(values, name) for name, values in vectors.items()}
    table = as_lengths(lengths)
    try:
        shape = np.broadcast_shapes(
            table.shape[:-2], *(values.shape[:-1] for values in given.values())
        )
    except ValueError:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in given.items())
        problem = f"the batch shapes do not fit each other: lengths {table.shape}, {shapes}"
        raise InvalidInput("lengths", problem) from None
    full = [np.broadcast_to(table, (*shape, *table.shape[-2:]))]
    return full + [np.broadcast_to(values, (*shape, 4)) for values in given.values()]


def _start(geometry: Geometry, pose: Array) -> Array:
    """Return the state (..., 13) of the nominal robot: coordinates, sliders, actuators."""
    return _state(pose, inverse_kinematics(geometry, pose), geometry)


def _state(pose: Array, found: Configuration, geometry: Geometry) -> Array:
    state = np.zeros((*pose.shape[:-1], STATE))
    state[..., :4] = pose
    axes = geometry.base_radius * LEG_AXES
    place = found.points[8][..., :2] - axes
    heading = np.stack([np.cos(found.beta), np.sin(found.beta)], axis=-1)
    state[..., SLIDES] = np.sum(place * heading, axis=-1)
    state[..., ACTUATORS] = found.actuators
    return state


def _solve(
    geometry: Geometry,
    lengths: Array,
    start: Array,
    given: Array,
    unknown: NDArray[np.intp],
    side: Array,
) -> UnequalPose:
    """Solve for some entries of the state, all of a batch at once.

    ``start`` (..., 13) is the nominal robot, ``given`` (..., 4) are the entries that are known, and
    ``side`` (...) is the sign of the determinant on the nominal robot's side of the singularities.
    """
    shape = start.shape[:-1]
    lengths = lengths.reshape(-1, *lengths.shape[-2:])
    start, side = start.reshape(-1, STATE), side.reshape(-1)
    known = np.setdiff1d(np.arange(STATE), unknown)
    wanted = start.copy()
    wanted[:, known] = given.reshape(-1, len(known))
    state, status = _newton(geometry, lengths, wanted, unknown, side)
    # Near the end of their reach, bars may meet for other places of the sliders than the nominal.
    late = np.flatnonzero((status == Closure.OPEN) & np.isfinite(start).all(axis=-1))
    state[late] = _in_stages(
        geometry, lengths[late], start[late], wanted[late], unknown, side[late]
    )
    status[late[np.isfinite(state[late]).all(axis=-1)]] = Closure.OK
    state = state.reshape(*shape, STATE)
    return UnequalPose(
        state[..., :4], state[..., 4:6], state[..., SLIDES], state[..., ACTUATORS],
        status.reshape(shape),
    )  # fmt: skip


def _in_stages(
    geometry: Geometry,
    lengths: Array,
    start: Array,
    wanted: Array,
    unknown: NDArray[np.intp],
    side: Array,
) -> Array:
    """Return solutions (n, 13) that are followed from the nominal robot; NaN where that fails.

    A stage takes a share more of what lengths and known entries differ by; if it fails, half of it.
    """
    nominal = nominal_lengths(geometry)
    known = np.setdiff1d(np.arange(STATE), unknown)
    reached = start.copy()
    done, stage = np.zeros(len(start)), np.full(len(start), 0.5)
    live = np.arange(len(start))
    while live.size:
        share = np.minimum(done[live] + stage[live], 1.0)
        trial = reached[live]
        first, last = start[np.ix_(live, known)], wanted[np.ix_(live, known)]
        trial[:, known] = first + share[:, None] * (last - first)
        legs = nominal + share[:, None, None] * (lengths[live] - nominal)
        found, status = _newton(geometry, legs, trial, unknown, side[live])
        fine = status == Closure.OK
        reached[live[fine]], done[live[fine]] = found[fine], share[fine]
        stage[live] *= np.where(fine, 2.0, 0.5)
        live = live[(done[live] < 1.0) & (stage[live] >= _SHORTEST_STAGE)]
    reached[done < 1.0] = np.nan
    return reached


def _newton(
    geometry: Geometry, lengths: Array, start: Array, unknown: NDArray[np.intp], side: Array
) -> tuple[Array, NDArray[np.uint8]]:
    """Return states (n, 13), NaN without a solution, and their status (n,), by Newton's method."""
    state = start.copy()
    status = np.full(len(state), Closure.DIVERGED, np.uint8)
    given = np.setdiff1d(np.arange(STATE), unknown)
    usable = np.isfinite(state[:, given]).all(axis=-1) & np.isfinite(lengths).all(axis=(-1, -2))
    status[~usable] = Closure.NOT_FINITE
    status[usable & ~np.isfinite(state).all(axis=-1)] = Closure.OPEN
    live = np.flatnonzero(status == Closure.DIVERGED)
    behind = np.sign(state[:, SLIDES])
    step = np.zeros((len(state), len(unknown)))
    flipped = np.zeros(len(state), np.bool_)
    for _ in range(_MOST_STEPS):
        if not live.size:
            break
        trial = state[live]
        trial[:, unknown] += step[live]
        found = closure_equations(lengths[live], trial, geometry.knee.sign)
        sign, change = _newton_step(found.by_state[:, :, unknown], found.gap)
        largest = np.abs(change).max(axis=-1)
        closed = np.isfinite(found.gap).all(axis=-1)
        on_axis = (trial[:, SLIDES] * behind[live] <= 0).any(axis=-1)
        singular = ~np.isfinite(largest) | (sign != side[live]) | on_axis
        fault = np.select([~closed, singular], [Closure.OPEN, Closure.SINGULAR], Closure.OK)
        # Beyond a singularity, or where bars cannot close, a shorter step may do.
        stuck = live[fault != Closure.OK]
        flipped[live[fault == Closure.SINGULAR]] = True
        step[stuck] *= 0.5
        ended = np.abs(step[live]).max(axis=-1) < _LAST_STEP
        status[stuck] = np.where(ended, fault, Closure.DIVERGED)[fault != Closure.OK]
        fine = fault == Closure.OK
        good, change, largest = live[fine], change[fine], largest[fine]
        state[good] = trial[fine]
        factor = np.minimum(1.0, _LARGEST_STEP / np.maximum(largest, _LAST_STEP))
        step[good] = change * factor[:, None]
        done = good[largest < _LAST_STEP]
        state[np.ix_(done, unknown)] += step[done]
        status[done] = Closure.OK
        live = live[status[live] == Closure.DIVERGED]
    status[(status == Closure.DIVERGED) & flipped] = Closure.SINGULAR
    state[status != Closure.OK] = np.nan
    return state, status


def _newton_step(matrix: Array, gap: Array) -> tuple[Array, Array]:
    """Return the determinants' signs (n,), and the steps (n, 9), NaN where a matrix is singular."""
    sign, regular = _signs(matrix)
    step = np.full(gap.shape, np.nan)
    step[regular] = -np.linalg.solve(matrix[regular], gap[regular][..., None])[..., 0]
    return sign, step


@np.errstate(all="ignore")
def _signs(matrix: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the signs of determinants (n,), and where a matrix (n, 9, 9) can be inverted."""
    sign = np.linalg.slogdet(matrix)[0]
    return sign, np.isfinite(matrix).all(axis=(-1, -2)) & (sign != 0)


@np.errstate(all="ignore")
def _sensitivities(geometry: Geometry, lengths: Array, state: Array) -> Sensitivities:
    shape = state.shape[:-1]
    found = closure_equations(
        lengths.reshape(-1, 3, len(INDEX)), state.reshape(-1, STATE), geometry.knee.sign
    )
    matrix = found.by_state[:, :, _FORWARD]
    _, regular = _signs(matrix)
    inverse = np.full(matrix.shape, np.nan)
    inverse[regular] = np.linalg.inv(matrix[regular])
    condition = np.prod([np.linalg.norm(a, np.inf, axis=(1, 2)) for a in (matrix, inverse)], axis=0)
    inverse[~(condition < _MOST_CONDITION)] = np.nan
    rows = -inverse[:, :6]
    by_leg = np.einsum("nikj,nkjl->nikl", rows.reshape(-1, 6, 3, 3), found.by_length)
    by_actuator = rows @ found.by_state[:, :, ACTUATORS]
    return Sensitivities(
        by_leg.reshape(*shape, 6, 3, len(INDEX)), by_actuator.reshape(*shape, 6, 4)
    )
