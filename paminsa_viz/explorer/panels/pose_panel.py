"""Sliders for the platform pose, the assembly mode, and the steps back and forth."""

from __future__ import annotations

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.pose_slider import PoseSlider
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import KneeBranch

ASSEMBLY_LABELS = {
    KneeBranch.LOWER: "lower knee (as printed)",
    KneeBranch.UPPER: "upper knee (mirror)",
}


class PosePanel:
    """Four sliders with number entry, assembly mode, home, undo and redo."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self.sliders = [PoseSlider(session, index) for index in range(4)]
        self.assembly = gui.add_dropdown(
            "KneeBranch",
            tuple(ASSEMBLY_LABELS.values()),
            initial_value=ASSEMBLY_LABELS[session.state.document.assembly],
            hint="Which root of Appendix 1 the knee 9 takes; switching mirrors the height",
        )
        self._assembly = Control(
            session,
            self.assembly,
            "pose.assembly",
            lambda s, label: actions.assemble(s, _assembly(label)),
            lambda s: ASSEMBLY_LABELS[s.document.assembly],
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
        for view in (*self.sliders, self._assembly):
            view.draw(frame, moving)


def _assembly(label: str) -> KneeBranch:
    for assembly, name in ASSEMBLY_LABELS.items():
        if name == label:
            return assembly
    return KneeBranch.LOWER
