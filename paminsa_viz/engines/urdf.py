"""The robot as a URDF, a tree for ROS and other readers, and its loops as a table beside it.

A URDF holds no loops. What ``<mimic>`` can say is that the bars of a pantograph stay parallel, B7
to B4 and B3 to B8. For that B7 hangs on B8 here, so that one joint says its angle: B7 turns against
B8, and B3 against B4 the other way, as much as joint 9 does. The platform slides along x, y, z and
turns by theta, one joint each. What is left open, joints 2, 3 and 5 of each leg, stands with all
closures in the table: joint values that satisfy them are those of the robot. (Joint 2 could be
mimicked, too, but Pinocchio reads no joint that follows one of another branch.)

Bodies are those of `rigid_bodies`. Of drives there is their largest torque or force and speed;
their inertia, friction and gravity have no place in a URDF.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from scipy.spatial.transform import Rotation

from paminsa_viz.engines.mechanism import (
    ORIGIN,
    PLATFORM,
    POSE_JOINTS,
    Joint,
    Link,
    MechanismTree,
    Part,
    Point,
    as_cylinder,
    build_mechanism,
    identifier,
    leg_name,
    link_color,
)
from paminsa_viz.engines.rigid_bodies import LEAST_INERTIA, rigid_bodies
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import workspace_height, workspace_radius
from paminsa_viz.version import MADE_BY

BASE = "base"

MOST_EFFORT, MOST_SPEED = 1000.0, 10.0
"""Limits of sliding joints, which the format demands and a design may not know [N], [m/s].

`docs/machine.md` states them.
"""

EMPTY_SHARE = 1e-9
"""Mass of the links between the platform's joints, over the platform's.

The robot has no such links. Without a mass, MuJoCo refuses them and PyBullet gives each 1 kg.
"""

MIMICKED_PIN = "pin7"
"""The closure of a leg that the mimicking joints satisfy."""


@of_design
def urdf_text(design: Design) -> str:
    """Write a design as a URDF.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If a link has no mass or no inertia.
    """
    mechanism = build_mechanism(design)
    bodies = rigid_bodies(mechanism)
    mimics, limits = _mimics(), _limits(design, mechanism)
    reach = 2 * (workspace_radius(design.geometry) + workspace_height(design.geometry))
    robot = ET.Element("robot", name=identifier(design.name))
    about = f"written by {MADE_BY}; loops are in a table of their own"
    robot.append(ET.Comment(f" {noting_equal_legs(about, design.deviations)} "))
    _add(robot, "link", name=BASE)
    for link in map(_hung, mechanism.links):
        if link.name == PLATFORM:
            _add_platform(robot, link, bodies[PLATFORM], reach, limits)
            continue
        _add_link(robot, link, bodies[link.name])
        (joint,) = link.joints
        place = link.place, (0.0, 0.0, link.heading)
        _add_joint(robot, joint, link.parent or BASE, link.name, *place, reach, limits, mimics)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


@of_design
def closure_table(design: Design) -> dict[str, Any]:
    """Return the loop closures of the URDF, for a JSON file beside it.

    Each has its name, two links with a point [m] in the frame of either, which coincide in the
    closed robot, and whether the mimicking joints see to it; the actuated joints are named too.
    """
    mechanism = build_mechanism(design)
    closures = [
        {
            "name": pin.name,
            "links": [pin.first, pin.second],
            "points": [list(map(float, pin.first_point)), list(map(float, pin.second_point))],
            "by_mimic": pin.name.endswith(MIMICKED_PIN),
        }
        for pin in mechanism.pins
    ]
    return {
        "made_by": MADE_BY,
        "units": "m",
        "actuated": list(mechanism.actuated),
        "closures": closures,
    }


def _hung(link: Link) -> Link:
    """Return a link as it hangs in the URDF's tree: B7 on B8, as both start at joint 8."""
    if link.leg is None or link.name != leg_name(link.leg, "B7"):
        return link
    return replace(link, parent=leg_name(link.leg, "B8"))


def _mimics() -> dict[str, tuple[str, float]]:
    """Return the joint that each mimicking joint follows, and by which factor."""
    found = {}
    for leg in range(3):
        found[leg_name(leg, "bar7")] = leg_name(leg, "bar4"), 1.0
        found[leg_name(leg, "bar3")] = leg_name(leg, "bar4"), -1.0
    return found


def _limits(design: Design, mechanism: MechanismTree) -> dict[str, tuple[float, float]]:
    """Return effort and speed of each joint that has limits: slides, and what a drive moves.

    The format has no joint with only one of them: a drive of a hinge without one limits nothing.
    """
    joints = (joint for link in mechanism.links for joint in link.joints)
    found = {joint.name: (MOST_EFFORT, MOST_SPEED) for joint in joints if joint.kind == "slide"}
    for name, own in zip(mechanism.actuated, design.output_limits, strict=True):
        effort, speed = found.get(name, (math.inf, math.inf))
        effort = own.peak if math.isfinite(own.peak) else effort
        speed = own.speed if math.isfinite(own.speed) else speed
        if math.isfinite(effort) and math.isfinite(speed):
            found[name] = effort, speed
    return found


def _add(parent: ET.Element, tag: str, **attributes: object) -> ET.Element:
    return ET.SubElement(parent, tag, {key: _text(value) for key, value in attributes.items()})


def _text(value: object) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return " ".join(map(_text, value))
    return repr(float(value) + 0.0)  # type: ignore[arg-type]


def _add_platform(
    robot: ET.Element, link: Link, body: Part, reach: float,
    limits: dict[str, tuple[float, float]],
) -> None:  # fmt: skip
    """Add the platform behind a chain of its four joints, with empty links between them."""
    joints = {joint.name: joint for joint in link.joints}
    before = BASE
    x, y, theta, z = POSE_JOINTS
    inertia = LEAST_INERTIA, LEAST_INERTIA, LEAST_INERTIA
    empty = Part("empty", EMPTY_SHARE * body.mass, ORIGIN, inertia)
    for name in (x, y, z, theta):
        after = PLATFORM if name == theta else f"{name}_slide"
        if name == theta:
            _add_link(robot, link, body)
        else:
            _add_inertial(_add(robot, "link", name=after), empty)
        _add_joint(robot, joints[name], before, after, ORIGIN, ORIGIN, reach, limits, {})
        before = after


def _add_link(robot: ET.Element, link: Link, body: Part) -> None:
    element = _add(robot, "link", name=link.name)
    _add_inertial(element, body)
    for rod in link.rods:
        visual = _add(element, "visual")
        bar = as_cylinder(rod)
        if bar is None:
            _add(visual, "origin", xyz=rod.start, rpy=ORIGIN)
            _add(_add(visual, "geometry"), "sphere", radius=rod.radius)
        else:
            _add(visual, "origin", xyz=bar.middle, rpy=_angles(bar.turn))
            _add(_add(visual, "geometry"), "cylinder", radius=bar.radius, length=bar.length)
        painted = link.name if link.leg is None else leg_name(link.leg, "color")
        material = _add(visual, "material", name=painted)
        _add(material, "color", rgba=(*link_color(link), 1.0))


def _add_inertial(element: ET.Element, body: Part) -> None:
    inertial = _add(element, "inertial")
    _add(inertial, "origin", xyz=body.center, rpy=ORIGIN)
    _add(inertial, "mass", value=body.mass)
    ixx, iyy, izz = body.inertia
    _add(inertial, "inertia", ixx=ixx, ixy=0, ixz=0, iyy=iyy, iyz=0, izz=izz)


def _angles(turn: Rotation) -> list[float]:
    """Return roll, pitch and yaw about fixed axes [rad], as URDF has them."""
    # Of a rod only the direction of z counts: a turn about it would be a gimbal lock's.
    x, y, z = turn.as_matrix()[:, 2].tolist()
    return [0.0, math.atan2(math.hypot(x, y), z), math.atan2(y, x)]


def _add_joint(
    robot: ET.Element, joint: Joint, parent: str, child: str, place: Point, turn: Point,
    reach: float, limits: dict[str, tuple[float, float]], mimics: dict[str, tuple[str, float]],
) -> None:  # fmt: skip
    kind = "continuous" if joint.kind == "hinge" else "prismatic"
    element = _add(robot, "joint", name=joint.name, type=kind)
    _add(element, "origin", xyz=place, rpy=turn)
    _add(element, "parent", link=parent)
    _add(element, "child", link=child)
    _add(element, "axis", xyz=joint.axis)
    if joint.name in limits:
        ends = {"lower": -reach, "upper": reach} if joint.kind == "slide" else {}
        effort, velocity = limits[joint.name]
        _add(element, "limit", **ends, effort=effort, velocity=velocity)
    if joint.name in mimics:
        followed, factor = mimics[joint.name]
        _add(element, "mimic", joint=followed, multiplier=factor, offset=0)
