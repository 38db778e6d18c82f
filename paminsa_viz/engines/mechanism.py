"""The PAMINSA as a tree of links with loop closures, in no engine's language.

At zero joint values all link frames are parallel to their parent's, but for the guides, whose x
points from the leg axis to the base center. In a leg, x points toward the platform and z up; bars
have x along the bar and turn about -y, so that a positive angle raises them. The tree:

    base - platform (slides along x, y, z; turns by theta; may tilt)
    base - lift (slides up by Z; carries the three arms B1)
    base - B10 of each leg (turns about the leg axis by theta_k)
              - B2 (slides up by Z)
              - slider with joint 8 (slides along the guide by r_8)
                  - B8 - B4 - B3         (hinges 8, 9, 4)
                  - B7                   (hinge 8)

Loops are closed at joint 2 between lift and B2, at joint 3 between B3 and B2, at joint 7 between
B3 and B7, and at joint 5 between B4 and the platform. Joint masses and counterweights are point
masses on the links.
"""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import NO_DRIVES, Drives
from paminsa_viz.model.kinematics import AXIS_ANGLES
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.palette import LEG_COLORS, LIFT_COLOR, rgb
from paminsa_viz.palette import PLATFORM as PLATFORM_COLOR
from paminsa_viz.units import rounded_to_side

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Point = tuple[float, float, float]


class Part(NamedTuple):
    """A rigid body fixed to a link: mass [kg], mass center [m] and inertias [kg m^2] in its axes.

    ``inertia`` is about the mass center; a point mass has none.
    """

    name: str
    mass: float
    center: Point
    inertia: Point = (0.0, 0.0, 0.0)


class Rod(NamedTuple):
    """A straight piece of a link, only for looks: ends and radius [m]."""

    start: Point
    end: Point
    radius: float


class Joint(NamedTuple):
    """A joint: a hinge turns its link about ``axis``, a slide moves it along; axis in the link."""

    name: str
    kind: Literal["hinge", "slide"]
    axis: Point


@dataclass(frozen=True)
class Link:
    """A moving link, its joints to its parent, and what is fixed to it.

    Attributes:
        name: Name of the link.
        parent: Name of the parent link, or None for the base.
        joints: From the parent to the link, one after the other, all through the link's origin.
        place: Origin of the link's frame in the parent's at zero joint values [m].
        parts: The masses; the first is the link proper.
        rods: Its looks.
        heading: Turn of the frame about z against the parent's at zero joint values [rad].
        leg: 0, 1, 2, or None for lift and platform.
    """

    name: str
    parent: str | None
    joints: tuple[Joint, ...]
    place: Point
    parts: tuple[Part, ...]
    rods: tuple[Rod, ...] = ()
    heading: float = 0.0
    leg: int | None = None


class Pin(NamedTuple):
    """Two points of two links that stay together: a ball joint outside the tree."""

    name: str
    first: str
    first_point: Point
    second: str
    second_point: Point


@dataclass(frozen=True)
class MechanismTree:
    """The whole robot.

    Attributes:
        links: Parents before children; the platform first, then the lift.
        pins: The loop closures; plane loops make some of their equations repeat others.
        actuated: Names of the four actuated joints, in the order of the actuators.
        gravity: Gravitational acceleration [m/s^2].
        drives: Motors and gears, whose inertia turns with the actuated joints.
    """

    links: tuple[Link, ...]
    pins: tuple[Pin, ...]
    actuated: tuple[str, str, str, str]
    gravity: float
    drives: Drives = NO_DRIVES


PLATFORM, LIFT = "platform", "lift"
X: Point = (1, 0, 0)
Y: Point = (0, 1, 0)
Z: Point = (0, 0, 1)
ORIGIN: Point = (0, 0, 0)

POSE_JOINTS = ("platform_x", "platform_y", "platform_theta", "platform_z")
"""The platform's joints whose values are the pose; two more let it tilt, if the loops would."""


def identifier(name: str) -> str:
    """Return a design's name as letters, digits and underscores, for formats that take no others.

    Accents are left out. It begins with a letter, and is that of the mechanism if nothing is left.
    """
    letters = (c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    plain = re.sub(r"[^0-9A-Za-z]+", "_", "".join(letters)).strip("_")
    return plain if plain[:1].isalpha() else f"PAMINSA_{plain}".strip("_")


def leg_name(leg: int, name: str) -> str:
    """Name of a link, joint or part of leg 0, 1 or 2."""
    return f"leg{leg + 1}_{name}"


def build_mechanism(design: Design) -> MechanismTree:
    """Describe a design as a mechanism; both branches of the knee have the same one.

    Raises:
        InvalidDesign: If a bar's axial inertia is more than twice its transverse one, which no
            body has and no engine accepts.
    """
    links = [_platform(design), _lift(design)]
    pins: list[Pin] = []
    for leg in range(3):
        links += _leg(design, leg)
        pins += _pins(design, leg)
    theta = (leg_name(0, "theta"), leg_name(1, "theta"), leg_name(2, "theta"))
    return MechanismTree(tuple(links), tuple(pins), (*theta, LIFT), design.gravity, design.drives)


def _vertical(inertia: float) -> Point:
    """Inertias of a body that only turns about the vertical: a flat disc's."""
    return (0.5 * inertia, 0.5 * inertia, inertia)


def _tube(design: Design, bar: str) -> Point:
    """Inertias of a bar with x along it (Eq. 10)."""
    axial = getattr(design.inertias, f"{bar}_axial")
    across = getattr(design.inertias, f"{bar}_transverse")
    if axial > 2 * across:
        most = rounded_to_side(2 * across, 6, up=False)
        raise InvalidDesign(
            f"inertias.{bar}_axial",
            axial,
            f"no rigid body has more than twice its transverse inertia, {most:.6g} kg·m²",
        )
    return (axial, across, across)


def _joint_5(design: Design, leg: int) -> Point:
    radius = design.geometry.platform_radius
    return (
        radius * math.cos(AXIS_ANGLES[leg]),
        radius * math.sin(AXIS_ANGLES[leg]),
        design.geometry.platform_joint_height,
    )


def _platform(design: Design) -> Link:
    g = design.geometry
    platform, load = design.platform, design.payload
    parts = [Part(PLATFORM, platform.mass, ORIGIN, _vertical(platform.inertia))]
    if load.mass > 0 or load.inertia > 0:
        center = (0.0, 0.0, load.height)
        parts.append(Part("payload", load.mass, center, _vertical(load.inertia)))
    width = 0.06 * max(g.platform_radius, 0.2 * g.base_radius)
    corners = [_joint_5(design, leg) for leg in range(3)]
    rods = [Rod(ORIGIN, (x, y, 0), 2 * width) for x, y, _ in corners]
    rods += [Rod((x, y, 0), (x, y, z), width) for x, y, z in corners if z > 0]
    x, y, theta, z = POSE_JOINTS
    joints = (
        Joint(x, "slide", X), Joint(y, "slide", Y), Joint(z, "slide", Z), Joint(theta, "hinge", Z),
        Joint("platform_roll", "hinge", X), Joint("platform_pitch", "hinge", Y),
    )  # fmt: skip
    return Link(PLATFORM, None, joints, ORIGIN, tuple(parts), tuple(rods))


def _lift(design: Design) -> Link:
    """The lift with the three arms B1; it only rises and sinks, so one mass replaces them."""
    radius = design.geometry.base_radius
    arms = Part("arms_3xB1", 3 * design.links.b1, ORIGIN)
    rods = tuple(
        Rod(ORIGIN, (radius * math.cos(a), radius * math.sin(a), 0), 0.03 * radius)
        for a in AXIS_ANGLES
    )
    return Link(LIFT, None, (Joint(LIFT, "slide", Z),), ORIGIN, (arms,), rods)


def _leg(design: Design, leg: int) -> list[Link]:
    g, links, inertias = design.geometry, design.links, design.inertias
    angle, crank, coupler = AXIS_ANGLES[leg], g.crank_length, g.coupler_length
    short = g.short_coupler_length
    width = 0.015 * (crank + coupler)
    foot: Point = (g.base_radius * math.cos(angle), g.base_radius * math.sin(angle), 0)
    below: Point = (0, 0, -g.shaft_length)
    behind: Point = (-g.guide_link_length, 0, 0)

    def name(text: str) -> str:
        return leg_name(leg, text)

    def joint(number: int, at: Point) -> Part:
        return Part(name(f"joint{number}"), getattr(design.joints, f"j{number}"), at)

    def bar(number: int, parent: str, place: Point, reach: float, *tips: Part) -> Link:
        tube = Part(
            name(f"B{number}"),
            getattr(links, f"b{number}"),
            (reach / 2, 0, 0),
            _tube(design, f"b{number}"),
        )
        fixed = (tube, *tips, *_counterweights(design, leg, f"b{number}", reach))
        hinge = Joint(name(f"bar{number}"), "hinge", (0, -1, 0))
        look = Rod(ORIGIN, (reach, 0, 0), width)
        return Link(tube.name, name(parent), (hinge,), place, fixed, (look,), leg=leg)

    guide = Part(name("B10"), links.b10, (behind[0] / 2, 0, 0), _vertical(inertias.b10_vertical))
    shaft = Part(name("B2"), links.b2, (0, 0, below[2] / 2), _vertical(inertias.b2_vertical))
    return [
        Link(
            guide.name, None, (Joint(name("theta"), "hinge", Z),), foot, (guide,),
            (Rod(ORIGIN, behind, 1.2 * width),), angle + math.pi, leg,
        ),
        Link(
            shaft.name, guide.name, (Joint(name("shaft"), "slide", Z),), ORIGIN,
            (shaft, joint(2, ORIGIN), joint(3, below)), (Rod(ORIGIN, below, width),), leg=leg,
        ),
        Link(
            name("slider"), guide.name, (Joint(name("slide"), "slide", X),), ORIGIN,
            (joint(8, ORIGIN),), (Rod((-width, 0, 0), (width, 0, 0), 2 * width),), leg=leg,
        ),
        bar(8, "slider", ORIGIN, crank, joint(9, (crank, 0, 0))),
        bar(4, "B8", (crank, 0, 0), coupler, joint(4, (short, 0, 0)), joint(5, (coupler, 0, 0))),
        bar(3, "B4", (short, 0, 0), -crank),
        bar(7, "slider", ORIGIN, short, joint(7, (short, 0, 0))),
    ]  # fmt: skip


def _counterweights(design: Design, leg: int, bar: str, reach: float) -> list[Part]:
    """Place the counterweights of a bar that goes from its first end at x = 0 to x = ``reach``."""
    first = BAR_ENDS[bar][0]
    outward = math.copysign(1.0, reach)  # a weight between the joints is less than 0 beyond one
    found = []
    for number, weight in enumerate(design.counterweights, 1):
        if weight.bar == bar:
            out = outward * weight.beyond
            x = -out if weight.joint == first else reach + out
            found.append(Part(leg_name(leg, f"counterweight{number}"), weight.mass, (x, 0, 0)))
    return found


def _pins(design: Design, leg: int) -> list[Pin]:
    g, angle = design.geometry, AXIS_ANGLES[leg]
    crank, short = g.crank_length, g.short_coupler_length

    def name(joint: str) -> str:
        return leg_name(leg, joint)

    foot: Point = (g.base_radius * math.cos(angle), g.base_radius * math.sin(angle), 0)
    # Joint 3 divides B3 as 4-3 : 3-7 = (k - 1) : 1, because 8, 3, 5 are in line with |85| = k |83|.
    on_bar3 = -crank * (1 - 1 / g.magnification)
    return [
        Pin(name("pin2"), LIFT, foot, name("B2"), ORIGIN),
        Pin(name("pin3"), name("B3"), (on_bar3, 0, 0), name("B2"), (0, 0, -g.shaft_length)),
        Pin(name("pin7"), name("B3"), (-crank, 0, 0), name("B7"), (short, 0, 0)),
        Pin(name("pin5"), name("B4"), (g.coupler_length, 0, 0), PLATFORM, _joint_5(design, leg)),
    ]


# ------------------------------------------------------------------------------- looks of the links

LEAST_ROD = 1e-9
"""Shortest rod that is drawn as one [m]; MuJoCo's own limit is 1e-14 m."""


def link_color(link: Link) -> list[float]:
    """Return red, green and blue of a link, 0 to 1."""
    if link.name == PLATFORM:
        color = PLATFORM_COLOR
    else:
        color = LIFT_COLOR if link.leg is None else LEG_COLORS[link.leg]
    return [round(channel / 255, 4) for channel in rgb(color)]


class Bar(NamedTuple):
    """A rod as a cylinder along z: middle [m], turn from z to the rod, length and radius [m]."""

    middle: Point
    turn: Rotation
    length: float
    radius: float


def as_cylinder(rod: Rod) -> Bar | None:
    """Return a rod as a cylinder, or None where it has no length."""
    start, end = np.asarray(rod.start, float), np.asarray(rod.end, float)
    length = math.dist(rod.start, rod.end)
    if length < LEAST_ROD:
        return None
    from scipy.spatial.transform import Rotation  # slow to load

    turn = Rotation.align_vectors([end - start], [(0.0, 0.0, 1.0)])[0]
    x, y, z = (0.5 * (start + end)).tolist()
    return Bar((x, y, z), turn, length, rod.radius)
