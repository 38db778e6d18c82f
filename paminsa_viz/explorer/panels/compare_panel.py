"""The current design next to a pinned reference, or to Appendix 4 as long as none is pinned."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

import numpy as np
from markupsafe import Markup

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.entries import ButtonGroup, Effect, Html
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.panels.balance_text import weights_by_place
from paminsa_viz.explorer.panels.design_layout import DIGITS, STROKE, is_changed
from paminsa_viz.explorer.state import State
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    Design,
    Parameter,
    static_imbalance,
    static_torques,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.units import NONE, fixed, number, percent_change, symbol_html

Cells = list[str | Markup]

PIN: Mapping[str, Effect] = {"Pin current design": actions.pin_reference}

PINNED: Mapping[str, Effect] = {
    "Pin current": actions.pin_reference,
    "Swap": actions.swap_reference,
    "Unpin": actions.unpin_reference,
}


def names_html(design: Design, reference: Design | None) -> str:
    """Return what is compared with what."""
    return render("compared.j2", design=design, reference=reference)


def torques_html(torques: Array, held: Array, design: Design, reference: Design, title: str) -> str:
    """Return a table of the static torques of both designs at the shown pose, and of M_p2.

    Args:
        torques, held: Of the current and the reference design, (4,) [N m, N]; NaN where the
            reference cannot take the pose.
        design, reference: The designs.
        title: Heading of the reference's column.
    """
    rows = [
        (f"m{j + 1}", symbol, unit, *_compared(float(torques[j]), float(held[j]), digits))
        for j, (symbol, unit, digits) in enumerate(
            [("τ_1", "N·m", 3), ("τ_2", "N·m", 3), ("τ_3", "N·m", 3), ("F_4", "N", 2)]
        )
    ]
    balances = _compared(static_imbalance(design), static_imbalance(reference), 4)
    rows.append(("", "M_p2", "N", *balances))
    return render(
        "compared_torques.j2", rows=rows, title=title, reachable=np.isfinite(held).all()
    )  # fmt: skip


def _compared(now: float, then: float, digits: int) -> tuple[str, str, str, str]:
    """Return the reference's value, the current one, and their difference, also in percent."""
    if not np.isfinite(then):
        return NONE, fixed(now, digits), NONE, NONE
    tiny = abs(then) < 0.5 * 10**-digits  # shown as zero; a share of it says nothing
    change = NONE if tiny else percent_change(then, now)
    return fixed(then, digits), fixed(now, digits), fixed(now - then, digits), change


def differences_html(design: Design, reference: Design, title: str) -> str:
    """Return a table of the numbers in which two designs differ; arguments as `torques_html`."""
    rows: list[Cells] = [
        [
            Markup(f'<span title="{escape(p.label)}">{symbol_html(p.symbol)}</span>'),
            _value(reference, p),
            Markup("<b>{}</b>").format(_value(design, p)),
            percent_change(reference.value(p.path), design.value(p.path)),
        ]
        for p in PARAMETERS
        if is_changed(design, p.path, reference)
    ]
    frames = [which.load.frame.value for which in (reference, design)]
    if frames[0] != frames[1]:
        rows.append(["load fixed in", frames[0], Markup("<b>{}</b>").format(frames[1]), ""])
    rows += [
        [
            f"on {place}",
            f"{number(held, DIGITS)}\u202fkg",
            Markup("<b>{}\u202fkg</b>").format(number(current, DIGITS)),
            percent_change(held, current),
        ]
        for place, (held, current) in weights_by_place(reference, design).items()
        if held != current
    ]
    return render("differences.j2", rows=rows, title=title)


def _value(design: Design, parameter: Parameter) -> Markup:
    text = parameter.display.format(design.value(parameter.path), DIGITS).replace(" ", "\u202f")
    follows = parameter.path == STROKE and design.geometry.guide_stroke is None
    return Markup("{} (l<sub>B10</sub>)" if follows else "{}").format(text)


def _names(frame: Frame) -> str:
    document = frame.state.document
    return names_html(document.design, document.reference)


def _compared_with(state: State) -> tuple[Design, str]:
    reference = state.document.reference
    if reference is not None:
        return reference, "reference"
    return APPENDIX_4.with_knee(state.document.design.geometry.knee), "App. 4"


def _torques(frame: Frame) -> str:
    reference, title = _compared_with(frame.state)
    standing = frame.state.standing
    # The frame's own torques are None both without a reference and where it cannot stand.
    held = static_torques(reference, standing.pose)
    return torques_html(frame.torques, held, frame.state.document.design, reference, title)


def _differences(frame: Frame) -> str:
    return differences_html(frame.state.document.design, *_compared_with(frame.state))


COMPARE = (
    ButtonGroup(
        "reference", "Reference",
        choices=lambda state: PIN if state.document.reference is None else PINNED,
    ),
    Html("compare.names", content=_names),
    Html("compare.torques", content=_torques),
    Html("compare.differences", content=_differences),
)  # fmt: skip
