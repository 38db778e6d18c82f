"""First-principles mechanics of the PAMINSA, for the tests only.

Nothing here comes from the paper's appendices 2 and 3 or from its Lagrange equations. Every joint
mass is a point, every link a rigid body with a mass center, a frame and principal inertias; their
places follow from the geometry of the mechanism (8, 3, 5 in one line, 8-9-4-7 a parallelogram).
Velocities, accelerations and Jacobians are exact derivatives by truncated Taylor series
(`tests.jets`), and the actuator forces come from the principle of virtual power:

    Q_pose,j = sum_i  dr_i/dq_j . m_i (r_i'' + g) + dw_i/dq_j' . (I_i w_i' + w_i x I_i w_i)

pulled back to the actuators through the derivative of the inverse kinematics. Accuracy: rounding
(about 1e-14 of the largest term). Shapes: poses (..., 4) = (x, y, theta, z) [m, m, rad, m]; forces
(..., 4) = (tau_1, tau_2, tau_3 [N m], F_4 [N]).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from paminsa_viz.model.design import Design
from tests.jets import Jet, cos, sin, sqrt

Vector = tuple[Any, Any, Any]
AXIS_ANGLES = np.radians([210.0, -30.0, 90.0])
UP: Vector = (0.0, 0.0, 1.0)


def add(a: Vector, b: Vector, scale: Any = 1.0) -> Vector:
    """a + scale * b."""
    return (a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2])


def minus(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def between(a: Vector, b: Vector, share: float = 0.5) -> Vector:
    """The point at ``share`` of the way from a to b."""
    return add(a, minus(b, a), share)


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector, b: Vector) -> Any:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a: Vector) -> Vector:
    """a / |a|."""
    length = sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length)


@dataclass(frozen=True)
class Body:
    """A rigid body: mass [kg], mass center [m], axes of its frame, inertias about them [kg m^2]."""

    name: str
    mass: float
    center: Vector
    axes: tuple[Vector, Vector, Vector] | None = None
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Leg:
    """One leg solved at a pose: joint points by the paper's number, and the leg plane's heading."""

    points: dict[int, Vector]
    heading: Vector
    normal: Vector


def leg(design: Design, q: tuple[Any, Any, Any, Any], index: int) -> Leg:
    """Place the joints of one leg at the pose coordinates q (numbers, arrays or jets)."""
    g = design.geometry
    x, y, theta, z = q
    k = g.magnification
    angle = AXIS_ANGLES[index]
    base = (g.base_radius * np.cos(angle), g.base_radius * np.sin(angle), 0.0)
    p5 = (
        x + g.platform_radius * cos(theta + angle),
        y + g.platform_radius * sin(theta + angle),
        z + g.platform_joint_height,
    )
    outward = minus((p5[0], p5[1], 0.0), base)
    heading = unit(outward)
    distance = sqrt(dot(outward, outward))
    p8 = add(base, heading, -1.0 * distance / (k - 1.0))
    p3 = (base[0], base[1], p5[2] / k)
    # The knee: l_B8 from 8 and l_B4 from 5, in the leg's plane; law of cosines in triangle 8-9-5.
    span = minus(p5, p8)
    length = sqrt(dot(span, span))
    along = unit(span)
    normal = cross(UP, heading)
    above = cross(along, normal)
    foot = (length * length + g.crank_length**2 - g.coupler_length**2) / (2.0 * length)
    height = sqrt(g.crank_length**2 - foot * foot)
    p9 = add(add(p8, along, foot), above, -design.geometry.knee.sign * height)
    link = minus(p5, p9)
    points = {
        2: (base[0], base[1], p3[2] + g.shaft_length),
        3: p3,
        4: add(p9, link, 1.0 / k),
        5: p5,
        7: add(p8, link, 1.0 / k),
        8: p8,
        9: p9,
    }
    return Leg(points, heading, normal)


def bodies(design: Design, q: tuple[Any, Any, Any, Any]) -> list[Body]:
    """List every body of the robot at the pose coordinates q (numbers, arrays or jets)."""
    g, links, inertias = design.geometry, design.links, design.inertias
    found: list[Body] = []
    for index in range(3):
        solved = leg(design, q, index)
        p, heading, normal = solved.points, solved.heading, solved.normal
        tag = f"leg {index + 1}: "
        for joint in (2, 3, 4, 5, 7, 8, 9):
            found.append(Body(f"{tag}joint {joint}", getattr(design.joints, f"j{joint}"), p[joint]))
        upright = (heading, normal, UP)
        arm = np.cos(AXIS_ANGLES[index]), np.sin(AXIS_ANGLES[index])
        reach = g.base_radius - 0.5 * g.arm_length
        found.append(Body(f"{tag}B1", links.b1, (reach * arm[0], reach * arm[1], p[2][2])))
        found.append(
            Body(f"{tag}B2", links.b2, between(p[3], p[2]), upright, (0, 0, inertias.b2_vertical))
        )
        for name, start, end in (("b3", 7, 4), ("b4", 9, 5), ("b7", 8, 7), ("b8", 8, 9)):
            axis = unit(minus(p[end], p[start]))
            across = getattr(inertias, f"{name}_transverse")
            found.append(
                Body(
                    tag + name.upper(),
                    getattr(links, name),
                    between(p[start], p[end]),
                    (axis, normal, cross(axis, normal)),
                    (getattr(inertias, f"{name}_axial"), across, across),
                )
            )
        foot = (p[3][0], p[3][1], 0.0)
        guide = add(foot, heading, -0.5 * g.guide_link_length)
        found.append(Body(f"{tag}B10", links.b10, guide, upright, (0, 0, inertias.b10_vertical)))
    x, y, theta, z = q
    turned = ((cos(theta), sin(theta), 0.0), (-1.0 * sin(theta), cos(theta), 0.0), UP)
    platform, payload = design.platform, design.payload
    found.append(Body("platform", platform.mass, (x, y, z), turned, (0, 0, platform.inertia)))
    center = (x, y, z + payload.height)
    found.append(Body("payload", payload.mass, center, turned, (0, 0, payload.inertia)))
    return found


def split(values: Any) -> tuple[Any, Any, Any, Any]:
    """Separate the last axis of a pose array."""
    values = np.asarray(values)
    values = values if np.iscomplexobj(values) else values.astype(float)
    return values[..., 0], values[..., 1], values[..., 2], values[..., 3]


def jets(pose: Any, rate: Any, second: Any = None) -> tuple[Any, Any, Any, Any]:
    """The curve pose + rate t + second t^2 / 2 as four jets."""
    pose, rate = np.broadcast_arrays(np.asarray(pose, float), np.asarray(rate, float))
    second = np.zeros_like(pose) if second is None else np.asarray(second, float)
    return tuple(  # type: ignore[return-value]
        Jet(pose[..., i], rate[..., i], 0.5 * second[..., i]) for i in range(4)
    )


def rate(v: Vector) -> Vector:
    """First derivative of a vector of jets and constants."""
    return tuple(c.rate if isinstance(c, Jet) else 0.0 for c in v)  # type: ignore[return-value]


def second(v: Vector) -> Vector:
    """Second derivative of a vector of jets and constants."""
    return tuple(c.second if isinstance(c, Jet) else 0.0 for c in v)  # type: ignore[return-value]


def value(v: Vector) -> Vector:
    """Value of a vector of jets and constants."""
    return tuple(c.a if isinstance(c, Jet) else c for c in v)  # type: ignore[return-value]


def turning(body: Body, of: Any = rate) -> Vector:
    """Angular velocity (``of=rate``) or acceleration (``of=second``) of a body given in jets.

    For orthonormal axes e_i, w = sum e_i x e_i' / 2; as e_i' x e_i' = 0, w' = sum e_i x e_i'' / 2.
    """
    total: Vector = (0.0, 0.0, 0.0)
    for axis in body.axes or ():
        total = add(total, cross(value(axis), of(axis)), 0.5)
    return total


def rotated(body: Body, w: Vector) -> Vector:
    """The body's inertia tensor times w."""
    total: Vector = (0.0, 0.0, 0.0)
    for axis, inertia in zip(body.axes or (), body.inertia, strict=False):
        direction = value(axis)
        total = add(total, direction, inertia * dot(direction, w))
    return total


def potential(design: Design, pose: Any) -> Any:
    """Potential energy [J], heights above z = 0; complex poses give complex values."""
    total = sum(body.mass * body.center[2] for body in bodies(design, split(pose)))
    return design.gravity * total


def kinetic(design: Design, pose: Any, velocity: Any) -> Any:
    """Kinetic energy [J] at a pose and its rate (..., 4) [m/s, m/s, rad/s, m/s]."""
    total: Any = 0.0
    for body in bodies(design, jets(pose, velocity)):
        v, w = rate(body.center), turning(body)
        total = total + 0.5 * body.mass * dot(v, v) + 0.5 * dot(w, rotated(body, w))
    return total


def actuators(design: Design, pose: Any) -> Any:
    """Actuator values (..., 4) = (theta_1, theta_2, theta_3 [rad], Z [m]) of real poses."""
    q = split(pose)
    columns = []
    top: Any = None
    for index in range(3):
        solved = leg(design, q, index)
        home = AXIS_ANGLES[index] + np.pi
        h = solved.heading
        ahead = h[0] * np.cos(home) + h[1] * np.sin(home)
        aside = h[1] * np.cos(home) - h[0] * np.sin(home)
        columns.append(np.arctan2(aside, ahead))
        top = solved.points[2][2]
    return np.stack(np.broadcast_arrays(*columns, top), axis=-1)


def actuator_rates(design: Design, pose: Any, velocity: Any) -> Any:
    """Rates of the actuators (..., 4) at a pose and its rate."""
    q = jets(pose, velocity)
    columns, top = [], None
    for index in range(3):
        solved = leg(design, q, index)
        columns.append(cross(value(solved.heading), rate(solved.heading))[2])
        top = rate(solved.points[2])[2]
    return np.stack(np.broadcast_arrays(*columns, top), axis=-1)


def actuator_jacobian(design: Design, pose: Any) -> Any:
    """Derivative of the actuators in the pose coordinates, (..., 4 actuators, 4 coordinates)."""
    rates = actuator_rates(design, np.asarray(pose, float)[..., None, :], np.eye(4))
    return np.swapaxes(rates, -1, -2)


def pose_forces(
    design: Design,
    pose: Any,
    velocity: Any,
    acceleration: Any,
) -> Any:
    """Generalized forces (..., 4) on (x, y, theta, z) that cause the motion, gravity included."""
    pose, velocity, acceleration = np.broadcast_arrays(
        *(np.asarray(a, float) for a in (pose, velocity, acceleration))
    )
    moving = bodies(design, jets(pose, velocity, acceleration))
    forces = []
    for body in moving:
        linear = add(second(body.center), UP, design.gravity)
        w = turning(body)
        moment = add(rotated(body, turning(body, second)), cross(w, rotated(body, w)))
        forces.append((tuple(body.mass * c for c in linear), moment))
    virtual = bodies(design, jets(pose[..., None, :], np.eye(4)))
    total: Any = np.zeros(pose.shape)
    for body, parts in zip(virtual, forces, strict=True):
        force, moment = (tuple(np.asarray(c)[..., None] for c in part) for part in parts)
        total = total + dot(rate(body.center), force) + dot(turning(body), moment)
    return total


def inverse_dynamics(
    design: Design,
    pose: Any,
    velocity: Any,
    acceleration: Any,
) -> Any:
    """Actuator forces (..., 4) = (tau_1, tau_2, tau_3 [N m], F_4 [N]) without joint friction."""
    needed = pose_forces(design, pose, velocity, acceleration)
    jacobian = np.broadcast_to(actuator_jacobian(design, pose), (*needed.shape, 4))
    return np.linalg.solve(np.swapaxes(jacobian, -1, -2), needed[..., None])[..., 0]


def static_torques(design: Design, pose: Any) -> Any:
    """Actuator forces (..., 4) that hold the robot at rest against gravity."""
    return inverse_dynamics(design, pose, np.zeros(4), np.zeros(4))
