"""The robot as an MJCF text for MuJoCo, written without needing MuJoCo.

All numbers are written in full precision, so that the text carries the design exactly. The model
is assembled in its start pose when it is loaded; hinge and slide values are the mechanism's own
(pose, theta_k, Z, r_8, angles between bars), not offsets from that pose.

Pinocchio's reader of MJCF takes the same text: the tree with all its masses, and from version 4 on
the loop closures too (``buildModelAndLegacyConstraintsFromMJCF``), but not gravity, which has to be
set where it is not 9.81 m/s^2. A URDF carries no loops, see `urdf`.

Two things that MuJoCo needs: a moving body may not be without mass or inertia, so a zero becomes
`FLOOR`; and loops are closed by soft constraints, which are set as stiff as the time step allows.
Friction of the design is left out: MuJoCo's dry friction is another law than the model's. The
inertia of its drives is the ``armature`` of the actuated joints.

MJCF has no place for ``xfrc_applied``. Where the design's load is asked for, it is an actuator
``load`` on a site of the platform, whose force is the wrench times 1 + its control: it acts as soon
as the model is loaded, and a control of -1 takes it away.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from paminsa_viz.engines.mechanism import (
    LEAST_ROD,
    PLATFORM,
    MechanismTree,
    Part,
    Point,
    Rod,
    build_mechanism,
    link_color,
)
from paminsa_viz.engines.poses import link_frame, start_pose, start_values
from paminsa_viz.errors import printable
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.design import Design
from paminsa_viz.model.load import LoadFrame

FLOOR = 2e-15
"""Mass [kg] and inertia [kg m^2] of a moving body that has none; MuJoCo refuses less than 1e-15."""

TIME_STEP = 5e-4
"""Time step of the exported model [s]."""

SERVO_FREQUENCY = 100.0
"""Natural frequency of the position servos [rad/s]."""


@dataclass(frozen=True)
class Servos:
    """Position servos about the start position, one for each actuator.

    A control is the wanted deviation from the start position [rad, rad, rad, m], so that a model
    just loaded, with all controls zero, does not move.

    Attributes:
        stiffness: Gain on the position (4,) [N m/rad, N/m].
        damping: Gain on the speed (4,) [N m s/rad, N s/m].
    """

    stiffness: tuple[float, ...]
    damping: tuple[float, ...]

    @classmethod
    def critical(cls, inertia: Sequence[Sequence[float]] | np.ndarray) -> Servos:
        """Return critically damped servos of `SERVO_FREQUENCY`.

        Args:
            inertia: Mass matrix of the robot in its actuators (4, 4). Each servo is set for what it
                feels when the others are free, 1 / (M^-1)_ii; stronger ones would be unstable at
                the exported time step.
        """
        felt = 1.0 / np.diag(np.linalg.inv(np.asarray(inertia, float)))
        stiffness = felt * SERVO_FREQUENCY**2
        return cls(tuple(stiffness.tolist()), tuple((2 * felt * SERVO_FREQUENCY).tolist()))


def mjcf_text(
    design: Design,
    *,
    pose: Sequence[float] | None = None,
    holding: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
    servos: Servos | None = None,
    load: bool = False,
) -> str:
    """Write a design as an MJCF model.

    Args:
        design: The robot.
        pose: Start pose (x, y, theta, z) [m, m, rad, m]; default `start_pose`.
        holding: Forces (tau_1..3 [N m], F_4 [N]) that hold the start pose. Servos add them to
            their own, so that they hold without sagging; motors find them in keyframe ``start``.
        servos: Position servos as actuators; without them plain motors, whose controls are torques
            [N m] and a force [N].
        load: Whether the design's load acts, by an actuator of its own.

    Raises:
        InvalidDesign: If a bar's inertias belong to no rigid body.
        UnreachablePose: If the robot cannot be in the start pose.
    """
    start = start_pose(design, pose)
    mechanism = build_mechanism(design)
    values = start_values(design, start)
    root = ET.Element("mujoco", model=printable(design.name))
    if note := equal_legs_note(design.deviations):
        root.append(ET.Comment(f" {note} "))
    _add(root, "compiler", angle="radian", autolimits="true")
    # Euler: the implicit integrators damp servos apart from the closures, which is unstable here.
    _add(
        root, "option", timestep=TIME_STEP, gravity=(0, 0, -design.gravity), integrator="Euler",
        iterations=50, tolerance=1e-12, jacobian="dense",
    )  # fmt: skip
    default = _add(root, "default")
    # Looks only: geoms without mass that touch nothing.
    _add(default, "geom", contype=0, conaffinity=0, mass=0, group=1)
    _add(default, "equality", solref=(2 * TIME_STEP, 1), solimp=(0.9999, 0.9999, 0.001, 0.5, 2))
    _add(default, "site", group=4, size=0.005)
    size = design.geometry.coupler_length + design.geometry.crank_length
    _add(root, "statistic", center=(0, 0, start[3] / 2), extent=1.5 * size)
    _add(_add(root, "visual"), "global", azimuth=120, elevation=-15)
    _add(
        _add(root, "asset"), "texture", type="skybox", builtin="gradient", width=256, height=256,
        rgb1=(0.95, 0.96, 0.97), rgb2=(0.75, 0.79, 0.83),
    )  # fmt: skip
    world = _add(root, "worldbody")
    _add(world, "light", pos=(0, 0, 3 * size), dir=(0, 0, -1), directional="true")
    # One root, so that Pinocchio's reader, which takes only the first body, takes the whole robot.
    _add_links(_add(world, "body", name="base"), mechanism, values)
    _add_closures(root, mechanism)
    actuators = _add_actuators(root, mechanism, design, values, holding, servos)
    if load and design.load.acts:
        _add_load(root, actuators, design)
        for key in root.iter("key"):
            key.set("ctrl", f"{key.attrib['ctrl']} 0")
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _number(value: object) -> str:
    """Write a value for an attribute; floats with all their digits."""
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return " ".join(_number(item) for item in value)
    number = float(value)  # type: ignore[arg-type]
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def _add(parent: ET.Element, tag: str, **attributes: object) -> ET.Element:
    return ET.SubElement(parent, tag, {key: _number(value) for key, value in attributes.items()})


def _inertial(body: ET.Element, part: Part, *, moving: bool) -> None:
    least = FLOOR if moving else 0.0
    _add(
        body, "inertial", pos=part.center, mass=max(part.mass, least),
        diaginertia=[max(value, least) for value in part.inertia],
    )  # fmt: skip


def _add_links(base: ET.Element, mechanism: MechanismTree, values: dict[str, float]) -> None:
    """Add the tree of bodies, placed in the start pose."""
    bodies: dict[str | None, ET.Element] = {None: base}
    armature = {
        joint: {"armature": drive.reflected_inertia}
        for joint, drive in zip(mechanism.actuated, mechanism.drives, strict=True)
        if drive is not None
    }
    sites: dict[str, list[tuple[str, Point]]] = {}
    for pin in mechanism.pins:
        sites.setdefault(pin.first, []).append((f"{pin.name}_a", pin.first_point))
        sites.setdefault(pin.second, []).append((f"{pin.name}_b", pin.second_point))
    for link in mechanism.links:
        place, turn, axes = link_frame(link, values)
        quaternion = turn.as_quat(scalar_first=True)
        body = _add(bodies[link.parent], "body", name=link.name, pos=place, quat=quaternion)
        bodies[link.name] = body
        _inertial(body, link.parts[0], moving=True)
        for joint, axis in zip(link.joints, axes, strict=True):
            value = values[joint.name]
            own = armature.get(joint.name, {})
            _add(body, "joint", name=joint.name, type=joint.kind, axis=axis, ref=value, **own)
        color = [*link_color(link), 1.0]
        for rod in link.rods:
            _add_rod(body, rod, color)
        for name, point in sites.get(link.name, []):
            _add(body, "site", name=name, pos=point)
        for part in link.parts[1:]:
            child = _add(body, "body", name=part.name)
            _inertial(child, part, moving=False)
            if part.name != "payload":
                radius = 1.3 * link.rods[0].radius
                _add(child, "geom", type="sphere", pos=part.center, size=radius, rgba=color)


def _add_rod(body: ET.Element, rod: Rod, color: list[float]) -> None:
    # A link may have no length at all, of which MuJoCo makes no capsule.
    if math.dist(rod.start, rod.end) < LEAST_ROD:
        _add(body, "geom", type="sphere", pos=rod.start, size=rod.radius, rgba=color)
        return
    ends = (*rod.start, *rod.end)
    _add(body, "geom", type="capsule", fromto=ends, size=rod.radius, rgba=color)


def _add_closures(root: ET.Element, mechanism: MechanismTree) -> None:
    equality = _add(root, "equality")
    for pin in mechanism.pins:
        _add(equality, "connect", name=pin.name, site1=f"{pin.name}_a", site2=f"{pin.name}_b")


def _add_actuators(
    root: ET.Element,
    mechanism: MechanismTree,
    design: Design,
    values: dict[str, float],
    holding: Sequence[float],
    servos: Servos | None,
) -> ET.Element:
    actuators = _add(root, "actuator")
    g = design.geometry
    for index, joint in enumerate(mechanism.actuated):
        name = f"M{index + 1}"
        if servos is None:
            _add(actuators, "motor", name=name, joint=joint)
            continue
        stiffness, damping = servos.stiffness[index], servos.damping[index]
        offset = holding[index] + stiffness * values[joint]
        reach = math.pi / 3 if index < 3 else 0.3 * (g.coupler_length + g.crank_length)
        _add(
            actuators, "general", name=name, joint=joint, gaintype="fixed", biastype="affine",
            gainprm=stiffness, biasprm=(offset, -stiffness, -damping), ctrlrange=(-reach, reach),
        )  # fmt: skip
    if servos is None:
        _add(_add(root, "keyframe"), "key", name="start", ctrl=holding)
    return actuators


def _add_load(root: ET.Element, actuators: ET.Element, design: Design) -> None:
    """Add the load as a site where it acts, with axes of the platform or the world's."""
    load = design.load
    platform = next(body for body in root.iter("body") if body.attrib.get("name") == PLATFORM)
    _add(platform, "site", name="load", pos=load.point)
    world = root.find("worldbody")
    frame = {}
    if load.frame is LoadFrame.WORLD and world is not None:
        _add(world, "site", name="world", pos=(0, 0, 0))
        frame["refsite"] = "world"
    _add(
        actuators, "general", name="load", site="load", gear=load.wrench, gaintype="fixed",
        biastype="affine", gainprm=1, biasprm=(1, 0, 0), ctrlrange=(-1, 1), **frame,
    )  # fmt: skip
