"""Trial robots: what is known of them before any pose is evaluated, and values over the poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from paminsa_viz.dimensions.body_scale import geometry_over_scale
from paminsa_viz.dimensions.layers import LAYER, TUBE_RADIUS
from paminsa_viz.dimensions.layout import plate_corners
from paminsa_viz.dimensions.needs import (
    PLATE_FROM_5,
    missing_room,
    needed_guide,
    needed_shaft,
)
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.model.leg import Mechanism, mechanism
from paminsa_viz.model.load import generalized_force
from paminsa_viz.model.parameters import LARGEST
from paminsa_viz.model.resizing import resized_coefficients, resized_masses
from paminsa_viz.quantities.registry import TORQUES
from paminsa_viz.quantities.requirements import Range, Workspace
from paminsa_viz.synthesis.masses.program import InnerSolution
from paminsa_viz.synthesis.search import kernels
from paminsa_viz.synthesis.search.case import CLEARANCE, REACH, SHAFT, Guide, SynthesisCase
from paminsa_viz.synthesis.search.region import (
    SPARSE,
    TRIAL,
    Density,
    Spans,
    TrialSamples,
    reach_margins,
    sample,
    spans,
)
from paminsa_viz.synthesis.volume.margins import Columns

SPARE = 1e-9
"""What guides that follow are longer than the workspace takes, against rounding [m]."""


ABOVE_QUILL = 0.01
"""What shafts that follow are longer than they need be, so that other bodies decide, for bodies of
the prototype's size [m]."""


@dataclass(frozen=True, eq=False)
class Poses:
    """The poses at which trials of a case are evaluated.

    Attributes:
        case: The case.
        density: How close they lie.
    """

    case: SynthesisCase
    density: Density = TRIAL

    @cached_property
    def alike(self) -> bool:
        """Whether no bound and no load tells the legs from each other."""
        load = self.case.reference.load
        single = {b.quantity for b in self.case.requirements.bounds} & set(TORQUES)
        turned = any((load.force_x, load.force_y, load.moment_z))
        return not single and not turned

    @cached_property
    def _kept(self) -> dict[Range, TrialSamples]:
        return {}

    @cached_property
    def _whole(self) -> dict[tuple[Range, Density], TrialSamples]:
        return {}

    def over(self, theta: Range) -> TrialSamples:
        """Return the samples of the workspace with some headings."""
        if theta not in self._kept:
            found = sample(self.case.workspace, theta, self.density, alike=self.alike)
            force = generalized_force(self.case.reference.load, found.theta)[:, :3]
            self._kept[theta] = replace(found, wrench=np.ascontiguousarray(force))
        return self._kept[theta]

    def whole(self, theta: Range, density: Density) -> TrialSamples:
        """Return samples of all legs, for what is of one of them, of x or y, or of drawn bodies."""
        if (theta, density) not in self._whole:
            self._whole[theta, density] = sample(self.case.workspace, theta, density)
        return self._whole[theta, density]

    def __reduce__(self) -> tuple[type[Poses], tuple[SynthesisCase, Density]]:
        """Send what the rest follows from."""
        return Poses, (self.case, self.density)


@dataclass(frozen=True, eq=False)
class TrialRobot:
    """A robot that reaches its workspace.

    Attributes:
        poses: Where it is evaluated.
        numbers: What was searched, in the order of the case's paths [SI].
        geometry: Its lengths.
        workspace: Its workspace, at its height.
        masses: In the order of `lumped.MASS_PATHS` (28,) [kg, kg m^2].
        coefficients: Lumped coefficients (18,).
        inner: The best masses and springs, where some are free; masses and coefficients are
            those with them.
    """

    poses: Poses
    numbers: Array
    geometry: Geometry
    workspace: Workspace
    masses: Array
    coefficients: Array
    inner: InnerSolution | None = None

    @property
    def case(self) -> SynthesisCase:
        """The case."""
        return self.poses.case

    @property
    def reference(self) -> Design:
        """The robot that the search starts from."""
        return self.case.reference

    @cached_property
    def design(self) -> Design:
        """The robot."""
        if self.inner is not None:
            return self.inner.design
        return self.case.design(self.geometry)

    @property
    def drawn(self) -> Design:
        """A robot that is drawn as it is: its masses do not follow, but for counterweights."""
        owner = self.case.reference if self.inner is None else self.inner.design
        return replace(owner, geometry=self.geometry)

    @cached_property
    def mechanism(self) -> Mechanism:
        """Its lengths in the form the formulas need."""
        return mechanism(self.geometry)

    def heights(self, z: Range | None = None) -> Array:
        """Return heights of the workspace (n,) [m], within a range; none if it is outside."""
        middle, height = self.workspace.center[2], self.workspace.size[2]
        assert middle is not None
        share = self.poses.over(self.case.requirements.theta).share
        if z is None:
            return middle + height * share
        low, high = max(z[0], middle - 0.5 * height), min(z[1], middle + 0.5 * height)
        if low > high:
            return np.empty(0)
        return 0.5 * (low + high) + (high - low) * share

    def condition(self, theta: Range) -> tuple[float, float]:
        """Return the least and largest condition number over headings."""
        found = self.poses.over(theta)
        z = float(self.heights()[0])
        xy = found.place(found.within, self.workspace)
        return kernels.load()[0](self.mechanism, xy, found.turns, z)

    def torques(self, theta: Range, z: Range | None = None) -> Array:
        """Return the least and largest of `kernels.TORQUE_COLUMNS` over headings and heights.

        (2, 6) [N m, N]; infinite without a finite value everywhere, NaN without poses.
        """
        heights = self.heights(z)
        if self.inner is not None and self.inner.springs:
            return self._sprung(theta, heights)
        out = np.full((2, len(kernels.TORQUE_COLUMNS)), np.nan)
        if not len(heights):
            return out
        found = self.poses.over(theta)
        c, load = self.coefficients, self.reference.load
        k, g = self.geometry.magnification, self.reference.gravity
        lift = k * (c[16] * g + 3 * c[0]) + 3 * c[2] - k * load.force_z
        xy = found.place(found.within, self.workspace)
        kernels.load()[1](
            self.mechanism, float(c[1]), float(lift), found.wrench, xy, found.turns, heights, out
        )
        return out

    def grid(self, theta: Range, heights: Array) -> Array:
        """Return the poses of headings and heights (h,), (n, 4)."""
        found = self.poses.over(theta)
        xy = found.place(found.within, self.workspace)
        return Columns.at(xy, found.theta, heights).poses().reshape(-1, 4)

    def _sprung(self, theta: Range, heights: Array) -> Array:
        """Return what `torques` returns of a robot with springs."""
        if not len(heights):
            return np.full((2, len(kernels.TORQUE_COLUMNS)), np.nan)
        assert self.inner is not None
        held = self.inner.held(self.grid(theta, heights))
        rotary = held[:, :3]
        both = np.abs(rotary).max(axis=1), np.sqrt((rotary**2).mean(axis=1))
        columns = np.column_stack([held, *both])
        if not np.isfinite(columns).all():
            return np.repeat([[-np.inf], [np.inf]], columns.shape[1], axis=1)
        return np.array([columns.min(axis=0), columns.max(axis=0)])

    def plate_distance(self, theta: Range, enough: float) -> float:
        """Return the least distance of a tube B4 from the platform's plate [m].

        Negative where they overlap, ``enough`` where it is more than that; on sparse samples.
        """
        found = self.poses.whole(theta, SPARSE)
        xy = found.place(found.within, self.workspace)
        middle, height = float(self.workspace.center[2] or 0.0), self.workspace.size[2]
        scale, geometry = self.geometry.body_scale, geometry_over_scale(self.geometry)
        corners = plate_corners(geometry.platform_radius)
        return scale * float(
            kernels.load()[3](
                mechanism(geometry), LAYER["b4"], TUBE_RADIUS["b4"], corners, *PLATE_FROM_5,
                enough / scale, xy / scale, found.turns, (middle + height * found.share) / scale,
            )
        )  # fmt: skip

    @cached_property
    def radii(self) -> Array:
        """Largest radii about z of joints 5, 8, 9 and the guides' ends over the workspace (4,) [m].

        Those of the knees may be largest inside the workspace.
        """
        found = self.poses.over(self.case.requirements.theta)
        out = np.empty(4)
        guide = self.geometry.guide_link_length
        xy = found.place(found.within, self.workspace)
        kernels.load()[2](self.mechanism, guide, xy, found.turns, self.heights(), out)
        return np.sqrt(out)

    @property
    def footprint(self) -> float:
        """Largest of the radii, R_f [m]."""
        return float(self.radii.max())

    @cached_property
    def _most(self) -> Array:
        """Largest of `kernels.TORQUE_COLUMNS` over the workspace."""
        return self.torques(self.case.requirements.theta)[1]

    @property
    def static_torque(self) -> float:
        """Largest static torque of M1 to M3 over the workspace [N m]."""
        return float(self._most[kernels.TORQUE_COLUMNS.index("max_torque")])


@dataclass(frozen=True, eq=False)
class Robots:
    """Lengths and workspaces of n trials, and what follows without looking at single poses.

    Attributes:
        case: The case.
        numbers: What was searched (n, d) [SI].
        possible: Which of them are robots (n,); the rest has p rows, one for each of those.
        geometries: Their lengths, with B10 as it follows.
        workspaces: Their workspaces.
        spans: Ranges of the legs' lengths (p,).
        margins: Least margins of reach (p, 4) [m].
    """

    case: SynthesisCase
    numbers: Array
    possible: Array
    geometries: list[Geometry]
    workspaces: list[Workspace]
    spans: Spans
    margins: Array

    @classmethod
    def of(cls, case: SynthesisCase, numbers: Array) -> Robots:
        """Return the robots of some numbers (n, d)."""
        possible = np.ones(len(numbers), bool)
        geometries: list[Geometry] = []
        for index, row in enumerate(numbers):
            try:
                geometries.append(case.geometry(row))
            except InvalidDesign:
                possible[index] = False
        workspaces = [case.workspace_of(row) for row in numbers[possible]]
        if not geometries:
            none = np.empty(0)
            return cls(case, numbers, possible, [], [], Spans(*[none] * 5), np.empty((0, 4)))
        found = spans(geometries, workspaces, case.requirements.theta)
        following = _following(case, geometries, found)
        geometries = [
            replace(geometry, **{name: float(lengths[i]) for name, lengths in following.items()})
            for i, geometry in enumerate(geometries)
        ]
        margins = reach_margins(geometries, found)
        return cls(case, numbers, possible, geometries, workspaces, found, margins)

    def missing_room(self, clearance: float) -> Array:
        """Return how much is missing of what the drawn bodies need (p, 4), see `needs` [m]."""
        k = np.array([g.magnification for g in self.geometries])
        found = self.spans
        zeta = np.stack([found.zeta_least, found.zeta_most], axis=-1)
        return missing_room(
            self.geometries, found.rho_least / (k - 1), zeta, found.diagonals(k), clearance
        )

    def trials(self, poses: Poses, which: Sequence[int]) -> list[TrialRobot]:
        """Return some of the p robots with their masses."""
        case = self.case
        geometries = [self.geometries[i] for i in which]
        if not geometries:
            return []
        masses = resized_masses(case.reference, geometries, case.bars)
        coefficients = resized_coefficients(case.reference, geometries, masses)
        rows = np.flatnonzero(self.possible)
        return [
            TrialRobot(poses, self.numbers[rows[i]], g, self.workspaces[i], m, c)
            for i, g, m, c in zip(which, geometries, masses, coefficients, strict=True)
        ]


def _following(
    case: SynthesisCase, geometries: Sequence[Geometry], found: Spans
) -> dict[str, Array]:
    """Return the lengths of guides and shafts that follow the workspace, (p,) of each [m].

    None is above the largest that a design may have: such a robot is refused as too short.
    """
    k = np.array([g.magnification for g in geometries])
    scale = case.reference.geometry.body_scale
    lengths = {}
    if case.guide is Guide.FOLLOWS:
        slider = found.rho_most / (k - 1)
        asked = (b.low or 0.0 for b in case.requirements.bounds if b.quantity == REACH)
        length = slider + max(case.margin, *asked, 0.0)
        if case.clear:
            length = np.maximum(length, needed_guide(slider, scale))
        lengths["guide_link_length"] = length + SPARE
    if case.shaft_follows and case.clear and SHAFT not in case.paths:
        apart = max(b.low or 0.0 for b in case.requirements.bounds if b.quantity == CLEARANCE)
        shaft = needed_shaft(case.reference, found.zeta_most, k)
        lengths["shaft_length"] = shaft + apart + scale * ABOVE_QUILL
    return {name: np.minimum(length, LARGEST["m"]) for name, length in lengths.items()}
