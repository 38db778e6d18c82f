"""The robot's numbers: geometry, masses, inertias, payload, friction, load, accuracy, elastic data.

Every class is frozen and hashable. Its defaults are the paper's Appendix 4, and each field knows
its symbol in the paper and its SI unit, so that a page, a file or a table can be built from the
field list alone (see `paminsa_viz.model.parameters`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, dataclass, field, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

from paminsa_viz.checks import require_kind
from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.accuracy import (
    Deviations,
    DriveAccuracy,
    Leg1Deviations,
    Leg2Deviations,
    Leg3Deviations,
    LegDeviations,
    Tolerances,
)
from paminsa_viz.model.drive import (
    ACTUATORS,
    NO_DRIVES,
    UNLIMITED,
    Drive,
    Drives,
    OutputLimits,
    check_drives,
)
from paminsa_viz.model.elastic import Elastic
from paminsa_viz.model.geometry import BODY_SCALE, Geometry, KneeBranch
from paminsa_viz.model.load import NO_LOAD, LoadCase
from paminsa_viz.model.parameters import (
    MOST_COUNTERWEIGHTS,
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
from paminsa_viz.units import rounded_to_side

TILT_INERTIA = "elastic.platform_tilt_inertia"


@dataclass(frozen=True)
class Design(Group, path="design"):
    """Everything that defines one robot. Two designs are equal if their numbers are.

    Attributes:
        geometry, joints, links, inertias, platform, payload, friction: Its numbers, in groups.
        load: An external force and moment on the platform.
        gravity: [m/s^2].
        counterweights: Point masses on the bars of every leg; none in the paper.
        drives: Motors and gears of M1..M4; none in the paper.
        accuracy: By how much the drives may be off; a default, none in the paper.
        leg1, leg2, leg3: Deviations of each leg's lengths from the geometry, which `precision`
            knows of alone; none in the paper.
        tolerances: Of the lengths, and clearances; none in the paper.
        elastic: Material, sections and stiffnesses; none in the paper.
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
    accuracy: DriveAccuracy = DriveAccuracy()
    leg1: LegDeviations = Leg1Deviations()
    leg2: LegDeviations = Leg2Deviations()
    leg3: LegDeviations = Leg3Deviations()
    tolerances: Tolerances = Tolerances()
    elastic: Elastic = Elastic()
    name: str = field(default="PAMINSA", compare=False)

    def __post_init__(self) -> None:
        for item in fields(self):
            group = getattr(self, item.name)
            expected = item.default
            is_group = is_dataclass(expected) or isinstance(expected, tuple)
            if not is_group or type(group) is type(expected):
                continue
            if not isinstance(expected, LegDeviations):
                raise InvalidDesign(item.name, group, f"a {type(expected).__name__} is needed")
            if not isinstance(group, LegDeviations):
                raise InvalidDesign(item.name, group, "a LegDeviations is needed")
            # The numbers of any leg will do; the class of its own is what messages name a leg by.
            object.__setattr__(self, item.name, type(expected)(*astuple(group)))
        if len(self.counterweights) > MOST_COUNTERWEIGHTS:
            raise InvalidDesign(
                "counterweights", len(self.counterweights), f"at most {MOST_COUNTERWEIGHTS} a leg"
            )
        for number, weight in enumerate(self.counterweights):
            if not isinstance(weight, Counterweight):
                raise InvalidDesign(f"counterweights.{number}", weight, "a Counterweight is needed")
        check_drives(self.drives)
        super().__post_init__()
        tilt = self.elastic.platform_tilt_inertia
        if tilt is not None and 2 * tilt < self.platform.inertia:
            least = rounded_to_side(0.5 * self.platform.inertia, 6, up=True)
            allowed = f"no rigid body has less than I_pl/2, {least:.6g} kg·m²"
            raise InvalidDesign(TILT_INERTIA, tilt, allowed)

    def value(self, path: str) -> float:
        """Return one number by its dotted path, for example ``"links.b3"`` or ``"gravity"``.

        ``"counterweights.0.mass"`` is that of the first counterweight, if there is one, and
        ``"drives.M1.gear_ratio"`` that of M1's drive. A number that is left open is returned as it
        counts: the guide stroke as l_B10, a section's value as the tube's, a stiffness as infinity,
        the platform's inertia about x and y as half of I_pl.

        Raises:
            InvalidInput: If there is no such number.
        """
        owner, name = self._owner(path)
        if path == TILT_INERTIA and self.elastic.platform_tilt_inertia is None:
            return 0.5 * self.platform.inertia
        return owner.in_force(name)

    def stored(self, path: str) -> float | None:
        """Return one number as it was given, None where it is left open; see `value`."""
        owner, name = self._owner(path)
        return getattr(owner, name)

    def _owner(self, path: str) -> tuple[Any, str]:
        """Return the group that holds a number, and the number's name in it."""
        require_kind(path, "path", str)
        group, _, name = path.rpartition(".")
        owner = self._group(group)
        if name not in _numbers_of(type(owner)):
            raise InvalidInput(path[:60], no_value(path))
        return owner, name

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
    def deviations(self) -> Deviations:
        """Deviations of the three legs' lengths."""
        return self.leg1, self.leg2, self.leg3

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
        changed in one step. The name stays, but that of Appendix 4: see `renamed_if_changed`.

        Raises:
            InvalidDesign: If a path does not exist or a value is not possible.
            InvalidInput: If the changes are no mapping.
        """
        require_kind(changes, "changes", Mapping)
        grouped: dict[str, dict[str, float | None]] = {}
        for path, value in changes.items():
            group, _, name = path.rpartition(".")
            if name not in _numbers_of(type(self._group(group))):
                raise InvalidDesign(path, value, no_value(path))
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
        changed = replace(self, counterweights=tuple(weights), drives=tuple(drives), **top)
        return renamed_if_changed(changed)


@lru_cache  # the page asks for some 700 values a frame
def _numbers_of(group: type) -> frozenset[str]:
    """Return the names of the numbers that a group of a design holds."""
    items = fields(group) if is_dataclass(group) else ()
    return frozenset(item.name for item in items if "unit" in item.metadata)


APPENDIX_4 = Design(name="Appendix 4")
"""The prototype's numbers as the paper gives them, with g = 9.81 m/s^2 (Appendix 3)."""

CHANGED = ", changed"
"""Ending of the name of a design that is another one's but for some numbers."""

CHANGED_NAME = f"{APPENDIX_4.name}{CHANGED}"
"""What the paper's design is called once a number of it was changed."""


def renamed_if_changed(design: Design) -> Design:
    """Return the design under a name that does not claim to be Appendix 4's if it is not.

    Figures and tables say the name: the paper's must not stand under another robot's numbers.
    """
    if not design.name.startswith(APPENDIX_4.name):
        return design
    printed = design.with_knee(APPENDIX_4.geometry.knee) == APPENDIX_4
    if design.name == APPENDIX_4.name and not printed:
        return replace(design, name=CHANGED_NAME)
    if design.name.startswith(CHANGED_NAME) and printed:
        return replace(design, name=APPENDIX_4.name)
    return design


def _parameters() -> tuple[Parameter, ...]:
    found = []
    for group in fields(APPENDIX_4):
        owner = getattr(APPENDIX_4, group.name)
        items = fields(owner) if is_dataclass(owner) else (group,)
        limits = getattr(owner, "_limits", None)
        for item in (item for item in items if "unit" in item.metadata):
            path = item.name if item is group else f"{group.name}.{item.name}"
            value = APPENDIX_4.value(path)
            found.append(Parameter(path, default=value, limits=limits, **item.metadata))
    return tuple(found)


_ALL = _parameters()

OPTIONAL_GROUPS = ("accuracy", "leg1", "leg2", "leg3", "tolerances", "elastic")
"""Groups that are no part of the rigid, exact robot: files name what is not the default."""

PARAMETERS: tuple[Parameter, ...] = tuple(p for p in _ALL if p.group not in OPTIONAL_GROUPS)
"""Every number of the rigid, exact robot, in the order of the paper's Appendix 4."""

MECHANISM_PATHS: tuple[str, ...] = tuple(
    p.path for p in PARAMETERS if p.group == "geometry" and p.path != BODY_SCALE
)
"""Lengths, and the magnification factor, that the mechanism depends on, by path."""

PARAMETER: dict[str, Parameter] = {item.path: item for item in _ALL}
"""Every number of a design by path."""


def no_value(path: str) -> str:
    """Return what is wrong with a path that names no number of a design, and the nearest one."""
    # a name without its group, perhaps with a unit as in design files: j7, j7_kg
    named = [known for known in PARAMETER if f"{path}_".startswith(f"{known.rpartition('.')[2]}_")]
    near = named[:4] or get_close_matches(path[:60], PARAMETER, 1)
    such = "such as links.b3 or geometry.base_radius"
    hint = f"did you mean {' or '.join(near)}?" if near else such
    return f"there is no design value of this name; {hint}"


def stated_parameters(design: Design) -> tuple[Parameter, ...]:
    """Return what tables name of a design: the rigid robot's numbers, and others not default."""
    return PARAMETERS + tuple(
        item
        for item in _ALL
        if item.group in OPTIONAL_GROUPS
        and design.stored(item.path) != APPENDIX_4.stored(item.path)
    )
