"""How round tubes compare with the masses and inertias of a design's links.

Appendix 4 gives masses and inertias, not sections. A tube of any wall can have a link's mass, but
its inertia about its middle then lies between m l^2 / 12 and little more, while Appendix 4's are
larger: what is at the bars' ends (forks, bearings) is in them. So sections cannot be read from the
paper, and have to be given.
"""

from __future__ import annotations

from typing import NamedTuple

from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import PANTOGRAPH


class TubeFit(NamedTuple):
    """A bar's tube beside the mass and inertias of the design; ratios are the design's over the
    tube's.

    Attributes:
        bar: Name, ``"B4"``.
        length: [m].
        mass: Mass of the tube [kg].
        mass_ratio: The link's mass over it.
        slender: m l^2 / 12 for the link's mass [kg m^2].
        slender_ratio: I_YY over it.
        transverse: The tube's inertia across, scaled to the link's mass [kg m^2].
        transverse_ratio: I_YY over it.
        axial: The tube's inertia along, scaled to the link's mass [kg m^2].
        axial_ratio: I_XX over it.
    """

    bar: str
    length: float
    mass: float
    mass_ratio: float
    slender: float
    slender_ratio: float
    transverse: float
    transverse_ratio: float
    axial: float
    axial_ratio: float


@of_design
def tube_fits(design: Design) -> tuple[TubeFit, ...]:
    """Compare the tubes of the pantograph's bars with the design's masses and inertias."""
    found = []
    for bar in PANTOGRAPH:
        length = bar_length(design.geometry, bar)
        section = design.elastic.section(bar)
        link = design.value(f"links.{bar}")
        mass = design.elastic.density * section.area * length
        slender = link * length**2 / 12
        squares = design.value(f"elastic.{bar}_outer") ** 2
        squares += design.value(f"elastic.{bar}_inner") ** 2
        across, along = slender + link * squares / 16, link * squares / 8
        given_across = design.value(f"inertias.{bar}_transverse")
        given_along = design.value(f"inertias.{bar}_axial")
        found.append(
            TubeFit(
                bar.upper(), length, mass, link / mass, slender, _ratio(given_across, slender),
                across, _ratio(given_across, across), along, _ratio(given_along, along),
            )
        )  # fmt: skip
    return tuple(found)


def _ratio(value: float, of: float) -> float:
    return value / of if of else float("nan")
