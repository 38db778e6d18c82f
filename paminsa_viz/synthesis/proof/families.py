"""Requirements that can be proven: margins over boxes of poses and at poses, and their symmetry.

Turning (x, y) by 120 degrees with theta kept exchanges the legs, and so does the mirror image
(-x, y, -theta). What does not tell legs apart has the same values there, apart from rounding, for
which `SLACK` is kept free.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import static_torques
from paminsa_viz.quantities.requirements import Range, Requirement, Requirements
from paminsa_viz.synthesis.proof.enclosures import (
    condition_bounds,
    determinant_bounds,
    static_bounds,
)
from paminsa_viz.synthesis.proof.regions import PoseRegion

EVERYWHERE: Range = (-np.inf, np.inf)
"""A requirement's heights where it names none."""


Ranges = dict[str, tuple[Array, Array]]
"""Least and largest values over boxes (n,) by key."""


class Method(Enum):
    """How a requirement is answered for."""

    CLOSED_FORM = "closed form"
    BISECTION = "interval bisection"
    SAMPLED = "sampled, not proven"


@dataclass(frozen=True)
class Family:
    """Quantities that are bounded by the same formula.

    Attributes:
        keys: Quantities with the sides that can be proven: ``(low, high)``.
        ranges: ``ranges(design, middle, half)`` returns least and largest values over boxes (n, 4)
            by key, each (n,); NaN or infinite for no bound.
        values: ``values(design, poses)`` returns the values at poses (n, 4) by key, each (n,).
        by_height: Whether they depend on z.
    """

    keys: dict[str, tuple[bool, bool]]
    ranges: Callable[[Design, Array, Array], Ranges]
    values: Callable[[Design, Array], dict[str, Array]]
    by_height: bool


def _condition_ranges(design: Design, middle: Array, half: Array) -> Ranges:
    most = condition_bounds(design, middle, half)
    least = np.ones_like(most)
    return {"condition": (least, most), "conditioning": (1 / most, least)}


def _dexterity(design: Design, poses: Array) -> dict[str, Array]:
    determinant, condition = backend.over_list(DEXTERITY, mechanism(design.geometry), poses).T
    return {"determinant": determinant, "condition": condition, "conditioning": 1 / condition}


def _determinant_ranges(design: Design, middle: Array, half: Array) -> Ranges:
    low, high = determinant_bounds(design, middle, half)
    return {"determinant": (low[:, 0], high[:, 0])}


_TORQUES = ("tau_1", "tau_2", "tau_3", "f_4")


def _static_ranges(design: Design, middle: Array, half: Array) -> Ranges:
    low, high = static_bounds(design, middle, half)
    found = {key: (low[:, i], high[:, i]) for i, key in enumerate(_TORQUES)}
    largest = np.maximum(-low[:, :3], high[:, :3]).max(axis=1)
    none = np.zeros_like(largest)
    found["max_torque"] = none, largest
    found["rms_torque"] = none, np.sqrt(high[:, 4]) * (1 + 1e-15)
    return found


def _static_values(design: Design, poses: Array) -> dict[str, Array]:
    torque = static_torques(design, poses)
    found = {key: torque[:, i] for i, key in enumerate(_TORQUES)}
    found["max_torque"] = np.abs(torque[:, :3]).max(axis=1)
    found["rms_torque"] = np.sqrt((torque[:, :3] ** 2).mean(axis=1))
    return found


FAMILIES: tuple[Family, ...] = (
    Family(
        {"condition": (False, True), "conditioning": (True, False)},
        _condition_ranges, _dexterity, by_height=False,
    ),
    Family(
        {"determinant": (True, True)},
        _determinant_ranges, _dexterity, by_height=False,
    ),
    Family(
        dict.fromkeys(_TORQUES, (True, True))
        | {"max_torque": (False, True), "rms_torque": (False, True)},
        _static_ranges, _static_values, by_height=True,
    ),
)  # fmt: skip
"""What can be proven by bisection; those of fewer coordinates come first, as they cost least."""


@dataclass(frozen=True)
class BoundGroup:
    """Requirements of one family over the same headings and heights.

    Attributes:
        design: The robot.
        family: What bounds them.
        requirements: The requirements.
        theta: Headings over which they hold [rad].
        z: Heights over which they hold [m].
    """

    design: Design
    family: Family
    requirements: tuple[Requirement, ...]
    theta: Range
    z: Range

    @property
    def sizes(self) -> Array:
        """Sizes of the bounds, the larger one of each requirement (requirements,) [SI]."""
        pairs = [(abs(r.low or 0.0), abs(r.high or 0.0)) for r in self.requirements]
        return np.array(pairs).max(axis=1)

    def margins(self, middle: Array, half: Array) -> Array:
        """Return margins that no pose of a box is below, (n, requirements); NaN for none."""
        found = self.family.ranges(self.design, middle, half)
        return np.stack([_least_margin(r, *found[r.quantity]) for r in self.requirements], axis=-1)

    def pose_margins(self, poses: Array) -> Array:
        """Return margins at poses (n, 4), (n, requirements); NaN where a pose cannot be taken."""
        found = self.family.values(self.design, poses)
        return np.stack([r.margin(found[r.quantity]) for r in self.requirements], axis=-1)


def _least_margin(requirement: Requirement, least: Array, most: Array) -> Array:
    sides = []
    if requirement.low is not None:
        sides.append(least - requirement.low)
    if requirement.high is not None:
        sides.append(requirement.high - most)
    return np.minimum(sides[0], sides[-1])


def method(requirement: Requirement) -> Method:
    """Return how a requirement is answered for: only reach and `FAMILIES` can be proven."""
    if requirement.quantity == "reach_margin":
        return Method.CLOSED_FORM if requirement.high is None else Method.SAMPLED
    for family in FAMILIES:
        low, high = family.keys.get(requirement.quantity, (False, False))
        if (low or requirement.low is None) and (high or requirement.high is None):
            return Method.BISECTION if low or high else Method.SAMPLED
    return Method.SAMPLED


def groups(design: Design, requirements: Requirements) -> tuple[BoundGroup, ...]:
    """Return the requirements that are proven by bisection, those that belong together as one."""
    found: dict[tuple[int, Range, Range], list[Requirement]] = {}
    for requirement in requirements.bounds:
        if method(requirement) is Method.BISECTION:
            index = next(i for i, f in enumerate(FAMILIES) if requirement.quantity in f.keys)
            place = (index, requirements.headings(requirement), requirement.z or EVERYWHERE)
            found.setdefault(place, []).append(requirement)
    return tuple(
        BoundGroup(design, FAMILIES[index], tuple(found[index, theta, z]), theta, z)
        for index, theta, z in sorted(found)
    )


SLACK = 1e-11
"""Margin that is kept where a pose stands for others, as a share of the bound."""

_ALIKE = frozenset({"condition", "conditioning", "determinant", "f_4", "max_torque", "rms_torque"})
"""Quantities that do not tell legs apart, nor the two senses of a turn."""

_TANGENT = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Symmetry:
    """What poses have to be looked at.

    Attributes:
        third: Positions within 60 degrees of the y-axis stand for all.
        mirror: Headings from 0 on stand for all.
    """

    third: bool
    mirror: bool

    @property
    def any(self) -> bool:
        """Whether poses stand for others."""
        return self.third or self.mirror

    def kept(self, middle: Array, half: Array) -> NDArray[np.bool_]:
        """Return which boxes (n, 4) have poses that stand for others (n,)."""
        if not self.third:
            return np.ones(len(middle), np.bool_)
        nearest = np.maximum(np.abs(middle[:, 0]) - half[:, 0], 0.0)
        return middle[:, 1] + half[:, 1] >= nearest * _TANGENT - SLACK


NONE = Symmetry(False, False)
"""Every pose stands for itself."""


def symmetry(group: BoundGroup, region: PoseRegion) -> Symmetry:
    """Return the symmetry that requirements and the region have in common.

    A horizontal force or a vertical moment on the platform leaves none.
    """
    load = group.design.load
    alike = all(bound.quantity in _ALIKE for bound in group.requirements)
    if not alike or load.force_x or load.force_y or load.moment_z:
        return NONE
    x, y, _ = region.center
    low, high = group.theta
    third = region.shape.section.threefold and x == 0.0 and y == 0.0
    return Symmetry(third, x == 0.0 and low == -high and high > 0.0)
