"""One rigid body a link, for programs that take no point masses.

MuJoCo and Pinocchio take a link's masses one by one, point masses among them. Importers of USD and
URDF take one mass, center and inertia a body, and replace those that no solid body has. So here the
joint masses, counterweights and the payload of a link are folded into it, and what the motion does
not depend on is chosen so that each body is a possible one:

* the links that only slide or turn about the vertical have any inertia about x and y: it is made as
  large as that about z, where it is smaller;
* the slider, a point mass, turns with the guide link B10: `SLEEVE` says how much of the guide's
  inertia it takes over;
* the lift only rises: it has the inertia of its three arms.

So kinetic and potential energy of the robot are those of the design, exactly.
"""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.engines.mechanism import LIFT, PLATFORM, Link, MechanismTree, Part, leg_name
from paminsa_viz.errors import InvalidInput

LEAST_MASS = 1e-6
"""Least mass of a body [kg]."""

LEAST_INERTIA = 1e-9
"""Least inertia of a body about an axis through its mass center [kg m^2]."""

SLEEVE = 0.02
"""Radius of gyration of the slider [m], as far as half of the guide's inertia allows it."""


def rigid_bodies(mechanism: MechanismTree) -> dict[str, Part]:
    """Return mass, mass center and inertias of every link in its own axes, by link name.

    Raises:
        InvalidInput: If a link has no mass or no inertia.
    """
    found = {link.name: _folded(link) for link in mechanism.links}
    lift = next(link for link in mechanism.links if link.name == LIFT)
    arm = math.dist(lift.rods[0].start, lift.rods[0].end)
    found[LIFT] = _round(found[LIFT], found[LIFT].mass * arm**2 / 3)
    for leg in range(3):
        guide, slider = (leg_name(leg, name) for name in ("B10", "slider"))
        whole = found[guide].inertia[2]
        share = min(found[slider].mass * SLEEVE**2, 0.5 * whole)
        found[guide] = _round(found[guide], whole - share)
        found[slider] = _round(found[slider], share)
        shaft = found[leg_name(leg, "B2")]
        found[shaft.name] = _round(shaft, shaft.inertia[2])
    found[PLATFORM] = _round(found[PLATFORM], found[PLATFORM].inertia[2])
    for body in found.values():
        _check(body)
    return found


def _folded(link: Link) -> Part:
    """Return the sum of a link's parts, whose centers lie on one of its axes."""
    mass = sum(part.mass for part in link.parts)
    centers = np.array([part.center for part in link.parts], float)
    weights = np.array([part.mass for part in link.parts])
    center = weights @ centers / mass if mass > 0 else centers[0]
    squares = (centers - center) ** 2
    across = squares.sum(axis=1, keepdims=True) - squares
    inertia = np.array([part.inertia for part in link.parts], float).sum(axis=0) + weights @ across
    x, y, z = center.tolist()
    ixx, iyy, izz = inertia.tolist()
    return Part(link.name, mass, (x, y, z), (ixx, iyy, izz))


def _round(body: Part, vertical: float) -> Part:
    """Return a body that never tilts with an inertia about z, and no less about x and y."""
    x, y, _ = body.inertia
    return body._replace(inertia=(max(x, vertical), max(y, vertical), vertical))


def _check(body: Part) -> None:
    least = min(body.inertia)
    for value, limit, unit in (
        (body.mass, LEAST_MASS, "kg"),
        (least, LEAST_INERTIA, "kg·m²"),
    ):
        if not value >= limit:
            raise InvalidInput(
                "design",
                f"{body.name} with its joints has {value:g} {unit}; USD and URDF need bodies of at "
                f"least {limit:g} {unit}",
            )
