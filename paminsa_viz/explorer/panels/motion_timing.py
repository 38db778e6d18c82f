"""How long a motion lasts: a given time, or the shortest within limits."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import DURATIONS, RATES, Kind, Motion, Timing
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State

TIMINGS = {
    "the preset's": Timing.OWN,
    "given": Timing.GIVEN,
    "shortest within limits": Timing.SHORTEST,
}


class LimitInput(NamedTuple):
    """A limit as a person sets it: label, field of `MotionLimits`, factor from SI, step."""

    label: str
    name: str
    factor: float
    step: float


_DEGREE = 180 / math.pi

LIMITS = (
    LimitInput("m/s", "speed", 1.0, 0.1),
    LimitInput("°/s", "turn_speed", _DEGREE, 10.0),
    LimitInput("m/s²", "acceleration", 1.0, 0.5),
    LimitInput("°/s²", "turn_acceleration", _DEGREE, 100.0),
    LimitInput("m/s³", "jerk", 1.0, 10.0),
    LimitInput("°/s³", "turn_jerk", _DEGREE, 1000.0),
    LimitInput("M1–3 N·m", "torque", 1.0, 0.5),
    LimitInput("F₄ N", "force", 1.0, 10.0),
)

_LIMITS_NOTE = """
<div class="paminsa-limits" style="font-size:12px;color:#7b8794;padding:2px 8px">
Largest speed, acceleration and jerk of the platform, torque of M1–M3, force of M4; 0: no limit
</div>
"""


class TimingInputs:
    """Duration, limits and rate of samples, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        motion = session.state.document.motion
        self.timing = gui.add_dropdown(
            "Duration", timing_options(motion), initial_value=timing_label(motion),
            hint="Given, or the shortest in which the robot keeps its limits",
        )  # fmt: skip
        self.duration = gui.add_number(
            "T [s]", motion.duration, min=DURATIONS[0], max=DURATIONS[1], step=0.05,
            hint="Of the way there, if the motion comes back again",
        )  # fmt: skip
        self._limits = gui.add_folder("Limits", expand_by_default=True)
        with self._limits:
            gui.add_html(_LIMITS_NOTE)
            limits = [self._limit(session, item) for item in LIMITS]
        self._rate = gui.add_number(
            "Samples [1/s]", motion.rate, min=RATES[0], max=RATES[1], step=50.0,
            hint="A motion has at most 20,000 samples here",
        )  # fmt: skip
        self._timing = Control(
            session, self.timing, "motion.timing",
            lambda s, label: motions.change(s, timing=TIMINGS[label]),
            lambda s: timing_label(s.document.motion),
        )  # fmt: skip
        self._controls = [
            *limits,
            _number(session, self.duration, "duration"),
            _number(session, self._rate, "rate"),
        ]

    @staticmethod
    def _limit(session: Session, item: LimitInput) -> Control:
        def show(state: State) -> float:
            value = getattr(state.document.motion.limits, item.name)
            return 0.0 if value is None else round(value * item.factor, 6)

        handle = session.client.gui.add_number(
            item.label, show(session.state), min=0.0, step=item.step
        )
        return DebouncedInput(
            session, handle, f"motion.limits.{item.name}",
            lambda s, value: motions.limit(s, item.name, float(value) / item.factor), show,
        )  # fmt: skip

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        motion = frame.state.document.motion
        planned = motion.kind is not Kind.TABLE
        options = timing_options(motion)
        if tuple(self.timing.options) != options:
            self.timing.options = options
        for handle, visible in (
            (self.timing, planned),
            (self.duration, planned and timing_label(motion) == "given"),
            (self._limits, planned and motion.timing is Timing.SHORTEST),
        ):
            if handle.visible != visible:
                handle.visible = visible
        for control in (self._timing, *self._controls):
            control.draw(frame, moving)


def _number(session: Session, handle: Any, name: str) -> Control:
    return DebouncedInput(
        session, handle, f"motion.{name}",
        lambda s, value: motions.change(s, **{name: float(value)}),
        lambda s: getattr(s.document.motion, name),
    )  # fmt: skip


def timing_options(motion: Motion) -> tuple[str, ...]:
    """Return what can be chosen: a motion that is no preset has no duration of its own."""
    options = tuple(TIMINGS)
    return options if motion.kind is Kind.PRESET else options[1:]


def timing_label(motion: Motion) -> str:
    """Return what is chosen."""
    timing = motion.timing
    if timing is Timing.OWN and motion.kind is not Kind.PRESET:
        timing = Timing.GIVEN
    return next(label for label, known in TIMINGS.items() if known is timing)
