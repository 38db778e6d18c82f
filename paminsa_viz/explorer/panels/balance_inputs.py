"""What may change, and what is to be small: the inputs of the balance."""

from __future__ import annotations

from typing import Any

from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.settings import ARMS, LONGEST, MOST, RANGES, FreeMasses, Goal
from paminsa_viz.explorer.controls import Control
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.panels.debounced_input import DebouncedInput
from paminsa_viz.explorer.panels.tables import note
from paminsa_viz.explorer.panels.validation import pair
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State


class BalanceInputs:
    """Goal, bounds, and the button that looks for the best masses, in the current container."""

    def __init__(self, session: Session) -> None:
        gui = session.client.gui
        self._session = session
        settings = session.state.balancing.settings
        goal = gui.add_dropdown(
            "Goal", tuple(goal.value for goal in Goal), initial_value=settings.goal.value,
            hint="What is to be small; torques are those of M1–M3",
        )  # fmt: skip
        self._share = gui.add_slider(
            "Motion counts [%]", 0.0, 100.0, 1.0, 100 * settings.share, visible=False,
            hint="Beside standing still; each peak relative to what it is now",
        )  # fmt: skip
        self._exact = gui.add_checkbox(
            "only M_p2 = 0", settings.exact,
            hint="Otherwise a balance comes as near as it can, and other goals are free of it",
        )  # fmt: skip
        gui.add_html(
            note(
                "Counterweights past a joint: longest lever [mm], most mass on each leg [kg]. "
                "Look whether they clear the frame: that is not checked.",
                muted=True,
            )
        )
        arms = [
            gui.add_vector2(
                f"{bar.upper()} past {joint}", _shown_arm(session.state, name),
                min=(1e3 * LONGEST[0], MOST[0]), max=(1e3 * LONGEST[1], MOST[1]), step=0.001,
                hint=f"Counterweight on each leg, on {bar.upper()} beyond joint {joint}: longest "
                "lever, most mass (0 for none)",
            )
            for name, bar, joint in ARMS
        ]  # fmt: skip
        movable = gui.add_dropdown(
            "Joints, links", tuple(item.value for item in FreeMasses),
            initial_value=settings.movable.value, hint="Which other masses of a leg may change",
        )  # fmt: skip
        self._bounds = [
            gui.add_number(
                "each up by [kg]", settings.heavier, min=0.0, max=RANGES["heavier"][1], step=0.001,
                hint="By how much each of them may grow; a link's inertia grows in proportion",
            ),
            gui.add_number(
                "each down by [%]", 100 * settings.lighter, min=0.0, max=100.0, step=0.1,
                hint="What part of each may be taken away",
            ),
        ]  # fmt: skip
        self._added = gui.add_number(
            "Added, at most [kg]", settings.added, min=0.0, max=RANGES["added"][1], step=0.001,
            hint="Largest added mass of the whole robot, for goals on the motion and for the "
            "front; 0: no limit",
        )  # fmt: skip
        self.find = gui.add_button("Find the best masses")
        self.stop = gui.add_button("Stop", color="gray", visible=False)
        self.find.on_click(
            lambda _: session.dispatch("balance.find", lambda s: requests.begin(s, Task.BEST))
        )
        self.stop.on_click(lambda _: session.dispatch("balance.stop", requests.stop))
        self._controls = [
            Control(
                session, goal, "balance.goal",
                lambda s, value: requests.choose_goal(s, Goal(value)),
                lambda s: s.balancing.settings.goal.value,
            ),
            Control(
                session, self._exact, "balance.exact",
                lambda s, value: requests.wish(s, exact=bool(value)),
                lambda s: s.balancing.settings.exact,
            ),
            Control(
                session, movable, "balance.movable",
                lambda s, value: requests.wish(s, movable=FreeMasses(value)),
                lambda s: s.balancing.settings.movable.value,
            ),
            self._number(self._share, "share", 100.0),
            self._number(self._bounds[0], "heavier"),
            self._number(self._bounds[1], "lighter", 100.0),
            self._number(self._added, "added"),
            *(self._arm(arm, name) for arm, (name, _, _) in zip(arms, ARMS, strict=True)),
        ]  # fmt: skip

    def _number(self, handle: Any, name: str, factor: float = 1.0) -> Control:
        return DebouncedInput(
            self._session, handle, f"balance.{name}",
            lambda s, value: requests.wish(s, **{name: float(value) / factor}),
            lambda s: round(factor * getattr(s.balancing.settings, name), 9),
        )  # fmt: skip

    def _arm(self, handle: Any, name: str) -> Control:
        def apply(state: State, value: Any) -> State:
            longest, most = pair(value)
            return requests.set_arm(state, name, longest / 1e3, most)

        return DebouncedInput(
            self._session, handle, f"balance.{name}", apply, lambda s: _shown_arm(s, name)
        )

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state."""
        for control in self._controls:
            control.draw(frame, moving)
        balancing = frame.state.balancing
        settings, busy = balancing.settings, balancing.running is not None
        masses = settings.movable is not FreeMasses.NONE
        for handle, visible in (
            (self._share, settings.goal is Goal.BOTH),
            (self._bounds[0], masses),
            (self._bounds[1], masses),
            (self._added, not settings.goal.static),
            (self.stop, busy),
            (self.find, not busy),
        ):
            if handle.visible != visible:
                handle.visible = visible


def _shown_arm(state: State, name: str) -> tuple[float, float]:
    arm = getattr(state.balancing.settings, name)
    return round(1e3 * arm.longest, 9), arm.most
