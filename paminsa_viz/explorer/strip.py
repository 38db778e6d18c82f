"""What is seen above all tabs: status and undo, pose, torques, the reference."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from paminsa_viz.explorer.core import tab_store
from paminsa_viz.explorer.core.actions import Action
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.features.compare.tab import REFERENCE, switch_html
from paminsa_viz.explorer.features.pins.tab import PINS, pins_html
from paminsa_viz.explorer.features.pose.tab import (
    load_html,
    pose_line_html,
    status_line_html,
    summary_html,
    torques_html,
)
from paminsa_viz.explorer.kit.entries import ButtonGroup, Effect, Html
from paminsa_viz.explorer.kit.robot_texts import line_texts, of_pose
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.balance import BalanceKind
from paminsa_viz.explorer.state.state import State


def requirements_html(state: State) -> str:
    """Return which requirements hold, or nothing without any."""
    if not asked(state.document.requirements):
        return ""
    from paminsa_viz.explorer.features.requirements import texts as requirements_text  # loads SciPy

    return requirements_text.strip_html(state)


def springs_html(frame: Frame) -> str:
    """Return the torques with the springs that were fitted, or nothing without any."""
    if frame.state.springs.result is None:
        return ""
    from paminsa_viz.explorer.features.springs.actions import relieved  # loads SciPy

    held = relieved(frame.state, frame.torques)
    if held is None:
        return ""
    return render("springs/strip.j2", texts=line_texts(frame.shown_design, held))


def strip_html(frame: Frame) -> str:
    """Return what is seen above all tabs; under the pointer also what *Pose* has in any case."""
    numbers = of_pose(frame, summary_html(frame), torques_html(frame))
    more = f'<div class="pv-more">{numbers}</div>'
    parts = (
        status_line_html(frame), pose_line_html(frame), of_pose(frame, load_html(frame)),
        springs_html(frame), pins_html(frame),
        requirements_html(frame.state), switch_html(frame), more,
    )  # fmt: skip
    return f'<div class="pv-strip">{"".join(parts)}</div>'


BALANCE_TASKS = {
    BalanceKind.OPTIMUM: "Balance",
    BalanceKind.FRONT: "Pareto front",
    BalanceKind.SENSITIVITY: "Sensitivity",
}
"""Labels of the tasks of the balance that can be started again."""


def restartable(state: State) -> dict[str, Effect]:
    """Return a button for each task that a reload has ended or lost, and one to leave them."""
    if not state.ended:
        return {}
    # Late: it loads SciPy.
    from paminsa_viz.explorer.features.balance import actions as balancing
    from paminsa_viz.explorer.features.drives.tab import SEARCH as DRIVES
    from paminsa_viz.explorer.features.identification.actions import SEARCH as EXCITATION
    from paminsa_viz.explorer.features.requirements.actions import LARGEST
    from paminsa_viz.explorer.features.synthesis.actions import SEARCH
    from paminsa_viz.explorer.features.synthesis.actions import start as search

    tasks: dict[str, tuple[str, Action]] = {
        SEARCH.place.path: ("Search for a robot", search),
        LARGEST.place.path: ("Largest workspace", LARGEST.start),
        DRIVES.place.path: ("Search for drives", DRIVES.start),
        EXCITATION.place.path: ("Motion for a log", EXCITATION.start),
    }
    for kind, label in BALANCE_TASKS.items():
        name = tab_store.task_name(balancing.OPTIMUM.place.path, kind.name)
        tasks[name] = label, partial(balancing.start, task=kind)
    found: dict[str, Effect] = {
        label: start for name, (label, start) in tasks.items() if name in state.ended
    }
    return {**found, "Leave it": _leave} if found else {}


def _leave(state: State) -> State:
    return replace(state, ended=())


STRIP = (
    REFERENCE,
    *PINS,
    Html("readout.strip", content=strip_html),
    ButtonGroup(
        "kept", "Kept state",
        choices={"Open it": tab_store.open_offered, "Leave it": tab_store.drop_offered},
        visible=lambda state: bool(state.offered),
        hint="What this tab has kept from before its reload; opening it can be undone",
    ),
    ButtonGroup(
        "ended", "Lost by reload", choices=restartable,
        hint="Starts again, from its beginning, what ran or was found before the page was reloaded",
    ),
)  # fmt: skip
