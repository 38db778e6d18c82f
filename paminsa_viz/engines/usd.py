"""The robot as a USD text (``.usda``) with UsdPhysics, for Isaac Sim, Newton and other readers.

There is one articulation, whose root is a base fixed to the world. The twelve loops are closed by
spherical joints: nine within the legs, three at the platform. Eleven have
``excludeFromArticulation``; the twelfth, joint 5 of leg 1, is the platform's place in the tree, as
PhysX has no articulation joint with six freedoms and Newton drops a body that is in no tree. Bodies
stand in the start pose; joint frames are such that joint values are the mechanism's own (theta_k,
Z, r_8, angles between bars). Units are meter, kilogram, second; USD's angles are degrees.

Bodies are those of `rigid_bodies`. Friction and load of the design are left out, as the schemas
have no place for them; the drives' inertia is ``newton:armature`` and ``physxJoint:armature`` of
the actuated joints, which the two programs read.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.mechanism import (
    PLATFORM,
    Link,
    MechanismTree,
    Part,
    Pin,
    Point,
    as_cylinder,
    build_mechanism,
    identifier,
    link_color,
)
from paminsa_viz.engines.mjcf import Servos
from paminsa_viz.engines.poses import start_pose, start_values, world_frames
from paminsa_viz.engines.rigid_bodies import rigid_bodies
from paminsa_viz.errors import printable
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.version import MADE_BY

BASE = "base"

BASE_PART = Part(BASE, 1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
"""The base is fixed: its numbers do nothing, but a body has to have some."""

_FLIPPED = Rotation.from_quat([1.0, 0.0, 0.0, 0.0])
_AXES: dict[Point, tuple[str, bool]] = {
    (1, 0, 0): ("X", False),
    (0, -1, 0): ("Y", True),
    (0, 0, 1): ("Z", False),
}
"""USD's name of a joint's axis, and whether its frame is turned over for it."""


def usd_text(
    design: Design, *, pose: Sequence[float] | None = None, servos: Servos | None = None
) -> str:
    """Write a design as a USD stage.

    Args:
        design: The robot.
        pose: Start pose (x, y, theta, z) [m, m, rad, m]; default `start_pose`.
        servos: Position drives of the actuated joints, which hold the start pose but for what
            gravity makes them yield; without them nothing drives the joints.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If a link has no mass or no inertia.
        UnreachablePose: If the robot cannot be in the start pose.
    """
    start = start_pose(design, pose)
    mechanism = build_mechanism(design)
    values = start_values(design, start)
    bodies, frames = rigid_bodies(mechanism), world_frames(mechanism, values)
    root = identifier(design.name)
    inside = [_scene(mechanism), _body(BASE_PART, (np.zeros(3), Rotation.identity()), [])]
    inside += [_body(bodies[link.name], frames[link.name], _rods(link)) for link in mechanism.links]
    drives = _drives(mechanism, values, servos)
    joints = [_root_joint(root)]
    joints += [
        _tree_joint(root, link, drives.get(link.joints[0].name, []))
        for link in mechanism.links
        if link.name != PLATFORM
    ]
    carrier = next(pin for pin in mechanism.pins if pin.second == PLATFORM)
    joints += [_ball_joint(root, pin, closes=pin is not carrier) for pin in mechanism.pins]
    inside.append(_prim("Scope", "joints", [], joints))
    about = noting_equal_legs(f"PAMINSA, written by {MADE_BY}", design.deviations)
    head = (
        "#usda 1.0\n(\n"
        f'    defaultPrim = "{root}"\n    doc = {_quoted(about)}\n'
        '    kilogramsPerUnit = 1\n    metersPerUnit = 1\n    upAxis = "Z"\n)\n\n'
    )
    name = f"displayName = {_quoted(printable(design.name))}"
    return head + _prim("Xform", root, [name, 'kind = "component"'], inside) + "\n"


def _prim(kind: str, name: str, meta: Sequence[str], lines: Iterable[str]) -> str:
    """Return a prim with its metadata, and its attributes and children, indented."""
    about = f" (\n{_indented(meta)}\n)" if meta else ""
    return f'def {kind} "{name}"{about}\n{{\n{_indented(lines)}\n}}'


def _indented(lines: Iterable[str]) -> str:
    return "\n".join(f"    {line}" for part in lines for line in part.split("\n"))


def _schemas(*names: str) -> str:
    return f"prepend apiSchemas = [{', '.join(map(_quoted, names))}]"


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _number(value: float) -> str:
    return repr(float(value) + 0.0)  # no negative zeros


def _vector(values: Iterable[float]) -> str:
    return f"({', '.join(map(_number, values))})"


def _quaternion(turn: Rotation) -> str:
    return _vector(turn.as_quat(canonical=True, scalar_first=True))


def _placed(place: Iterable[float], turn: Rotation) -> list[str]:
    return [
        f"double3 xformOp:translate = {_vector(place)}",
        f"quatd xformOp:orient = {_quaternion(turn)}",
        'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]',
    ]


def _scene(mechanism: MechanismTree) -> str:
    lines = [
        "vector3f physics:gravityDirection = (0, 0, -1)",
        f"float physics:gravityMagnitude = {_number(mechanism.gravity)}",
    ]
    return _prim("PhysicsScene", "scene", [], lines)


def _body(part: Part, frame: tuple[Array, Rotation], looks: list[str]) -> str:
    lines = [
        *_placed(*frame),
        f"float physics:mass = {_number(part.mass)}",
        f"point3f physics:centerOfMass = {_vector(part.center)}",
        f"float3 physics:diagonalInertia = {_vector(part.inertia)}",
        "quatf physics:principalAxes = (1, 0, 0, 0)",
        *looks,
    ]
    meta = [_schemas("PhysicsRigidBodyAPI", "PhysicsMassAPI")]
    return _prim("Xform", part.name, meta, lines)


def _rods(link: Link) -> list[str]:
    found = []
    color = f"color3f[] primvars:displayColor = [{_vector(link_color(link))}]"
    for number, rod in enumerate(link.rods, 1):
        bar = as_cylinder(rod)
        if bar is None:
            lines = [*_placed(rod.start, Rotation.identity())]
            kind, radius = "Sphere", rod.radius
        else:
            lines = [
                *_placed(bar.middle, bar.turn),
                'uniform token axis = "Z"',
                f"double height = {_number(bar.length)}",
            ]
            kind, radius = "Capsule", bar.radius
        lines += [f"double radius = {_number(radius)}", color]
        found.append(_prim(kind, f"rod{number}", [], lines))
    return found


def _between(
    root: str, first: str, second: str, place: Iterable[float], other: Iterable[float],
    turn: Rotation, other_turn: Rotation,
) -> list[str]:  # fmt: skip
    """Return which bodies a joint joins, and its frame in either."""
    return [
        *([f"rel physics:body0 = </{root}/{first}>"] if first else []),
        f"rel physics:body1 = </{root}/{second}>",
        f"point3f physics:localPos0 = {_vector(place)}",
        f"quatf physics:localRot0 = {_quaternion(turn)}",
        f"point3f physics:localPos1 = {_vector(other)}",
        f"quatf physics:localRot1 = {_quaternion(other_turn)}",
    ]


def _root_joint(root: str) -> str:
    none = Rotation.identity()
    lines = _between(root, "", BASE, (0, 0, 0), (0, 0, 0), none, none)
    meta = [_schemas("PhysicsArticulationRootAPI")]
    return _prim("PhysicsFixedJoint", "fixed", meta, lines)


def _tree_joint(root: str, link: Link, drive: list[str]) -> str:
    (joint,) = link.joints
    axis, flipped = _AXES[joint.axis]
    frame = _FLIPPED if flipped else Rotation.identity()
    turn = Rotation.from_euler("z", link.heading) * frame
    lines = [
        f'uniform token physics:axis = "{axis}"',
        *_between(root, link.parent or BASE, link.name, link.place, (0, 0, 0), turn, frame),
        *drive,
    ]
    way = "angular" if joint.kind == "hinge" else "linear"
    kind = "PhysicsRevoluteJoint" if joint.kind == "hinge" else "PhysicsPrismaticJoint"
    meta = [_schemas(f"PhysicsDriveAPI:{way}")] if drive else []
    return _prim(kind, joint.name, meta, lines)


def _ball_joint(root: str, pin: Pin, closes: bool) -> str:
    none = Rotation.identity()
    lines = _between(root, pin.first, pin.second, pin.first_point, pin.second_point, none, none)
    lines += ["bool physics:excludeFromArticulation = 1"] * closes
    return _prim("PhysicsSphericalJoint", pin.name, [], lines)


def _drives(
    mechanism: MechanismTree, values: dict[str, float], servos: Servos | None
) -> dict[str, list[str]]:
    """Return drive and armature of the actuated joints, by joint name; USD has degrees there."""
    found = {}
    joints = [joint for link in mechanism.links for joint in link.joints]
    hinges = {joint.name for joint in joints if joint.kind == "hinge"}
    for index, (joint, drive) in enumerate(zip(mechanism.actuated, mechanism.drives, strict=True)):
        name, per = ("angular", math.radians(1)) if joint in hinges else ("linear", 1.0)
        stiffness = servos.stiffness[index] * per if servos else 0.0
        damping = servos.damping[index] * per if servos else 0.0
        lines = [
            f'uniform token drive:{name}:physics:type = "force"',
            f"float drive:{name}:physics:stiffness = {_number(stiffness)}",
            f"float drive:{name}:physics:damping = {_number(damping)}",
            f"float drive:{name}:physics:targetPosition = {_number(values[joint] / per)}",
        ]
        if drive is not None:
            lines += [
                f"custom float {program}:armature = {_number(drive.reflected_inertia)}"
                for program in ("newton", "physxJoint")
            ]
        found[joint] = lines
    return found
