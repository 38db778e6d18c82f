"""How sure an answer is: its margins, and the fraction of robots built to it that meets them.

Lengths are off by the design's own `Tolerances`, masses by a part of themselves, evenly distributed
and independent of each other; the three legs of a robot are alike, as a `Design` has them. So what
moves the legs against each other (directions of axes and joints, zeros of the drives, clearances)
is not in it: the quantities of accuracy have it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain

import numpy as np

from paminsa_viz.balancing import Spring, spring_torques
from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.statics import static_torques
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.synthesis.masses.space import ACTUATORS_OF, bound_margins, sampled_solution, within
from paminsa_viz.synthesis.search.extremes import OVER_POSES, Extent, least_on_samples
from paminsa_viz.synthesis.search.result import SynthesisResult
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.margins import Columns, headings
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
        return Columns.at(found.positions, theta, found.z).poses().reshape(-1, 4)

    def __call__(self, design: Design) -> dict[str, float]:
        """Return the margins by name, negative where a requirement is not met [SI]."""
        bounds = self.requirements.bounds
        sprung = [b for b in bounds if self.springs and b.quantity in ACTUATORS_OF]
        sampled = [b for b in bounds if b.quantity in OVER_POSES and b.high is None]
        apart = (*sprung, *sampled)
        rest = replace(
            self.requirements, bounds=tuple(bound for bound in bounds if bound not in apart)
        )
        found = {item.label: item.margin for item in check_requirements(design, rest).items}
        if sprung:
            found |= self._at_rest(design, sprung)
        for bound in sampled:
            found[requirement_label(bound)] = self._least(design, bound)
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

    def _least(self, design: Design, bound: Requirement) -> float:
        """Return the margin of what takes long in a pose, such as clearance, on sparse samples."""
        assert self.requirements.workspace is not None
        headings = self.requirements.headings(bound)
        extent = Extent(self.requirements.workspace, headings).within(bound.z)
        if extent is None:
            return np.inf
        return float(bound.margin(least_on_samples(bound.quantity, design, extent)))

    def _in_motion(self, design: Design, motion: Trajectory) -> dict[str, float]:
        solved = sampled_solution(design.geometry, motion, design.gravity)
        if not solved.check.possible:
            return {f"run {motion.name}": -np.inf}
        torque = solved.torques(design)
        torque += spring_torques(design.geometry, self.springs, motion.pose)
        margins = self.motion_margins(motion, torque)
        return {f"run {motion.name}": float(solved.check.closest.margin)} | {
            label: margin for label, _, _, margin in margins
        }

    def motion_margins(
        self, motion: Trajectory, torque: Array
    ) -> list[tuple[str, str, float, float]]:
        """Return label, SI unit, limit and margin of each limit on a motion's torques (n, 4)."""
        return [
            (f"{label} {motion.name}", unit, most, most - float(np.abs(torque[:, part]).max()))
            for label, unit, part, most in (
                ("torque of M1-M3 on", "N m", slice(0, 3), self.motion_torque),
                ("force of M4 on", "N", slice(3, 4), self.motion_force),
            )
            if most is not None
        ]


Margins = Callable[[Design], Mapping[str, float]]
"""Margins of a robot to its requirements by name, negative where one is not met [SI]."""

PART = 8
"""Robots handed to a worker at a time."""


@dataclass(frozen=True)
class Fraction:
    """A part of all robots, known from samples.

    Attributes:
        passed, samples: How many of how many.
        low, high: Confidence interval of the part.
        confidence: How likely it holds the true part, at least.
    """

    passed: int
    samples: int
    low: float
    high: float
    confidence: float

    @property
    def value(self) -> float:
        """The part of the samples."""
        return self.passed / self.samples


def fraction(passed: int, samples: int, confidence: float = 0.95) -> Fraction:
    """Return a part with its interval by Clopper and Pearson (Biometrika 26, 1934).

    It holds the true part with at least the confidence, however few the samples are.

    Args:
        passed, samples: How many of how many.
        confidence: Above 0 and below 1.

    Raises:
        InvalidInput: If there are no samples, or the numbers are not possible.
    """
    from scipy.special import betaincinv  # slow to load

    if not (samples >= 1 and 0 <= passed <= samples):
        raise InvalidInput("samples", f"{passed} of {samples} is no part of anything")
    if not 0 < confidence < 1:
        raise InvalidInput("confidence", f"above 0 and below 1 is needed, not {confidence!r}")
    tail = 0.5 * (1 - confidence)
    low = 0.0 if passed == 0 else float(betaincinv(passed, samples - passed + 1, tail))
    high = 1.0 if passed == samples else float(betaincinv(passed + 1, samples - passed, 1 - tail))
    return Fraction(passed, samples, low, high, confidence)


@dataclass(frozen=True, eq=False)
class BuildYield:
    """Robots built within tolerances.

    Attributes:
        fraction: The part that meets all requirements.
        missed: By requirement, how many do not meet it, the most frequent first.
        worst: By requirement, the least margin of all [SI].
        canceled: Whether the progress function ended it; the fraction is of those built so far.
    """

    fraction: Fraction
    missed: dict[str, int]
    worst: dict[str, float]
    canceled: bool


def built_robots(
    design: Design, samples: int, *, mass_tolerance: float = 0.02, seed: int = 0
) -> list[Design | None]:
    """Return robots built within tolerances; None for lengths that make no robot.

    Args:
        design: The robot as drawn, with its `Tolerances`.
        samples: How many.
        mass_tolerance: Of each mass to either side, as a part of it; inertias follow.
        seed: The same seed gives the same robots.

    Raises:
        InvalidInput: If there are no samples, or the tolerance is no part below 1.
    """
    if samples < 1:
        raise InvalidInput("samples", f"at least one sample is needed, not {samples!r}")
    if not 0 <= mass_tolerance < 1:
        problem = f"at least 0 and below 1 is needed, not {mass_tolerance!r}"
        raise InvalidInput("mass_tolerance", problem)
    masses = [p for p in MASS_PATHS if PARAMETER[p].unit == "kg" and p != "payload.mass"]
    weights = [f"counterweights.{i}.mass" for i in range(len(design.counterweights))]
    rng = np.random.default_rng(seed)
    lengths = rng.uniform(-1.0, 1.0, (samples, 8))
    factors = 1 + mass_tolerance * rng.uniform(-1.0, 1.0, (samples, len(masses) + len(weights)))
    build = partial(_built, design, [*masses, *weights])
    return [build(*row) for row in zip(lengths, factors, strict=True)]


def _built(design: Design, paths: list[str], draw: Array, factors: Array) -> Design | None:
    g, t = design.geometry, design.tolerances
    # B4 carries joint 4 between its ends: its two parts make l_B4, and their ratio makes k
    upper = g.coupler_length / g.magnification + t.bar * draw[0]
    whole = upper + g.coupler_length * (1 - 1 / g.magnification) + t.bar * draw[1]
    numbers: dict[str, float | None] = {
        "geometry.coupler_length": whole,
        "geometry.magnification": whole / upper,
        "geometry.crank_length": g.crank_length + t.bar * draw[2],
        "geometry.shaft_length": g.shaft_length + t.shaft * draw[3],
        "geometry.base_radius": g.base_radius + t.axis_radius * draw[4],
        "geometry.platform_radius": g.platform_radius + t.joint_radius * draw[5],
        # joint 5 above the guide is what counts
        "geometry.platform_joint_height": g.platform_joint_height
        + t.joint_height * draw[6]
        + t.guide_height * draw[7],
    }
    for path, factor in zip(paths, factors.tolist(), strict=True):
        numbers[path] = design.value(path) * factor
        bar = path.partition(".")[2]
        for inertia in MASS_PATHS:
            if path.startswith("links.") and inertia.startswith(f"inertias.{bar}_"):
                numbers[inertia] = design.value(inertia) * factor
    try:
        return design.vary(numbers)
    except InvalidDesign:
        return None


def _margins_of(margins: Margins, robots: Iterable[Design | None]) -> list[dict[str, float]]:
    return [{"no robot": -np.inf} if r is None else dict(margins(r)) for r in robots]


def build_yield(
    design: Design,
    margins: Margins,
    *,
    samples: int = 400,
    mass_tolerance: float = 0.02,
    confidence: float = 0.95,
    seed: int = 0,
    workers: Workers = here,
    progress: Progress = go_on,
) -> BuildYield:
    """Return which part of the robots built within tolerances meets all requirements.

    Args:
        design: The robot as drawn, with its `Tolerances`.
        margins: Margins of a robot to its requirements; can be sent to the workers.
        samples: Robots to draw.
        mass_tolerance: Of each mass to either side, as a part of it.
        confidence: Of the interval.
        seed: The same seed gives the same result, whatever it runs on.
        workers: Where the robots are measured.
        progress: Called after each part of the robots; true ends it with those done.

    Raises:
        InvalidInput: If there are no samples, or a tolerance or the confidence is not possible.
    """
    fraction(0, 1, confidence)
    robots = built_robots(design, samples, mass_tolerance=mass_tolerance, seed=seed)
    parts = (robots[start : start + PART] for start in range(0, samples, PART))
    found: list[dict[str, float]] = []
    for part in workers.in_order(partial(_margins_of, margins), parts):
        found += part
        if progress(len(found) / samples):
            break
    # a margin that is no number is not met
    bad = [[name for name, margin in robot.items() if not margin >= 0] for robot in found]
    worst: dict[str, float] = {}
    for robot in found:
        for name, margin in robot.items():
            value = -np.inf if np.isnan(margin) else float(margin)
            worst[name] = min(worst.get(name, np.inf), value)
    return BuildYield(
        fraction(sum(not names for names in bad), len(found), confidence),
        dict(Counter(chain.from_iterable(bad)).most_common()),
        worst,
        len(found) < samples,
    )
