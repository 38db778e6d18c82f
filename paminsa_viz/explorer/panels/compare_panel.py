"""The present design beside a pinned reference, or beside Appendix 4 as long as none is pinned."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.design_layout import is_changed
from paminsa_viz.explorer.panels.tables import dot, note, table
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    Design,
    Parameter,
    static_imbalance,
    static_torques,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.units import fixed, number, percent_change, symbol_html

PIN, SWAP, UNPIN = "Pin present", "Swap", "Unpin"

_INTENTS = {
    PIN: actions.pin_reference,
    SWAP: actions.swap_reference,
    UNPIN: actions.unpin_reference,
}


def names_html(design: Design, reference: Design | None) -> str:
    """Say what is compared with what."""
    name = f"<b>{escape(design.name) or 'Present design'}</b>"
    if reference is None:
        return note(
            f"No design is pinned, so the present one ({name}) is compared with Appendix 4. Pin it "
            f"to see what later changes do: here, in the readouts, and as difference maps.",
            "compared",
        )
    return note(f"{name} beside <b>{escape(reference.name) or 'the reference'}</b>", "compared")


def torques_html(torques: Array, held: Array, design: Design, reference: Design, title: str) -> str:
    """Return a table of the static torques of both designs at the standing pose, and of M_p2.

    Args:
        torques, held: Of the present and the reference design, (4,) [N m, N]; NaN where the
            reference cannot take the pose.
        design, reference: The designs.
        title: Heading of the reference's column.
    """
    balances = static_imbalance(design), static_imbalance(reference)
    lines = [
        (f"{dot(ACTUATOR_COLORS[j])}τ<sub>{j + 1}</sub> [N·m]", torques[j], held[j], 3)
        for j in range(3)
    ]
    lines.append((f"{dot(ACTUATOR_COLORS[3])}F<sub>4</sub> [N]", torques[3], held[3], 2))
    lines.append(("<i>M</i><sub>p2</sub> [N]", *balances, 4))
    rows = []
    for label, now, then, digits in lines:
        if np.isfinite(then):
            tiny = abs(then) < 0.5 * 10**-digits  # shown as zero; a share of it says nothing
            change = "–" if tiny else percent_change(float(then), float(now))
            rest = [fixed(float(then), digits), fixed(float(now - then), digits), change]
        else:
            rest = ["–"] * 3
        rows.append([label, rest[0], f"<b>{fixed(float(now), digits)}</b>", *rest[1:]])
    text = table(["LastReachable still", title, "present", "Δ", "Δ %"], rows)
    if not np.isfinite(held).all():
        text += "The reference cannot take this pose."
    return note(text, "compared-torques")


def _value(design: Design, parameter: Parameter) -> str:
    text = parameter.display.format(design.value(parameter.path), 6).replace(" ", "\u202f")
    if parameter.path == "geometry.guide_stroke" and design.geometry.guide_stroke is None:
        return f"{text} (l<sub>B10</sub>)"
    return text


def _weights(design: Design, reference: Design) -> list[list[str]]:
    """Return rows for places where two designs have other counterweights."""
    held: dict[str, float] = {}
    present: dict[str, float] = {}
    for found, weights in ((held, reference.counterweights), (present, design.counterweights)):
        for weight in weights:
            found[weight.place] = found.get(weight.place, 0.0) + weight.mass
    return [
        [
            f"on {escape(place)}",
            f"{number(held.get(place, 0.0), 6)}\u202fkg",
            f"<b>{number(present.get(place, 0.0), 6)}\u202fkg</b>",
            percent_change(held.get(place, 0.0), present.get(place, 0.0)),
        ]
        for place in dict.fromkeys([*held, *present])
        if held.get(place) != present.get(place)
    ]


def differences_html(design: Design, reference: Design, title: str) -> str:
    """Return a table of the numbers in which two designs differ; arguments as `torques_html`."""
    rows = [
        [
            f'<span title="{escape(p.label)}">{symbol_html(p.symbol)}</span>',
            _value(reference, p),
            f"<b>{_value(design, p)}</b>",
            percent_change(reference.value(p.path), design.value(p.path)),
        ]
        for p in PARAMETERS
        if is_changed(design, p.path, reference)
    ]
    rows += _weights(design, reference)
    if not rows:
        return note("No number differs.", "differences", muted=True)
    count = f"{len(rows)} number{'s differ' if len(rows) > 1 else ' differs'}"
    return note(table([count, title, "present", "change"], rows), "differences")


class ComparePanel:
    """Pin, swap, unpin; torques side by side; a table of what differs."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        self.buttons = gui.add_button_group("Reference", (PIN,))
        self.buttons.on_click(self._on_click)
        self._texts = [gui.add_html("") for _ in range(3)]

    def _on_click(self, event: Any) -> None:
        intent = _INTENTS.get(event.target.value)
        if intent is not None:
            self._session.dispatch("reference", intent)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Write what changed."""
        del moving
        document = frame.state.document
        options = (PIN,) if document.reference is None else (PIN, SWAP, UNPIN)
        if tuple(self.buttons.options) != options:
            self.buttons.options = options
        reference = document.reference or APPENDIX_4.with_knee(document.design.geometry.knee)
        title = "App. 4" if document.reference is None else "reference"
        standing = frame.state.standing
        # The frame's own torques are None both without a reference and where it cannot stand.
        held = static_torques(reference, standing.pose)
        texts = (
            names_html(document.design, document.reference),
            torques_html(frame.torques, held, document.design, reference, title),
            differences_html(document.design, reference, title),
        )
        for handle, text in zip(self._texts, texts, strict=True):
            if handle.content != text:
                handle.content = text
