"""Puts one tab together: its session, its scene, its panels."""

from __future__ import annotations

import logging
from dataclasses import replace

import viser

from paminsa_viz.explorer import actions, commands, saving
from paminsa_viz.explorer.bridge import Bridge
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion.clock import Clock
from paminsa_viz.explorer.motion.store import MotionStore
from paminsa_viz.explorer.panels.balance_panel import BalancePanel
from paminsa_viz.explorer.panels.compare_panel import ComparePanel
from paminsa_viz.explorer.panels.design_panel import DesignPanel
from paminsa_viz.explorer.panels.file_panel import FilePanel
from paminsa_viz.explorer.panels.maps_panel import MapsPanel
from paminsa_viz.explorer.panels.motion_panel import MotionPanel
from paminsa_viz.explorer.panels.pose_panel import PosePanel
from paminsa_viz.explorer.panels.readout import Readout
from paminsa_viz.explorer.panels.view_panel import ViewPanel
from paminsa_viz.explorer.scene import backdrop
from paminsa_viz.explorer.scene.floor import FloorMap
from paminsa_viz.explorer.scene.gizmo import Gizmo
from paminsa_viz.explorer.scene.path import MotionPath
from paminsa_viz.explorer.scene.view import RobotView, look
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.palette import rgb

log = logging.getLogger(__name__)

PANEL_WIDTH = 380
"""Width of the control panel [px]; fits labels and numbers at a laptop's 1280 px."""

BRAND = "#0b6e99"

SOFTWARE_RENDERERS = ("swiftshader", "llvmpipe", "softpipe", "software", "basic render")
"""Parts of the names of what draws in the absence of a graphics card."""

LATER_TABS = ("Design", "Balance", "Motion", "Compare", "View", "File")
"""Tabs beside the first one; they are filled when the page stands."""

# viser gives every tab the same margins, with which seven names take two rows of the panel. Here
# they share one row instead.
TAB_STYLE = """
<style>
[role="tablist"]:has(> [title="Pose"]) {
  padding-right: 8px;  /* where a long tab has its scroll bar */
  & > [role="tab"] { flex: 1 1 auto; justify-content: center; padding: 0 0.3em !important; }
}
</style>
"""


class TabStore:
    """Keeps the document in the tab's own store, once the hand rests."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._kept = ""

    def draw(self, frame: Frame, moving: bool) -> None:
        """Save what has changed."""
        if moving:
            return
        text = saving.dump(frame.state.document)
        if text != self._kept:
            self._kept = text
            self._bridge.save(text)


def has_graphics_card(renderer: object) -> bool:
    """Return whether what a browser names as its renderer is more than a program."""
    name = renderer.lower() if isinstance(renderer, str) else ""
    return bool(name) and not any(word in name for word in SOFTWARE_RENDERERS)


def build(client: viser.ClientHandle, design: Design) -> Session:
    """Build the page of a tab that has just connected, and start its worker.

    The first tab and the robot come first; the rest follows when the browser shows them, so that
    nobody waits for it.
    """
    session = Session(client, initial_state(design))
    bridge = Bridge(client)
    gui = client.gui
    gui.configure_theme(
        control_width="large", show_logo=False, show_share_button=False, brand_color=rgb(BRAND)
    )
    gui.set_panel_label("PAMINSA")
    gui.main_panel.dock_right()
    gui.main_panel.set_width(PANEL_WIDTH)
    bridge.run(backdrop.SCRIPT)
    look(session, "3D")

    tabs = gui.add_tab_group()
    with tabs.add_tab("Pose"):
        readout = Readout(session)
        pose = PosePanel(session)
        gui.add_html(TAB_STYLE)
    places = {name: tabs.add_tab(name) for name in LATER_TABS}
    session.first += [readout, pose, RobotView(session)]

    def build_rest() -> None:
        if session.built.is_set():
            return
        motions = MotionStore()
        maps = MapsPanel(session, bridge, motions)
        with places["Design"]:
            design_panel = DesignPanel(session)
        with places["Balance"]:
            balance = BalancePanel(session, bridge)
        with places["Motion"]:
            motion = MotionPanel(session, motions)
        with places["Compare"]:
            compare = ComparePanel(session)
        with places["View"]:
            view = ViewPanel(session)
        with places["File"]:
            files = FilePanel(session)
        session.first += [Gizmo(session), design_panel, balance, view]
        session.first += [Clock(session), motion, MotionPath(session, motions)]
        session.later += [FloorMap(session, maps.store), maps, compare, files, TabStore(bridge)]
        commands.register(session)
        session.built.set()
        # A new object, so that what has been added is drawn.
        session.ask("page", replace)

    def restore(saved: object) -> None:
        if not isinstance(saved, str):
            return
        try:
            document = saving.load(saved)
        except PaminsaError as error:
            log.info("a tab's saved state was not taken: %s", error)
            return
        session.ask("restore", lambda state: actions.restore(state, document), step=False)

    def choose_detail(renderer: object) -> None:
        if has_graphics_card(renderer):
            session.ask("graphics", lambda state: actions.set_layers(state, fine=True))

    bridge.on("hello", restore)
    bridge.on("graphics", choose_detail)
    bridge.on("shown", lambda _: session.do(build_rest))
    bridge.open()
    session.start()
    return session
