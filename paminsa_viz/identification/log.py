"""A log of the built robot: measured positions and torques, checked and in equal steps.

A gap is never closed up: it is refused with its row, or splits the log into segments that are
filtered each by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import Array, as_numbers, own_vectors
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.trajectory.simulation import Simulation
from paminsa_viz.units import counted, rounded_to_side

LONGEST_STEP = 1.5
"""Longest time between two rows, in sample times; more is a gap."""

EVEN = 0.01
"""How far rows may be from equal steps before they are resampled, in sample times."""

SLOWEST = 20.0
"""Fewest rows a second of a log."""

FASTEST = (100.0, 10.0)
"""Fastest actuators that are believed [rad/s, m/s]; a larger step between rows is an error."""

_NAMES = ("theta1", "theta2", "theta3", "Z")


class InvalidLog(PaminsaError):
    """A log that cannot be used.

    Attributes:
        problem: What is wrong, what is allowed and what to do, in words.
        row: Row of the file, or of the arrays counted from 1; None if it is about all of them.
        column: What the row's number stands for, such as ``"theta1"``, or an empty string.
        log: Name of the log, or an empty string where the reader of the message knows it.
        other_unit: How a table names the column if its numbers are in another unit than SI, which
            may be what is wrong; empty where it is not.
    """

    def __init__(
        self,
        problem: str,
        row: int | None = None,
        column: str = "",
        log: str = "",
        other_unit: str = "",
    ) -> None:
        self.problem, self.row, self.column, self.log = problem, row, column, log
        self.other_unit = other_unit
        named = f"log {log}" if log else ""
        place = [part for part in (named, "" if row is None else f"row {row}", column) if part]
        problem = "; ".join(filter(None, (problem, other_unit)))
        super().__init__(f"{', '.join(place)}: {problem}" if place else problem)


@dataclass(frozen=True, eq=False)
class Log:
    """Measured positions and torques in equal steps; `make_log` checks them.

    Attributes:
        t: (n,) times [s].
        position: (n, 4) actuator positions (theta_1, theta_2, theta_3, Z) [rad, m].
        torque: (n, 4) what the actuators delivered, friction included [N m, N m, N m, N].
        rate: Samples a second [1/s].
        starts: Where segments begin; the first is 0. Between segments there are gaps.
        rows: (n,) row of each sample, for messages.
        split: Whether rows that cannot be used split the log instead of being refused.
        name: What a person calls it.
        notes: What was done to it, in words.
    """

    t: Array
    position: Array
    torque: Array
    rate: float
    starts: tuple[int, ...]
    rows: NDArray[np.int64] | None
    split: bool
    name: str
    notes: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Time that is covered by samples [s]."""
        return len(self.t) / self.rate

    @property
    def segments(self) -> list[slice]:
        """The pieces without gaps."""
        ends = (*self.starts[1:], len(self.t))
        return [slice(start, end) for start, end in zip(self.starts, ends, strict=True)]

    def row(self, index: int) -> int:
        """Return the row of a sample, for a message."""
        return index + 1 if self.rows is None else int(self.rows[index])


def make_log(
    t: ArrayLike,
    position: ArrayLike,
    torque: ArrayLike,
    *,
    split: bool = False,
    name: str = "log",
    first_row: int = 1,
) -> Log:
    """Check measured signals and bring them into equal steps.

    Args:
        t: (n,) times [s].
        position: (n, 4) actuator positions [rad, rad, rad, m].
        torque: (n, 4) actuator torques and force [N m, N m, N m, N].
        split: Split the log at gaps, and later at rows out of reach or near a singularity, instead
            of refusing it.
        name: What a person calls it.
        first_row: Row of the first sample, for messages.

    Raises:
        InvalidLog: At the first row that is not finite, whose time does not follow the one before,
            that comes after a gap, or that no robot can be in.
        InvalidInput: If the shapes do not fit.
    """
    t = as_numbers(t, "t").copy()
    position, torque = own_vectors(position, "position"), own_vectors(torque, "torque")
    if t.ndim != 1:
        raise InvalidInput("t", f"one axis of times is needed; the shape is {t.shape}")
    for label, values in (("position", position), ("torque", torque)):
        if values.shape != (t.size, 4):
            raise InvalidInput(label, f"shape {values.shape} where {(t.size, 4)} is needed")
    if t.size < 10:
        raise InvalidLog(f"a log needs at least 10 rows; there are {t.size}")
    rows = first_row + np.arange(t.size)
    _check_numbers(t, position, torque, rows)
    steps = np.diff(t)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > LONGEST_STEP * usual) + 1
    step = float(np.delete(steps, gaps - 1).mean())
    if gaps.size and not split:
        gap = int(gaps[0])
        raise InvalidLog(
            f"{t[gap] - t[gap - 1]:.6g} s after the row before, where {step:.6g} s are usual; "
            "cut the log there, or split it at gaps (--split on the command line)",
            int(rows[gap]),
            "t",
        )
    if step > 1 / SLOWEST:
        problem = f"there are {1 / step:.3g} rows a second; at least {SLOWEST:g} are needed"
        raise InvalidLog(problem, column="t", other_unit="times in milliseconds are t_ms")
    position[:, :3] = np.unwrap(position[:, :3], axis=0)
    _check_steps(t, position, rows, gaps)
    starts, notes = (0, *(int(gap) for gap in gaps)), []
    if gaps.size:
        notes.append(f"split at {counted(gaps.size, 'gap')}")
    ends = (*starts[1:], t.size)
    worst = max(_unevenness(t[a:b], step) for a, b in zip(starts, ends, strict=True))
    if worst > EVEN:
        pieces = [
            _resampled(t[a:b], position[a:b], torque[a:b], rows[a:b], step)
            for a, b in zip(starts, ends, strict=True)
        ]
        t, position, torque, rows = (np.concatenate(part) for part in zip(*pieces, strict=True))
        starts = tuple(np.cumsum([0] + [len(piece[0]) for piece in pieces[:-1]]).tolist())
        notes.append(
            f"resampled by cubic splines to equal steps of {1e3 * step:.6g} ms; "
            f"rows were up to {1e3 * worst * step:.3g} ms off"
        )
    return Log(t, position, torque, 1 / step, starts, rows, split, name, tuple(notes))


@kinds_checked
def log_of_simulation(simulation: Simulation) -> Log:
    """Return what encoders and drives of a simulated robot record, without any noise.

    Args:
        simulation: The motion, up to where it stopped; its torques are those of the actuators,
            friction included, as in any log.

    Raises:
        InvalidLog: If it has fewer than 10 samples, or fewer than 20 a second.
    """
    position = inverse_kinematics(simulation.design.geometry, simulation.pose).actuators
    return make_log(simulation.t, position, simulation.torque, name="simulation")


def _check_numbers(t: Array, position: Array, torque: Array, rows: NDArray[np.int64]) -> None:
    names = ("t", *_NAMES, "torque1", "torque2", "torque3", "force4")
    lost = ~np.isfinite(np.concatenate([t[:, None], position, torque], axis=1))
    if lost.any():
        row = int(np.flatnonzero(lost.any(axis=1))[0])
        raise InvalidLog("no finite number", int(rows[row]), names[int(lost[row].argmax())])
    late = np.flatnonzero(np.diff(t) <= 0)
    if late.size:
        row = int(late[0]) + 1
        kind = "is there twice" if t[row] == t[row - 1] else f"follows {t[row - 1]:.15g} s"
        raise InvalidLog(f"times have to increase, and {t[row]:.15g} s {kind}", int(rows[row]), "t")
    turn = (2 * np.pi, "rad is beyond a full turn", "degrees", "deg")
    for name, values, (most, beyond, unit, ending) in zip(
        _NAMES, position.T, [turn] * 3 + [(20.0, "m is beyond 20 m", "millimeters", "mm")],
        strict=True,
    ):  # fmt: skip
        far = np.flatnonzero(np.abs(values) > most)
        if far.size:
            problem, row = f"{values[far[0]]:.6g} {beyond}", int(rows[far[0]])
            other = f"a column in {unit} is {name}_{ending}"
            raise InvalidLog(problem, row, name, other_unit=other)


def _check_steps(
    t: Array, position: Array, rows: NDArray[np.int64], gaps: NDArray[np.int64]
) -> None:
    speed = np.abs(np.diff(position, axis=0)) / np.diff(t)[:, None]
    speed[gaps - 1] = 0.0
    limits = np.array([FASTEST[0]] * 3 + [FASTEST[1]])
    fast = np.flatnonzero((speed > limits).any(axis=1))
    if fast.size:
        row = int(fast[0])
        column = int((speed[row] / limits).argmax())
        unit = "m/s" if column == 3 else "rad/s"
        size = rounded_to_side(float(speed[row, column]), 3, up=True)
        problem = f"a jump at {size:.3g} {unit}; at most {limits[column]:g} is real"
        raise InvalidLog(problem, int(rows[row + 1]), _NAMES[column])


def _unevenness(t: Array, step: float) -> float:
    """Return how far times are from equal steps, in steps."""
    return float(np.abs(t - t[0] - step * np.arange(t.size)).max() / step)


def _resampled(
    t: Array, position: Array, torque: Array, rows: NDArray[np.int64], step: float
) -> tuple[Array, Array, Array, NDArray[np.int64]]:
    from scipy.interpolate import CubicSpline  # takes a while to load

    even = t[0] + step * np.arange(int((t[-1] - t[0]) / step + 1e-6) + 1)
    if t.size < 4:
        return t, position, torque, rows
    values = CubicSpline(t, np.concatenate([position, torque], axis=1))(even)
    nearest = np.searchsorted(t, even).clip(0, t.size - 1)
    return even, values[:, :4], values[:, 4:], rows[nearest]
