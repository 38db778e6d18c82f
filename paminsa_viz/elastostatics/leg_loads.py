"""Internal forces of a leg for unit loads, with what each of them bends: rows of the force method.

The columns are the loads: forces along w and z at joint 5, and five redundants (see
`leg_compliance`). In the plane the force along z acts alone and equilibrium decides: with p the
compression of B8 and q that of B7, p = (k-1) cos psi / sin(phi - psi) and q = -(k-1) cos phi /
sin(phi - psi); the shaft carries k and the guide k - 1 times the force. Across the plane the joints
transmit all but nothing is released: a force along w and moments about u and z at any point.

A bar's bending moment is linear between joints, so that its energy needs the moment at its middle
and the shear force, besides torque and axial force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from paminsa_viz.elastostatics.leg_frame import LegFrame
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS, BeamSection, Elastic

PARTS = ("B1", "B2", "B3", "B4", "B7", "B8", "B10", "drive", "bearings", "ball joint", "guide")
"""Parts of a leg that deform; the drive is that of its M_k."""

APPLIED = 2
"""Loads at joint 5, along w and z: the first two of a leg's columns."""

COLUMNS = 7
"""Loads of a leg: two applied, then the redundants S, M_u at 2; f, m_u, m_z at 7."""

FORCE_W, FORCE_Z, S2, M2, F7, MU7, MZ7 = range(COLUMNS)

_AT_5, _AT_2, _AT_7 = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_ALL = (1.0, 1.0, 1.0)

_SPANS: tuple[tuple[str, int, int, tuple[float, float, float]], ...] = (
    ("b4", 4, 5, _AT_5),
    ("b4", 9, 4, _ALL),
    ("b8", 8, 9, _ALL),
    ("b3", 3, 4, (0.0, 1.0, 1.0)),
    ("b3", 3, 7, _AT_7),
    ("b2", 3, 2, _AT_2),
    ("b7", 8, 7, _AT_7),
    ("b10", 0, 8, (1.0, 1.0, 0.0)),
)
"""Bars between joints, and which of the loads at 5, 2 and 7 each carries across the plane;
a sign of all of them does not count."""

_REVOLUTES: tuple[tuple[int, tuple[float, float, float]], ...] = (
    (8, _ALL),
    (8, _AT_7),
    (9, _ALL),
    (4, (0.0, 1.0, 1.0)),
    (7, _AT_7),
    (3, _AT_2),
)
"""Revolutes about w: pins of B8 and B7 at 8, then 9, 4, 7, 3, and what each carries."""


Number = Array | float
"""One number, or one for every leg of a batch."""


class StrainRow(NamedTuple):
    """One internal force or moment of a part.

    Attributes:
        part: Name in `PARTS`.
        flexibility: The energy is half of it times the square of the force or moment
            [m/N, rad/(N m)].
        loads: What each load causes, by its column; columns that cause nothing are left out.
    """

    part: str
    flexibility: Number
    loads: dict[int, Number]


class _Rows(list[StrainRow]):
    """Collects rows."""

    def put(self, part: str, flexibility: Number, **loads: Number) -> None:
        """Add a row, its loads by name."""
        columns: dict[int, Number] = {_COLUMN[name]: value for name, value in loads.items()}
        self.append(StrainRow(part, flexibility, columns))


_COLUMN = {"w": FORCE_W, "z": FORCE_Z, "s": S2, "m": M2}


def leg_rows(frame: LegFrame, elastic: Elastic, *, shear: bool) -> tuple[StrainRow, ...]:
    """Return the internal forces of the legs for unit loads; arguments as in `leg_compliance`."""
    rows = _Rows()
    sections = {bar: elastic.section(bar) for bar in BARS}
    material = _Material(elastic, shear)
    points = {joint: (p[..., 0].copy(), p[..., 1].copy()) for joint, p in frame.points.items()}
    points[0] = (np.zeros_like(frame.rho), np.zeros_like(frame.rho))
    _add_across(rows, points, sections, material)
    _add_arm(rows, frame, sections["b1"], material)
    _add_plane(rows, frame, points, sections, material)
    _add_joints(rows, frame, points, elastic)
    return tuple(rows)


@dataclass(frozen=True)
class _Material:
    """Flexibilities of a bar of a length, for what is in the rows."""

    elastic: Elastic
    shear: bool

    def axial(self, section: BeamSection, length: Number) -> Number:
        return length / (self.elastic.young_modulus * section.area)

    def twist(self, section: BeamSection, length: Number) -> Number:
        return length / (self.elastic.shear_modulus * section.torsion)

    def bend(self, inertia: float, length: Number) -> Number:
        """For the moment at the middle."""
        return length / (self.elastic.young_modulus * inertia)

    def across(self, section: BeamSection, inertia: float, length: Number) -> Number:
        """For the shear force: the moment's change along the bar, and shear if it counts."""
        own = length**3 / (12 * self.elastic.young_modulus * inertia)
        if self.shear:
            own += length / (self.elastic.shear_modulus * section.area * section.shear)
        return own


Plane = dict[int, tuple[Array, Array]]
"""Joints of legs, r and z by the paper's number [m]."""


def carried(
    points: Plane, r: Array, z: Array, loads: tuple[float, float, float]
) -> tuple[dict[int, Number], dict[int, Number], dict[int, Number]]:
    """Return force f along w and moments m_u, m_z at a point (r, z) of the plane, by column.

    A force f along w at a distance (dr, dz) has the moments -dz f about u and dr f about z.
    """
    force: dict[int, Number] = {}
    mu: dict[int, Number] = {}
    mz: dict[int, Number] = {}
    for joint, column, share in zip((5, 2, 7), (FORCE_W, S2, F7), loads, strict=True):
        if share:
            force[column] = share
            mu[column] = share * (z - points[joint][1])
            mz[column] = share * (points[joint][0] - r)
    if loads[1]:
        mu[M2] = loads[1]
    if loads[2]:
        mu[MU7] = mz[MZ7] = loads[2]
    return force, mu, mz


def _mixed(
    first: dict[int, Number], a: Number, second: dict[int, Number], b: Number
) -> dict[int, Number]:
    """Return a times the first and b times the second row of loads."""
    found = {column: a * value for column, value in first.items()}
    for column, value in second.items():
        found[column] = found[column] + b * value if column in found else b * value
    return found


def _add_across(
    rows: _Rows, points: Plane, sections: dict[str, BeamSection], material: _Material
) -> None:
    """Add twist, bending and shear across the plane of all bars in it."""
    for bar, first, second, loads in _SPANS:
        (r1, z1), (r2, z2) = points[first], points[second]
        length = np.hypot(r2 - r1, z2 - z1)
        divisor = np.where(length > 0, length, 1.0)  # a bar without length has no direction
        c, s = (r2 - r1) / divisor, (z2 - z1) / divisor
        force, mu, mz = carried(points, 0.5 * (r1 + r2), 0.5 * (z1 + z2), loads)
        section, part = sections[bar], bar.upper()
        rows.append(StrainRow(part, material.twist(section, length), _mixed(mu, c, mz, s)))
        bend = material.bend(section.inertia_out, length)
        rows.append(StrainRow(part, bend, _mixed(mz, c, mu, -s)))
        rows.append(StrainRow(part, material.across(section, section.inertia_out, length), force))


def _add_arm(rows: _Rows, frame: LegFrame, section: BeamSection, material: _Material) -> None:
    """Add the arm, which carries the shaft's vertical force, S and the moment at joint 2."""
    length, k = frame.geometry.arm_length, frame.geometry.magnification
    au, aw = np.moveaxis(frame.arm, -1, 0)
    half = 0.5 * length
    rows.put("B1", material.twist(section, length), m=au)  # alone in a row a sign does not count
    rows.put("B1", material.bend(section.inertia_in, length), m=aw, z=-k * half)
    rows.put("B1", material.across(section, section.inertia_in, length), z=k)
    rows.put("B1", material.bend(section.inertia_out, length), s=half * au)
    rows.put("B1", material.across(section, section.inertia_out, length), s=au)
    rows.put("B1", material.axial(section, length), s=aw)


def _two_force_bars(frame: LegFrame) -> tuple[Array, Array]:
    """Return the compressions of B8 and B7 for a unit force along z at joint 5, (..., 3 legs)."""
    k = frame.geometry.magnification
    (cos_psi, sin_psi), (cos_phi, sin_phi) = (np.moveaxis(a, -1, 0) for a in (frame.psi, frame.phi))
    scale = (k - 1) / (sin_phi * cos_psi - cos_phi * sin_psi)
    return scale * cos_psi, -scale * cos_phi


def _add_plane(
    rows: _Rows,
    frame: LegFrame,
    points: Plane,
    sections: dict[str, BeamSection],
    material: _Material,
) -> None:
    """Add stretch and bending in the plane, for the force along z."""
    g = frame.geometry
    k = g.magnification
    (cos_psi, sin_psi), (cos_phi, sin_phi) = (np.moveaxis(a, -1, 0) for a in (frame.psi, frame.phi))
    in_b8, in_b7 = _two_force_bars(frame)
    between = cos_phi * cos_psi + sin_phi * sin_psi  # cosine of the angle from B4 to B8

    def span(bar: str, length: Number, axial: Number, moment: Number) -> None:
        """Add a bar whose moment falls from ``moment`` at one end to zero at the other.

        Each is a row of its own, whose square counts: signs are left out.
        """
        section, part = sections[bar], bar.upper()
        if np.ndim(axial) or axial:
            rows.put(part, material.axial(section, length), z=axial)
        if np.ndim(moment) or moment:
            rows.put(part, material.bend(section.inertia_in, length), z=0.5 * moment)
            falls = material.across(section, section.inertia_in, length)
            rows.put(part, falls, z=moment / length)

    outer, inner = g.coupler_length * (k - 1) / k, g.coupler_length / k
    at_4 = outer * cos_psi
    span("b4", outer, sin_psi, at_4)
    span("b4", inner, in_b8 * between, at_4)
    upper, lower = g.crank_length * (k - 1) / k, g.crank_length / k
    at_3 = upper * cos_phi
    span("b3", upper, sin_phi + in_b8, at_3)
    span("b3", lower, in_b7 * between, at_3)
    span("b8", g.crank_length, in_b8, 0.0)
    span("b7", g.short_coupler_length, in_b7, 0.0)
    span("b2", g.shaft_length, k, 0.0)
    reach = np.abs(points[8][0])
    span("b10", reach, 0.0, (k - 1) * reach)


def _add_joints(rows: _Rows, frame: LegFrame, points: Plane, elastic: Elastic) -> None:
    """Add the drive of M_k, and the joints that are not rigid."""
    k = frame.geometry.magnification
    force, mu, mz = carried(points, *points[0], (1.0, 1.0, 0.0))
    rows.append(StrainRow("drive", 1 / elastic.drive_rotary, mz))
    _add_revolutes(rows, frame, points, elastic)
    if elastic.bearing_radial is not None:  # of joint 2 and of M_k, about vertical axes
        rows.put("bearings", 1 / elastic.bearing_radial, s=1.0)
        rows.append(StrainRow("bearings", 1 / elastic.bearing_radial, force))
    if elastic.bearing_axial is not None:
        rows.put("bearings", 1 / elastic.bearing_axial, z=k)
        rows.put("bearings", 1 / elastic.bearing_axial, z=k - 1)
    if elastic.bearing_tilt is not None:
        rows.put("bearings", 1 / elastic.bearing_tilt, m=1.0)
        rows.append(StrainRow("bearings", 1 / elastic.bearing_tilt, mu))
        rows.put("bearings", 1 / elastic.bearing_tilt, z=(k - 1) * points[8][0])
    if elastic.ball is not None:
        rows.put("ball joint", 1 / elastic.ball, w=1.0)
        rows.put("ball joint", 1 / elastic.ball, z=1.0)
    force, mu, mz = carried(points, *points[8], (1.0, 1.0, 0.0))
    if elastic.guide is not None:
        rows.append(StrainRow("guide", 1 / elastic.guide, force))
        rows.put("guide", 1 / elastic.guide, z=k - 1)
    if elastic.guide_tilt is not None:
        rows.append(StrainRow("guide", 1 / elastic.guide_tilt, mu))
        rows.append(StrainRow("guide", 1 / elastic.guide_tilt, mz))


def _add_revolutes(rows: _Rows, frame: LegFrame, points: Plane, elastic: Elastic) -> None:
    """Add the bearings of the revolutes about w."""
    in_b8, in_b7 = _two_force_bars(frame)
    cos_phi, sin_phi = np.moveaxis(frame.phi, -1, 0)
    at_4 = np.hypot(in_b8 * cos_phi, 1 + in_b8 * sin_phi)
    pins = (in_b8, in_b7, in_b8, at_4, in_b7, frame.geometry.magnification)
    for (joint, loads), pin in zip(_REVOLUTES, pins, strict=True):
        force, mu, mz = carried(points, *points[joint], loads)
        if elastic.bearing_radial is not None:
            rows.put("bearings", 1 / elastic.bearing_radial, z=pin)
        if elastic.bearing_axial is not None:
            rows.append(StrainRow("bearings", 1 / elastic.bearing_axial, force))
        if elastic.bearing_tilt is not None:
            rows.append(StrainRow("bearings", 1 / elastic.bearing_tilt, mu))
            rows.append(StrainRow("bearings", 1 / elastic.bearing_tilt, mz))
