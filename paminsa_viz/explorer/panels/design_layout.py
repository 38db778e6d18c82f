"""Which numbers of the design stand where on the page, as a person would look for them."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.explorer.panels.number_row import Row, round_up
from paminsa_viz.model import PARAMETER


@dataclass(frozen=True)
class Group:
    """A folder of the panel.

    Attributes:
        tab: Tab that it stands on.
        title: Its heading, with the unit of its rows.
        rows: What it holds.
        open: Whether it is open at first.
    """

    tab: str
    title: str
    rows: tuple[Row, ...]
    open: bool = True


def _row(path: str, name: str, high: float, step: float, *, low: float = 0.0) -> Row:
    lowest = max(low, step) if PARAMETER[path].positive else low
    return Row(path, name, lowest, high, step)


def _mass(path: str, name: str) -> Row:
    high = round_up(3 * PARAMETER[path].default) or 10.0
    return _row(path, name, high, 0.0005)


def _inertia(path: str, name: str) -> Row:
    high = round_up(3 * PARAMETER[path].default) or 0.1
    return _row(path, name, high, 0.00005)


def _length(path: str, name: str, high: float | None = None) -> Row:
    # Twice Appendix 4's length: with the other lengths unchanged, the pantograph can still close.
    parameter = PARAMETER[path]
    if high is None:
        high = round_up(2 * parameter.display.from_si(parameter.default))
    return _row(path, name, high, 0.25)


def _friction(path: str, high: float, step: float) -> Row:
    return _row(path, f"[{PARAMETER[path].display.text}]", high, step)


_INERTIA_ROWS = (
    *(
        _inertia(f"inertias.{bar}_{axis}", word)
        for bar in ("b3", "b4", "b7", "b8")
        for axis, word in (("axial", "along"), ("transverse", "across"))
    ),
    _inertia("inertias.b2_vertical", "shaft"),
    _inertia("inertias.b10_vertical", "guide link"),
)

GROUPS: tuple[Group, ...] = (
    Group(
        "Masses",
        "Platform and payload [kg]",
        (_mass("platform.mass", "platform"), _mass("payload.mass", "payload")),
    ),
    Group(
        "Masses",
        "Links of each leg [kg]",
        (
            _mass("links.b1", "arm"),
            _mass("links.b2", "shaft"),
            _mass("links.b3", "bar 4–3–7"),
            _mass("links.b4", "bar 9–4–5"),
            _mass("links.b7", "bar 7–8"),
            _mass("links.b8", "bar 8–9"),
            _mass("links.b10", "guide link"),
        ),
    ),
    Group(
        "Masses",
        "Joints of each leg [kg]",
        (
            _mass("joints.j2", "shaft, arm"),
            _mass("joints.j3", "B3, shaft"),
            _mass("joints.j4", "B3, B4"),
            _mass("joints.j5", "B4, platform"),
            _mass("joints.j7", "B3, B7"),
            _mass("joints.j8", "slider"),
            _mass("joints.j9", "knee B8, B4"),
        ),
    ),
    Group(
        "Geometry",
        "Pantograph [mm]",
        (
            _row("geometry.magnification", "[no unit]", 6.0, 0.025, low=1.35),
            _length("geometry.crank_length", ""),
            _length("geometry.coupler_length", ""),
        ),
    ),
    Group(
        "Geometry",
        "Base and platform [mm]",
        (
            _length("geometry.base_radius", "leg axes"),
            _length("geometry.platform_radius", "joints 5"),
            _length("geometry.platform_joint_height", "joint 5 up"),
        ),
    ),
    Group(
        "Geometry",
        "Arms, shafts and guides [mm]",
        (
            _length("geometry.arm_length", "arm"),
            _length("geometry.shaft_length", "shaft"),
            _length("geometry.guide_link_length", "guide link"),
            _length("geometry.guide_stroke", ""),
            _length("geometry.axis_clearance", "", 100.0),
        ),
    ),
    Group(
        "Inertia, friction, g",
        "Platform and payload [kg·m²]",
        (_inertia("platform.inertia", "platform"), _inertia("payload.inertia", "payload")),
    ),
    Group("Inertia, friction, g", "Inertias of the links [kg·m²]", _INERTIA_ROWS, open=False),
    Group("Inertia, friction, g", "Gravity", (_row("gravity", "[m/s²]", 20.0, 0.005),)),
    Group(
        "Inertia, friction, g",
        "Friction of the actuators",
        (
            _friction("friction.viscous_rotary", 2.0, 0.005),
            _friction("friction.coulomb_rotary", 2.0, 0.005),
            _friction("friction.viscous_linear", 100.0, 0.5),
            _friction("friction.coulomb_linear", 50.0, 0.5),
            _friction("friction.transition_speed", 0.1, 0.0005),
        ),
        open=False,
    ),
)
"""Every number of a design, once."""

TABS: tuple[str, ...] = tuple(dict.fromkeys(group.tab for group in GROUPS))
