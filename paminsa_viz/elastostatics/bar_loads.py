"""Axial force N, shear force V and bending moment M along the bars, in their legs' planes.

Signs are those of `bar_diagram`, with e the direction from start to end.

========  ======================================================================================
bar       from, to
========  ======================================================================================
B1        joint 2, the carriage of M4; e is horizontal, n is up. In the arm's own vertical plane
B2        joint 3, joint 2
B3        joint 4, joint 7
B4        joint 9, joint 5
B7        joint 8, joint 7
B8        joint 8, joint 9
B10       its free end, the leg axis
========  ======================================================================================

The stress along a bar is |N|/A + |M| c/I, with c the outer radius and I for bending in the plane;
shear is left out, as in slender bars, and so is buckling. The statically indeterminate sideways
shares are not in it: it is a lower bound, and what the loads of a leg's own plane use of the
material.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.elastostatics.bar_diagram import (
    BarLoads,
    PointLoad,
    largest_value,
    make_diagram,
)
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JointForces, joint_forces
from paminsa_viz.elastostatics.leg_bodies import Vector, bar_masses, joint_places
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import kept
from paminsa_viz.model.arrays import Array, in_blocks
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.grids import Field
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.parameters import PANTOGRAPH
from paminsa_viz.model.reach import Limit

BAR_NAMES: dict[str, str] = {bar: bar.upper() for bar in BARS}
"""Bars by key."""

BLOCK = 2**13
"""Poses worked on at a time; their forces take some 10 MB."""

BAR_MEASURES = ("axial", "bending", "utilization")
"""Results of `field_bar_loads`: largest |N| [N], |M| [N m] of a bar, and its utilization [1]."""


@kinds_checked
def bar_loads(forces: JointForces, bar: str) -> BarLoads:
    """Return N, V and M along a bar of every leg, batch shape (..., 3 legs).

    For B1 they are those of the arm's vertical plane that the leg's plane causes; what the shaft's
    indeterminate sideways share would add is not in them, see `arm_tip`.

    Raises:
        InvalidInput: If there is no such bar.
    """
    if bar in PANTOGRAPH:
        return _pantograph_bar(forces, bar)
    if bar == "b2":
        return _shaft(forces)
    if bar == "b10":
        return _guide_link(forces)
    if bar == "b1":
        return _arm(forces)
    raise InvalidInput("bar", f"one of {', '.join(BAR_NAMES)} is needed, not {bar!r}")


@kinds_checked
def all_bar_loads(forces: JointForces) -> dict[str, BarLoads]:
    """Return `bar_loads` of every bar."""
    return {bar: bar_loads(forces, bar) for bar in BAR_NAMES}


def _joint(forces: JointForces, key: str) -> Vector:
    """Return the force at a joint in the leg's plane (n, 3)."""
    force = forces.force.reshape(-1, 3, *forces.force.shape[-2:])[:, :, JOINT_INDEX[key]]
    return Vector(force[..., 0], force[..., 2])


_ON_BAR: dict[str, dict[int, tuple[str, float]]] = {
    "b3": {4: ("4", -1.0), 3: ("3", 1.0), 7: ("7", 1.0)},
    "b4": {9: ("9", 1.0), 4: ("4", 1.0), 5: ("5", -1.0)},
    "b7": {8: ("8_b7", 1.0), 7: ("7", -1.0)},
    "b8": {8: ("8_b8", 1.0), 9: ("9", -1.0)},
}
"""Joints of a bar: the force on it is that of `JOINTS`, or the opposite one."""


def _pantograph_bar(forces: JointForces, bar: str) -> BarLoads:
    bodies, design = forces.bodies, forces.design
    masses = bar_masses(design)[bar]
    e, length = bodies.direction[bar], masses.length
    first, last = bodies.ends(bar)
    places = joint_places(design.geometry, bar)
    points = []
    for number, (key, sign) in _ON_BAR[bar].items():
        force = _joint(forces, key).scaled(sign)
        points.append(PointLoad(places[number], force.along(e), force.across(e)))
    slope = (last - first).scaled(1 / length)
    for point in masses.points:
        force = (first + slope.scaled(point.place)).scaled(point.mass)
        place = min(max(point.place, 0.0), length)
        lever = point.place - place
        across = force.across(e)
        points.append(PointLoad(place, force.along(e), across, lever * across))
    density = masses.mass / length
    return make_diagram(forces.force.shape[:-2], bar, length, points,
        _ends(first, last, e, density), bodies.couple[bar] / length,
    )  # fmt: skip


def _ends(first: Vector, last: Vector, e: Vector, density: float) -> tuple[Any, Any, Any, Any]:
    """Return load along and across a bar for its length, at its start and at its end [N/m]."""
    return (
        density * first.along(e), density * last.along(e),
        density * first.across(e), density * last.across(e),
    )  # fmt: skip


def _shaft(forces: JointForces) -> BarLoads:
    """B2 from joint 3 up to joint 2: e = z, n = -r."""
    design = forces.design
    length, weight = design.geometry.shaft_length, forces.bodies.lift_apparent
    three, two = _joint(forces, "3"), _joint(forces, "2")
    moment = forces.moment.reshape(-1, 3, forces.moment.shape[-1])[..., JOINT_INDEX["2"]]
    # a shaft without length is a point at joint 2
    spread, point = (design.links.b2 / length, 0.0) if length else (0.0, design.links.b2)
    points = [
        PointLoad(0.0, -three.z, three.r),
        PointLoad(length, two.z + (design.joints.j2 + point) * weight, -two.r, moment),
    ]
    load = spread * weight
    return make_diagram(forces.force.shape[:-2], "b2", length, points, (load, load, 0.0, 0.0), 0.0)


def _guide_link(forces: JointForces) -> BarLoads:
    """B10 from its free end to the leg axis: e = r, n = z."""
    design, q = forces.design, forces.bodies.motion
    length = design.geometry.guide_link_length
    on_axis, guide = _joint(forces, "m"), _joint(forces, "guide")
    moment = forces.moment.reshape(-1, 3, forces.moment.shape[-1])[..., JOINT_INDEX["m"]]
    # A stroke longer than B10 leaves the slider on an extension beyond its free end.
    reach = forces.bodies.position.rho / (design.geometry.magnification - 1)
    place = np.maximum(length - reach, 0.0)
    lever = (length - reach) - place
    points = [
        PointLoad(place, 0.0, -guide.z, -lever * guide.z),
        PointLoad(length, on_axis.r, on_axis.z, moment),
    ]
    density = design.links.b10 / length
    outward = -density * length * q.beta_rate**2
    weight = -density * design.gravity
    return make_diagram(
        forces.force.shape[:-2], "b10", length, points, (outward, 0.0, weight, weight), 0.0
    )


def _arm(forces: JointForces) -> BarLoads:
    """B1 from joint 2 to the carriage, in its vertical plane: e horizontal, n = z."""
    design, bodies = forces.design, forces.bodies
    length, load = design.geometry.arm_length, arm_tip(forces)
    weight = design.links.b1 / length * bodies.lift_apparent if length else 0.0
    at_tip = load.up if length else load.up + design.links.b1 * bodies.lift_apparent
    points = [PointLoad(0.0, load.along, at_tip, load.bending)]
    loads = make_diagram(
        forces.force.shape[:-2], "b1", length, points, (0.0, 0.0, weight, weight), 0.0
    )
    # The carriage holds the arm's end: nothing of it is a known force.
    return BarLoads("b1", length, loads.places, loads.coefficients, np.zeros_like(loads.residual))


class ArmTip(NamedTuple):
    """What a leg's plane puts on the tip of its arm B1, each (n, 3 legs).

    Attributes:
        along: Force along the arm, toward the carriage [N].
        sideways: Horizontal force across the arm, along z x e [N].
        up: Vertical force [N].
        bending: Moment in the arm's vertical plane, positive from e to z [N m].
        torsion: Moment about the arm's axis e [N m].
    """

    along: Any
    sideways: Any
    up: Any
    bending: Any
    torsion: Any


def arm_tip(forces: JointForces) -> ArmTip:
    """Return the load of the shaft's force and moment at joint 2 on the arm B1.

    The tangential force of joint 2 and its moment about r are statically indeterminate and are not
    in it.
    """
    g, two = forces.bodies.position, _joint(forces, "2")
    moment = forces.moment.reshape(-1, 3, forces.moment.shape[-1])[..., JOINT_INDEX["2"]]
    inward = -LEG_AXES
    cos = g.ux * inward[:, 0] + g.uy * inward[:, 1]
    sin = g.uy * inward[:, 0] - g.ux * inward[:, 1]
    return ArmTip(-two.r * cos, -two.r * sin, -two.z, -moment * cos, -moment * sin)


def bar_stress(forces: JointForces, loads: BarLoads) -> Array:
    """Return the largest stress along a bar of every leg, (..., 3 legs) [Pa].

    For B1 the bending in the horizontal plane that the leg's plane causes is added at its largest.
    """
    section = forces.design.elastic.section(loads.bar)
    normal = loads.coefficients[..., 0, :] / section.area
    bending = loads.coefficients[..., 2, :] * (section.radius / section.inertia_in)
    # |N| and |M| together are the larger one of |N + M| and |N - M|
    found = np.maximum(
        *(np.abs(largest_value(loads.places, normal + sign * bending)[0]) for sign in (1.0, -1.0))
    )
    if loads.bar == "b1":
        sideways = np.abs(arm_tip(forces).sideways).reshape(found.shape) * loads.length
        found = found + sideways * (section.radius / section.inertia_out)
    return np.asarray(found)


@kinds_checked
def utilization(forces: JointForces, bars: tuple[str, ...] = BARS) -> Array:
    """Return the largest stress of bars over the yield stress, (..., 3 legs, len(bars)) [1]."""
    strength = forces.design.elastic.yield_stress
    stress = [bar_stress(forces, bar_loads(forces, bar)) / strength for bar in bars]
    return np.stack(stress, axis=-1)


@kept(2)
def field_joint_forces(field: Field, design: Design) -> Array:
    """Return the largest force of each of `JOINTS` over the legs, and two moments, (12, ...).

    At rest under the design's load; [N], then the largest moments at M_k and at joint 2 [N m]. NaN
    where there are none.
    """

    def measure(forces: JointForces) -> Array:
        moments = np.abs(forces.moment[..., [JOINT_INDEX["m"], JOINT_INDEX["2"]]])
        return np.concatenate([forces.magnitude, moments], axis=-1).max(axis=1)

    return _over(field, design, measure)


@kept(2)
def field_bar_loads(field: Field, design: Design) -> Array:
    """Return `BAR_MEASURES` of the bar and leg where each is largest, (3, ...), at rest."""

    def measure(forces: JointForces) -> Array:
        found = []
        for bar in BARS:
            loads = bar_loads(forces, bar)
            stress = bar_stress(forces, loads) / design.elastic.yield_stress
            inner = np.abs(loads.largest((0, 2))[0])
            found.append(np.concatenate([inner, stress[..., None]], axis=-1))
        return np.stack(found).max(axis=(0, 2))

    return _over(field, design, measure)


def _over(field: Field, design: Design, measure: Callable[[JointForces], Array]) -> Array:
    """Evaluate measures (n, size) of poses (n, 4) over a field, (size, ...)."""
    with np.errstate(invalid="ignore"):
        found = in_blocks(
            lambda poses: [measure(joint_forces(design, poses))], field.grid.poses(), BLOCK
        )[0]
    found[field.status != Limit.OK] = np.nan
    return np.moveaxis(found, -1, 0)
