"""Equilibrium of a leg in its plane, solved by substitution.

The bars B3, B4, B7, B8 and the slider have 14 equations in the plane, for the 12 components at the
pins 8 (B8), 8 (B7), 9, 4, 7 and 3, the guide force, and the radial force at joint 5; its vertical
one is given. B7 and B8 about joint 8, the slider along the guide, B4 about joint 4 and B3 about
joint 3 give them one after the other. The radial force does not depend on the vertical one: with
the shaft at rest joint 5 is free to move along r.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from paminsa_viz.elastostatics.leg_bodies import LegBodies, Vector, bar_masses


class PlaneForces(NamedTuple):
    """Forces in the planes of the legs for given vertical ones at joint 5, see `solve_plane`."""

    slider_b8: Vector
    slider_b7: Vector
    nine: Vector
    four: Vector
    seven: Vector
    three: Vector
    guide: Any


class PinEquations(NamedTuple):
    """What the equations of a leg share."""

    a: Any  # component of the force at 9 across B8, from B8 about joint 8
    b: Any  # component of the force at 7 across B7, from B7 about joint 8
    about_4: Any  # load moment of B4 about joint 4 over l_B7 [N]
    about_3: Any  # load moment of B3 about joint 3 over l_B8/k [N]
    cos: Any  # of phi - psi
    sin: Any


def pin_equations(bodies: LegBodies) -> PinEquations:
    g, load, masses = bodies.position, bodies.loads, bar_masses(bodies.design)
    k = bodies.design.geometry.magnification
    short, crank = masses["b7"].length, masses["b8"].length
    b4, b3 = bodies.direction["b4"], bodies.direction["b3"]
    return PinEquations(
        load["b8"].moment / crank,
        load["b7"].moment / short,
        load["b4"].moment / short - load["b4"].force.across(b4),
        (load["b3"].moment / crank) * k - load["b3"].force.across(b3) * (k - 1),
        g.cos_phi * g.cos_psi + g.sin_phi * g.sin_psi,
        g.sin_phi * g.cos_psi - g.cos_phi * g.sin_psi,
    )


def radial_force(bodies: LegBodies, pins: PinEquations) -> Any:
    """Return the radial force of the platform on joint 5: the legs' own loads decide it alone."""
    g, load = bodies.position, bodies.loads
    k = bodies.design.geometry.magnification
    b8 = bodies.direction["b8"]
    along_guide = bodies.slider_force.r + load["b8"].force.r + load["b7"].force.r
    along_guide = along_guide + pins.a * g.sin_phi + pins.b * g.sin_psi
    from_b4 = pins.about_4 - pins.a * pins.cos
    from_b3 = (k - 1) * (pins.a + load["b4"].force.across(b8)) - pins.b * pins.cos + pins.about_3
    return (along_guide - (g.cos_phi * from_b4 - g.cos_psi * from_b3) / pins.sin) / (k - 1)


def solve_plane(bodies: LegBodies, pins: PinEquations, five: Vector) -> PlaneForces:
    """Return the forces in the legs' planes for the platform's force on joint 5 of B4."""
    load, direction = bodies.loads, bodies.direction
    k = bodies.design.geometry.magnification
    b4, b8 = direction["b4"], direction["b8"]
    s = ((k - 1) * five.across(b4) + pins.about_4 - pins.a * pins.cos) / pins.sin
    loaded = five + load["b4"].force
    t = pins.b * pins.cos - (k - 1) * (pins.a + loaded.across(b8)) - pins.about_3
    t = t / pins.sin
    nine = _of_parts(s, pins.a, b8)
    seven = _of_parts(t, pins.b, b4)
    four = -(nine + loaded)
    slider_b8 = nine - load["b8"].force
    slider_b7 = seven - load["b7"].force
    return PlaneForces(
        slider_b8, slider_b7, nine, four, seven,
        four - seven - load["b3"].force,
        slider_b8.z + slider_b7.z - bodies.slider_force.z,
    )  # fmt: skip


def _of_parts(along: Any, across: Any, direction: Vector) -> Vector:
    return Vector(
        along * direction.r - across * direction.z, along * direction.z + across * direction.r
    )
