"""The formulas checked against engines that nobody here wrote, as the paper did with ADAMS.

`verify` compares static torques over the workspace and dynamic torques along a trajectory, actuator
by actuator; runs the formulas as published past the same engine; and lets MuJoCo move
under the calculated torques. Joint friction is left out on both sides: it is not part of the
paper's equations, and engines have other laws for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.missing import EngineMissing
from paminsa_viz.engines.mujoco_model import MujocoRobot, Played, load_mujoco, play
from paminsa_viz.engines.pinocchio_model import PinocchioRobot, load_pinocchio
from paminsa_viz.engines.poses import workspace_poses
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import TORQUE_UNITS
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.statics import static_breakdown, static_torques
from paminsa_viz.trajectory import Trajectory, check_path

# ------------------------------------------------------------------ two sources of the same torques

LEAST_SCALE = 1e-6
"""What differences are measured by where no body has weight and nothing moves [N m, N]."""

SYMBOLS = ("tau_1", "tau_2", "tau_3", "F_4")


@dataclass(frozen=True, eq=False)
class Comparison:
    """Actuator torques of the formulas and of an engine, at the same n states.

    Attributes:
        computed: (n, 4) those of the formulas [N m, N].
        reference: (n, 4) those of the engine.
        scale: (4,) what differences of each actuator are measured by, see `torque_scale`.
    """

    computed: Array
    reference: Array
    scale: Array

    @cached_property
    def difference(self) -> Array:
        """Computed minus reference, (n, 4) [N m, N]."""
        return self.computed - self.reference

    @cached_property
    def largest(self) -> Array:
        """Largest difference of each actuator, (4,) [N m, N]; NaN if a torque is missing."""
        return np.abs(self.difference).max(axis=0)

    @cached_property
    def rms(self) -> Array:
        """Root mean square of the difference, (4,) [N m, N]."""
        return np.sqrt((self.difference**2).mean(axis=0))

    @property
    def relative(self) -> Array:
        """Largest difference over the scale, (4,)."""
        return self.largest / self.scale

    @property
    def relative_rms(self) -> Array:
        """Root mean square of the difference over the scale, (4,)."""
        return self.rms / self.scale

    def agrees(self, tolerance: float) -> bool:
        """Whether no difference of any actuator exceeds ``tolerance`` times its scale."""
        return bool((self.relative <= tolerance).all())

    def summary(self) -> list[dict[str, Any]]:
        """Return the figures of each actuator, ready for JSON."""
        rows = zip(
            SYMBOLS, TORQUE_UNITS, self.scale.tolist(), self.largest.tolist(), self.rms.tolist(),
            self.relative.tolist(), self.relative_rms.tolist(), strict=True,
        )  # fmt: skip
        names = (
            "actuator", "unit", "largest_torque", "max_difference", "rms_difference",
            "max_relative", "rms_relative",
        )  # fmt: skip
        return [dict(zip(names, row, strict=True)) for row in rows]


def torque_scale(design: Design, poses: Array, torques: Array) -> Array:
    """Return what differences of each actuator's torque are measured by, (4,) [N m, N].

    It is the largest torque. Where the bodies balance each other, so that nothing but rounding is
    left of it, it is the largest torque of a single body's weight.

    Args:
        design: The robot.
        poses: (n, 4) where the torques belong to [m, m, rad, m].
        torques: (n, 4) [N m, N].
    """
    shares = np.abs(static_breakdown(design, poses).per_leg)
    # Where a reference misses a torque, the comparison fails by its difference, not by its scale.
    whole = np.nan_to_num(np.abs(torques)).max(axis=0)
    single = np.nan_to_num(shares).max(axis=(0, 2, 3))
    return np.maximum(np.maximum(whole, single), LEAST_SCALE)


# ------------------------------------------------------------------------- formulas against engines

TOLERANCE = 1e-6
"""Largest difference that passes, over the largest torque of the same actuator."""

LARGEST_TOLERANCE = 0.1
"""Largest tolerance: torques of another robot must not pass."""

POSES = 200
"""Random poses of the static comparison, unless they are given."""

MOST_STATES = 4000
"""Samples of a trajectory that are compared; of a longer one, so many in equal distance."""

STRAY_LIMIT = 0.02
"""How far the simulated platform may stray before the simulation ends, over R_b."""

SIMULATED_RATE = 1000.0
"""Samples a second of the simulated motion, between which the torques are linear [1/s]."""

MOST_SIMULATED = 100_000
"""Samples of the simulated motion of a very long trajectory."""

EVERY_MISPRINT: tuple[Misprint, ...] = (*Misprint, Misprint.ALL)
"""Each misprint alone, and the formulas exactly as published."""


@dataclass(frozen=True, eq=False)
class EngineCheck:
    """The formulas compared with one engine.

    Attributes:
        engine: Its name.
        version: Its version.
        static: Torques at rest, at the poses of the workspace.
        dynamic: Torques along the trajectory.
    """

    engine: str
    version: str
    static: Comparison
    dynamic: Comparison

    def agrees(self, tolerance: float) -> bool:
        """Whether all torques agree within ``tolerance`` of the largest one of each actuator."""
        return self.static.agrees(tolerance) and self.dynamic.agrees(tolerance)


@dataclass(frozen=True, eq=False)
class Verification:
    """What `verify` found.

    Attributes:
        design: The robot, without joint friction.
        trajectory: The motion, with the samples that were compared.
        poses: (n, 4) poses of the static comparison [m, m, rad, m].
        tolerance: What the verdict is measured by.
        engines: One check an engine; MuJoCo first.
        missing: Names of engines that are not installed.
        published: Dynamic torques of the formulas as published, by misprint, compared with the
            first engine.
        wanted: The trajectory as it was simulated.
        played: MuJoCo's motion under the calculated torques, at the times of ``wanted``.
    """

    design: Design
    trajectory: Trajectory
    poses: Array
    tolerance: float
    engines: tuple[EngineCheck, ...]
    missing: tuple[str, ...]
    published: Mapping[Misprint, Comparison]
    wanted: Trajectory
    played: Played

    @property
    def passed(self) -> bool:
        """Whether every engine agrees with the formulas within the tolerance."""
        return all(check.agrees(self.tolerance) for check in self.engines)

    @property
    def worst(self) -> float:
        """Largest relative difference of any actuator, of any engine; NaN if a torque is missing.

        Relative to the largest torque of the same actuator.
        """
        found = [c.relative for check in self.engines for c in (check.static, check.dynamic)]
        return float(np.max(found))


@of_design
def verify(
    design: Design,
    trajectory: Trajectory,
    *,
    poses: ArrayLike | int = POSES,
    seed: int = 0,
    tolerance: float = TOLERANCE,
    misprints: tuple[Misprint, ...] = EVERY_MISPRINT,
    xml: str | None = None,
) -> Verification:
    """Compare the formulas with MuJoCo, and with Pinocchio where it is installed.

    Args:
        design: The robot; joint friction is left out.
        trajectory: The motion; the robot has to be able to run it.
        poses: Poses (..., 4) of the static comparison [m, m, rad, m], or how many are drawn by
            `workspace_poses`.
        seed: Of the random poses.
        tolerance: Largest difference that passes, over the largest torque of the actuator.
        misprints: Which formulas as published to run past the engine too.
        xml: An exported MJCF text to check instead of the design's own; only MuJoCo is used then.

    Raises:
        EngineMissing: If MuJoCo is not installed.
        ImpossibleTrajectory: If the robot cannot run the trajectory.
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If the tolerance is not possible, or there are no such poses.
    """
    if not 0 < tolerance <= LARGEST_TOLERANCE:
        problem = f"a number above 0 and at most {LARGEST_TOLERANCE} is needed, not {tolerance!r}"
        raise InvalidInput("tolerance", problem)
    design = design.without_friction()
    check_path(design.geometry, trajectory).require()
    motion = _thinned(trajectory)
    places = (
        workspace_poses(design.geometry, poses, seed)
        if isinstance(poses, int)
        else as_vectors(poses, "poses").reshape(-1, 4)
    )
    if not len(places):
        raise InvalidInput("poses", "at least one is needed")
    robots, missing = _robots(design, xml)
    checks = []
    for engine, version, robot in robots:
        at_rest = robot.static_torques(places)
        moving = robot.inverse_dynamics(
            motion.pose, motion.velocity, motion.acceleration, load=motion.load
        )
        static = Comparison(
            static_torques(design, places),
            at_rest,
            torque_scale(design, places, at_rest),
        )
        dynamic = _along(design, motion, moving, Misprint.NONE)
        checks.append(EngineCheck(engine, version, static, dynamic))
    first = checks[0].dynamic
    wanted = motion.resampled(min(SIMULATED_RATE, MOST_SIMULATED / motion.duration))
    return Verification(
        design=design,
        trajectory=motion,
        poses=places,
        tolerance=float(tolerance),
        engines=tuple(checks),
        missing=missing,
        published={
            item: _along(design, motion, first.reference, item) for item in misprints
        },
        wanted=wanted,
        played=play(
            design, wanted.t, wanted.pose, wanted.velocity,
            _computed(design, wanted), limit=STRAY_LIMIT * design.geometry.base_radius,
            loads=wanted.load,
        ),
    )  # fmt: skip


def _robots(
    design: Design, xml: str | None
) -> tuple[list[tuple[str, str, ClosedLoopRobot]], tuple[str, ...]]:
    """Return the robot in each engine, with the engine's name and version; and who is missing."""
    mujoco = load_mujoco()
    found: list[tuple[str, str, ClosedLoopRobot]] = [
        ("MuJoCo", mujoco.__version__, MujocoRobot(design, xml=xml))
    ]
    if xml is not None:
        return found, ()
    try:
        version = load_pinocchio().__version__
    except EngineMissing as error:
        return found, (error.engine,)
    return [*found, ("Pinocchio", version, PinocchioRobot(design))], ()


def _along(design: Design, motion: Trajectory, reference: Array, misprints: Misprint) -> Comparison:
    """Compare dynamic torques, some of them perhaps as published, with an engine's (n, 4)."""
    computed = _computed(design, motion, misprints)
    return Comparison(computed, reference, torque_scale(design, motion.pose, reference))


def _computed(design: Design, motion: Trajectory, misprints: Misprint = Misprint.NONE) -> Array:
    """Return the torques of the formulas along a motion, (n, 4) [N m, N]."""
    states = motion.pose, motion.velocity, motion.acceleration
    return inverse_dynamics(design, *states, misprints, load=motion.load).torque


def _thinned(trajectory: Trajectory) -> Trajectory:
    """Return a trajectory with at most `MOST_STATES` of its samples, both ends among them."""
    if trajectory.size <= MOST_STATES:
        return trajectory
    return trajectory.take(np.linspace(0, trajectory.size - 1, MOST_STATES).round().astype(np.intp))
