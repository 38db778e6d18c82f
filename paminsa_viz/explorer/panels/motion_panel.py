"""The tab in which a motion is chosen or built, played, and simulated."""

from __future__ import annotations

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.motion_inputs import MotionInputs
from paminsa_viz.explorer.panels.motion_playback import PlaybackInputs
from paminsa_viz.explorer.panels.motion_plots import ACTUATORS
from paminsa_viz.explorer.panels.motion_simulation import SimulationInputs
from paminsa_viz.explorer.panels.motion_timing import TimingInputs
from paminsa_viz.explorer.scene.path import legend_html, path_scale
from paminsa_viz.explorer.session import Session


class MotionPanel:
    """Status and playback, the motion, its duration, its path, its simulation.

    Made in the current container of the page.
    """

    def __init__(self, session: Session, store: MotionStore) -> None:
        gui = session.client.gui
        self._store = store
        self.playback = PlaybackInputs(session, store)
        self.inputs = MotionInputs(session)
        self.timing = TimingInputs(session)
        with gui.add_folder("Path in the scene", expand_by_default=False):
            show = gui.add_checkbox(
                "Show the path", "path" in session.state.layers, hint="Drawn on the maps as well"
            )
            color = gui.add_dropdown(
                "Colored by", ACTUATORS, initial_value=ACTUATORS[0],
                hint="Torque or force of this actuator; red where the motion fails",
            )  # fmt: skip
            self._legend = gui.add_html("")
        with gui.add_folder("Simulation", expand_by_default=False):
            self.simulation = SimulationInputs(session)
        self._controls = [
            Control(
                session, show, "layers.path",
                lambda s, value: actions.set_layers(s, path=bool(value)),
                lambda s: "path" in s.layers,
            ),
            Control(
                session, color, "plots.color",
                lambda s, value: motions.set_plots(s, color=ACTUATORS.index(value)),
                lambda s: ACTUATORS[s.plots.color],
            ),
        ]  # fmt: skip

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for part in (self.playback, self.inputs, self.timing, self.simulation, *self._controls):
            part.draw(frame, moving)
        analysis = self._store.analysis(frame.state)
        actuator = frame.state.plots.color
        html = "" if analysis is None else legend_html(path_scale(analysis, actuator), actuator)
        if self._legend.content != html:
            self._legend.content = html
