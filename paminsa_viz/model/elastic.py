"""Elastic data of a design: material, sections of the bars, stiffness of drives, joints and guides.

None of it is in the paper. The defaults are chosen, not measured: tubes of an aluminum alloy that
weigh what Appendix 4 gives for the links, to 1 %; drives as strain-wave gears of size 17 and a ball
screw of 16 mm have them; joints and guides rigid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.parameters import Group, parameter

BARS = ("b1", "b2", "b3", "b4", "b7", "b8", "b10")
"""Bars of a leg that bend: arm, shaft, the four of the pantograph, guide link."""

SECTION_VALUES = ("area", "inertia_in", "inertia_out", "torsion")
"""Values of a section that may be given in place of those of the tube."""


class BeamSection(NamedTuple):
    """Cross-section of a bar.

    Attributes:
        area: [m^2].
        inertia_in: Second moment of area for bending in the leg's plane [m^4]; of the arm B1, in
            the vertical plane.
        inertia_out: The same for bending out of the plane [m^4]; of B1, in the horizontal plane.
        torsion: Torsion constant J [m^4].
        shear: Shear area over the area, of the tube (Cowper 1966).
        radius: Outer radius of the tube [m], the distance of the outermost fiber.
    """

    area: float
    inertia_in: float
    inertia_out: float
    torsion: float
    shear: float
    radius: float


def _outer(bar: str, value: float) -> float:
    return parameter(value, f"D_{bar}", "m", f"{bar}, outer diameter of the tube", positive=True)


def _inner(bar: str, value: float) -> float:
    return parameter(value, f"d_{bar}", "m", f"{bar}, inner diameter of the tube")


def _area(bar: str) -> float | None:
    return parameter(None, f"A_{bar}", "m^2", f"{bar}, area (default: the tube's)", positive=True)


def _in_plane(bar: str) -> float | None:
    label = f"{bar}, second moment of area in plane (default: the tube's)"
    return parameter(None, f"I_in^({bar})", "m^4", label, positive=True)


def _out_of_plane(bar: str) -> float | None:
    label = f"{bar}, second moment of area out of plane (default: the tube's)"
    return parameter(None, f"I_out^({bar})", "m^4", label, positive=True)


def _torsion(bar: str) -> float | None:
    label = f"{bar}, torsion constant (default: the tube's)"
    return parameter(None, f"J^({bar})", "m^4", label, positive=True)


def _rigid(symbol: str, unit: str, text: str) -> float | None:
    return parameter(None, symbol, unit, f"{text} (default: rigid)", positive=True)


@dataclass(frozen=True)
class Elastic(Group, path="elastic"):
    """What bends and by how much: not in the paper, documented defaults.

    A stiffness that is None is infinite; a drive's is a number, and 1e18 as good as infinite. The
    values of a section are the tube's until they are given.

    Raises:
        InvalidDesign: If a value is not possible, or an inner diameter not below the outer one.
    """

    young_modulus: float = parameter(69e9, "E", "Pa", "Young's modulus of the bars", positive=True)
    shear_modulus: float = parameter(26e9, "G", "Pa", "shear modulus of the bars", positive=True)
    density: float = parameter(2700.0, "rho", "kg/m^3", "density of the bars", positive=True)
    yield_stress: float = parameter(240e6, "R_p", "Pa", "yield stress of the bars", positive=True)
    drive_rotary: float = parameter(
        1e4, "k_M", "N m/rad", "stiffness of M1..M3, motor locked", positive=True
    )
    drive_linear: float = parameter(
        5e7, "k_4", "N/m", "stiffness of M4, motor locked", positive=True
    )
    bearing_radial: float | None = _rigid("k_r", "N/m", "bearings of the revolute joints, across")
    bearing_axial: float | None = _rigid("k_a", "N/m", "bearings of the revolute joints, along")
    bearing_tilt: float | None = _rigid("k_t", "N m/rad", "bearings of the revolute joints, tilt")
    ball: float | None = _rigid("k_b", "N/m", "ball joint 5")
    guide: float | None = _rigid("k_g", "N/m", "guide, across")
    guide_tilt: float | None = _rigid("k_gt", "N m/rad", "guide, tilt and roll")
    platform_tilt_inertia: float | None = parameter(
        None, "I_tilt", "kg m^2", "platform, about x and y (default: I_pl/2)", positive=True
    )

    b1_outer: float = _outer("B1", 0.05)
    b1_inner: float = _inner("B1", 0.0251)
    b1_area: float | None = _area("B1")
    b1_inertia_in: float | None = _in_plane("B1")
    b1_inertia_out: float | None = _out_of_plane("B1")
    b1_torsion: float | None = _torsion("B1")
    b2_outer: float = _outer("B2", 0.05)
    b2_inner: float = _inner("B2", 0.039)
    b2_area: float | None = _area("B2")
    b2_inertia_in: float | None = _in_plane("B2")
    b2_inertia_out: float | None = _out_of_plane("B2")
    b2_torsion: float | None = _torsion("B2")
    b3_outer: float = _outer("B3", 0.04)
    b3_inner: float = _inner("B3", 0.0338)
    b3_area: float | None = _area("B3")
    b3_inertia_in: float | None = _in_plane("B3")
    b3_inertia_out: float | None = _out_of_plane("B3")
    b3_torsion: float | None = _torsion("B3")
    b4_outer: float = _outer("B4", 0.04)
    b4_inner: float = _inner("B4", 0.0331)
    b4_area: float | None = _area("B4")
    b4_inertia_in: float | None = _in_plane("B4")
    b4_inertia_out: float | None = _out_of_plane("B4")
    b4_torsion: float | None = _torsion("B4")
    b7_outer: float = _outer("B7", 0.03)
    b7_inner: float = _inner("B7", 0.0257)
    b7_area: float | None = _area("B7")
    b7_inertia_in: float | None = _in_plane("B7")
    b7_inertia_out: float | None = _out_of_plane("B7")
    b7_torsion: float | None = _torsion("B7")
    b8_outer: float = _outer("B8", 0.04)
    b8_inner: float = _inner("B8", 0.0339)
    b8_area: float | None = _area("B8")
    b8_inertia_in: float | None = _in_plane("B8")
    b8_inertia_out: float | None = _out_of_plane("B8")
    b8_torsion: float | None = _torsion("B8")
    b10_outer: float = _outer("B10", 0.04)
    b10_inner: float = _inner("B10", 0.0322)
    b10_area: float | None = _area("B10")
    b10_inertia_in: float | None = _in_plane("B10")
    b10_inertia_out: float | None = _out_of_plane("B10")
    b10_torsion: float | None = _torsion("B10")

    def __post_init__(self) -> None:
        super().__post_init__()
        for bar in BARS:
            outer, inner = getattr(self, f"{bar}_outer"), getattr(self, f"{bar}_inner")
            if inner >= outer:
                allowed = f"a tube's inner diameter is below its outer one, here {outer!r} m"
                raise InvalidDesign(f"elastic.{bar}_inner", inner, allowed)

    @property
    def poisson(self) -> float:
        """Poisson's ratio of an isotropic material with this E and G."""
        return self.young_modulus / (2 * self.shear_modulus) - 1

    def section(self, bar: str) -> BeamSection:
        """Return the section of a bar of `BARS`: what is given, and the tube's for the rest."""
        outer, inner = getattr(self, f"{bar}_outer"), getattr(self, f"{bar}_inner")
        given = (getattr(self, f"{bar}_{name}") for name in SECTION_VALUES)
        tube = tube_section(outer, inner, self.poisson)
        both = zip(given, tube, strict=False)
        area, inside, outside, torsion = (own if value is None else value for value, own in both)
        return BeamSection(area, inside, outside, torsion, tube.shear, tube.radius)

    def in_force(self, name: str) -> float:
        """Return a number as it counts: the tube's section values, infinity for rigid."""
        value = getattr(self, name)
        if value is not None:
            return float(value)
        bar, _, what = name.partition("_")
        return float(getattr(self.section(bar), what)) if bar in BARS else math.inf


def tube_section(outer: float, inner: float, poisson: float = 0.3) -> BeamSection:
    """Return the section of a round tube; diameters [m]. The shear area is Cowper's (1966)."""
    second = math.pi / 64 * (outer**4 - inner**4)
    ratio = (inner / outer) ** 2
    ring = (1 + ratio) ** 2
    shear = 6 * (1 + poisson) * ring
    shear /= (7 + 6 * poisson) * ring + (20 + 12 * poisson) * ratio
    area = math.pi / 4 * (outer**2 - inner**2)
    return BeamSection(area, second, second, 2 * second, shear, outer / 2)
