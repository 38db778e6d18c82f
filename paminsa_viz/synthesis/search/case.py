"""What a synthesis is about: requirements, lengths that are free, and what is to be least."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property

import numpy as np

from paminsa_viz.checks import require_at_least, require_range, require_seed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import geometry_of
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, MECHANISM_PATHS, Design
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.model.resizing import IN_PROPORTION, BarLaw, resized
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace
from paminsa_viz.synthesis.masses.case import InnerCase, check_inner
from paminsa_viz.synthesis.search.objectives import find_objective

GUIDE = "geometry.guide_link_length"
ARM = "geometry.arm_length"
SHAFT = "geometry.shaft_length"
CLEARANCE = "clearance"
"""Quantity of the registry whose least value says that no two bodies overlap as they are drawn."""
REACH = "reach_margin"
"""Quantity of the registry that is the distance to the nearest limit of reach."""

DIMENSIONS: dict[str, str] = {
    "workspace.z": "height of the workspace’s center",
    "workspace.width": "diameter of the workspace, or its extent along x and y",
    "workspace.height": "height of the workspace",
}
"""What else than lengths can be searched [m]: place and size of the workspace."""

DEFAULT_PATHS = (
    "geometry.base_radius", "geometry.platform_radius", "geometry.magnification",
    "geometry.crank_length", "geometry.coupler_length",
)  # fmt: skip
"""Lengths searched by default: R_b, R_pl, k, and the bars B3 and B8, B4."""


class Regime(Enum):
    """Which of base and platform is larger.

    With R_pl < R_b the robot is singular at |theta| = acos(R_pl/R_b), with R_pl > R_b at none; at
    R_pl = R_b it is singular at home.
    """

    SMALLER = "R_pl < R_b"
    LARGER = "R_pl > R_b"

    @property
    def sign(self) -> float:
        """Sign of R_b - R_pl."""
        return 1.0 if self is Regime.SMALLER else -1.0


class Guide(Enum):
    """What the guide link B10 is like in a robot of other lengths."""

    FOLLOWS = "follows"  # as long as the workspace takes
    KEPT = "kept"  # the reference's, unless it is searched


@dataclass(frozen=True)
class SearchRange:
    """A number that is searched.

    Attributes:
        path: Path of a length of the design, or one of `DIMENSIONS`.
        low, high: Least and largest value [SI].

    Raises:
        InvalidInput: If there is no such number, or the range is empty.
    """

    path: str
    low: float
    high: float

    def __post_init__(self) -> None:
        if self.path not in MECHANISM_PATHS and self.path not in DIMENSIONS:
            known = ", ".join((*DEFAULT_PATHS, *DIMENSIONS))
            raise InvalidInput(self.path, f"only lengths can be searched, such as {known}")
        require_range(self.low, self.high, self.path)
        if self.path != "workspace.z" and self.low <= 0:
            raise InvalidInput(self.path, f"the least value has to be above 0, not {self.low!r}")


UNLIMITED = 1e12
"""A limit that is none, so that a search returns an objective's value next to another."""


@dataclass(frozen=True)
class ObjectiveLimit:
    """The largest value that an objective may have, next to the one that is minimized.

    Attributes:
        objective: Key of an objective.
        most: Its largest value, the least one of an objective that is maximized [SI].

    Raises:
        InvalidInput: If there is no such objective, or the value is not finite.
    """

    objective: str
    most: float

    def __post_init__(self) -> None:
        find_objective(self.objective)
        if not math.isfinite(self.most):
            raise InvalidInput(self.objective, f"a finite limit is needed, not {self.most!r}")

    @property
    def is_limit(self) -> bool:
        """Whether it is a limit, not only there for its objective's value."""
        return abs(self.most) < UNLIMITED

    def margin(self, value: float) -> float:
        """Return how far a value is inside the limit, negative outside [SI]."""
        return find_objective(self.objective).sign * (self.most - value)


@dataclass(frozen=True)
class Effort:
    """How long the search looks.

    Attributes:
        generations: Most generations of each regime.
        population: Trials in a generation for each number that is searched.
    """

    generations: int = 200
    population: int = 8

    def __post_init__(self) -> None:
        for name, least in (("generations", 1), ("population", 4)):
            value = getattr(self, name)
            if not (isinstance(value, int) and least <= value <= 100_000):
                raise InvalidInput(f"effort.{name}", f"{least} to 100000 is possible, not {value}")


@dataclass(frozen=True)
class SynthesisCase:
    """A question: which lengths meet the requirements and minimize an objective.

    theta counts from the heading at which each joint 5 is toward its own leg axis.

    Attributes:
        requirements: What has to hold, with the workspace over which it holds.
        ranges: What is searched. The height of the workspace is, too, where the workspace leaves
            it free; its range follows from the bars unless it is given as ``workspace.z``. A free
            x or y is taken as zero.
        reference: Where all other numbers come from.
        objective: Key of what is minimized.
        limits: Largest values of other objectives.
        bars: How masses, inertias and sections of the bars follow their lengths.
        guide: Whether B10 follows the workspace.
        arm_follows: Whether the arms B1 grow with R_b, so that they end at their leg axes as those
            of the reference do. Where they do not, they are drawn through joint 1.
        shaft_follows: Whether the shafts B2 are as long as the drawn bodies need over the
            workspace, where bodies must not overlap and l_B2 is not searched.
        allow_overlap: Whether bodies may overlap as they are drawn. If not, and no bound on
            ``clearance`` is among the requirements, one is added to them; if so, that one is left
            out of them again.
        clearance: That bound: the least distance of two drawn bodies over the workspace [m].
        margin: Least distance to every limit of reach over the workspace [m].
        above_guides: Whether joints 5 may be above the guides (with the lower knee; below them
            with the upper one).
        regimes: Which of R_pl < R_b and R_pl > R_b are searched.
        inner: Masses, counterweights and springs to choose for each set of lengths, and motions;
            its bounds are those of the requirements, its goal the objective if it can be.
        seed: The same seed gives the same result.
        effort: How long to search.
        name: What a person calls it.

    Raises:
        InvalidInput: If something is missing or contradicts itself; says what.
    """

    requirements: Requirements
    ranges: tuple[SearchRange, ...]
    reference: Design = APPENDIX_4
    objective: str = "footprint"
    limits: tuple[ObjectiveLimit, ...] = ()
    bars: BarLaw = IN_PROPORTION
    guide: Guide = Guide.FOLLOWS
    arm_follows: bool = True
    shaft_follows: bool = True
    allow_overlap: bool = False
    clearance: float = 0.001
    margin: float = 0.001
    above_guides: bool = False
    regimes: tuple[Regime, ...] = (Regime.SMALLER, Regime.LARGER)
    inner: InnerCase | None = None
    seed: int = 0
    effort: Effort = field(default_factory=Effort)
    name: str = field(default="synthesis", compare=False)

    def __post_init__(self) -> None:
        workspace = self.requirements.workspace
        if workspace is None:
            raise InvalidInput("workspace", "a workspace is needed, over which requirements hold")
        x, y, z = workspace.center
        if x is None or y is None:  # the robot is alike about its axis
            workspace = replace(workspace, center=(x or 0.0, y or 0.0, z))
            required = replace(self.requirements, workspace=workspace)
            object.__setattr__(self, "requirements", required)
        check_inner(self.inner, (self.objective, *(limit.objective for limit in self.limits)))
        find_objective(self.objective)
        paths = [item.path for item in self.ranges]
        if not paths:
            raise InvalidInput("ranges", "at least one length has to be searched")
        for path in paths:
            if paths.count(path) > 1:
                raise InvalidInput(path, "it is searched twice")
        if "workspace.z" in paths and workspace.center[2] is not None:
            raise InvalidInput("workspace.z", "it is given by the workspace’s center already")
        if GUIDE in paths and self.guide is Guide.FOLLOWS:
            raise InvalidInput(GUIDE, 'it is searched only with guide = "kept"')
        if ARM in paths and self.arm_follows:
            raise InvalidInput(ARM, "it is searched only with arm_follows = false")
        require_at_least(self.margin, "margin", what="at least 0")
        require_at_least(self.clearance, "clearance", what="at least 0")
        apart = Requirement(CLEARANCE, low=self.clearance)
        bounds = self.requirements.bounds
        if self.allow_overlap:  # of a case that did not allow it
            bounds = tuple(bound for bound in bounds if bound != apart)
        elif not self.clear:
            bounds = (*bounds, apart)
        object.__setattr__(self, "requirements", replace(self.requirements, bounds=bounds))
        require_seed(self.seed)
        if not self.regimes:
            raise InvalidInput("regimes", "at least one of R_pl < R_b and R_pl > R_b is needed")
        if workspace.center[2] is None and "workspace.z" not in paths:
            object.__setattr__(self, "ranges", (*self.ranges, self._heights(workspace)))

    def _heights(self, workspace: Workspace) -> SearchRange:
        """Return heights of the center that the longest bars may reach."""
        bars = self.most("geometry.crank_length") + self.most("geometry.coupler_length")
        if self.above_guides:
            return SearchRange("workspace.z", -bars, bars)
        side = -self.reference.geometry.knee.sign
        near, far = sorted((side * min(0.5 * workspace.size[2], 0.999 * bars), side * bars))
        offset = self.reference.geometry.platform_joint_height
        return SearchRange("workspace.z", near - offset, far - offset)

    @property
    def clear(self) -> bool:
        """Whether it is required that no two bodies overlap as they are drawn."""
        return any(
            bound.quantity == CLEARANCE and bound.low is not None and bound.low >= 0
            for bound in self.requirements.bounds
        )

    @property
    def title(self) -> str:
        """What designs of its answer are called; it says where bodies may overlap."""
        return self.name if self.clear else f"{self.name}, overlap allowed"

    @property
    def workspace(self) -> Workspace:
        """The required workspace."""
        assert self.requirements.workspace is not None  # see __post_init__
        return self.requirements.workspace

    @cached_property
    def paths(self) -> tuple[str, ...]:
        """What is searched, in the order of the numbers of a trial."""
        return tuple(item.path for item in self.ranges)

    @property
    def bounds(self) -> Array:
        """Least and largest number of each path (n, 2) [SI]."""
        return np.array([(item.low, item.high) for item in self.ranges])

    def least(self, path: str) -> float:
        """Return the least value that a length may have [SI]."""
        return next((r.low for r in self.ranges if r.path == path), self._held(path))

    def most(self, path: str) -> float:
        """Return the largest value that a length may have [SI]."""
        return next((r.high for r in self.ranges if r.path == path), self._held(path))

    def _held(self, path: str) -> float:
        if path.startswith("workspace."):
            size = self.workspace.size
            held = {
                "z": self.workspace.center[2], "width": max(size[0], size[1]), "height": size[2]
            }[path.partition(".")[2]]  # fmt: skip
            return math.nan if held is None else held
        return self.reference.value(path)

    def split(self, numbers: Array) -> tuple[dict[str, float], dict[str, float]]:
        """Return the lengths of a trial, and place and size of its workspace, by path."""
        lengths, places = {}, {}
        for path, value in zip(self.paths, numbers.tolist(), strict=True):
            (places if path in DIMENSIONS else lengths)[path] = value
        return lengths, places

    def geometry(self, numbers: Array) -> Geometry:
        """Return the lengths of a trial; B10 and B2, where they follow, are the reference's still.

        Raises:
            InvalidDesign: If no robot has them.
        """
        lengths, _ = self.split(numbers)
        changes = {path.partition(".")[2]: value for path, value in lengths.items()}
        if self.arm_follows and "base_radius" in changes:
            held = self.reference.geometry
            grown = changes["base_radius"] - held.base_radius
            changes["arm_length"] = max(held.arm_length + grown, 0.0)
        if self.guide is Guide.FOLLOWS:
            changes["guide_stroke"] = None  # type: ignore[assignment]
        return replace(self.reference.geometry, **changes)

    def workspace_of(self, numbers: Array) -> Workspace:
        """Return the workspace of a trial."""
        _, places = self.split(numbers)
        held = self.workspace
        if not places:
            return held
        x, y, z = held.center
        width = places.get("workspace.width")
        wide = held.size[:2] if width is None else (width, width * (held.size[1] / held.size[0]))
        height = places.get("workspace.height", held.size[2])
        return replace(held, size=(*wide, height), center=(x, y, places.get("workspace.z", z)))

    def design(self, geometry: Geometry | Design) -> Design:
        """Return the robot with some lengths; its masses follow them if they do in this case.

        Raises:
            InvalidDesign: If no robot has them.
        """
        geometry = geometry_of(geometry)
        changes = {
            f"geometry.{name}": getattr(geometry, name)
            for name in Geometry.__dataclass_fields__
            if name != "knee" and getattr(geometry, name) != getattr(self.reference.geometry, name)
        }
        return resized(self.reference, changes, self.bars)
