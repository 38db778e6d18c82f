"""The panel of the inspector: it floats over the view and is there while a part is inspected."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any, Final

import viser

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.inspector import numbers
from paminsa_viz.explorer.features.inspector.shares import (
    imbalance_share,
    strain_share,
    tolerance_share,
)
from paminsa_viz.explorer.features.loads.solving import found, instant
from paminsa_viz.explorer.features.stiffness.tab import elastic_label
from paminsa_viz.explorer.kit.bindings import Panel, perform
from paminsa_viz.explorer.kit.design_numbers import GROUPS, label
from paminsa_viz.explorer.kit.entries import Effect, Html, Message, Then
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.inspector import PartKind, RobotPart
from paminsa_viz.explorer.state.monte_carlo import NAMES
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.stiffness import CASES
from paminsa_viz.model import PARAMETER, Design
from paminsa_viz.units import number, percent

WIDTH: Final = 236
"""Width of the panel [px]."""

ESCAPE: Final = "escape"
"""Message of the page: the key Esc was pressed and nothing else takes it."""

INSPECT: Final = "inspector"
"""Message of the page: a link of the panel was clicked."""

LENGTHS: Final = {
    "b1": "geometry.arm_length", "b2": "geometry.shaft_length", "b3": "geometry.crank_length",
    "b4": "geometry.coupler_length", "b7": "geometry.magnification",
    "b8": "geometry.crank_length", "b10": "geometry.guide_link_length",
}  # fmt: skip
"""Paths of what sets the lengths of the bars; B7 follows from B4 and k."""


def inspect(state: State, part: RobotPart | None) -> State:
    """Inspect a part; None closes the inspector."""
    return state if state.inspected == part else replace(state, inspected=part)


def fields_of(part: RobotPart) -> tuple[str, ...]:
    """Return paths of the design's numbers that are worth changing for a part."""
    if part.kind is PartKind.BAR:
        return part.mass_path, LENGTHS[part.name], f"elastic.{part.name}_outer"
    if part.kind is PartKind.MOTOR:
        name = "linear" if part.leg is None else "rotary"
        return f"elastic.drive_{name}", f"friction.coulomb_{name}"
    own = {
        "5": ("geometry.platform_radius", "elastic.ball"), "8": ("elastic.guide",),
    }.get(part.name, ("elastic.bearing_radial",))  # fmt: skip
    return part.mass_path, *own


def section_of(path: str) -> str:
    """Return the section where a number of the design is set."""
    if path.startswith("elastic."):
        return "Stiffness"
    return next(
        group.tab for group in GROUPS for one in group.parameters if one.path == path
    )  # fmt: skip


def label_of(path: str) -> str:
    """Return how the label of a number of the design begins on the page."""
    group, _, name = path.partition(".")
    return elastic_label(name) if group == "elastic" else label(PARAMETER[path])


def quantity_of(part: RobotPart) -> str:
    """Return the key of the map quantity that goes with a part."""
    if part.kind is PartKind.BAR:
        return "utilization"
    if part.kind is PartKind.MOTOR:
        return "f_4" if part.leg is None else f"tau_{part.leg + 1}"
    return {"8": "force_8_b8"}.get(part.name, f"force_{part.name}")


def text(frame: Frame) -> str:
    """Return what is said of the part that is inspected."""
    state = frame.state
    part = state.inspected
    if part is None:
        return ""
    time = instant(state).time
    return render(
        "inspector/part.j2", title=part.title, words=part.words, message=INSPECT,
        dot="m4" if part.leg is None else f"m{part.leg + 1}",
        length=_length(state, part),
        fields=[_field(state.shown_design, path) for path in fields_of(part)],
        reason=numbers.reason(state), rows=numbers.numbers(state, part), missing=_missing(state),
        when="At rest" if time is None else f"At {time:.2f} s",
        shares=_shares(frame, part), actions=_actions(state),
    )  # fmt: skip


def _length(state: State, part: RobotPart) -> str:
    """Return the length of a bar [mm], where none of the fields is it."""
    if part.kind is not PartKind.BAR or PARAMETER[LENGTHS[part.name]].unit == "m":
        return ""
    return number(1e3 * numbers.bar_length(state, part.name), 4)


def _field(design: Design, path: str) -> tuple[str, str, str, str, str]:
    """Return path, symbol, name, value and section of a number of the design."""
    parameter = PARAMETER[path]
    value = design.value(path)
    text = "rigid" if math.isinf(value) else parameter.display.format(value, 4)
    return path, parameter.symbol.partition(" = ")[0], parameter.label, text, section_of(path)


def _missing(state: State) -> str:
    """Return how the worst values are got, if they are not known."""
    if found(state) is not None:
        return ""
    if planned(state.document.motion, state.document.design).trajectory is None:
        return "Worst: over a motion, which the section Path sets."
    if state.loads.settings.along:
        return "Worst: being computed."
    return ""


def _shares(frame: Frame, part: RobotPart) -> list[tuple[str, str, str]]:
    state = frame.state
    added = imbalance_share(state.shown_design, part)
    coordinate = NAMES[state.monte_carlo.settings.coordinate]
    rows = []
    if added is not None:
        hint = "Of these parts of all legs, in the weight that M1 to M3 hold"
        rows.append(("M_p2", f"{number(added, 3)} N of {number(frame.balance, 3)} N", hint))
    strain = strain_share(state, part)
    if strain is not None:
        share = "no load" if math.isnan(strain) else percent(strain, digits=3)
        case = CASES[state.stiffness.settings.case][0]
        rows.append(("strain energy", share, f"Of this part alone, under {case}"))
    error = tolerance_share(frame, part)
    if error is not None:
        hint = "In the variance by tolerances, of these parts of all legs"
        rows.append((f"error of {coordinate}", percent(error, digits=3), hint))
    return rows


def _actions(state: State) -> dict[str, Effect]:
    """Return what the links below do, by their texts."""
    part = state.inspected
    if part is None:
        return {}
    shown: dict[str, Effect] = {
        "map this": Then(partial(choose_quantity, quantity=quantity_of(part)), opens="Single map")
    }
    planned_motion = planned(state.document.motion, state.document.design).trajectory
    if planned_motion is not None and not state.loads.settings.along:
        shown["along the motion"] = partial(along_motion, part=part)
    return {**shown, "close": partial(inspect, part=None)}


def along_motion(state: State, part: RobotPart) -> State:
    """Find the loads along the motion; their answer lists the part's leg, and its bar."""
    own: dict[str, Any] = {} if part.leg is None else {"leg": part.leg}
    if part.kind is PartKind.BAR:
        own["bar"] = part.name
    return state.updated("loads.settings", along=True, **own)


def _escape(session: Session, data: Any) -> None:
    """Close the inspector; nothing is looked at of what the page sends."""
    del data
    session.dispatch("inspect", partial(inspect, part=None), step=False)


def _receive(session: Session, data: Any) -> None:
    """Do what was clicked in the panel; ``data`` comes from the page."""
    part = session.state.inspected
    if part is None or not isinstance(data, str):
        return
    if data in fields_of(part):
        session.open_tab(section_of(data))
        session.bridge.call("focusInput", [label_of(data)])
    elif data in (choices := _actions(session.state)):
        perform(session, INSPECT, choices[data], undo=False)


INSPECTOR: Final = (
    Message(ESCAPE, receive=_escape),
    Message(INSPECT, receive=_receive),
    Html("inspector.part", content=text, idle=True),
)


class Inspector:
    """The panel, as a view: hidden and without any computation while nothing is inspected."""

    def __init__(self, session: Session) -> None:
        self._panel = session.client.gui.add_panel(visible=False)
        with self._panel.add_tab("Inspector", viser.Icon.SEARCH):
            self._entries = Panel(session, INSPECTOR)
        self._panel.float(x=10, y=10, width=WIDTH)
        self._shown: RobotPart | None = None

    @property
    def handles(self) -> dict[str, Any]:
        """viser's handles of the entries by their keys."""
        return self._entries.handles

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the pose when the page is idle, and another part at once."""
        part = frame.state.inspected
        if part is not None:
            self._entries.draw(frame, dragging and part == self._shown)
        if (part is None) != (self._shown is None):
            self._panel.visible = part is not None
        self._shown = part
