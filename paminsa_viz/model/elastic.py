"""Elastic data of a design: material, sections of the bars, stiffness of drives, joints and guides.

None of it is in the paper. The defaults are chosen, not measured: tubes of an aluminum alloy that
weigh what Appendix 4 gives for the links, to 0.5 %; drives as strain-wave gears of size 17 and a
ball screw of 16 mm have them; joints and guides rigid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, make_dataclass
from typing import Any, NamedTuple

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.parameters import Group, parameter

TUBES = {
    "b1": (0.05, 0.0251), "b2": (0.05, 0.039), "b3": (0.04, 0.0338), "b4": (0.04, 0.0331),
    "b7": (0.03, 0.0257), "b8": (0.04, 0.0339), "b10": (0.04, 0.0322),
}  # fmt: skip
"""Outer and inner diameter of the tubes [m] of the bars of a leg that bend: arm, shaft, the four
of the pantograph, guide link."""

BARS = tuple(TUBES)

SECTION_VALUES = {
    "area": ("A_{}", "m^2", "area"),
    "inertia_in": ("I_in^({})", "m^4", "second moment of area in plane"),
    "inertia_out": ("I_out^({})", "m^4", "second moment of area out of plane"),
    "torsion": ("J^({})", "m^4", "torsion constant"),
}
"""Values of a section that may be given in place of those of the tube: symbol, unit, name."""


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


def _bar_fields() -> list[tuple[str, Any, Any]]:
    """Return the fields of the bars: each tube's diameters, then what its section may have."""
    found: list[tuple[str, Any, Any]] = []
    for bar, (outer, inner) in TUBES.items():
        name = bar.upper()
        text = f"{name}, outer diameter of the tube"
        value = parameter(outer, f"D_{name}", "m", text, positive=True)
        found.append((f"{bar}_outer", float, value))
        value = parameter(inner, f"d_{name}", "m", f"{name}, inner diameter of the tube")
        found.append((f"{bar}_inner", float, value))
        for key, (symbol, unit, label) in SECTION_VALUES.items():
            text = f"{name}, {label} (default: the tube’s)"
            value = parameter(None, symbol.format(name), unit, text, positive=True)
            found.append((f"{bar}_{key}", float | None, value))
    return found


def _rigid(symbol: str, unit: str, text: str) -> float | None:
    return parameter(None, symbol, unit, f"{text} (default: rigid)", positive=True)


@dataclass(frozen=True)
class _Rigidities(Group, path="elastic"):
    """What all bars have in common: material, drives, joints and guides."""

    young_modulus: float = parameter(69e9, "E", "Pa", "Young’s modulus of the bars", positive=True)
    shear_modulus: float = parameter(26e9, "G", "Pa", "shear modulus of the bars", positive=True)
    density: float = parameter(2700.0, "rho", "kg/m^3", "density of the bars", positive=True)
    yield_stress: float = parameter(240e6, "R_p", "Pa", "yield stress of the bars", positive=True)
    drive_rotary: float = parameter(
        1e4, "k_M", "N m/rad", "stiffness of M1 to M3, motor locked", positive=True
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


_WithBars: Any = make_dataclass("_WithBars", _bar_fields(), bases=(_Rigidities,), frozen=True)


@dataclass(frozen=True)
class Elastic(_WithBars):
    """What bends and by how much: not in the paper, documented defaults.

    A stiffness that is left open (None) is infinite, as of a rigid part; a drive's is always a
    number, and 1e18 is as good as infinite. The values of a section are the tube's until they are
    given.

    Raises:
        InvalidDesign: If a value is not possible, or an inner diameter not below the outer one.
    """

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
        """Return the section of a bar of `BARS`: what is given, and the tube's for the rest.

        Raises:
            InvalidInput: If there is no such bar.
        """
        if not (isinstance(bar, str) and bar in BARS):
            raise InvalidInput("bar", f"one of {', '.join(BARS)} is needed, not {bar!r:.60}")
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
