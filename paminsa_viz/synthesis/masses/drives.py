"""Masses and drives together: each is chosen for the other, until neither changes.

The drives' inertia loads the motions, and what masses are best depends on it; which drives are
needed depends on the masses. Masses are solved exactly for the drives of the round before, drives
are the first feasible ones of a catalog. There is no certificate for both together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.selection import Selection, select_drives
from paminsa_viz.actuation.sizing import Order
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES, Drives
from paminsa_viz.synthesis.masses.case import InnerCase
from paminsa_viz.synthesis.masses.program import InnerSolution, solve_inner

ROUNDS = 6
"""Most rounds; drives come in sizes, so that two rounds mostly do."""


@dataclass(frozen=True, eq=False)
class DrivenSolution:
    """Masses with drives that fit them.

    Attributes:
        inner: The best masses for the drives.
        selection: The drives of the catalog on the motions of the robot with these masses.
        rounds: Rounds made.
        settled: Whether the last round changed no drive; if not, the drives of the last round but
            one are in the design, and the selection is what they led to.
    """

    inner: InnerSolution
    selection: Selection
    rounds: int
    settled: bool

    @property
    def feasible(self) -> bool:
        """Whether every actuator has a drive, and the masses are the best with it."""
        return self.selection.feasible and self.settled


def solve_with_drives(
    design: Design,
    case: InnerCase,
    pose: Array,
    catalog: Catalog,
    *,
    duties: Sequence[Duty] | None = None,
    order: Order = "mass",
    same: bool = False,
) -> DrivenSolution:
    """Return the best masses and the first drives that fit the motions with them.

    Args:
        design: The robot; drives of its own are replaced.
        case: What is free; without springs, which the sizing of drives does not know.
        pose: (n, 4) poses at which bounds at rest count [m, m, rad, m].
        catalog: Motors, gears, screws and belts.
        duties: The duty cycle; by default each motion of the case once.
        order: What the first of the feasible drives is by.
        same: Whether M1..M3 have to have the same drive.

    Raises:
        CatalogError: If the catalog lacks motors, gears, or screws and belts.
        InnerInfeasible: If a pose or a motion is out of reach, or no masses keep the limits.
        InvalidInput: If there are springs or no motions.
    """
    if case.springs:
        raise InvalidInput("springs", "drives can be chosen for robots without springs only")
    chosen = [Duty(motion) for motion in case.motions] if duties is None else list(duties)
    if not chosen:
        raise InvalidInput("motions", "drives are chosen for motions; at least one is needed")
    drives: Drives = NO_DRIVES
    number = 0
    while True:
        number += 1
        inner = solve_inner(replace(design, drives=drives), case, pose)
        found = select_drives(duty_cycle(inner.design, chosen), catalog, order=order, same=same)
        following = found.design(replace(inner.design, drives=NO_DRIVES)).drives
        if following == drives or number == ROUNDS:
            break
        drives = following
    return DrivenSolution(inner, found, number, following == drives)
