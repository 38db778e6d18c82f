"""The design's numbers: masses, geometry, inertias, friction; and what the masses come to."""

from __future__ import annotations

from typing import Any

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.design_layout import GROUPS, TABS, Group
from paminsa_viz.explorer.panels.number_row import NumberRow, Row
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import APPENDIX_4, Design, Geometry, lumped_matrix, static_imbalance
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.palette import INK, MUTED, OK, REFERENCE
from paminsa_viz.units import fixed, number

WHOLE_GROUP = "all"
"""What the button says that sets a whole group back."""


class GroupFolder:
    """A folder of sliders, and below them a button for each number that is not Appendix 4's."""

    def __init__(self, session: Session, group: Group) -> None:
        gui = session.client.gui
        self._session = session
        with gui.add_folder(group.title, expand_by_default=group.open):
            design = session.state.document.design
            self.rows = [NumberRow(session, row, full_hint(row, design)) for row in group.rows]
            self.reset = gui.add_button_group(
                "Reset to App. 4",
                (WHOLE_GROUP,),
                visible=False,
                hint="Set one value, or all of this group, back to Appendix 4's",
            )
        self._paths = {number_row.name: number_row.row.path for number_row in self.rows}
        self.reset.on_click(self._on_reset)

    def _on_reset(self, event: Any) -> None:
        chosen = event.target.value
        every = tuple(self._paths.values())
        paths = every if chosen == WHOLE_GROUP else (self._paths[chosen],)
        self._session.dispatch(
            f"reset.{paths[0]}", lambda state: actions.reset_values(state, paths)
        )

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for row in self.rows:
            row.draw(frame, moving)
        options = tuple(row.name for row in self.rows if row.changed(frame.state))
        if len(options) > 1:
            options += (WHOLE_GROUP,)
        if options and tuple(self.reset.options) != options:
            self.reset.options = options
        if self.reset.visible != bool(options):
            self.reset.visible = bool(options)


def balance_hint(path: str, geometry: Geometry, gravity: float) -> str:
    """Say what a mass does to M_p2, the scale of the torques of M1 to M3."""
    if path not in MASS_PATHS:
        return ""
    share = float(lumped_matrix(geometry, gravity)[1, MASS_PATHS.index(path)])
    if abs(share) < 1e-12:
        return "No part in M_p2: the static torques of M1–M3 do not depend on it."
    word = "raises" if share > 0 else "lowers"
    return f"Each kg {word} M_p2 by {number(abs(share), 4)} N."


def full_hint(row: Row, design: Design) -> str:
    """Return all that is said of a number where the pointer rests on it."""
    return f"{row.hint} {balance_hint(row.path, design.geometry, design.gravity)}".strip()


def balance_html(state: State, balance: float) -> str:
    """Return M_p2 in words and as a mark on a line from Appendix 4's value through zero."""
    document = state.document
    printed = static_imbalance(APPENDIX_4)
    pinned = None if document.reference is None else static_imbalance(document.reference)
    span = 1.25 * max(abs(v) for v in (printed, balance, pinned or 0.0))

    def tick(value: float, color: str, size: str) -> str:
        return (
            f'<div style="position:absolute;left:{50 + 50 * value / span:.2f}%;{size};'
            f'transform:translateX(-50%);background:{color};border-radius:2px"></div>'
        )

    line = tick(0.0, OK, "top:1px;height:12px;width:2px")
    line += tick(printed, MUTED, "top:3px;height:8px;width:2px")
    if pinned is not None:
        line += tick(pinned, REFERENCE, "top:1px;height:12px;width:3px")
    line += tick(balance, INK, "top:0;height:14px;width:6px")
    reference = "" if pinned is None else f", reference {fixed(pinned, 3)}"
    return note(
        f"<b><i>M</i><sub>p2</sub> = {fixed(balance, 3)} N</b> from balance "
        f'<span style="color:{MUTED}">(App. 4: {fixed(printed, 3)}{reference})</span>'
        f'<div style="position:relative;height:14px;margin-top:5px" '
        f'title="Green: balanced, gravity asks nothing of M1–M3. Gray: Appendix 4.">'
        f'<div style="position:absolute;top:6px;height:2px;width:100%;background:#d7dce1"></div>'
        f"{line}</div>",
        "balance",
    )


class DesignPanel:
    """Every number of the design, grouped, with M_p2 above them."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self.balance = gui.add_html("")
        tabs = gui.add_tab_group()
        self.folders: list[GroupFolder] = []
        for name in TABS:
            with tabs.add_tab(name):
                self.folders += [
                    GroupFolder(session, group) for group in GROUPS if group.tab == name
                ]
        self._rows = [row for folder in self.folders for row in folder.rows]
        self._hinted = _told_by_hints(session.state.document.design)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state; hints follow once the hand rests."""
        html = balance_html(frame.state, frame.balance)
        if self.balance.content != html:
            self.balance.content = html
        for folder in self.folders:
            folder.draw(frame, moving)
        design = frame.state.document.design
        if not moving and self._hinted != _told_by_hints(design):
            self._hinted = _told_by_hints(design)
            for row in self._rows:
                hint = full_hint(row.row, design)
                if row.slider.hint != hint:
                    row.slider.hint = hint


def _told_by_hints(design: Design) -> tuple[Geometry, float]:
    return design.geometry, design.gravity
