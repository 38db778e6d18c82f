"""The counterweights of each leg: a row of each, and what attaches and removes them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from paminsa_viz.blocks.balance import room_text
from paminsa_viz.explorer.core.actions import change_design
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.kit.entries import ButtonGroup, Effect, Folder, Html
from paminsa_viz.explorer.kit.inputs import Dropdown, Pair
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.settings import MILLIMETERS, PLAIN
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model.parameters import BAR_ENDS, MOST_COUNTERWEIGHTS, Counterweight

PLACES = {
    f"{bar.upper()} past {joint}": (bar, joint) for bar, ends in BAR_ENDS.items() for joint in ends
}
"""Where a counterweight can be attached."""

ALL = "all"
"""What the button says that removes all of them."""


def counterweights_html(frame: Frame) -> str:
    """Return what the rows of the counterweights hold, and the clearance that the discs need."""
    design = frame.state.document.design
    needs = [room_text(design.geometry, weight) for weight in design.counterweights]
    return render("balance/counterweights.j2", needs=needs)


def _weight(number: int) -> Pair:
    """Return the row of a counterweight: its lever and its mass."""

    def held(state: State) -> Counterweight | None:
        return next(iter(state.document.design.counterweights[number:]), None)

    def label(state: State) -> str:
        weight = held(state)
        place = "" if weight is None else f": {weight.bar.upper()} past {weight.joint}"
        return f"{number + 1}{place}"

    def read(state: State) -> tuple[float, float]:
        weight = held(state)
        return (0.0, 0.0) if weight is None else (weight.beyond, weight.mass)

    def apply(state: State, value: tuple[float, float]) -> State:
        beyond, mass = value
        return balancing.change_counterweight(state, number, mass, beyond)

    return Pair(
        f"weights.{number}", label, visible=lambda state: held(state) is not None,
        units=(MILLIMETERS, PLAIN), read=read, apply=apply,
        hint="Distance beyond the joint [mm]; before it, on the bar itself, where negative. Mass "
        "on each leg [kg]",
    )  # fmt: skip


def _attach(state: State, place: tuple[str, int] | None) -> State:
    return state if place is None else balancing.add_counterweight(state, *place)


def removals(state: State) -> Mapping[str, Effect]:
    """Return a button for each counterweight if there are several, and one for all."""
    count = len(state.document.design.counterweights)
    found: dict[str, Effect] = {
        str(number + 1): partial(balancing.remove_counterweight, number=number)
        for number in range(count if count > 1 else 0)
    }
    if count:
        found[ALL] = partial(change_design, counterweights=())
    return found


COUNTERWEIGHTS = (
    Html("weights.text", content=counterweights_html, idle=True),
    Folder(
        "weights.rows", entries=tuple(_weight(number) for number in range(MOST_COUNTERWEIGHTS)),
        visible=lambda state: bool(state.document.design.counterweights),
    ),
    Dropdown(
        "weights.add", "Attach to", options={"choose …": None, **PLACES},
        hint="1 kg on each leg, 100 mm beyond that joint; then change it as you like",
        read=lambda state: None, apply=_attach,
    ),
    ButtonGroup("weights.remove", "Remove", choices=removals, hint="One of them, or all"),
)  # fmt: skip
