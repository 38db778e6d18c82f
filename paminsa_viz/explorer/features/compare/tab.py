"""The current design next to a pinned reference, or to Appendix 4 as long as none is pinned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from paminsa_viz.blocks.design import changes_table
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.bindings import perform
from paminsa_viz.explorer.kit.entries import Answer, ButtonGroup, Effect, Entry, Html, Message
from paminsa_viz.explorer.kit.robot_texts import decimals, of_pose
from paminsa_viz.explorer.kit.text import blocks_html, note, render
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design, static_imbalance, static_torques
from paminsa_viz.model.arrays import Array
from paminsa_viz.units import counted

PIN: Mapping[str, Effect] = {"Pin current design": actions.pin_reference}

PINNED: Mapping[str, Effect] = {
    "Pin current": actions.pin_reference,
    "Swap": actions.swap_reference,
    "Unpin": actions.unpin_reference,
}


def _pin(state: State) -> State:
    """Pin the current design, unless one is pinned that is not Appendix 4."""
    return state if switched(state) == "pinned" else actions.pin_reference(state)


def names_html(design: Design, reference: Design | None) -> str:
    """Return what is compared with what."""
    return render("compare/compared.j2", design=design, reference=reference)


def torques_html(torques: Array, held: Array, design: Design, reference: Design, title: str) -> str:
    """Return a table of the static torques of both designs at the shown pose, and of M_p2.

    Args:
        torques, held: Of the current and the reference design, (4,) [N m, N]; NaN where the
            reference cannot take the pose.
        design, reference: The designs.
        title: Heading of the reference's column.
    """
    of_torque, of_force = decimals(design)
    rows = [
        (f"m{j + 1}", symbol, unit, float(torques[j]), float(held[j]), digits)
        for j, (symbol, unit, digits) in enumerate(
            [*((f"τ_{k}", "N·m", of_torque) for k in (1, 2, 3)), ("F_4", "N", of_force)]
        )
    ]
    balances = static_imbalance(design), static_imbalance(reference)
    rows.append(("", "M_p2", "N", *balances, of_force + 1))
    return render(
        "compare/compared_torques.j2", rows=rows, title=title, reachable=np.isfinite(held).all()
    )  # fmt: skip


def differences_html(design: Design, reference: Design, title: str) -> str:
    """Return a table of the numbers in which two designs differ; arguments as `torques_html`."""
    table = changes_table(reference, design, (title, "Current"))
    if not table.rows:
        return note("differences", "No number differs.", muted=True)
    head = counted(len(table.rows), "number differs", "numbers differ")
    shown = replace(table.columns(0, 3, 4, 5, hint=1), head=(head, title, "Current", "Change"))
    return blocks_html("differences", shown, look="pv-tight", bold=[2])


def _names(frame: Frame) -> str:
    document = frame.state.document
    return names_html(document.design, document.reference)


def _compared_with(state: State) -> tuple[Design, str]:
    reference = state.document.reference
    if reference is not None:
        return reference, "Reference"
    return actions.appendix_of(state), "App. 4"


def _torques(frame: Frame) -> str:
    reference, title = _compared_with(frame.state)
    last_reachable = frame.state.last_reachable
    # The frame's own torques are None both without a reference and where it cannot be.
    held = static_torques(reference, last_reachable.pose)
    text = torques_html(frame.torques, held, frame.state.document.design, reference, title)
    return of_pose(frame, text)


def _differences(frame: Frame) -> str:
    return differences_html(frame.state.document.design, *_compared_with(frame.state))


SWITCH = {"none": actions.unpin_reference, "Appendix 4": actions.pin_appendix, "pinned": _pin}
"""What the reference is, and what makes it that."""

OPEN_COMPARISON = "table"
"""What the strip sends for the table of differences."""


def switched(state: State) -> str:
    """Return which of `SWITCH` the reference is."""
    reference = state.document.reference
    if reference is None:
        return "none"
    return "Appendix 4" if reference == actions.appendix_of(state) else "pinned"


def switch_html(frame: Frame) -> str:
    """Return the switch of the reference, as a line of the strip."""
    return render("compare/switch.j2", choices=tuple(SWITCH), chosen=switched(frame.state))


def _receive(session: Session, data: Any) -> None:
    """Switch the reference, or show the differences from it; ``data`` comes from the page."""
    if data == OPEN_COMPARISON:
        perform(session, COMPARISON.key, COMPARISON.opens, undo=False)
    elif isinstance(data, str) and data in SWITCH:
        session.dispatch("reference", SWITCH[data])


REFERENCE = Message("reference", receive=_receive)
"""What the switch in the strip sends."""

COMPARE: tuple[Entry, ...] = (
    ButtonGroup(
        "reference", "Reference",
        choices=lambda state: PIN if state.document.reference is None else PINNED,
        hint="What the current design is compared with: pin it as it is now, exchange the two, or "
        "compare with Appendix 4 again",
    ),
    Html("compare.names", content=_names),
    Html("compare.torques", content=_torques),
    Html("compare.differences", content=_differences),
)  # fmt: skip

COMPARISON = Answer("compare.answer", "Comparison", entries=COMPARE, always=True)
"""The design next to its reference."""
