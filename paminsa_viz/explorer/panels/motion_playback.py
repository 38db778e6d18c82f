"""Playing a motion: its status, play and pause, the instant, speed, and whether it repeats."""

from __future__ import annotations

import math
from html import escape

from viser import Icon

from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.playback import SPEEDS
from paminsa_viz.explorer.motion.results import MotionStore
from paminsa_viz.explorer.panels.motion_words import status_line
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.palette import BAD, MUTED, OK

PLAY, PAUSE = "Play", "Pause"

TIME = "t  [s]"

SPEED_WORDS = {f"{speed:g} ×": speed for speed in SPEEDS}
"""What a person reads of a speed."""


def status_html(state: State, store: MotionStore) -> str:
    """Return the line that says whether the motion is fine."""
    fine, words = status_line(state, store.analysis(state))
    bound = motions.planned(state).bound
    color, head = (OK, "Fine") if fine else (BAD, "Not possible")
    if motions.planned(state).trajectory is None:
        color, head = MUTED, "No motion yet"
    more = f"<br>shortest: {escape(bound)}" if bound else ""
    return (
        f'<div data-testid="motion-status" style="border-left:5px solid {color};padding:5px 9px;'
        f"margin:2px 10px 4px 10px;background:{color}18;border-radius:4px;font-size:13px;"
        f'line-height:1.35"><b style="color:{color}">{head}</b><br>{escape(words)}{more}</div>'
    )


class PlaybackInputs:
    """Status and playback, first in the current container of the page."""

    def __init__(self, session: Session, store: MotionStore) -> None:
        gui = session.client.gui
        self._store = store
        playback = session.state.playback
        gui.add_html('<span class="paminsa-playback"></span>')
        self._status = gui.add_html("")
        self.play = gui.add_button(
            PLAY, icon=Icon.PLAYER_PLAY, hint="Play the motion with the robot (key: M)"
        )
        self.play.on_click(
            lambda _: session.dispatch("playback.play", motions.play_or_pause, step=False)
        )
        speed = gui.add_dropdown(
            "speed", tuple(SPEED_WORDS), initial_value="1 ×", hint="1 × is true time"
        )
        loop = gui.add_checkbox("repeat", playback.loop, hint="Begin again at the end")
        self._end = self._last(session.state)
        self.time = gui.add_slider(
            TIME, 0.0, self._end, 0.001, 0.0, hint="The instant shown; drag it to go through"
        )
        self._controls = [
            Control(
                session, speed, "playback.speed",
                lambda s, word: motions.set_playback(s, speed=SPEED_WORDS[word]),
                lambda s: f"{s.playback.speed:g} ×",
            ),
            Control(
                session, loop, "playback.loop",
                lambda s, value: motions.set_playback(s, loop=bool(value)),
                lambda s: s.playback.loop,
            ),
        ]  # fmt: skip
        self._time = Control(
            session, self.time, "playback.time", motions.scrub,
            lambda s: round(s.playback.time, 3), step=False,
        )  # fmt: skip

    @staticmethod
    def _last(state: State) -> float:
        """Return the end of the slider, the duration rounded up to its step [s]."""
        return max(math.ceil(1e3 * motions.duration(state) - 1e-6) / 1e3, 0.001)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        state = frame.state
        end = self._last(state)
        if end != self._end:
            self._end = self.time.max = end
        for control in (*self._controls, self._time):
            control.draw(frame, moving)
        label = PAUSE if state.playback.playing else PLAY
        if self.play.label != label:
            self.play.label = label
            self.play.icon = Icon.PLAYER_PAUSE if state.playback.playing else Icon.PLAYER_PLAY
        html = status_html(state, self._store)
        if self._status.content != html:
            self._status.content = html
