"""The tab that balances: one button for the paper's balance, and everything beyond it."""

from __future__ import annotations

from viser import Icon

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.actions import Action
from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Job, Outcome
from paminsa_viz.explorer.balancing.solving import run
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.maps import hold_range, toggle_difference
from paminsa_viz.explorer.panels.balance_front import FrontPlot
from paminsa_viz.explorer.panels.balance_inputs import BalanceInputs
from paminsa_viz.explorer.panels.balance_tornado import TornadoPlot
from paminsa_viz.explorer.panels.balance_weights import WeightList
from paminsa_viz.explorer.panels.balance_words import details_html, status_html
from paminsa_viz.explorer.panels.design_panel import gauge_html
from paminsa_viz.explorer.session import Session
from paminsa_viz.model import InvalidInput

MAPS: dict[str, Action] = {
    "one scale": hold_range,
    "difference": toggle_difference,
    "swap": actions.swap_reference,
}
"""Ways to look at the maps before and after."""


class BalancePanel:
    """M_p2, the button, goals and bounds, what came of it, counterweights, the front, the tornado.

    Made in the current container of the page.
    """

    def __init__(self, session: Session, bridge: Bridge) -> None:
        gui = session.client.gui
        self._job: BackgroundJob[Job, Outcome] = BackgroundJob(
            session, "balance", run, requests.receive_result, progress=requests.progressed,
            failed=lambda job, problem: Outcome(job, problem=InvalidInput("balance", problem)),
        )  # fmt: skip
        self._gauge = gui.add_html("")
        self.button = gui.add_button(
            "Balance as in the paper", icon=Icon.SCALE,
            hint="M_p2 = 0 (Eqs. 7–8) by masses of joints and links, with the least added mass",
        )  # fmt: skip
        self.button.on_click(lambda _: session.dispatch("balance", requests.balance_now))
        self._status = gui.add_html("")
        self.maps = gui.add_button_group(
            "Maps", tuple(MAPS), visible=False,
            hint="Color the maps of design and reference alike; show their difference; change "
            "places with the reference",
        )  # fmt: skip
        self.maps.on_click(lambda event: session.dispatch("balance.maps", MAPS[event.target.value]))
        with gui.add_folder("Other masses, other goals", expand_by_default=False):
            self.inputs = BalanceInputs(session)
        self._details = gui.add_html("")
        self._detailed: Outcome | None = None
        with gui.add_folder("Counterweights of each leg"):
            self.weights = WeightList(session)
        with gui.add_folder("Moving against standing: the front", expand_by_default=False):
            self.front = FrontPlot(session, bridge)
        with gui.add_folder("What each mass and length matters", expand_by_default=False):
            self.tornado = TornadoPlot(session)

    def draw(self, frame: Frame, moving: bool) -> None:
        """Follow the state, and begin what is asked for."""
        self._job.request(frame.state.balancing.running)
        for part in (self.inputs, self.weights, self.front, self.tornado):
            part.draw(frame, moving)
        outcome = frame.state.balancing.outcome
        if outcome is not self._detailed:
            self._detailed = outcome
            self._details.content = details_html(outcome)
        for handle, html in (
            (self._gauge, gauge_html(frame)),
            (self._status, status_html(frame.state)),
        ):
            if handle.content != html:
                handle.content = html
        pinned = frame.state.document.reference is not None
        if self.maps.visible != pinned:
            self.maps.visible = pinned
        busy = frame.state.balancing.running is not None
        if self.button.disabled != busy:
            self.button.disabled = busy
