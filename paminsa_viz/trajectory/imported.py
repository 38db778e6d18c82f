"""Trajectories from samples that someone else made."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors, own_vectors
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.trajectory.sampled import LARGEST, Passage, Trajectory
from paminsa_viz.units import percent

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

UNITS = ("m", "m", "rad", "m")


def from_samples(
    t: ArrayLike,
    pose: ArrayLike,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    *,
    load: ArrayLike | None = None,
    rest: bool = False,
    name: str = "imported",
    passages: Sequence[Passage] = (),
) -> Trajectory:
    """Return a trajectory from poses at given times; what is not given comes from a spline.

    Without a velocity, velocity and acceleration are those of the spline of fifth degree through
    the poses (of a lower one through fewer than six); with it, the acceleration is that of the
    spline through the velocities. Times are shifted to start at zero, and turns by a full circle
    between neighbors are removed from theta, with a note.

    Args:
        t: (n,) increasing, at least two [s].
        pose: (n, 4) [m, m, rad, m].
        velocity: (n, 4) [m/s, m/s, rad/s, m/s].
        acceleration: (n, 4); only together with a velocity.
        load: (n, 6) wrench on the platform, see `Trajectory` [N, N m].
        rest: Whether the motion starts and ends at rest: speed and acceleration of a spline
            vanish there. Use it where the samples are a few waypoints.
        name: Its name.
        passages: Planned crossings of type-2 singularities, at times as in ``t``.

    Raises:
        InvalidInput: If shapes do not fit, a number is not finite, times do not increase, or a
            crossing is not between the first and the last one.
    """
    if acceleration is not None and velocity is None:
        raise InvalidInput("acceleration", "it can be given only together with the velocity")
    times = np.array(as_numbers(t, "t"))
    poses = own_vectors(pose, "pose")
    zero = np.zeros((times.size, 4))
    wrench = None if load is None else as_vectors(load, "load", 6)
    # Checks shapes and values, before anything is made of them.
    speeds = zero if velocity is None else as_vectors(velocity, "velocity")
    growth = zero if acceleration is None else as_vectors(acceleration, "acceleration")
    Trajectory(times, poses, speeds, growth, load=wrench)
    for item in passages:
        if not times[0] < item.t < times[-1]:
            ends = f"{times[0]:.6g} and {times[-1]:.6g} s"
            raise InvalidInput("passages", f"times between {ends} are possible, not {item.t!r}")
    crossed = tuple(item._replace(t=float(item.t - times[0])) for item in passages)
    notes: list[str] = []
    if times[0] != 0.0:
        notes.append(f"The times are shifted by {-times[0]:.6g} s, to start at zero.")
        times -= times[0]
    straight = np.unwrap(poses[:, 2])
    turned = np.abs(straight - poses[:, 2]) > 1.0
    if turned.any():
        notes.append("Jumps of theta by a full turn between samples are removed.")
        poses[turned, 2] = straight[turned]
    if velocity is None:
        spline = _spline(times, poses, rest)
        speeds, growth = spline(times, 1), spline(times, 2)
        notes.append(f"Velocity and acceleration are those of a spline of degree {spline.k}.")
    elif acceleration is None:
        spline = _spline(times, speeds, False)
        growth = spline(times, 1)
        notes.append(f"The acceleration is that of a spline of degree {spline.k}.")
    if not (np.abs(speeds).max() <= LARGEST and np.abs(growth).max() <= LARGEST):
        problem = "velocity or acceleration would be too large; check the units of t and pose"
        raise InvalidInput("pose", problem)
    if velocity is None:
        notes += _rounding(times, poses)
    else:
        notes += _mismatch("velocity", times, poses, speeds)
    if acceleration is not None:
        notes += _mismatch("acceleration", times, speeds, growth)
    kind = "imported samples"
    return Trajectory(times, poses, speeds, growth, name, kind, tuple(notes), wrench, crossed)


def _spline(t: Array, values: Array, rest: bool) -> BSpline:
    """Return a spline with the rates of the values, exactly zero for those that stay."""
    from scipy.interpolate import make_interp_spline  # slow to load

    change = values - values[0]
    if rest:
        still = np.zeros(4)
        ends = [(1, still), (2, still)]
        return make_interp_spline(t, change, k=5, bc_type=(ends, ends))
    degree = 5 if len(t) > 5 else 3 if len(t) > 3 else len(t) - 1
    return make_interp_spline(t, change, k=degree)


def _rounding(t: Array, pose: Array) -> list[str]:
    """Note by how much the last digit of the poses may move the acceleration, if that matters."""
    if len(t) < 3:
        return []
    step = np.median(np.diff(t))
    for column, (word, unit) in enumerate(zip(COORDINATES, UNITS, strict=True)):
        if np.ptp(pose[:, column]) == 0:
            continue  # a constant coordinate does not show how it is rounded
        digit = _last_digit(pose[:, column])
        # Second differences of numbers that are wrong by up to half a digit each.
        noise = 2.0 * digit / step**2
        if noise > 0.1:
            return [
                f"{word} is written in steps of {digit:.3g} {unit}; at this rate of samples the "
                f"acceleration may be wrong by {noise:.2g} {unit}/s²."
            ]
    return []


def _last_digit(values: Array) -> float:
    """Return the decimal step in which numbers are written, 0 if it is finer than 1e-9."""
    for digits in range(10):
        if np.abs(values - np.round(values, digits)).max() < 1e-12:
            return 10.0**-digits
    return 0.0


def _mismatch(what: str, t: Array, values: Array, rate: Array) -> list[str]:
    """Note if a given rate is not that of the values.

    Over a step, the change of a value is compared with the mean of its given rates.
    """
    actual = np.diff(values, axis=0) / np.diff(t)[:, None]
    wrong = np.abs(actual - 0.5 * (rate[1:] + rate[:-1]))
    size = np.maximum(np.abs(rate).max(axis=0), np.abs(actual).max(axis=0))
    share = np.where(size > 1e-9, wrong / np.maximum(size, 1e-300), 0.0)
    # A jump of a rate within one step is no mismatch; a wrong unit is one nearly everywhere.
    typical = np.median(share, axis=0)
    column = int(np.argmax(typical))
    if typical[column] <= 0.05:
        return []
    return [
        f"The {what} of {COORDINATES[column]} is not the rate at which the samples change: it is "
        f"typically off by {percent(typical[column])} of its largest value."
    ]
