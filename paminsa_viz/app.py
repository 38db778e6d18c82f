"""Starts the explorer: a web server on this machine, one session a browser tab."""

from __future__ import annotations

import contextlib
import importlib
import logging
import runpy
import sys
import threading
import warnings
import webbrowser
from typing import TYPE_CHECKING

import viser

from paminsa_viz.explorer.server.listening import exposure_notice, open_server, server_url
from paminsa_viz.files.design_bounds import validate_limits
from paminsa_viz.files.design_file import load_design
from paminsa_viz.model import APPENDIX_4, Design
from paminsa_viz.model.backend import compile_in_background
from paminsa_viz.options import AppOptions
from paminsa_viz.quantities import formulas

if TYPE_CHECKING:  # loaded in the background, while the browser starts
    from paminsa_viz.explorer.session import Session

log = logging.getLogger(__name__)


SWITCH_INTERVAL = 0.001
"""Longest time one thread keeps the others waiting [s]: what is drawn is sent at once while the
next frame is computed. Python's own 5 ms would be felt."""


FIRST_TAB_TIMEOUT = 2.0
"""How long the program waits for a first tab before it prepares what that needs [s]."""


class App:
    """The running server and its sessions.

    Attributes:
        server: The guarded viser server.
        sessions: Session of every connected tab, by client number.
    """

    def __init__(self, options: AppOptions, design: Design) -> None:
        self.design = design
        self.sessions: dict[int, Session] = {}
        self._first_tab = threading.Event()
        self.server = open_server(options.host, options.port, allowed_hosts=options.allow_host)
        self.server.on_client_connect(self._connect)
        self.server.on_client_disconnect(self._disconnect)
        threading.Thread(target=_warm_up, args=(design, self._first_tab), daemon=True).start()

    @property
    def url(self) -> str:
        """Address of the page."""
        return server_url(self.server)

    def _connect(self, client: viser.ClientHandle) -> None:
        from paminsa_viz.explorer.page import build

        self.sessions[client.client_id] = build(client, self.design)
        self._first_tab.set()

    def _disconnect(self, client: viser.ClientHandle) -> None:
        session = self.sessions.pop(client.client_id, None)
        if session is not None:
            session.close()

    def stop(self) -> None:
        """Close every session and the server."""
        for session in list(self.sessions.values()):
            session.close()
        self.server.stop()


def _warm_up(design: Design, first_tab: threading.Event) -> None:
    """Load what a page needs while the browser starts, make its bodies, then load the kernels.

    Args:
        design: What the pages start with.
        first_tab: Set when the first tab has connected. Until then the server sends the page, and
            nothing that can wait is in its way.
    """
    importlib.import_module("paminsa_viz.explorer.page")
    first_tab.wait(FIRST_TAB_TIMEOUT)
    importlib.import_module("paminsa_viz.explorer.scene.bodies")
    from paminsa_viz.meshes import prepare

    prepare(design.geometry)
    importlib.import_module("paminsa_viz.explorer.deferred_tabs")
    compile_in_background(*formulas())
    importlib.import_module("scipy.optimize")  # or the first balance would wait for it


def run(options: AppOptions) -> None:
    """Start the server, open the browser, and serve until interrupted.

    Raises:
        PaminsaError: If the design file is not usable or the port is taken.
    """
    # A tab may go while it is drawn; viser would report every message that it no longer got.
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    sys.setswitchinterval(SWITCH_INTERVAL)
    design = APPENDIX_4 if options.design is None else validate_limits(load_design(options.design))
    app = App(options, design)
    notice = exposure_notice(options.host)
    if notice:
        print(notice, file=sys.stderr)
    print(f"PAMINSA explorer: {app.url}   (Ctrl+C ends it)", flush=True)
    if options.browser:
        threading.Thread(target=webbrowser.open, args=(app.url,), daemon=True).start()
    with contextlib.suppress(KeyboardInterrupt):
        threading.Event().wait()
    app.stop()


if __name__ == "__main__":
    runpy.run_module("paminsa_viz", run_name="__main__")
