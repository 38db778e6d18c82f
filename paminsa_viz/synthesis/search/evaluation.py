"""How good a trial is: closed-form limits first, then poses, as long as it is worth it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.space import InnerInfeasible
from paminsa_viz.synthesis.search import kernels
from paminsa_viz.synthesis.search.case import CLEARANCE, REACH, Regime, SynthesisCase
from paminsa_viz.synthesis.search.extremes import (
    OVER_POSES,
    Extent,
    least_of,
    least_on_samples,
)
from paminsa_viz.synthesis.search.objectives import find_objective
from paminsa_viz.synthesis.search.region import SPARSE, TRIAL, Density, farthest
from paminsa_viz.synthesis.search.trial import Poses, Robots, TrialRobot
from paminsa_viz.synthesis.search.trial_masses import with_best_masses
from paminsa_viz.synthesis.volume.reach import cosine_range

REFUSED = 1e9
"""Cost from which a trial breaks a requirement; below it, all are met."""

STAGES = 8
"""Stages of an evaluation: lengths, singularities, reach, room for the drawn bodies, bars beside
the platform, condition, torques, other quantities."""

CLOSER = 2
"""How many times closer than those of a trial lie the samples that the pattern search starts at."""

SLOW = 1e-4
"""Time of a pose from which the verification has no more samples than a trial [s]."""

CONDITIONS = ("condition", "conditioning")


@dataclass(frozen=True, eq=False)
class TrialEvaluation:
    """Values of one trial.

    Attributes:
        stage: The stage at which it failed, `STAGES` if it meets all requirements.
        violation: By how much it failed there, as a share of the limits; zero if it did not.
        objective: What is minimized [SI]; NaN if it failed.
        worst: Value of each bound's quantity where it is closest to the bound [SI]; NaN if it was
            not evaluated.
        limits: Values of the objectives that are limited [SI]; NaN if not evaluated.
        trial: The robot; None if it does not reach its workspace.
    """

    stage: int
    violation: float
    objective: float
    worst: Array
    limits: Array
    trial: TrialRobot | None

    @property
    def values(self) -> Array:
        """Those of the bounds, then those of the limits [SI]."""
        return np.concatenate([self.worst, self.limits])

    @property
    def feasible(self) -> bool:
        """Whether all requirements are met."""
        return self.stage == STAGES

    def cost(self, sign: float) -> float:
        """Return the cost: the objective, or `REFUSED` and more, the sooner it failed the more."""
        if self.feasible:
            return sign * self.objective
        share = self.violation / (1 + self.violation) if np.isfinite(self.violation) else 1.0
        return REFUSED * (STAGES - self.stage + share)


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Evaluates trials of a case in one regime; can be sent to another process.

    Attributes:
        case: The case.
        regime: Which of base and platform is larger.
        density: How close the poses lie.
        tighter: By how much each bound, and each limit after them, is tightened [SI]; empty for
            none.
        relaxed: Index of a bound, or of a limit after the bounds, that need not be met: what is
            minimized is then by how much it is broken.
    """

    case: SynthesisCase
    regime: Regime
    density: Density = TRIAL
    tighter: tuple[float, ...] = ()
    relaxed: int | None = None

    @cached_property
    def _poses(self) -> Poses:
        """The poses that trials are measured at; solved once in each process."""
        return Poses(self.case, self.density)

    def costs(
        self, numbers: Sequence[Array], most: Sequence[float] = (), best: float = np.inf
    ) -> list[float]:
        """Return the costs of some trials.

        Args:
            numbers: The trials.
            most: Cost of each from which it does not matter how much more it is; none if empty.
            best: The least cost so far. Distances of all bodies take long: trials that cost as much
                or more are not asked for them, but for what is known in closed form and B4.
        """
        found = self.evaluate(np.asarray(numbers, np.float64), most, best)
        return [one.cost(self._sign) for one in found]

    @property
    def _sign(self) -> float:
        return 1.0 if self.relaxed is not None else find_objective(self.case.objective).sign

    def evaluate(
        self, numbers: Array, most: Sequence[float] = (), best: float = np.inf
    ) -> list[TrialEvaluation]:
        """Evaluate trials (n, d) [SI]; arguments as of `costs`."""
        nothing = np.full(len(self.case.requirements.bounds), np.nan)
        unlimited = np.full(len(self.case.limits), np.nan)
        robots = Robots.of(self.case, numbers)
        found: list[TrialEvaluation] = [
            TrialEvaluation(0, np.inf, np.nan, nothing, unlimited, None) for _ in numbers
        ]
        rows = np.flatnonzero(robots.possible)
        singular = self._singular(robots)
        beyond = self._beyond_reach(robots)
        cramped = self._without_room(robots)
        taken = []
        for p, row in enumerate(rows):
            if singular[p] > 0:
                found[row] = TrialEvaluation(1, singular[p], np.nan, nothing, unlimited, None)
            elif beyond[p] > 0:
                found[row] = TrialEvaluation(2, beyond[p], np.nan, nothing, unlimited, None)
            elif cramped[p] > 0:
                found[row] = TrialEvaluation(3, cramped[p], np.nan, nothing, unlimited, None)
            else:
                taken.append(p)
        for p, trial in zip(taken, robots.trials(self._poses, taken), strict=True):
            enough = most[int(rows[p])] if len(most) else np.inf
            found[rows[p]] = self._over_poses(trial, robots.margins[p], enough, best)
        return found

    def _singular(self, robots: Robots) -> Array:
        """Return by how much singularities are in the way (p,), as a share of R_b + R_pl."""
        least, largest = cosine_range(*self.case.requirements.theta)
        rb = np.array([g.base_radius for g in robots.geometries])
        rp = np.array([g.platform_radius for g in robots.geometries])
        far = np.array([farthest(w) for w in robots.workspaces])
        circle = np.sqrt(rb**2 + rp**2 - 2 * rb * rp * largest)
        turn = rb * least - rp if self.regime is Regime.SMALLER else rp - rb
        return (np.maximum(far - circle, 0.0) + np.maximum(-turn, 0.0)) / (rb + rp) + (
            (far >= circle) | (turn <= 0)
        ) * 1e-9

    def _beyond_reach(self, robots: Robots) -> Array:
        """Return by how much limits of reach are exceeded (p,), as a share of the bars."""
        needed = self.case.margin
        for index, bound in enumerate(self.case.requirements.bounds):
            counts = bound.quantity == REACH and index != self.relaxed
            if counts and bound.low is not None:
                needed = max(needed, bound.low + self._tightened(index))
        # The bars can be stretched and joints 5 on their axes at a singular pose only.
        short = np.maximum(needed - robots.margins, 0.0).sum(axis=-1)
        short += (robots.margins[:, [0, 1, 3]] <= 0).any(axis=-1) * 1e-9
        if not self.case.above_guides:
            short += np.maximum(robots.spans.beyond, 0.0)
        bars = np.array([g.crank_length + g.coupler_length for g in robots.geometries])
        return short / bars

    def _without_room(self, robots: Robots) -> Array:
        """Return by how much drawn bodies overlap in closed form (p,), as a share of the bars."""
        needed = self._needed_clearance
        if needed is None or not robots.geometries:
            return np.zeros(len(robots.geometries))
        bars = np.array([g.crank_length + g.coupler_length for g in robots.geometries])
        return robots.missing_room(needed).sum(axis=-1) / bars

    def _beside_platform(self, trial: TrialRobot) -> float:
        """Return by how much bars overlap with the platform, as a share of its radius."""
        needed = self._needed_clearance
        if needed is None:
            return 0.0
        least = trial.plate_distance(self.case.requirements.theta, needed)
        return (needed - least) / trial.geometry.platform_radius

    @cached_property
    def _needed_clearance(self) -> float | None:
        """Least clearance that is required in all poses [m]; None for none."""
        needed = [
            bound.low + self._tightened(index)
            for index, bound in enumerate(self.case.requirements.bounds)
            if bound.quantity == CLEARANCE and bound.low is not None and index != self.relaxed
            and bound.theta is None and bound.z is None
        ]  # fmt: skip
        return max(needed) if needed else None

    def _tightened(self, index: int) -> float:
        return self.tighter[index] if self.tighter else 0.0

    def _over_poses(
        self, trial: TrialRobot, margins: Array, most: float, best: float
    ) -> TrialEvaluation:
        bounds = self.case.requirements.bounds
        worst = np.full(len(bounds), np.nan)
        unlimited = np.full(len(self.case.limits), np.nan)
        for index, bound in enumerate(bounds):
            if bound.quantity == REACH:
                worst[index] = margins.min()
        if self._is_worse(trial, most):
            value = self._objective(trial, worst, unlimited)
            return TrialEvaluation(STAGES, 0.0, value, worst, unlimited, trial)
        beside = self._beside_platform(trial)
        if beside > 0:
            return TrialEvaluation(4, beside, np.nan, worst, unlimited, trial)
        stages = (self._conditions, self._torques, self._others)
        for stage, values in enumerate(stages, 5):
            over = 0.0
            if stage == 6 and self.case.inner is not None:
                try:
                    trial = with_best_masses(trial, self.tighter, self.relaxed)
                except InnerInfeasible as error:
                    return TrialEvaluation(stage, error.excess, np.nan, worst, unlimited, trial)
            for index, extremes in values(trial):
                worst[index], broken = self._worst(index, bounds[index], extremes)
                over += broken if index != self.relaxed else 0.0
            limits = unlimited
            if stage == 6:
                over_limits, unlimited = self._limits(trial)
                over, limits = over + over_limits, unlimited
            if over > 0:
                return TrialEvaluation(stage, over, np.nan, worst, limits, trial)
        traded = self.relaxed is not None and self.relaxed in self._clearances
        value = np.nan if traded else self._objective(trial, worst, unlimited)
        if traded or self._sign * value < best:
            over = 0.0
            for index in self._clearances:
                worst[index], broken = self._worst(
                    index, bounds[index], (self._least(trial, bounds[index]), np.inf)
                )
                over += broken if index != self.relaxed else 0.0
            if over > 0:
                return TrialEvaluation(STAGES - 1, over, np.nan, worst, unlimited, trial)
            value = self._objective(trial, worst, unlimited)
        if not np.isfinite(value):
            return TrialEvaluation(STAGES - 1, np.inf, np.nan, worst, unlimited, trial)
        return TrialEvaluation(STAGES, 0.0, value, worst, unlimited, trial)

    def _is_worse(self, trial: TrialRobot, most: float) -> bool:
        """Whether a trial costs more than ``most`` even if it meets all requirements.

        Its objective is then known before them; with masses to choose it is not.
        """
        if most >= REFUSED or self.relaxed is not None or self.case.inner is not None:
            return False
        return bool(self._sign * find_objective(self.case.objective).value(trial) > most)

    def _objective(self, trial: TrialRobot, worst: Array, limits: Array) -> float:
        if self.relaxed is None:
            return float(find_objective(self.case.objective).value(trial))
        bounds = self.case.requirements.bounds
        if self.relaxed < len(bounds):
            return -float(bounds[self.relaxed].margin(worst[self.relaxed]))
        limit = self.case.limits[self.relaxed - len(bounds)]
        return -limit.margin(limits[self.relaxed - len(bounds)])

    def _worst(
        self, index: int, bound: Requirement, extremes: tuple[float, float]
    ) -> tuple[float, float]:
        """Return the value that is closest to a bound, and by what share it breaks it."""
        if np.isnan(extremes).any():  # no pose of the workspace is asked for
            return float("nan"), 0.0
        margins = bound.margin(extremes)
        which = int(np.argmin(margins))
        limit = bound.low if which == 0 and bound.low is not None else bound.high
        scale = abs(limit) if limit else 1.0
        broken = max(0.0, self._tightened(index) - float(margins[which])) / scale
        return float(extremes[which]), broken

    def _limits(self, trial: TrialRobot) -> tuple[float, Array]:
        over, values = 0.0, []
        for index, limit in enumerate(self.case.limits, len(self.case.requirements.bounds)):
            value = float(find_objective(limit.objective).value(trial))
            values.append(value)
            if index != self.relaxed:
                broken = max(0.0, self._tightened(index) - limit.margin(value))
                over += broken / (abs(limit.most) or 1.0)
        return over, np.array(values)

    def _conditions(self, trial: TrialRobot) -> Iterable[tuple[int, tuple[float, float]]]:
        for index, bound in enumerate(self.case.requirements.bounds):
            if bound.quantity in CONDITIONS:
                low, high = trial.condition(self.case.requirements.headings(bound))
                if bound.quantity == "conditioning":
                    low, high = 1 / high, 1 / low
                yield index, (low, high)

    def _torques(self, trial: TrialRobot) -> Iterable[tuple[int, tuple[float, float]]]:
        solved = {}
        for index, bound in enumerate(self.case.requirements.bounds):
            if bound.quantity in kernels.TORQUE_COLUMNS:
                window = (self.case.requirements.headings(bound), bound.z)
                if window not in solved:
                    solved[window] = trial.torques(*window)
                column = kernels.TORQUE_COLUMNS.index(bound.quantity)
                yield index, (float(solved[window][0, column]), float(solved[window][1, column]))

    def _others(self, trial: TrialRobot) -> Iterable[tuple[int, tuple[float, float]]]:
        """Quantities that have no kernel, by the registry on all poses: slower a hundred times."""
        known = (*CONDITIONS, REACH, *kernels.TORQUE_COLUMNS)
        for index, bound in enumerate(self.case.requirements.bounds):
            if bound.quantity in known and not (bound.quantity == REACH and bound.low is None):
                continue
            if index in self._clearances:
                continue
            if bound.quantity in OVER_POSES and bound.high is None:
                yield index, (self._least(trial, bound), np.inf)
                continue
            samples = self._poses.whole(self.case.requirements.headings(bound), self.density)
            heights = trial.heights(bound.z)
            if not len(heights):
                continue
            try:
                design = trial.design
            except InvalidDesign:
                yield index, (-np.inf, np.inf)
                continue
            low, high = np.inf, -np.inf
            for x, y in samples.place(samples.within, trial.workspace):
                grid = Grid.over((x, y, 0.0, 0.0), theta=samples.theta, z=heights)
                values = bound.entry.over(solve_field(design.geometry, grid, threads=1), design)
                if not np.isfinite(values).all():
                    low, high = -np.inf, np.inf
                    break
                low, high = min(low, values.min()), max(high, values.max())
            yield index, (float(low), float(high))

    @cached_property
    def _clearances(self) -> tuple[int, ...]:
        """Indices of the bounds on the least clearance, which is looked at last."""
        bounds = enumerate(self.case.requirements.bounds)
        return tuple(i for i, b in bounds if b.quantity == CLEARANCE and b.high is None)

    def _least(self, trial: TrialRobot, bound: Requirement) -> float:
        """Return the least value of a quantity that is measured in single poses; NaN without any.

        On sparse samples, and beyond those of a trial (`TRIAL`) by a pattern search as well.
        """
        headings = self.case.requirements.headings(bound)
        extent = Extent(trial.workspace, headings).within(bound.z)
        if extent is None:
            return np.nan
        try:
            design = trial.drawn if bound.quantity == CLEARANCE else trial.design
        except InvalidDesign:
            return -np.inf
        if self.density == TRIAL:
            return least_on_samples(bound.quantity, design, extent)
        density = SPARSE.finer(CLOSER if bound.entry.cost < SLOW else 1)
        return least_of(bound.quantity, design, extent, density).value
