"""Checks of an answer as a whole: with its springs, on its motions, built, and in MuJoCo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.balancing import Spring, spring_torques
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.statics import static_torques
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.answer.build_yield import BuildYield, build_yield
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck, bound_margins, check_by_mujoco
from paminsa_viz.synthesis.masses.space import ACTUATORS_OF, sampled_solution, within
from paminsa_viz.synthesis.search.result import SynthesisResult
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.margins import headings
from paminsa_viz.synthesis.volume.workspace import sample_workspace
from paminsa_viz.trajectory.sampled import Trajectory

DENSITY, HEADINGS = 4, 9
"""Samples from the workspace's center to its boundary, and headings, of the poses checked here."""


@dataclass(frozen=True, eq=False)
class AnswerMargins:
    """Margins of a robot to the requirements of an answer; can be sent to another process.

    Attributes:
        requirements: What has to hold, with the workspace where it is.
        springs: Springs of each leg.
        motions: Motions that the robot has to run.
        motion_torque, motion_force: Limits on them; None for none [N m], [N].
    """

    requirements: Requirements
    springs: tuple[Spring, ...] = ()
    motions: tuple[Trajectory, ...] = ()
    motion_torque: float | None = None
    motion_force: float | None = None

    @classmethod
    def of(cls, result: SynthesisResult) -> AnswerMargins:
        """Return the margins of an answer's case."""
        requirements = replace(result.case.requirements, workspace=result.workspace)
        inner = result.case.inner
        if inner is None:
            return cls(requirements)
        inner = inner.placed(np.array(result.workspace.center, np.float64))
        springs = () if result.inner is None else result.inner.springs
        return cls(requirements, springs, inner.motions, inner.motion_torque, inner.motion_force)

    def poses(self) -> Array:
        """Return poses of the workspace, (n, 4)."""
        assert self.requirements.workspace is not None
        x, y, z = (float(place or 0.0) for place in self.requirements.workspace.center)
        found = sample_workspace(self.requirements.workspace, (x, y, z), DENSITY)
        theta = headings(self.requirements.theta, HEADINGS)
        shape = (len(found.positions), len(theta), len(found.z))
        pose = np.empty((*shape, 4))
        pose[..., :2] = found.positions[:, None, None]
        pose[..., 2], pose[..., 3] = theta[:, None], found.z
        return pose.reshape(-1, 4)

    def __call__(self, design: Design) -> dict[str, float]:
        """Return the margins by name, negative where a requirement is not met [SI]."""
        bounds = self.requirements.bounds
        sprung = [b for b in bounds if self.springs and b.quantity in ACTUATORS_OF]
        rest = replace(
            self.requirements, bounds=tuple(bound for bound in bounds if bound not in sprung)
        )
        found = {item.label: item.margin for item in check_requirements(design, rest).items}
        if sprung:
            found |= self._at_rest(design, sprung)
        for motion in self.motions:
            found |= self._in_motion(design, motion)
        return found

    def _at_rest(self, design: Design, bounds: list[Requirement]) -> dict[str, float]:
        pose = self.poses()
        held = static_torques(design, pose)
        held += spring_torques(design.geometry, self.springs, pose)
        return {
            requirement_label(bound): float(bound_margins(bound, held[within(bound, pose)]).min())
            for bound in bounds
        }

    def _in_motion(self, design: Design, motion: Trajectory) -> dict[str, float]:
        solved = sampled_solution(design.geometry, motion, design.gravity)
        if not solved.check.ok:
            return {f"run {motion.name}": -np.inf}
        torque = solved.torques(design)
        torque += spring_torques(design.geometry, self.springs, motion.pose)
        found = {f"run {motion.name}": float(solved.check.closest.margin)}
        for name, part, most in (
            ("torque of M1-M3 on", torque[:, :3], self.motion_torque),
            ("force of M4 on", torque[:, 3], self.motion_force),
        ):
            if most is not None:
                found[f"{name} {motion.name}"] = most - float(np.abs(part).max())
        return found


def answer_yield(
    result: SynthesisResult,
    *,
    samples: int = 400,
    mass_tolerance: float = 0.02,
    confidence: float = 0.95,
    seed: int = 0,
    workers: Workers = here,
    progress: Callable[[int, int], bool | None] | None = None,
) -> BuildYield:
    """Return which part of the robots built to an answer meets all its requirements.

    Springs are as drawn. Arguments as in `build_yield`.

    Raises:
        InvalidInput: If there are no samples, or a tolerance or the confidence is not possible.
    """
    return build_yield(
        result.design, AnswerMargins.of(result), samples=samples, mass_tolerance=mass_tolerance,
        confidence=confidence, seed=seed, workers=workers, progress=progress,
    )  # fmt: skip


def mujoco_check(result: SynthesisResult) -> MujocoCheck:
    """Return what MuJoCo says of an answer's requirements; errors as in `check_by_mujoco`."""
    asked = AnswerMargins.of(result)
    return check_by_mujoco(
        result.design, asked.requirements.bounds, asked.poses(), springs=asked.springs,
        motions=asked.motions, motion_torque=asked.motion_torque, motion_force=asked.motion_force,
    )  # fmt: skip
