"""Terms of an optimization: torques, energy, added mass, change of masses.

Each term is convex in the masses. Torques are linear in the state (c, mass) of a `MassSpace`; their
peak is a maximum of linear functions, their RMS a norm, the driving energy a sum of positive parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from paminsa_viz.balancing.changes import AMOUNTS, MASS, MassSpace
from paminsa_viz.balancing.convex import ConvexTerm, MaxAbs, Norm, PositivePartSum
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Field
from paminsa_viz.model.lumped import COEFFICIENTS, Misprint
from paminsa_viz.model.reach import Limit
from paminsa_viz.trajectory.integrals import mean_weights, time_weights
from paminsa_viz.trajectory.solved import SolvedTrajectory

ROTARY = (0, 1, 2)
"""M1..M3 among the actuators."""

LIFT = (3,)
"""M4 among the actuators."""

GROUP = 32
"""Samples whose energy is enclosed together."""

MP1, MP2, MP3, PLATFORM = (COEFFICIENTS.index(name) for name in ("Mp1", "Mp2", "Mp3", "m_pl"))


class Term(Protocol):
    """Something to minimize or to limit.

    Attributes:
        label: What it is, in words.
        unit: Its SI unit.
    """

    @property
    def label(self) -> str: ...
    @property
    def unit(self) -> str: ...

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """Return it as a function of the space's states.

        Raises:
            InvalidInput: If it was made for another robot, or has no value there.
        """
        ...


def _row(size: int, **entries: float) -> Array:
    row = np.zeros(size)
    for name, value in entries.items():
        row[COEFFICIENTS.index(name)] = value
    return row


def _same_geometry(space: MassSpace, geometry: object, argument: str) -> None:
    if geometry != space.design.geometry:
        raise InvalidInput(argument, "it was solved for another geometry than the design's")


def _reached(space: MassSpace, field: Field) -> Array:
    """Return Gamma where it has a value, (4, n) [m, 1]; raises where that is nowhere."""
    _same_geometry(space, field.geometry, "field")
    gamma = field.gamma[:, field.status == Limit.OK]
    if gamma.size == 0:
        raise InvalidInput("field", "the robot cannot take a single pose of the workspace grid")
    return gamma


def _static(space: MassSpace, field: Field) -> tuple[Array, Array]:
    """Return static torques of M1..M3 as matrix . s + offset, (3 n, d), (3 n,); load the offset."""
    gamma = _reached(space, field)[:3].ravel()
    load = field.load_torques(space.design)[:3, field.status == Limit.OK]
    return gamma[:, None] * _row(len(space.start), Mp2=1.0), load.ravel()


def _imbalance(space: MassSpace, factor: float) -> MaxAbs:
    """Return a factor times |M_p2|."""
    return MaxAbs(factor * _row(len(space.start), Mp2=1.0)[None], np.zeros(1))


@dataclass(frozen=True)
class Imbalance:
    """|M_p2|, which all static torques of M1..M3 are proportional to (Eq. 8) [N]."""

    label: str = "|M_p2|"
    unit: str = "N"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        return _imbalance(space, 1.0)


@dataclass(frozen=True, eq=False)
class StaticPeak:
    """Largest static torque of M1..M3 over the poses of a field that can be taken [N m].

    All of them are M_p2 times a map that no mass changes, and a load's constant part. Without a
    load this is a constant times |M_p2|.
    """

    field: Field
    label: str = "peak static torque"
    unit: str = "N m"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        if space.design.load.acts:
            return MaxAbs(*_static(space, self.field))
        return _imbalance(space, float(np.abs(_reached(space, self.field)[:3]).max()))


@dataclass(frozen=True, eq=False)
class StaticRms:
    """Root mean square of the static torques of M1..M3 over the poses of a field [N m]."""

    field: Field
    label: str = "RMS static torque"
    unit: str = "N m"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        if not space.design.load.acts:
            gamma = _reached(space, self.field)[:3]
            return _imbalance(space, float(np.sqrt(np.mean(gamma**2))))
        matrix, load = _static(space, self.field)
        root = np.sqrt(load.size)
        return Norm.of_many(matrix / root, load / root)


@dataclass(frozen=True, eq=False)
class StaticLift:
    """Largest static force of M4 over the poses of a field [N]."""

    field: Field
    label: str = "peak static force of M4"
    unit: str = "N"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        lift = _reached(space, self.field)[3]
        k, g = space.design.geometry.magnification, space.design.gravity
        matrix = [
            _row(len(space.start), Mp1=3 * k, Mp2=end, Mp3=3.0, m_pl=k * g)
            for end in (float(lift.min()), float(lift.max()))
        ]
        push = -k * space.design.load.force_z  # a load lifts or presses alike everywhere
        return MaxAbs(np.array(matrix), np.full(2, push))


def trajectory_rows(
    space: MassSpace, solved: SolvedTrajectory, actuators: tuple[int, ...]
) -> tuple[Array, Array]:
    """Return torques on a trajectory as matrix . s + offset: (n, actuators, d), (n, actuators).

    The offset is friction, the load and the inertia of the drives.

    Raises:
        InvalidInput: If the trajectory fails somewhere, is another robot's, or has misprints.
    """
    _same_geometry(space, solved.geometry, "trajectory")
    if solved.misprints != Misprint.NONE:
        raise InvalidInput(
            "trajectory", "published misprints describe no machine; solve it without them"
        )
    if not solved.check.possible or len(solved.y) == 0:
        raise InvalidInput("trajectory", "the robot cannot run the whole trajectory")
    matrix = np.zeros((len(solved.y), len(actuators), len(space.start)))
    matrix[..., :MASS] = solved.y[:, actuators]
    if 3 in actuators:
        extra = space.design.gravity - solved.gravity
        k = space.design.geometry.magnification
        matrix[:, actuators.index(3), PLATFORM] += k * extra
    design = space.design
    offset = solved.friction(design) + solved.drive_inertia_torque(design)
    if solved.loaded(design):
        offset += solved.load_torques(design)
    return matrix, offset[:, actuators]


@dataclass(frozen=True, eq=False)
class _Effort:
    """A measure of the torques of some actuators over a trajectory."""

    solved: SolvedTrajectory
    actuators: tuple[int, ...] = ROTARY
    measure: ClassVar[str]

    @property
    def label(self) -> str:
        """See `Term`."""
        of = {ROTARY: "torque of M1-M3", LIFT: "force of M4"}.get(
            self.actuators, "effort of " + ", ".join(f"M{j + 1}" for j in self.actuators)
        )
        return f"{self.measure} {of} on the trajectory"

    @property
    def unit(self) -> str:
        """See `Term`."""
        return "N" if self.actuators == LIFT else "N m"


class TrajectoryPeak(_Effort):
    """Largest torque, in size, of ``actuators`` (0 to 3) on a ``solved`` motion [N m, N]."""

    measure = "peak"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        matrix, offset = trajectory_rows(space, self.solved, self.actuators)
        # samples of one actuator stay neighbors, so that a part of the list is a part of time
        matrix = np.moveaxis(matrix, 1, 0).reshape(-1, matrix.shape[-1])
        return MaxAbs(np.ascontiguousarray(matrix), offset.T.ravel())


class TrajectoryRms(_Effort):
    """Root mean square over time and ``actuators`` (0 to 3) on a ``solved`` motion [N m, N]."""

    measure = "RMS"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        matrix, offset = trajectory_rows(space, self.solved, self.actuators)
        weight = np.sqrt(mean_weights(self.solved.trajectory.t) / len(self.actuators))
        matrix, offset = matrix * weight[:, None, None], offset * weight[:, None]
        return Norm.of_many(matrix.reshape(-1, matrix.shape[-1]), offset.ravel())


@dataclass(frozen=True, eq=False)
class TrajectoryEnergy:
    """Energy that all four actuators put in while they drive; braking gives none back [J].

    Attributes:
        solved: The trajectory, solved for the geometry.
    """

    solved: SolvedTrajectory
    label: str = "driving energy on the trajectory"
    unit: str = "J"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        matrix, offset = trajectory_rows(space, self.solved, (0, 1, 2, 3))
        weight = (time_weights(self.solved.trajectory.t)[:, None] * self.solved.speed).T
        matrix = np.moveaxis(matrix, 1, 0) * weight[..., None]
        starts = np.concatenate(
            [np.arange(0, weight.shape[1], GROUP) + j * weight.shape[1] for j in range(4)]
        )
        return PositivePartSum(
            matrix.reshape(-1, matrix.shape[-1]), (offset.T * weight).ravel(), starts
        )


MOTION_GOALS = {"peak": TrajectoryPeak, "rms": TrajectoryRms, "energy": TrajectoryEnergy}
"""What can be minimized on a motion, by the names that commands take."""


@dataclass(frozen=True)
class AddedMass:
    """The robot's mass after the change less that before it, all three legs together [kg]."""

    label: str = "added mass"
    unit: str = "kg"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        row = np.eye(1, len(space.start), MASS)
        return MaxAbs(row, -space.before[[MASS]], absolute=False)


@dataclass(frozen=True)
class MassChange:
    """All that is added and all that is removed, all three legs together [kg]."""

    label: str = "mass moved"
    unit: str = "kg"

    def convex_term(self, space: MassSpace) -> ConvexTerm:
        """See `Term`."""
        held = space.before[AMOUNTS:]
        return deviations(space, held, held)


def deviations(space: MassSpace, low: Array, high: Array) -> PositivePartSum:
    """Return by how much the amounts are outside of ranges, all three legs together [kg]."""
    count = len(space.counts)
    rows = np.zeros((2 * count, len(space.start)))
    rows[:count, AMOUNTS:], rows[count:, AMOUNTS:] = np.diag(space.counts), -np.diag(space.counts)
    offset = np.concatenate([-space.counts * high, space.counts * low])
    return PositivePartSum(rows, offset, np.arange(2 * count))
