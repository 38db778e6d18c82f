"""The duty cycle of the drives: what motions, with their repetitions and rests, ask of each.

The load torque T is that of the robot without the drives' own inertia and friction; the friction of
the joints is part of it. A motor behind a ratio N [rad/rad, rad/m] and an efficiency gives

    tau = T_e/N + N (J w' + b w) + c sgn w,    T_e = T/eta where T w > 0, T eta where T w < 0,

and T_e = T at rest. That is a sum of six signals of the load (`Signal`) with factors of the drive,
so all squares and products of it follow from one matrix of their means.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from paminsa_viz.checks import require_at_least, require_each
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import kept
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, NO_DRIVES
from paminsa_viz.model.dynamics import friction_torque
from paminsa_viz.model.load import NO_LOAD
from paminsa_viz.model.statics import static_torques
from paminsa_viz.trajectory import Trajectory, actuator_inertia, analyze
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.integrals import running_integral

SLOWER = (1e-9, 1e9)
"""Smallest and largest factor on the durations of a cycle: torques take its square."""

INERTIA_SAMPLES = 200
"""Samples of a motion at which the robot's inertia is looked at."""

BLOCK_WIDTH = 64
"""Neighboring samples that are looked at together."""


class Signal(IntEnum):
    """The signals of a load, rows of `ActuatorLoad.signals`."""

    DRIVING = 0
    """T where T w > 0 [N m, N]."""
    BRAKING = 1
    """T where T w < 0."""
    REST = 2
    """T where w = 0."""
    ACCELERATION = 3
    """w' [rad/s^2, m/s^2]."""
    SPEED = 4
    """w [rad/s, m/s]."""
    SIGN = 5
    """sgn w."""


class Duty(NamedTuple):
    """A motion of a duty cycle.

    Attributes:
        trajectory: The motion.
        repeats: How often it is made in a cycle, one time after the other; at least 1.
        dwell: How long the robot waits after each time, where the motion ends [s].
    """

    trajectory: Trajectory
    repeats: float = 1.0
    dwell: float = 0.0


class DutyMotion(NamedTuple):
    """One motion of a load, over its samples.

    Attributes:
        t: (n,) from 0 [s].
        signals: (6, n), see `Signal`.
        repeats, dwell: As in `Duty`.
        held: Load torque in the dwell [N m, N].
    """

    t: Array
    signals: Array
    repeats: float
    dwell: float
    held: float


class Blocks(NamedTuple):
    """The signals of a load in blocks of neighboring samples; the last one repeats its end.

    Attributes:
        signals: (6, blocks, `BLOCK_WIDTH`).
        speed: Size of the speed, (blocks, `BLOCK_WIDTH`).
        sample, speed_sample: Those of a sample in the middle of each block, (6, blocks), (blocks,).
        middle, half_range: Middle and half width of each signal's range, (6, blocks).
        speed_least, speed_top: Range of the speed's size, (blocks,).
    """

    signals: Array
    speed: Array
    sample: Array
    speed_sample: Array
    middle: Array
    half_range: Array
    speed_least: Array
    speed_top: Array


@dataclass(frozen=True, eq=False)
class ActuatorLoad:
    """What a duty cycle asks of one actuator.

    Attributes:
        name: M1 .. M4.
        passages: Its motions.
        inertia: The robot's largest inertia at the actuator, away from planned crossings of
            singularities, where it has no bound [kg m^2, kg].
    """

    name: str
    passages: tuple[DutyMotion, ...]
    inertia: float

    @cached_property
    def period(self) -> float:
        """Time of a cycle [s]."""
        return float(sum(p.repeats * (p.t[-1] + p.dwell) for p in self.passages))

    @cached_property
    def signals(self) -> Array:
        """Samples of all motions, (6, n)."""
        return np.ascontiguousarray(np.concatenate([p.signals for p in self.passages], axis=1))

    @cached_property
    def blocks(self) -> Blocks:
        """The signals in blocks of `BLOCK_WIDTH`."""
        size = self.signals.shape[1]
        count = -(-size // BLOCK_WIDTH)
        padded = np.pad(self.signals, ((0, 0), (0, count * BLOCK_WIDTH - size)), "edge")
        signals = padded.reshape(6, count, BLOCK_WIDTH)
        low, high = signals.min(axis=2), signals.max(axis=2)
        speed, at = np.abs(signals[Signal.SPEED]), BLOCK_WIDTH // 2
        return Blocks(
            signals, speed, np.ascontiguousarray(signals[:, :, at]), speed[:, at],
            (low + high) / 2, (high - low) / 2, speed.min(axis=1), speed.max(axis=1),
        )  # fmt: skip

    @cached_property
    def means(self) -> Array:
        """Means over the cycle of the products of two signals, (6, 6)."""
        total = np.zeros((6, 6))
        for p in self.passages:
            products = np.einsum("in,jn->nij", p.signals, p.signals)
            total += p.repeats * running_integral(p.t, products)[-1]
        return total / self.period

    @cached_property
    def held_square(self) -> float:
        """Mean over the cycle of T^2 in the dwells, zero while the robot moves."""
        return sum(p.repeats * p.dwell * p.held**2 for p in self.passages) / self.period

    @cached_property
    def held(self) -> float:
        """Largest load torque in a dwell, in size."""
        return max((abs(p.held) for p in self.passages if p.dwell > 0), default=0.0)

    @property
    def torque(self) -> Array:
        """Load torque of all samples, (n,)."""
        return self.signals[: Signal.ACCELERATION].sum(axis=0)

    @cached_property
    def peak(self) -> float:
        """Largest load torque, in size [N m, N]."""
        return max(float(np.abs(self.torque).max()), self.held)

    @cached_property
    def rms(self) -> float:
        """Root mean square of the load torque over the cycle [N m, N]."""
        share = self.means[:3, :3].sum() + self.held_square
        return float(np.sqrt(max(share, 0.0)))

    @cached_property
    def top_speed(self) -> float:
        """Largest speed [rad/s, m/s]."""
        return float(np.abs(self.signals[Signal.SPEED]).max())

    @property
    def mean_speed(self) -> float:
        """Mean of the speed's size over the cycle [rad/s, m/s]."""
        return float(self.means[Signal.SPEED, Signal.SIGN])

    @cached_property
    def top_power(self) -> float:
        """Largest power of the load, in size [W]."""
        return float(np.abs(self.torque * self.signals[Signal.SPEED]).max())


@dataclass(frozen=True, eq=False)
class DutyCycle:
    """Motions of a robot and their loads.

    Attributes:
        design: The robot, without drives.
        duties: The motions.
        slower: Factor that stretches the motions in time; the dwells stay.
        loads: Those of M1..M4.
    """

    design: Design
    duties: tuple[Duty, ...]
    slower: float
    loads: tuple[ActuatorLoad, ...]

    def stretched(self, slower: float) -> DutyCycle:
        """Return the cycle with its motions ``slower`` times as long as they are given.

        Speeds divide by the factor, accelerations and all torques of inertia by its square.
        """
        return duty_cycle(self.design, self.duties, slower=slower)


@of_design
def duty_cycle(design: Design, duties: Sequence[Duty], *, slower: float = 1.0) -> DutyCycle:
    """Return what motions ask of the actuators; drives of the design are left out.

    Args:
        design: The robot.
        duties: The motions of a cycle.
        slower: Factor on the motions' durations.

    Raises:
        ImpossibleTrajectory: If the robot cannot run a motion.
        InvalidInput: If there is none, or a count, a dwell or the factor is not possible.
    """
    if not duties:
        raise InvalidInput("duties", "at least one motion is needed")
    require_each(duties, "duties", Duty)
    for duty in duties:
        require_at_least(duty.repeats, "repeats", 1.0, "a number of at least 1")
        require_at_least(duty.dwell, "dwell", what="a time of at least 0 s")
    if not SLOWER[0] <= slower <= SLOWER[1]:
        problem = f"{SLOWER[0]:g} to {SLOWER[1]:g} are possible, not {slower!r}"
        raise InvalidInput("slower", problem)
    plain = replace(design, drives=NO_DRIVES)
    solved = [_solved(plain, duty.trajectory) for duty in duties]
    parts = [_passages(duty, *one[:2], slower) for duty, one in zip(duties, solved, strict=True)]
    inertia = np.max([largest for _, _, largest in solved], axis=0)
    loads = tuple(
        ActuatorLoad(name, tuple(part[j] for part in parts), float(inertia[j]))
        for j, name in enumerate(ACTUATORS)
    )
    return DutyCycle(plain, tuple(duties), slower, loads)


@kept(4)
def _solved(design: Design, motion: Trajectory) -> tuple[TrajectoryAnalysis, Array, Array]:
    """Return a motion at its own pace, the torques that hold it (n, 4), the largest inertias (4,).

    Kept, as a motion that is stretched in time needs no more.
    """
    analysis = analyze(design, motion)
    analysis.require()
    static = static_torques(replace(design, load=NO_LOAD), motion.pose)
    if analysis.solved.loaded(design):
        static = static + analysis.solved.load_torques(design)
    # toward a planned crossing it has no bound, and samples would decide the number
    near = np.zeros(motion.size, bool)
    for window in analysis.check.windows:
        near |= (window.begin <= motion.t) & (motion.t <= window.end)
    pose = motion.pose if near.all() else motion.pose[~near]
    step = max(1, len(pose) // INERTIA_SAMPLES)
    return analysis, static, np.nanmax(actuator_inertia(design, pose[::step]), axis=0)


def load_signals(torque: Array, growth: Array, speed: Array) -> Array:
    """Return the signals of a load, (6, ...), see `Signal`: its torque by the power's direction.

    Args:
        torque: Of the load (...) [N m, N].
        growth: Acceleration of the actuator (...) [rad/s^2, m/s^2].
        speed: Of the actuator (...) [rad/s, m/s].
    """
    power = torque * speed
    driving = np.where((power >= 0) & (speed != 0), torque, 0.0)
    braking, resting = np.where(power < 0, torque, 0.0), np.where(speed == 0, torque, 0.0)
    return np.stack([driving, braking, resting, growth, speed, np.sign(speed)])


def _passages(
    duty: Duty, analysis: TrajectoryAnalysis, static: Array, slower: float
) -> list[DutyMotion]:
    """Return a motion as the four actuators see it."""
    own_speed, friction = analysis.solved.speed, analysis.design.actuator_friction
    speed, growth = own_speed / slower, analysis.solved.actuator_acceleration / slower**2
    dynamic = analysis.torque - friction_torque(friction, own_speed) - static
    torque = static + dynamic / slower**2 + friction_torque(friction, speed)
    signals = load_signals(torque, growth, speed)
    times = duty.trajectory.t
    t, count, dwell = slower * (times - times[0]), float(duty.repeats), float(duty.dwell)
    return [DutyMotion(t, signals[:, :, j], count, dwell, float(static[-1, j])) for j in range(4)]
