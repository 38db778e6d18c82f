"""Axial force N, shear force V and bending moment M along the bars, in their legs' planes.

N > 0 is tension; the other signs stand below, with e the direction from start to end.

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

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked
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

# ---------------------------------------------------------------------------- N, V, M along one bar
# A bar is cut at a distance s from its start; e is the direction from start to end, and n is e
# turned by +90 degrees, from r to z. The part beyond the cut acts on the part before it with the
# force N e - V n and the moment M (positive from r to z). So
#
#     N > 0: tension,    V > 0: turns a piece of the bar from z to r (clockwise),
#     M > 0: bends the bar hollow toward n,
#     dN/ds = -q_e,    dV/ds = q_n,    dM/ds = V - c,
#
# with the forces q and couple c on the bar for its length. The bars' masses and the couples of
# their inertias are spread evenly; pins, counterweights and joints act at points. A counterweight
# beyond an end of its bar acts on the end by its force and moment. Between points N and V are
# parabolas and M is a cubic, so that extremes are exact.

ALIKE = 1e-12
"""Sizes whose difference is a smaller share of them are the same but for rounding."""

COMPONENTS = ("N", "V", "M")
"""Axial force [N], shear force [N], bending moment [N m]."""


class PointLoad(NamedTuple):
    """A force [N] and a couple [N m] at a place on a bar [m]; components along e and n."""

    place: Any
    along: Any
    across: Any
    couple: Any = 0.0


@dataclass(frozen=True, eq=False)
class BarLoads:
    """N, V and M along one bar of all legs; batch shape (...), which ends with the three legs.

    Attributes:
        bar: Key of the bar.
        length: Of the bar [m].
        places: (..., points) where forces act, sorted, from 0 to the length [m].
        coefficients: (..., points - 1, 3, 4) of N, V, M between them, as polynomials of the
            distance from the point before, constant first.
        residual: (..., 3) N, V and M left behind the end [N, N, N m]; zero in equilibrium.
    """

    bar: str
    length: float
    places: Array
    coefficients: Array
    residual: Array

    def at(self, s: ArrayLike) -> Array:
        """Return N, V, M at places s (m,), (..., m, 3) [N, N, N m]; at a point load beyond it.

        At the end it is what the last point load acts against.
        """
        s = np.asarray(s, dtype=np.float64)
        inner = self.places[..., 1:-1]
        index = (s[:, None] >= inner[..., None, :]).sum(axis=-1)
        start = np.take_along_axis(self.places, index, axis=-1)
        chosen = np.take_along_axis(self.coefficients, index[..., None, None], axis=-3)
        return _polynomial(chosen, (s - start)[..., None])

    def extremes(self) -> Array:
        """Return N, V, M that are largest in size, with their signs, (..., 3) [N, N, N m]."""
        return self.largest()[0]

    def largest(self, components: tuple[int, ...] = (0, 1, 2)) -> tuple[Array, Array]:
        """Return what is largest in size, with its sign, and where it is [m].

        Args:
            components: Indices into `COMPONENTS`.

        Returns:
            Two arrays (..., len(components)).
        """
        found = [
            largest_value(self.places, self.coefficients[..., component, :])
            for component in components
        ]
        return np.stack([f[0] for f in found], -1), np.stack([f[1] for f in found], -1)


def largest_value(places: Array, coefficients: Array) -> tuple[Array, Array]:
    """Return the value of piecewise cubics that is largest in size, with its sign, and its place.

    Of values alike but for rounding, such as the shear at both ends of a bar that only its own
    weight bends, it is one at a start of a piece before one at an end, and of several the first.

    Args:
        places: (..., points) ends of the pieces.
        coefficients: (..., points - 1, 4) of the distance from a piece's start, constant first.

    Returns:
        Two arrays (...).
    """
    c = np.moveaxis(coefficients, (-1, -2), (0, 1))
    start = np.moveaxis(places, -1, 0)
    step = np.diff(start, axis=0)
    with np.errstate(all="ignore"):
        # where the derivative is zero; of a parabola, c_3 = 0, the second root is left
        half = -(c[2] + np.copysign(np.sqrt(c[2] * c[2] - 3 * c[3] * c[1]), c[2]))
        x = np.stack([np.zeros_like(step), step, half / (3 * c[3]), c[1] / half])
        x[2:] = np.where((x[2:] > 0) & (x[2:] < step), x[2:], 0.0)
    values = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    values = values.reshape(math.prod(values.shape[:2]), *values.shape[2:])
    reached = (start[:-1] + x).reshape(values.shape)
    sizes = np.abs(values)
    # a NaN is the largest, as of `max`
    largest = np.isnan(sizes) | (sizes >= (1.0 - ALIKE) * sizes.max(axis=0))
    best = largest.argmax(axis=0)[None]
    return (
        np.take_along_axis(values, best, axis=0)[0],
        np.take_along_axis(reached, best, axis=0)[0],
    )


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Evaluate polynomials (..., 4), constant first, at x (...)."""
    c0, c1, c2, c3 = np.moveaxis(coefficients, -1, 0)
    return np.asarray(c0 + x * (c1 + x * (c2 + x * c3)))


def make_diagram(
    batch: tuple[int, ...],
    bar: str,
    length: float,
    points: list[PointLoad],
    spread: tuple[Any, Any, Any, Any],
    couple: Any,
) -> BarLoads:
    """Add up the loads of a bar from its start.

    Args:
        batch: Batch shape of the result, (..., 3).
        bar, length: Key and length [m].
        points: Loads at points, sorted unless all places are numbers.
        spread: Load along at start and end, load across at start and end, linear between [N/m].
        couple: Couple for the length [N].
    """
    flat = (math.prod(batch) // 3, 3)
    if all(isinstance(point.place, float) for point in points):
        points = sorted(points, key=lambda point: point.place)
    sorted_places: list[Any] = [0.0]
    jumps = [np.zeros((3, *flat))]
    for point in (*points, PointLoad(length, 0.0, 0.0)):
        if point.place is not sorted_places[-1] and not _same(point.place, sorted_places[-1]):
            sorted_places.append(point.place)
            jumps.append(np.zeros((3, *flat)))
        jumps[-1][0] -= point.along
        jumps[-1][1] += point.across
        jumps[-1][2] -= point.couple
    if len(sorted_places) == 1:  # a bar without length
        sorted_places.append(length)
        jumps.append(np.zeros((3, *flat)))
    places = np.stack([np.broadcast_to(place, flat) for place in sorted_places])
    step = np.diff(places, axis=0)
    c = np.zeros((3, 4, len(step), *flat))
    along0, along1, across0, across1 = spread
    rise_along = (along1 - along0) / length if length else 0.0
    rise_across = (across1 - across0) / length if length else 0.0
    now = jumps[0]
    for index, x in enumerate(step):
        along = along0 + rise_along * places[index]
        across = across0 + rise_across * places[index]
        c[:, 0, index] = now
        c[0, 1, index], c[0, 2, index] = -along, -0.5 * rise_along
        c[1, 1, index], c[1, 2, index] = across, 0.5 * rise_across
        c[2, 1, index] = now[1] - couple
        c[2, 2, index], c[2, 3, index] = 0.5 * across, rise_across / 6
        c0, c1, c2, c3 = (c[:, power, index] for power in range(4))
        now = c0 + x * (c1 + x * (c2 + x * c3)) + jumps[index + 1]
    return BarLoads(
        bar,
        length,
        np.moveaxis(places, 0, -1).reshape(*batch, len(places)),
        np.moveaxis(c.reshape(*c.shape[:3], *batch), (2, 0, 1), (-3, -2, -1)),
        np.moveaxis(now, 0, -1).reshape(*batch, 3),
    )


def _same(one: Any, other: Any) -> bool:
    return isinstance(one, float) and isinstance(other, float) and one == other


# ---------------------------------------------------------------------------- the bars of the robot

BAR_NAMES: dict[str, str] = {bar: bar.upper() for bar in BARS}
"""Bars by key."""

BLOCK = 2**11
"""Poses worked on at a time; their forces take some 3 MB, those of bars three times as much."""

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
    """Return the largest stress of bars over the yield stress, (..., 3 legs, len(bars)) [1].

    Raises:
        InvalidInput: If there is no bar, or none of a name.
    """
    if not bars:
        raise InvalidInput("bars", "at least one bar is needed")
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
