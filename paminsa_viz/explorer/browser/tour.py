"""The steps of the guided tour, which ``tour.js`` shows."""

from __future__ import annotations

from typing import Any, Final

from paminsa_viz.explorer.browser.bridge import Bridge

START: Final = "start-tour"
"""Message of the page: the tour is asked for."""


def _step(
    title: str,
    text: str,
    selector: str = "[role=tab]",
    *,
    tab: str = "",
    heading: str = "",
    host: bool = False,
    opens: str = "",
) -> Any:
    """Return a step about an element, its container, a tab, or a folder; it may open a tab."""
    about = {"selector": selector, "tab": tab, "heading": heading, "host": host}
    about["opens"] = opens or tab
    return {"title": title, "text": text, **about}


STEPS: Final = (
    _step(
        "Status and torques",
        "This strip stays above all tabs: whether the robot can take the pose, the margin to the "
        "nearest limit, and the static torques of M1 to M4. Under the pointer it also shows the "
        "condition number κ, and the static imbalance, zero for a balanced robot.",
        "div:has(> .pv-strip)",
    ),
    _step(
        "The robot",
        "Drag to turn the view, scroll to zoom, press 1 to 6 for other views. Press G for a handle "
        "on the platform, and click the colored map on the ground to go there.",
        "canvas[data-engine]",
    ),
    _step(
        "Maps",
        "Torques over the whole workspace at this θ and z. Click a map to go there, or draw a "
        "motion on it. Tabs beside them hold one map of any quantity, the motion’s curves, and the "
        "answers of all sections. Below each figure are its files.",
        '[data-paminsa-slot="torques"]', host=True, opens="Torque maps",
    ),
    _step(
        "Robot: what is it?",
        "Pose, lengths, masses and load. Pin a design as reference (P), in the strip, and press "
        "compare to see every number next to it.",
        tab="Robot",
    ),
    _step(
        "Motion: can it move so?",
        "Choose a motion, or build one from poses that are typed, dragged or drawn. Play it, "
        "choose motors and gears for it, and simulate it with a controller.",
        tab="Motion",
    ),
    _step(
        "Strength: does it hold?",
        "Forces in joints and bars, stiffness and vibration, and how exact the robot is with its "
        "drives and as it is built.",
        tab="Strength",
    ),
    _step(
        "Optimize: what should it be?",
        "Ask for a workspace and bounds, and have them proven. Balance finds the masses or springs "
        "that take gravity off M1 to M3, Synthesis the lengths.",
        tab="Optimize",
    ),
    _step(
        "Built: does the real one agree?",
        "Identify masses and friction from a log of the built robot, find the best motion to "
        "record one with, and calibrate the lengths from measured poses.",
        tab="Built",
    ),
    _step(
        "Examples and files",
        "Five example robots are a click away, next to design files, share codes and a page in one "
        "file, which needs no server. The tour can be started again there. Ctrl+K finds all else.",
        heading="File",
    ),
)  # fmt: skip
"""What a newcomer is shown, in this order; a step whose element is not on the page is left out."""


def offer_tour(bridge: Bridge) -> None:
    """Start the tour for a newcomer, and for whoever asks for it."""
    bridge.on(START, lambda _: bridge.call("tour", STEPS, True))
    bridge.call("tour", STEPS, False)
