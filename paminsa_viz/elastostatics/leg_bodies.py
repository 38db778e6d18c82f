"""Bodies of a leg with their masses, and the inertial loads on them.

A leg has seven moving bodies: the shaft B2 (joints 3-2), the bars B3, B4, B7 and B8, the slider 8,
and the guide link B10. The pins' masses are on one body each: m_9 on B8, m_4 and m_5 on B4, m_3 on
B3, m_7 on B7, m_8 on the slider, m_2 on B2. A bar's mass is uniform along the bar; what its inertia
exceeds that of such a thin bar by, I_YY - m l^2/12, acts as a couple spread evenly.

Everything is in the leg's plane: (r, z) with r from the leg axis toward the platform; a moment is
positive where it turns r toward z, so that it raises a bar.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.leg import LegMotion, LegPosition
from paminsa_viz.model.leg_points import PointWeights, bar_length, point_weights
from paminsa_viz.model.parameters import BAR_ENDS, PANTOGRAPH

_PINS: dict[str, tuple[int, ...]] = {"b3": (3,), "b4": (4, 5), "b7": (7,), "b8": (9,)}
"""Joints whose mass is on a bar of the pantograph."""


def joint_places(geometry: Geometry, bar: str) -> dict[int, float]:
    """Return where the joints of a bar of the pantograph are, from its first one [m]."""
    length, k = bar_length(geometry, bar), geometry.magnification
    first, last = BAR_ENDS[bar]
    between = {"b3": {3: length * (1 - 1 / k)}, "b4": {4: length / k}}.get(bar, {})
    return {first: 0.0, **between, last: length}


class PointMass(NamedTuple):
    """A mass [kg] on a bar, at a distance from the bar's first joint toward its last [m]."""

    place: float
    mass: float


class BarMass(NamedTuple):
    """Masses of one bar of the pantograph.

    Attributes:
        length: Distance of its first and last joint [m].
        mass: Of the bar, uniform along it [kg].
        points: Pins and counterweights on it; the latter may be beyond its ends.
        excess: I_YY - m l^2/12 [kg m^2], negative for a bar that is heavier at its middle.
        spin: The same less I_XX: what turning about the vertical adds to that [kg m^2].
        moments: Sums of m, m s and m s^2 over all of it, s from the first joint [kg, kg m, kg m^2].
    """

    length: float
    mass: float
    points: tuple[PointMass, ...]
    excess: float
    spin: float
    moments: tuple[float, float, float]


@kept(64)
def bar_masses(design: Design) -> dict[str, BarMass]:
    """Return the masses of B3, B4, B7 and B8, counterweights included."""
    return {bar: _bar_mass(design, bar) for bar in PANTOGRAPH}


def _bar_mass(design: Design, bar: str) -> BarMass:
    length, places = bar_length(design.geometry, bar), joint_places(design.geometry, bar)
    mass: float = getattr(design.links, bar)
    points = [PointMass(places[pin], getattr(design.joints, f"j{pin}")) for pin in _PINS[bar]]
    for weight in design.counterweights:
        if weight.bar == bar:
            at_first = weight.joint == BAR_ENDS[bar][0]
            place = -weight.beyond if at_first else length + weight.beyond
            points.append(PointMass(place, weight.mass))
    thin = mass * length**2 / 12
    across: float = getattr(design.inertias, f"{bar}_transverse")
    axial: float = getattr(design.inertias, f"{bar}_axial")
    moments = (
        mass + sum(p.mass for p in points),
        mass * length / 2 + sum(p.mass * p.place for p in points),
        mass * length**2 / 3 + sum(p.mass * p.place**2 for p in points),
    )
    return BarMass(length, mass, tuple(points), across - thin, across - thin - axial, moments)


class Vector(NamedTuple):
    """Radial and vertical component of something in each leg's plane, (..., 3 legs)."""

    r: Any
    z: Any

    def __add__(self, other: Any) -> Vector:
        return Vector(self.r + other.r, self.z + other.z)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.r - other.r, self.z - other.z)

    def __neg__(self) -> Vector:
        return Vector(-self.r, -self.z)

    def scaled(self, factor: Any) -> Vector:
        """Return the vector times a number."""
        return Vector(factor * self.r, factor * self.z)

    def along(self, direction: Vector) -> Any:
        """Return the component along a unit vector."""
        return self.r * direction.r + self.z * direction.z

    def across(self, direction: Vector) -> Any:
        """Return the component along a unit vector turned by +90 degrees, from r to z."""
        return self.z * direction.r - self.r * direction.z


class BarLoad(NamedTuple):
    """Inertial and weight forces on one bar: resultant and moment about the first joint."""

    force: Vector  # [N]
    moment: Any  # [N m]


class LegBodies(NamedTuple):
    """Motion and inertial loads of the bodies of all legs.

    Attributes:
        design: The robot.
        position, motion: Of the legs, every field (..., 3).
        direction: Unit vector of each pantograph bar, from its first joint to its last.
        couple: Evenly spread couple on each bar, in all [N m].
        loads: Resultant of inertia and weight on each bar.
    """

    design: Design
    position: LegPosition
    motion: LegMotion
    direction: dict[str, Vector]
    couple: dict[str, Any]
    loads: dict[str, BarLoad]

    def apparent(self, weights: PointWeights) -> Vector:
        """Return the force on 1 kg at a point of the leg, g - a in the plane [m/s^2]."""
        q = self.motion
        return Vector(
            -(weights.r5 * q.a5r + weights.r9 * q.a9r),
            -(weights.z5 * q.zeta_acc + weights.r9 * q.z9_acc + self.design.gravity),
        )

    def ends(self, bar: str) -> tuple[Vector, Vector]:
        """Return `apparent` at the first and the last joint of a bar of the pantograph."""
        joints = point_weights(self.design.geometry)
        first, last = BAR_ENDS[bar]
        return self.apparent(joints[first]), self.apparent(joints[last])

    @property
    def slider_force(self) -> Vector:
        """Inertia and weight of m_8 on the slider [N]."""
        at_8 = point_weights(self.design.geometry)[8]
        return self.apparent(at_8).scaled(self.design.joints.j8)

    @property
    def lift_apparent(self) -> Any:
        """Vertical force on 1 kg of shaft and arm, -(g + Z'') [m/s^2]."""
        return -(self.design.gravity + self.motion.zeta_acc / self.design.geometry.magnification)


def leg_bodies(design: Design, position: LegPosition, motion: LegMotion) -> LegBodies:
    """Return the inertial loads of legs; position and motion as `kinematics.leg_states` gives."""
    g, q = position, motion
    b4, b8 = Vector(g.cos_psi, g.sin_psi), Vector(g.cos_phi, g.sin_phi)
    bodies = LegBodies(design, g, q, {"b3": -b8, "b4": b4, "b7": b4, "b8": b8}, {}, {})
    spin2 = q.beta_rate * q.beta_rate
    turn = {
        "psi": (q.psi_acc, spin2 * g.sin_psi * g.cos_psi),
        "phi": (q.phi_acc, spin2 * g.sin_phi * g.cos_phi),
    }
    for bar, masses in bar_masses(design).items():
        first, last = bodies.ends(bar)
        slope = (last - first).scaled(1 / masses.length)
        along = bodies.direction[bar]
        m0, m1, m2 = masses.moments
        acceleration, centrifugal = turn["psi" if bar in ("b4", "b7") else "phi"]
        couple = -(masses.excess * acceleration + masses.spin * centrifugal)
        bodies.couple[bar] = couple
        bodies.loads[bar] = BarLoad(
            first.scaled(m0) + slope.scaled(m1),
            m1 * first.across(along) + m2 * slope.across(along) + couple,
        )
    return bodies


def angular_momentum_rate(bodies: LegBodies) -> Array:
    """Return the moment about each leg's axis that its motion needs, (..., 3) [N m].

    It comes from the actuator M_k and from the sideways force of the platform on joint 5.
    """
    design, g, q = bodies.design, bodies.position, bodies.motion
    geometry = design.geometry
    joints = point_weights(geometry)
    at_8 = joints[8].r5
    total: Any = design.joints.j8 * at_8 * at_8 * g.rho * q.a5t
    for bar, masses in bar_masses(design).items():
        first, last = (joints[number] for number in BAR_ENDS[bar])
        reach, across = (
            [w.r5 * five + w.r9 * nine for w in (first, last)]
            for five, nine in ((g.rho, g.r9), (q.a5t, q.a9t))
        )
        psi = bar in ("b4", "b7")
        c, s = (g.cos_psi, g.sin_psi) if psi else (g.cos_phi, g.sin_phi)
        turn = q.psi_rate if psi else q.phi_rate
        inertias = design.inertias
        axial: float = getattr(inertias, f"{bar}_axial")
        # the thin bar and the points, with radii and sideways accelerations linear along the bar
        m0, m1, m2 = masses.moments
        slope_r = (reach[1] - reach[0]) / masses.length
        slope_a = (across[1] - across[0]) / masses.length
        total = total + (
            m0 * reach[0] * across[0]
            + m1 * (reach[0] * slope_a + slope_r * across[0])
            + m2 * slope_r * slope_a
        )
        # d/dt of (I_XX sin^2 + (I_YY - m l^2/12) cos^2) theta_k'
        total = total + (axial * s * s + masses.excess * c * c) * q.beta_acc
        total = total - 2.0 * masses.spin * s * c * turn * q.beta_rate
    spin = design.inertias.b2_vertical + design.inertias.b10_vertical
    spin += design.links.b10 * geometry.guide_link_length**2 / 4
    return total + spin * q.beta_acc
