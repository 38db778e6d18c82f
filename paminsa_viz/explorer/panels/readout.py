"""Numbers of the current pose, and its status."""

from __future__ import annotations

import numpy as np

from paminsa_viz.explorer.entries import Html
from paminsa_viz.explorer.frame import Frame, Health
from paminsa_viz.explorer.panels.render import render
from paminsa_viz.model.reach import MARGINS

LEVELS = {Health.OK: "ok", Health.NEAR: "warn", Health.UNREACHABLE: "bad"}


def status_html(frame: Frame) -> str:
    """Return the status line."""
    return render(
        "status.j2", testid="status", level=LEVELS[frame.health],
        title=frame.health.value.capitalize(), lines=[frame.explanation],
    )  # fmt: skip


def actuators_html(frame: Frame) -> str:
    """Return positions and static torques of the four actuators."""
    return render(
        "actuators.j2", frame=frame, pinned=frame.state.document.reference is not None,
        reference=frame.reference_torques, degrees=np.degrees,
    )  # fmt: skip


def quality_html(frame: Frame) -> str:
    """Return static imbalance, condition, distances to singularities and the legs' margins."""
    return render(
        "quality.j2", frame=frame, singularity=frame.singularity, degrees=np.degrees,
        margins=frame.configuration.reach.margins,
        limits={limit.label: index for index, limit in enumerate(MARGINS)},
    )  # fmt: skip


READOUT = (
    Html("readout.status", content=status_html),
    Html("readout.actuators", content=actuators_html),
    Html("readout.quality", content=quality_html),
)
