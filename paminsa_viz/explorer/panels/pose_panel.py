"""Sliders for the platform pose, the knee's branch, and the steps back and forth."""

from __future__ import annotations

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.pose_slider import PoseSlider
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import KneeBranch

KNEE_LABELS = {
    KneeBranch.LOWER: "lower knee (as printed)",
    KneeBranch.UPPER: "upper knee (mirror)",
}


class PosePanel:
    """Four sliders with number entry, the knee's branch, home, undo and redo."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self.sliders = [PoseSlider(session, index) for index in range(4)]
        self.knee = gui.add_dropdown(
            "Knee",
            tuple(KNEE_LABELS.values()),
            initial_value=KNEE_LABELS[session.state.document.design.geometry.knee],
            hint="Which root of Appendix 1 the knee 9 takes; switching mirrors the height",
        )
        self._knee = Control(
            session,
            self.knee,
            "pose.knee",
            lambda s, label: actions.set_knee(s, _knee(label)),
            lambda s: KNEE_LABELS[s.document.design.geometry.knee],
        )
        steps = gui.add_button_group("Steps", ("Home", "Undo", "Redo"))

        @steps.on_click
        def _(event) -> None:  # type: ignore[no-untyped-def]
            {
                "Home": lambda: session.dispatch("home", actions.go_home),
                "Undo": session.undo,
                "Redo": session.redo,
            }.get(event.target.value, lambda: None)()

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for view in (*self.sliders, self._knee):
            view.draw(frame, moving)


def _knee(label: str) -> KneeBranch:
    for knee, name in KNEE_LABELS.items():
        if name == label:
            return knee
    return KneeBranch.LOWER
