"""Live numbers of the present pose, and its plain status."""

from __future__ import annotations

from html import escape

import numpy as np

from paminsa_viz.explorer.frame import Frame, Health
from paminsa_viz.explorer.session import Session
from paminsa_viz.model.reach import MARGINS, Limit
from paminsa_viz.palette import ACTUATOR_COLORS, BAD, LEG_COLORS, MUTED, OK, WARN
from paminsa_viz.units import fixed

_STYLE = {Health.FINE: OK, Health.NEAR: WARN, Health.UNREACHABLE: BAD}

LIMIT_NAMES = {
    Limit.STRETCHED: "stretch",
    Limit.FOLDED: "fold",
    Limit.GUIDE: "guide",
    Limit.AXIS: "axis",
}


def status_html(frame: Frame) -> str:
    """Return the status line."""
    color = _STYLE[frame.health]
    name = frame.health.value.capitalize()
    return (
        f'<div data-testid="status" style="border-left:5px solid {color};padding:5px 9px;'
        f"margin:2px 10px 4px 10px;"
        f'background:{color}18;border-radius:4px;font-size:13px;line-height:1.35">'
        f'<b style="color:{color}">{name}</b><br>{escape(frame.explanation)}</div>'
    )


_PAD = "padding:2px 12px 4px 12px"

_CELL = "padding:1px 0 1px 6px;text-align:right;white-space:nowrap"


def _row(cells: list[str], head: bool = False) -> str:
    tag = "th" if head else "td"
    weight = f"font-weight:600;color:{MUTED}" if head else ""
    first = f'<{tag} style="text-align:left;white-space:nowrap;{weight}">{cells[0]}</{tag}>'
    rest = "".join(f'<{tag} style="{_CELL};{weight}">{cell}</{tag}>' for cell in cells[1:])
    return f"<tr>{first}{rest}</tr>"


def _table(rows: list[str]) -> str:
    return (
        '<table style="width:100%;border-collapse:collapse;font-size:12.5px;'
        'font-variant-numeric:tabular-nums">' + "".join(rows) + "</table>"
    )


def dot(color: str) -> str:
    """Return a colored dot for a table."""
    return (
        f'<span style="display:inline-block;width:9px;height:9px;border-radius:5px;'
        f'background:{color};margin-right:5px"></span>'
    )


def actuators_html(frame: Frame) -> str:
    """Return positions and static torques of the four actuators."""
    reference = frame.reference_torques
    pinned = frame.state.document.reference is not None
    head = ["Actuator", "position", "holds"] + (["reference", "Δ"] if pinned else [])
    rows = [_row(head, head=True)]
    position = frame.configuration.actuators
    for j in range(4):
        rotary = j < 3
        place = (
            f"θ{'₁₂₃'[j]} = {fixed(float(np.degrees(position[j])), 2)}°"
            if rotary
            else f"Z = {fixed(1e3 * float(position[3]), 1)} mm"
        )
        unit, digits = ("N·m", 3) if rotary else ("N", 2)
        value = float(frame.torques[j])
        name = dot(ACTUATOR_COLORS[j]) + f"M{j + 1}"
        cells = [name, place, f"<b>{fixed(value, digits)}</b> {unit}"]
        if pinned and reference is not None:
            held = float(reference[j])
            cells += [fixed(held, digits), fixed(value - held, digits)]
        elif pinned:
            cells += ["–", "–"]
        rows.append(_row(cells))
    return f'<div data-testid="actuators" style="{_PAD}">{_table(rows)}</div>'


def quality_html(frame: Frame) -> str:
    """Return balance, condition, distances to singularities and the legs' margins."""
    s = frame.singularity
    rows = [
        _row(["M<sub>p2</sub>, distance from balance", f"<b>{fixed(frame.balance, 4)}</b> N"]),
        _row(["condition number", fixed(float(s.condition), 3)]),
        _row(["to the singular circle", f"{fixed(1e3 * float(s.position_distance), 1)} mm"]),
        _row(
            [
                "to a singular rotation",
                f"{fixed(float(np.degrees(s.rotation_distance)), 2)}°",
            ]
        ),
    ]
    margins = [_row(["Room to limits [mm]", *LIMIT_NAMES.values()], head=True)]
    values = frame.configuration.reach.margins
    for leg in range(3):
        cells = [fixed(1e3 * float(values[leg, MARGINS.index(limit)]), 1) for limit in LIMIT_NAMES]
        margins.append(_row([dot(LEG_COLORS[leg]) + f"leg {leg + 1}", *cells]))
    tables = f'{_table(rows)}<div style="height:6px"></div>{_table(margins)}'
    return f'<div data-testid="quality" style="{_PAD}">{tables}</div>'


class Readout:
    """Status, actuators, and the pose's quality, as text that follows the pose."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self.status = gui.add_html("")
        self.actuators = gui.add_html("")
        self.quality = gui.add_html("")

    def draw(self, frame: Frame, moving: bool) -> None:
        """Write what changed."""
        del moving
        for handle, html in (
            (self.status, status_html(frame)),
            (self.actuators, actuators_html(frame)),
            (self.quality, quality_html(frame)),
        ):
            if handle.content != html:
                handle.content = html
