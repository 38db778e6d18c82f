"""What is seen above all tabs: status and pose, actuators, requirements."""

from __future__ import annotations

from paminsa_viz.explorer.core import tab_store
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.features.pose.tab import (
    actuators_html,
    pose_line_html,
    status_html,
    summary_html,
)
from paminsa_viz.explorer.kit.entries import ButtonGroup, Html
from paminsa_viz.explorer.kit.robot_texts import of_pose
from paminsa_viz.explorer.state.state import State


def requirements_html(state: State) -> str:
    """Return which requirements hold, or nothing without any."""
    if not asked(state.document.requirements):
        return ""
    from paminsa_viz.explorer.features.requirements import texts as requirements_text  # loads SciPy

    return requirements_text.strip_html(state)


def strip_html(frame: Frame) -> str:
    """Return what is seen above all tabs."""
    numbers = of_pose(frame, actuators_html(frame), summary_html(frame))
    parts = (status_html(frame), pose_line_html(frame), numbers, requirements_html(frame.state))
    return f'<div class="pv-strip">{"".join(parts)}</div>'


STRIP = (
    Html("readout.strip", content=strip_html),
    ButtonGroup(
        "kept", "Kept state",
        choices={"Open it": tab_store.open_offered, "Leave it": tab_store.drop_offered},
        visible=lambda state: bool(state.offered),
        hint="What this tab has kept from before its reload; opening it can be undone",
    ),
)  # fmt: skip
