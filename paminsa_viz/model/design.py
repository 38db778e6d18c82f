"""The robot's numbers: geometry, masses, inertias, payload, friction, load.

Every class is frozen and hashable. Its defaults are the paper's Appendix 4, and each field knows
its symbol in the paper and its SI unit, so that a page, a file or a table can be built from the
field list alone (see `paminsa_viz.model.parameters`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import Enum
from typing import Any

from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.drive import (
    ACTUATORS,
    NO_DRIVES,
    UNLIMITED,
    Drive,
    Drives,
    OutputLimits,
    check_drives,
)
from paminsa_viz.model.load import NO_LOAD, LoadCase
from paminsa_viz.model.parameters import (
    MOST_COUNTERWEIGHTS,
    SMALLEST,
    ActuatorFriction,
    Counterweight,
    Friction,
    Group,
    Inertias,
    JointMasses,
    LinkMasses,
    Parameter,
    Payload,
    Platform,
    parameter,
)


class KneeBranch(Enum):
    """Which of the two roots the knee 9 takes.

    ``LOWER`` is the root that Appendix 1 prints for F; the platform then hangs below the guides,
    z < 0. ``UPPER`` is the other one, its mirror image. A robot changes its branch only by being
    put together again: on the way the pantographs would pass through the stretched configuration.
    """

    LOWER = "printed"
    UPPER = "mirror"

    @property
    def sign(self) -> float:
        """+1 for the published root, -1 for its mirror image."""
        return 1.0 if self is KneeBranch.LOWER else -1.0

    @property
    def label(self) -> str:
        """ "lower knee" or "upper knee", for captions."""
        return f"{self.name.lower()} knee"


@dataclass(frozen=True)
class Geometry(Group, path="geometry"):
    """Lengths of the mechanism (Appendix 4), and ``knee``, the branch of its knees.

    Link B7 is as long as B4 divided by k, and B8 as long as B3; without that 8-9-4-7 would be no
    parallelogram, so they are no parameters of their own.
    """

    magnification: float = parameter(3.0, "k", "", "pantograph magnification factor", positive=True)
    base_radius: float = parameter(0.35, "R_b", "m", "radius of the leg axes", positive=True)
    platform_radius: float = parameter(0.1, "R_pl", "m", "radius of platform joints", positive=True)
    arm_length: float = parameter(0.308, "l_B1", "m", "length of arm B1")
    shaft_length: float = parameter(0.442, "l_B2", "m", "length of shaft B2")
    crank_length: float = parameter(0.42, "l_B3 = l_B8", "m", "length of B3 and B8", positive=True)
    coupler_length: float = parameter(0.63, "l_B4 = k l_B7", "m", "length of B4", positive=True)
    platform_joint_height: float = parameter(0.0275, "l_B5", "m", "joint 5 above the platform")
    guide_link_length: float = parameter(
        0.3635, "l_B10", "m", "length of guide link B10", positive=True
    )
    guide_stroke: float | None = parameter(
        None, "|X_4| max", "m", "stroke of joint 8 (default: l_B10)", positive=True
    )
    axis_clearance: float = parameter(0.0, "X_1 min", "m", "least distance of 5 from its leg axis")
    knee: KneeBranch = KneeBranch.LOWER

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.knee, KneeBranch):
            raise InvalidDesign("geometry.knee", self.knee, "a KneeBranch is needed")
        if self.magnification < 1 + SMALLEST:
            raise InvalidDesign(
                "geometry.magnification",
                self.magnification,
                f"k has to be greater than 1, by {SMALLEST:g} or more, or joint 4 would not lie "
                f"between 9 and 5",
            )
        if self.home_span >= self.crank_length + self.coupler_length:
            longest = self.crank_length + self.coupler_length
            raise InvalidDesign(
                "geometry.coupler_length",
                self.coupler_length,
                f"B4 and B8 cannot close the pantograph with the platform at the center: together "
                f"they reach {longest:.6g} m, and joints 8 and 5 are at least "
                f"{self.home_span:.6g} m apart there; lengthen B4 or B8, or bring R_b and R_pl "
                f"closer together",
            )

    @property
    def home_span(self) -> float:
        """Horizontal distance from 8 to 5 at x = y = theta = 0 [m]."""
        return self.span_ratio * abs(self.base_radius - self.platform_radius)

    @property
    def span_ratio(self) -> float:
        """Horizontal distance from 8 to 5 divided by X_1, that is k/(k-1)."""
        return self.magnification / (self.magnification - 1)

    @property
    def stroke(self) -> float:
        """Largest distance of joint 8 from the leg axis, |X_4| [m]."""
        return self.guide_link_length if self.guide_stroke is None else self.guide_stroke

    @property
    def short_coupler_length(self) -> float:
        """Length of link B7, l_B4/k [m]."""
        return self.coupler_length / self.magnification


@dataclass(frozen=True)
class Design(Group, path="design"):
    """Everything that defines one robot. Two designs are equal if their numbers are.

    Attributes:
        geometry, joints, links, inertias, platform, payload, friction: Its numbers, in groups.
        load: An external force and moment on the platform.
        gravity: [m/s^2].
        counterweights: Point masses on the bars of every leg; none in the paper.
        drives: Motors and gears of M1..M4; none in the paper.
        name: What a person calls it.

    Raises:
        InvalidDesign: If a value is negative, not finite, or cannot belong to a machine.
    """

    geometry: Geometry = Geometry()
    joints: JointMasses = JointMasses()
    links: LinkMasses = LinkMasses()
    inertias: Inertias = Inertias()
    platform: Platform = Platform()
    payload: Payload = Payload()
    friction: Friction = Friction()
    load: LoadCase = NO_LOAD
    gravity: float = parameter(9.81, "g", "m/s^2", "gravitational acceleration")
    counterweights: tuple[Counterweight, ...] = ()
    drives: Drives = NO_DRIVES
    name: str = field(default="PAMINSA", compare=False)

    def __post_init__(self) -> None:
        for item in fields(self):
            group = getattr(self, item.name)
            expected = item.default
            is_group = is_dataclass(expected) or isinstance(expected, tuple)
            if is_group and type(group) is not type(expected):
                raise InvalidDesign(item.name, group, f"a {type(expected).__name__} is needed")
        if len(self.counterweights) > MOST_COUNTERWEIGHTS:
            raise InvalidDesign(
                "counterweights", len(self.counterweights), f"at most {MOST_COUNTERWEIGHTS} a leg"
            )
        for number, weight in enumerate(self.counterweights):
            if not isinstance(weight, Counterweight):
                raise InvalidDesign(f"counterweights.{number}", weight, "a Counterweight is needed")
        check_drives(self.drives)
        super().__post_init__()

    def value(self, path: str) -> float:
        """Return one number by its dotted path, for example ``"links.b3"`` or ``"gravity"``.

        ``"counterweights.0.mass"`` is that of the first counterweight, if there is one, and
        ``"drives.M1.gear_ratio"`` that of M1's drive. The guide stroke is returned as the length
        in force, also where it follows l_B10.

        Raises:
            InvalidInput: If there is no such number.
        """
        if path == "geometry.guide_stroke":
            return self.geometry.stroke
        group, _, name = path.rpartition(".")
        owner = self._group(group)
        if name not in _numbers_of(owner):
            raise InvalidInput("path", f"there is no design value {path!r}")
        return float(getattr(owner, name))

    def _group(self, name: str) -> Any:
        """Return what holds the values under a path, None if there is no such thing."""
        head, _, number = name.partition(".")
        if head == "counterweights":
            known = number.isdecimal() and int(number) < len(self.counterweights)
            return self.counterweights[int(number)] if known else None
        if head == "drives":
            return self.drives[ACTUATORS.index(number)] if number in ACTUATORS else None
        return getattr(self, name, None) if name else self

    @property
    def actuator_friction(self) -> ActuatorFriction:
        """Friction of each actuator: that of its joint, and its drive's N^2 b and N c."""
        joints = self.friction.by_actuator
        if self.drives == NO_DRIVES:
            return joints
        own = [(0.0, 0.0) if d is None else d.reflected_friction for d in self.drives]
        return ActuatorFriction(
            tuple(b + more for b, (more, _) in zip(joints.viscous, own, strict=True)),
            tuple(c + more for c, (_, more) in zip(joints.coulomb, own, strict=True)),
            joints.transition_speed,
        )

    @property
    def drive_inertia(self) -> tuple[float, ...]:
        """Inertia of the drives at their actuators, N^2 J, (4,) [kg m^2, kg]; zero for none."""
        return tuple(0.0 if drive is None else drive.reflected_inertia for drive in self.drives)

    @property
    def output_limits(self) -> tuple[OutputLimits, ...]:
        """What the drives of M1..M4 give at their actuators; infinite without a drive."""
        return tuple(UNLIMITED if drive is None else drive.output_limits for drive in self.drives)

    def without_friction(self) -> Design:
        """Return the design without friction, neither of the joints nor of the drives."""
        drives: Any = tuple(d if d is None else d.without_friction() for d in self.drives)
        return replace(self, friction=Friction(), drives=drives)

    def with_knee(self, knee: KneeBranch) -> Design:
        """Return the design with its knees on the given branch."""
        return replace(self, geometry=replace(self.geometry, knee=knee))

    def vary(self, changes: Mapping[str, float | None]) -> Design:
        """Return a copy with some numbers changed, given by dotted path.

        Changes of one group are made together, so that lengths that depend on each other can be
        changed in one step.

        Raises:
            InvalidDesign: If a path does not exist or a value is not possible.
        """
        grouped: dict[str, dict[str, float | None]] = {}
        for path, value in changes.items():
            group, _, name = path.rpartition(".")
            if name not in _numbers_of(self._group(group)):
                raise InvalidDesign(path, value, "there is no design value of this name")
            grouped.setdefault(group, {})[name] = value
        top: dict[str, Any] = dict(grouped.pop("", {}))
        weights, drives = list(self.counterweights), list(self.drives)
        for group, values in grouped.items():
            changed = replace(self._group(group), **values)
            if isinstance(changed, Counterweight):
                weights[int(group.partition(".")[2])] = changed
            elif isinstance(changed, Drive):
                drives[ACTUATORS.index(group.partition(".")[2])] = changed
            else:
                top[group] = changed
        return replace(self, counterweights=tuple(weights), drives=tuple(drives), **top)


def _numbers_of(owner: object) -> set[str]:
    """Return the names of the numbers that a group of a design holds."""
    items = fields(owner) if is_dataclass(owner) else ()
    return {item.name for item in items if "unit" in item.metadata}


APPENDIX_4 = Design(name="Appendix 4")
"""The prototype's numbers as the paper gives them, with g = 9.81 m/s^2 (Appendix 3)."""


def _parameters() -> tuple[Parameter, ...]:
    found = []
    for group in fields(APPENDIX_4):
        owner = getattr(APPENDIX_4, group.name)
        items = fields(owner) if is_dataclass(owner) else (group,)
        for item in (item for item in items if "unit" in item.metadata):
            path = item.name if item is group else f"{group.name}.{item.name}"
            found.append(Parameter(path, default=APPENDIX_4.value(path), **item.metadata))
    return tuple(found)


PARAMETERS: tuple[Parameter, ...] = _parameters()
"""Every number of a design, in the order of the paper's Appendix 4."""

PARAMETER: dict[str, Parameter] = {item.path: item for item in PARAMETERS}
"""The same by path."""
