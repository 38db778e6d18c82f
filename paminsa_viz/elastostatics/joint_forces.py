"""Forces at the joints of all legs, from the equilibrium of every body (Newton-Euler).

With joint 5 a ball, a leg is statically determinate in its own plane (`solve_plane`), and so
are all of joint 5 and all drives: the platform's six equations give the sideways and the vertical
forces at the joints 5.

How the legs share sideways forces depends on their elasticity: with five redundant constraints a
leg, equilibrium does not say. Those components are NaN here (`NEEDS_STIFFNESS`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.elastostatics.leg_bodies import (
    LegBodies,
    Vector,
    angular_momentum_rate,
    bar_masses,
    leg_bodies,
)
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, together, unfolded
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import friction_torque
from paminsa_viz.model.jacobians import actuator_acceleration, actuator_velocity
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.leg import LegPosition, LegVector, mechanism
from paminsa_viz.model.load import center_wrench, flat_load
from paminsa_viz.model.reach import Limit, OfLimits, reach_status
from paminsa_viz.model.robot import platform_determinant, solve_wrench

# -------------------------------------------------------------- a leg in its plane, by substitution
# The bars B3, B4, B7, B8 and the slider have 14 equations in the plane, for the 12 components at
# the pins 8 (B8), 8 (B7), 9, 4, 7 and 3, the guide force, and the radial force at joint 5; its
# vertical one is given. B7 and B8 about joint 8, the slider along the guide, B4 about joint 4 and
# B3 about joint 3 give them one after the other. The radial force does not depend on the vertical
# one: with the shaft at rest joint 5 is free to move along r.


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


# ------------------------------------------------------------------------------ joints of the robot


class LegJoint(NamedTuple):
    """A joint of a leg. Its force is on the first body, from the second one.

    Attributes:
        key: Name in Python, in tables and files.
        label: Short name.
        on, by: Bodies; the first is nearer to the platform.
        turning: Whether the bearing turns; the guide slides.
    """

    key: str
    label: str
    on: str
    by: str
    turning: bool = True

    @property
    def name(self) -> str:
        """What it is of any leg: ``joint 2``, ``guide``, ``bearing of M``."""
        if self.key == "m":
            return "bearing of M"
        return f"joint {self.label}" if self.key[0].isdigit() else self.label


JOINTS: tuple[LegJoint, ...] = (
    LegJoint("m", "M_k", "B10", "base"),
    LegJoint("guide", "guide", "slider 8", "B10", turning=False),
    LegJoint("8_b8", "8 (B8)", "B8", "slider 8"),
    LegJoint("8_b7", "8 (B7)", "B7", "slider 8"),
    LegJoint("9", "9", "B4", "B8"),
    LegJoint("4", "4", "B4", "B3"),
    LegJoint("7", "7", "B3", "B7"),
    LegJoint("3", "3", "B3", "B2"),
    LegJoint("2", "2", "B2", "B1"),
    LegJoint("5", "5", "platform", "B4"),
)
"""Joints of a leg, from base to platform, in the order of results."""

JOINT_INDEX: dict[str, int] = {joint.key: index for index, joint in enumerate(JOINTS)}

NEEDS_STIFFNESS = (
    "statically indeterminate: a leg has five redundant constraints out of its plane, so its "
    "sideways shares follow from the stiffness of bars and bearings, not from equilibrium"
)
"""Why the tangential components but those of joint 5 are NaN."""


@dataclass(frozen=True, eq=False)
class JointForces(OfLimits):
    """Forces at the joints for poses of batch shape (...); NaN where ``status`` is not OK.

    Attributes:
        design: The robot.
        status: (...) values of `Limit`; ``SINGULAR`` where a force has no bound.
        leg: (...) index of the leg that is the reason, -1 for none.
        force: (..., 3 legs, 10 joints, 3) radial (toward the platform), tangential (along
            increasing theta_k) and vertical, on the first body of each of `JOINTS` [N]. Tangential
            components are NaN but for joint 5, see `NEEDS_STIFFNESS`.
        moment: (..., 3, 10) moment at each joint in the leg's plane, on the same body, positive
            from r to z [N m]. Zero at pins, and at the guide, as the pins lie on its line; at M_k
            and 2 those of the bearings about the tangential axis.
        torque: (..., 4) of M1..M3 [N m] and M4 [N], friction and drives' inertia included.
        axial: (...) force of M4's carriage on the three arms, upward [N]: the same as of M4 but
            for friction and the inertia of its drive.
        bodies: Motion and inertial loads, every field (n, 3 legs), n the size of the batch.
    """

    design: Design
    status: NDArray[np.uint8]
    leg: NDArray[np.int8]
    force: Array
    moment: Array
    torque: Array
    axial: Array
    bodies: LegBodies

    @property
    def magnitude(self) -> Array:
        """Size of each force in the leg's plane, at joint 5 in space, (..., 3, 10) [N]."""
        return magnitude(self.force)

    def of(self, joint: str) -> Array:
        """Return the force at a joint by its key, (..., 3 legs, 3) [N].

        Raises:
            InvalidInput: If there is no such joint.
        """
        if joint not in JOINT_INDEX:
            hint = name_hint(str(joint), JOINT_INDEX)
            raise InvalidInput("joint", f"there is no {joint!r:.60}; {hint}")
        return self.force[..., JOINT_INDEX[joint], :]


def magnitude(force: Array) -> Array:
    """Return sizes (..., 10) of forces (..., 10, 3) in the leg's plane, at joint 5 in space [N]."""
    size = np.hypot(force[..., 0], force[..., 2])
    five = JOINT_INDEX["5"]
    size[..., five] = np.hypot(size[..., five], force[..., five, 1])
    return size


@of_design
def joint_forces(
    design: Design,
    pose: ArrayLike,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    *,
    load: ArrayLike | None = None,
) -> JointForces:
    """Return the forces at all joints, at rest or for a platform motion, under the design's load.

    Args:
        design: The robot.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s]; zero if not given.
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2]; zero if not given.
        load: (..., 6) a wrench on top of the design's load, see `load.center_wrench` [N, N m].

    Raises:
        InvalidInput: If shapes do not fit or values are not real. Poses out of reach raise
            nothing; they are NaN, with the reason in ``status``.
    """
    zero = np.zeros(4)
    shape, (p, v, a) = together(
        pose=pose,
        velocity=zero if velocity is None else velocity,
        acceleration=zero if acceleration is None else acceleration,
    )
    geometry = design.geometry
    g, q = leg_states(geometry, p, v, a)
    wrench = center_wrench(design.load, p[:, 2], flat_load(load, shape))
    with np.errstate(all="ignore"):
        bodies = leg_bodies(design, g, q)
        pins = pin_equations(bodies)
        radial = radial_force(bodies, pins)
        tangential, vertical = _platform_forces(design, p, a, g, radial, wrench)
        plane = solve_plane(bodies, pins, Vector(radial, vertical))
        force, moment = _all_joints(bodies, plane, radial, tangential, vertical)
        torque = angular_momentum_rate(bodies) - tangential * g.rho
        axial = force[:, :, JOINT_INDEX["2"], 2] - design.links.b1 * bodies.lift_apparent
        axial = axial.sum(axis=-1)
        drives = np.concatenate([torque, axial[:, None]], axis=-1)
        if any(design.drive_inertia):
            drives += np.array(design.drive_inertia) * actuator_acceleration(geometry, p, v, a)
        if not design.actuator_friction.zero:
            speed = actuator_velocity(design, p, v)
            drives += friction_torque(design.actuator_friction, speed)
    status, leg = reach_status(geometry, p)
    known = np.isfinite(drives).all(axis=-1) & np.all(np.isfinite(magnitude(force)), axis=(1, 2))
    given = np.all(np.isfinite(np.concatenate([v, a, wrench], axis=-1)), axis=-1)
    lost = (status == Limit.OK) & ~known
    status[lost] = np.where(given[lost], np.uint8(Limit.SINGULAR), np.uint8(Limit.NOT_FINITE))
    bad = status != Limit.OK
    for values in (force, moment, drives, axial):
        values[bad] = np.nan
    status, leg, *found = unfolded((status, leg, force, moment, drives, axial), shape)
    force, moment, drives, axial = found
    return JointForces(design, status, leg, force, moment, drives, axial, bodies)


def _platform_forces(
    design: Design, pose: Array, acceleration: Array, g: LegPosition, radial: Any, wrench: Array
) -> tuple[Array, Array]:
    """Return sideways and vertical forces (n, 3) of the platform on the joints 5 [N].

    The platform's six equations: three in the plane for the sideways forces, singular at type-2
    singularities, and F_z, M_x, M_y for the vertical ones on an equilateral triangle of joints.
    """
    geometry, m = design.geometry, mechanism(design.geometry)
    mass = design.platform.mass + design.payload.mass
    inertia = design.platform.inertia + design.payload.inertia
    # What the legs give the platform is the negative of what it gives them.
    given = wrench[:, [0, 1, 5, 2]] - acceleration * np.array([mass, mass, inertia, mass])
    given[:, 3] -= mass * design.gravity
    fx, fy = radial * g.ux, radial * g.uy
    legs: Any = [
        LegVector(*(part[:, leg] for part in (g.px, g.py, g.ux * g.rho, g.uy * g.rho, g.rho**2)))
        for leg in range(3)
    ]
    determinant = platform_determinant(m, pose[:, 0], pose[:, 1], np.cos(pose[:, 2]))
    solved: Any = solve_wrench
    split = solved(
        determinant, *legs,
        given[:, 0] - fx.sum(axis=-1),
        given[:, 1] - fy.sum(axis=-1),
        given[:, 2] - (g.px * fy - g.py * fx).sum(axis=-1),
    )  # fmt: skip
    tangential = np.stack(split, axis=-1) * g.rho
    # Moments about P's horizontal axes: the joints 5 are l_B5 above it.
    height = geometry.platform_joint_height
    above = design.payload.mass * design.payload.height
    about_x = wrench[:, 3] + height * given[:, 1] + above * acceleration[:, 1]
    about_y = height * given[:, 0] - wrench[:, 4] + above * acceleration[:, 0]
    tilt = g.px * about_y[:, None] + g.py * about_x[:, None]
    vertical = given[:, 3:] / 3 + tilt * (2 / (3 * geometry.platform_radius**2))
    return tangential, vertical


def _all_joints(
    bodies: LegBodies, plane: PlaneForces, radial: Any, tangential: Any, vertical: Any
) -> tuple[Array, Array]:
    """Return forces (n, 3 legs, 10, 3) and moments (n, 3, 10) in the order of `JOINTS`."""
    design = bodies.design
    geometry, g, q = design.geometry, bodies.position, bodies.motion
    guide_mass, length = design.links.b10, geometry.guide_link_length
    shaft_mass = design.links.b2 + design.joints.j2
    reach = -mechanism(geometry).guide_ratio * g.rho
    force = np.full((*np.shape(g.rho), len(JOINTS), 3), np.nan)
    moment = np.zeros(force.shape[:-1])
    two = Vector(plane.three.r, plane.three.z - shaft_mass * bodies.lift_apparent)
    found = {
        "m": Vector(
            0.5 * guide_mass * length * q.beta_rate * q.beta_rate,
            plane.guide + guide_mass * design.gravity,
        ),
        "guide": Vector(0.0, plane.guide),
        "8_b8": plane.slider_b8,
        "8_b7": plane.slider_b7,
        "9": plane.nine,
        "4": plane.four,
        "7": plane.seven,
        "3": plane.three,
        "2": two,
        "5": Vector(-radial, -vertical),
    }
    for key, value in found.items():
        force[..., JOINT_INDEX[key], 0] = value.r
        force[..., JOINT_INDEX[key], 2] = value.z
    force[..., JOINT_INDEX["5"], 1] = -tangential
    moment[..., JOINT_INDEX["m"]] = reach * plane.guide - 0.5 * length * guide_mass * design.gravity
    moment[..., JOINT_INDEX["2"]] = geometry.shaft_length * plane.three.r
    return force, moment
