"""Changes to a design: masses within bounds, and counterweights on bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.balancing.program import Levers, Variable
from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design, of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import PARAMETER, Design, Geometry
from paminsa_viz.model.leg_points import bar_length, bar_point, counterweight_point
from paminsa_viz.model.lumped import (
    COEFFICIENTS,
    MASS_PATHS,
    lumped_coefficients,
    lumped_matrix,
    point_mass_column,
)
from paminsa_viz.model.parameters import BAR_ENDS, LARGEST, Counterweight
from paminsa_viz.model.statics import BODIES

LEGS = 3
"""A mass of a leg is there three times."""

MOST = LARGEST["kg"]
"""Largest mass of a design [kg]."""

MASS = len(COEFFICIENTS)
"""Place of the robot's whole mass in the state, after the lumped coefficients."""

AMOUNTS = MASS + 1
"""Place of the first of the amounts that may change in the state."""

SAME_PLACE = 1e-9
"""Distance of counterweights that are at one place [m]."""


@dataclass(frozen=True)
class MassRange:
    """A mass that may change.

    Attributes:
        path: Its path in the design, such as ``"links.b3"`` or ``"counterweights.0.mass"``.
        low, high: Bounds [kg], on each leg where it belongs to one.
        inertia_follows: Whether a link's moments of inertia change in proportion to its mass, as
            those of a thicker tube do; without it they stay as they are.
    """

    path: str
    low: float
    high: float
    inertia_follows: bool = True

    def __post_init__(self) -> None:
        if not 0 <= self.low <= self.high <= MOST:
            problem = (
                f"0 <= low <= high <= {MOST:g} kg is needed, not {self.low!r} to {self.high!r}"
            )
            raise InvalidInput(self.path, problem)

    @property
    def per_robot(self) -> int:
        """How many times the robot has this mass."""
        return 1 if self.path.startswith(("platform.", "payload.")) else LEGS


@dataclass(frozen=True)
class CounterweightRange:
    """Where counterweights may be put: a part of a bar or of its extension, on every leg.

    Attributes:
        bar, joint: As in `Counterweight`.
        nearest, farthest: Range of its ``beyond`` [m]; equal for one fixed place.
        high: Most mass on each leg [kg].
        low: Least mass [kg].
    """

    bar: str
    joint: int
    nearest: float
    farthest: float
    high: float
    low: float = 0.0

    def __post_init__(self) -> None:
        for lever, mass in ((self.nearest, self.low), (self.farthest, self.high)):
            Counterweight(self.bar, self.joint, lever, mass)
        if not (self.nearest <= self.farthest and self.low <= self.high):
            raise InvalidInput(
                self.name, f"nearest <= farthest and low <= high are needed, not {self.nearest!r} "
                f"to {self.farthest!r} m and {self.low!r} to {self.high!r} kg",
            )  # fmt: skip

    @property
    def name(self) -> str:
        """The bar and the joint, in words."""
        return f"counterweight on {self.bar.upper()} from joint {self.joint}"


@kinds_checked
def beyond(bar: str, joint: int, longest: float, most: float) -> CounterweightRange:
    """Return the range on a bar's extension beyond a joint, up to a lever [m] and a mass [kg]."""
    return CounterweightRange(bar, joint, 0.0, longest, most)


@of_geometry
def along(geometry: Geometry, bar: str, most: float) -> CounterweightRange:
    """Return the range between the two joints of a bar, up to a mass [kg].

    Raises:
        InvalidInput: If the bar can carry no counterweight.
    """
    if bar not in BAR_ENDS:
        raise InvalidInput("bar", f"one of {', '.join(BAR_ENDS)} is needed, not {bar!r:.60}")
    return CounterweightRange(bar, BAR_ENDS[bar][0], -bar_length(geometry, bar), 0.0, most)


@dataclass(frozen=True)
class Changes:
    """What may change in a design; everything else stays as it is.

    Attributes:
        masses: Masses of the design and their bounds.
        counterweights: Places for more counterweights.
    """

    masses: tuple[MassRange, ...] = ()
    counterweights: tuple[CounterweightRange, ...] = ()

    def __post_init__(self) -> None:
        paths = [mass.path for mass in self.masses]
        for path in paths:
            if paths.count(path) > 1:
                raise InvalidInput(path, "this mass is in the list of changes twice")


@dataclass(frozen=True, eq=False)
class MassSpace:
    """The designs that changes can make of one design, as states of a program.

    The state is (c, mass, amounts): the 18 lumped coefficients, the robot's whole mass, and the
    masses that may change [kg]. It is linear in the masses; along a range it is a parabola in the
    lever, as the inertia of a point mass grows with the square of its lever.

    Attributes:
        design: The design to change.
        changes: What may change.
        start: (19 + n,) state with all that may change removed.
        variables: (n) what may change: the masses, then the counterweight ranges.
        before: (19 + n,) state of the design as it is; its amounts are those of one leg where they
            belong to a leg.
        counts: (n,) how many times the robot has each.
    """

    design: Design
    changes: Changes
    start: Array
    variables: tuple[Variable, ...]
    before: Array
    counts: Array

    def design_of(self, levers: Levers) -> Design:
        """Return the design for a choice; ranges without mass leave no counterweight."""
        numbers: dict[str, float | None] = {}
        masses = self.changes.masses
        for mass, ((_, amount),) in zip(masses, levers, strict=False):
            held = self.design.value(mass.path)
            numbers[mass.path] = amount
            if held > 0:
                for path in _inertias(mass):
                    # In this order an unchanged mass leaves its inertia to the last digit.
                    numbers[path] = self.design.value(path) * (amount / held)
        added = tuple(
            Counterweight(item.bar, item.joint, lever, amount)
            for item, places in zip(self.changes.counterweights, levers[len(masses) :], strict=True)
            for lever, amount in places
            if amount > 0
        )
        changed = self.design.vary(numbers)
        return replace(changed, counterweights=with_weights(changed.counterweights, added))


def with_weights(
    held: Sequence[Counterweight], added: Sequence[Counterweight]
) -> tuple[Counterweight, ...]:
    """Return counterweights with more of them; one that is added where one is makes it heavier."""
    weights = list(held)
    for weight in added:
        for number, other in enumerate(weights):
            near = abs(other.beyond - weight.beyond) < SAME_PLACE
            if near and (other.bar, other.joint) == (weight.bar, weight.joint):
                weights[number] = replace(other, mass=other.mass + weight.mass)
                break
        else:
            weights.append(weight)
    return tuple(weights)


def _inertias(mass: MassRange) -> list[str]:
    """Return the paths of the inertias that follow a mass."""
    group, _, name = mass.path.partition(".")
    if group != "links" or not mass.inertia_follows:
        return []
    return [path for path in MASS_PATHS if path.startswith(f"inertias.{name}_")]


@of_design
def whole_mass(design: Design) -> float:
    """Return the mass of all that moves, all three legs, platform and payload [kg]."""
    legs = sum(map(design.value, BODIES))
    legs += sum(weight.mass for weight in design.counterweights)
    return LEGS * legs + design.platform.mass + design.payload.mass


def mass_space(design: Design, changes: Changes) -> MassSpace:
    """Return the designs that changes can make of a design.

    Raises:
        InvalidInput: If a path is not that of a mass.
    """
    matrix = lumped_matrix(design.geometry, design.gravity)
    size = AMOUNTS + len(changes.masses) + len(changes.counterweights)
    before = np.zeros(size)
    before[:MASS], before[MASS] = lumped_coefficients(design), whole_mass(design)
    start = before.copy()
    variables: list[Variable] = []
    for place, mass in enumerate(changes.masses, AMOUNTS):
        held = design.value(mass.path)
        effect = np.zeros((3, size))
        effect[0, :MASS], effect[0, MASS] = _column(design, mass, matrix), mass.per_robot
        start -= held * effect[0]
        before[place], effect[0, place] = held, 1.0
        variables.append(Variable(mass.path, mass.low, mass.high, effect))
    for place, item in enumerate(changes.counterweights, AMOUNTS + len(changes.masses)):
        # a parabola is known from three of its points
        point = bar_point(design.geometry, item.bar, item.joint, np.array([-1.0, 0.0, 1.0]))
        left, middle, right = point_mass_column(point, design.gravity).T
        effect = np.zeros((3, size))
        effect[0, :MASS], effect[0, MASS], effect[0, place] = middle, LEGS, 1.0
        effect[1, :MASS], effect[2, :MASS] = 0.5 * (right - left), 0.5 * (right + left) - middle
        span = (item.nearest, item.farthest)
        variables.append(Variable(item.name, item.low, item.high, effect, span))
    counts = [mass.per_robot for mass in changes.masses] + [LEGS] * len(changes.counterweights)
    return MassSpace(design, changes, start, tuple(variables), before, np.array(counts, float))


def _column(design: Design, mass: MassRange, matrix: Array) -> Array:
    """Return what 1 kg of a mass adds to c, (18,)."""
    group, _, rest = mass.path.partition(".")
    if group == "counterweights":
        number, _, name = rest.partition(".")
        if name == "mass" and number.isdecimal() and int(number) < len(design.counterweights):
            weight = design.counterweights[int(number)]
            return point_mass_column(counterweight_point(design.geometry, weight), design.gravity)
    elif mass.path in MASS_PATHS and PARAMETER[mass.path].unit == "kg":
        column = matrix[:, MASS_PATHS.index(mass.path)].copy()
        held = design.value(mass.path)
        for path in _inertias(mass):
            share = design.value(path) / held if held > 0 else 0.0
            column += share * matrix[:, MASS_PATHS.index(path)]
        return column
    raise InvalidInput(mass.path, "this is no mass of the design")
