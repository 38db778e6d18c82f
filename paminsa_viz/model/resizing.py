"""Robots of other lengths whose bars follow: their masses and inertias, and their sections.

A bar that becomes r times as long keeps its cross section, or the diameters of its tube grow r
times as well (`BarLaw`). Its mass and inertias follow from those of the design, in proportion, or
are those of the tube alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Design, Geometry
from paminsa_viz.model.elastic import BARS, SECTION_VALUES
from paminsa_viz.model.leg_points import bar_length, counterweight_point
from paminsa_viz.model.lumped import MASS_PATHS, lumped_of_masses, mass_vector, point_mass_column
from paminsa_viz.model.parameters import PANTOGRAPH

_AXIAL, _ACROSS = "axial", "across"

_INERTIAS: dict[str, tuple[str, str]] = {
    "inertias.b2_vertical": ("b2", _AXIAL),
    "inertias.b10_vertical": ("b10", _ACROSS),
    **{f"inertias.{bar}_axial": (bar, _AXIAL) for bar in PANTOGRAPH},
    **{f"inertias.{bar}_transverse": (bar, _ACROSS) for bar in PANTOGRAPH},
}
"""Inertias that follow a bar, the bar, and whether they are along its tube or across it."""

_SECTION_POWERS = {"area": 2, "inertia_in": 4, "inertia_out": 4, "torsion": 4}


@dataclass(frozen=True)
class BarLaw:
    """How the bars of a robot of other lengths follow from those of the design.

    Attributes:
        follow: Whether mass and inertia follow the length at all; otherwise they are the design's.
        grow: Whether the diameters of a bar's tube grow in proportion to its length, so that its
            mass grows with the cube of the length, its stiffness in bending with the length
            itself. Otherwise it keeps its cross section: mass and axial inertia grow with the
            length, transverse inertia with its cube, and its stiffness in bending falls with the
            cube.
        tubes: Whether mass and inertia are those of the tube, from its section, its length and the
            density of the elastic data, in place of the design's in proportion. What is at the
            bars' ends (forks, bearings) is then in the joints' masses alone.

    Raises:
        InvalidInput: If bars are to grow, or to be tubes, and not to follow.
    """

    follow: bool = True
    grow: bool = False
    tubes: bool = False

    def __post_init__(self) -> None:
        if not self.follow and (self.grow or self.tubes):
            problem = "bars that keep their masses neither grow nor weigh what their tubes do"
            raise InvalidInput("scale_bars", problem)

    def power(self, kind: str) -> int:
        """Return the power of the length that a bar's mass or an inertia grows with."""
        return {"mass": 1, _AXIAL: 1, _ACROSS: 3}[kind] + (
            0 if not self.grow else 2 if kind != _AXIAL else 4
        )


IN_PROPORTION = BarLaw()
"""Bars keep their cross section; mass grows with the length."""


def _length(geometry: Geometry, bar: str) -> float:
    others = {
        "b1": geometry.arm_length, "b2": geometry.shaft_length, "b10": geometry.guide_link_length
    }  # fmt: skip
    return others[bar] if bar in others else bar_length(geometry, bar)


def _ratio(after: Geometry, before: Geometry, bar: str) -> float:
    """Return how much longer a bar is; 1 if it had no length."""
    length = _length(before, bar)
    return _length(after, bar) / length if length else 1.0


def bar_masses(
    design: Design, geometries: Sequence[Geometry], law: BarLaw = IN_PROPORTION
) -> dict[str, Array]:
    """Return masses and inertias of the bars with other lengths, (n,) of each path [kg, kg m^2].

    Those that do not follow are left out.
    """
    if not law.follow:
        return {}
    ratio = {bar: np.array([_ratio(g, design.geometry, bar) for g in geometries]) for bar in BARS}
    if not law.tubes:
        found = {
            f"links.{bar}": design.value(f"links.{bar}") * ratio[bar] ** law.power("mass")
            for bar in BARS
        }
        for path, (bar, kind) in _INERTIAS.items():
            found[path] = design.value(path) * ratio[bar] ** law.power(kind)
        return found
    found = {}
    along, across = {}, {}
    for bar in BARS:
        size = ratio[bar] if law.grow else np.ones(len(geometries))
        length = np.array([_length(g, bar) for g in geometries])
        mass = design.elastic.density * design.elastic.section(bar).area * size**2 * length
        squares = sum(design.value(f"elastic.{bar}_{end}") ** 2 for end in ("outer", "inner"))
        found[f"links.{bar}"] = mass
        along[bar] = mass * squares * size**2 / 8
        across[bar] = mass * (length**2 / 12 + squares * size**2 / 16)
    for path, (bar, kind) in _INERTIAS.items():
        found[path] = (along if kind == _AXIAL else across)[bar]
    return found


def _grown_sections(design: Design, after: Geometry) -> dict[str, float | None]:
    """Return the elastic data of tubes that have grown with their bars, by path."""
    found: dict[str, float | None] = {}
    for bar in BARS:
        ratio = _ratio(after, design.geometry, bar)
        for end in ("outer", "inner"):
            found[f"elastic.{bar}_{end}"] = ratio * design.value(f"elastic.{bar}_{end}")
        for key in SECTION_VALUES:
            given = getattr(design.elastic, f"{bar}_{key}")
            if given is not None:
                found[f"elastic.{bar}_{key}"] = ratio ** _SECTION_POWERS[key] * given
    return found


def length_ratio(geometry: Geometry) -> float:
    """Return how long crank plus coupler are over Appendix 4's; the reach grows with them."""
    return _span(geometry) / _span(APPENDIX_4.geometry)


def radius_ratio(geometry: Geometry) -> float:
    """Return R_b over Appendix 4's: what has room beside the singular circles follows it."""
    return geometry.base_radius / APPENDIX_4.geometry.base_radius


def is_comparable(ratio: float) -> bool:
    """Whether a length is so near Appendix 4's that what is chosen for its robot holds as well."""
    return 0.5 < ratio < 2.0


def plain_decimals(geometry: Geometry) -> int:
    """Return the decimals of plain positions [m]: a millimeter's, more for a small robot."""
    return max(3, 3 - round(math.log10(length_ratio(geometry))))


TURN_LENGTH = 0.1
"""What a turn of 1 rad counts as where turns and lengths are compared, at Appendix 4's lengths
[m]."""


def turn_length(geometry: Geometry) -> float:
    """Return what a turn of 1 rad counts as where turns and lengths are compared [m]."""
    return TURN_LENGTH * length_ratio(geometry)


def _span(geometry: Geometry) -> float:
    return geometry.crank_length + geometry.coupler_length


@of_design
def resized(design: Design, values: Mapping[str, float], law: BarLaw = IN_PROPORTION) -> Design:
    """Return the design with other lengths.

    Args:
        design: The design.
        values: Lengths by path.
        law: How the arm B1, the shaft B2, the bars B3, B4, B7, B8 and the guide link B10 follow.

    Raises:
        InvalidDesign: If a path is no length's, or the lengths make no robot.
    """
    for path, value in values.items():
        # A mass given here would be lost: the law of the bars writes its own over it.
        if not path.startswith("geometry."):
            allowed = "values of the geometry can be given here; use Design.vary for others"
            raise InvalidDesign(path, value, allowed)
    changed = design.vary(dict(values))
    if not law.follow:
        return changed
    after = changed.geometry
    numbers: dict[str, float | None] = {
        path: float(value[0]) for path, value in bar_masses(design, [after], law).items()
    }
    if law.grow:
        numbers |= _grown_sections(design, after)
    return changed.vary(numbers)


def resized_masses(design: Design, geometries: Sequence[Geometry], law: BarLaw) -> Array:
    """Return the masses of the design with other geometries, (n, 28), as `resized` has them.

    In the order of `lumped.MASS_PATHS` [kg, kg m^2].
    """
    masses = np.tile(mass_vector(design), (len(geometries), 1))
    for path, values in bar_masses(design, geometries, law).items():
        masses[:, MASS_PATHS.index(path)] = values
    return masses


def resized_coefficients(design: Design, geometries: Sequence[Geometry], masses: Array) -> Array:
    """Return the lumped coefficients of the design with other geometries and masses, (n, 18).

    For many robots at once what `lumped.lumped_coefficients` is for one; counterweights keep their
    places on the bars.
    """
    c = lumped_of_masses(geometries, design.gravity, masses)
    for weight in design.counterweights:
        for row, geometry in zip(c, geometries, strict=True):
            point = counterweight_point(geometry, weight)
            row += weight.mass * point_mass_column(point, design.gravity)
    return c
