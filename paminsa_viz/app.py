"""``paminsa-viz start``: the explorer, a web server with one session a browser tab."""

from __future__ import annotations

import importlib
import sys
import threading
import warnings
import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from paminsa_viz import cli
from paminsa_viz.cli.arguments import OrNone, Words
from paminsa_viz.errors import InvalidInput
from paminsa_viz.version import COMMAND

if TYPE_CHECKING:  # loaded when the server starts, and in the background
    import viser

    from paminsa_viz.explorer.core.session import Session
    from paminsa_viz.model import Design
    from paminsa_viz.quantities.requirements import Requirements
    from paminsa_viz.trajectory import Trajectory

SWITCH_INTERVAL = 0.001
"""Longest time one thread keeps the others waiting [s]: what is drawn is sent at once while the
next frame is computed. Python's own 5 ms would be felt."""


FIRST_TAB_TIMEOUT = 8.0
"""How long the program waits for a first tab before it prepares what that needs [s]: longer than a
browser takes to start on a slow machine, which it would slow down."""


LOADED_WITHIN = 4.0
"""Time that each kind of kernels takes to load from disk, at most [s]; the first compilation on a
computer takes longer."""

MOST_PAGES = 1000
"""Largest possible number of open pages."""


_NAMES = max(map(len, cli.COMMANDS))

DESCRIPTION = f"""\
Explore the parallel manipulator PAMINSA: drag the pose, see the robot and its torque maps.

Without a command the explorer starts and opens in the browser. It runs on this machine and, unless
--host says otherwise, only this machine can reach it. Stop it with Ctrl-C.

Commands:
{chr(10).join(f"  {name:<{_NAMES}}  {text}" for name, text in cli.COMMANDS.items())}

'{COMMAND} COMMAND --help' explains a command; '{COMMAND} --version' prints the version."""


@dataclass(frozen=True)
class AppOptions:
    """How to start the application: flags of the command.

    Raises:
        InvalidInput: If the port or the address is not one.
    """

    host: str = "127.0.0.1"
    """Address to listen on. 0.0.0.0 lets everybody in your network use the page who has the
    printed address with its access token."""
    port: int = 8080
    """Port to listen on; 0 takes any free one. A port in use is an error."""
    browser: bool = True
    """Open the page in the browser."""
    design: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML) to start with, instead of the paper's Appendix 4."""
    allow_host: Annotated[Words, tyro.conf.arg(metavar="NAME")] = ()
    """Another name under which a browser may open the page, such as robot.local; can be
    repeated."""
    token: Literal["auto", "on", "off"] = "auto"
    """Whether a browser has to show the access token that is part of the printed address; auto asks
    for it unless only this machine can reach the page."""
    pages: int = 24
    """Pages that can be open at the same time. Each takes some 15 MB, and 25 MB once all its
    sections have been used."""

    def __post_init__(self) -> None:
        if not 0 <= self.port <= 65535:
            raise InvalidInput("--port", f"{self.port} is not from 0 to 65535")
        if not self.host.strip():
            raise InvalidInput("--host", "an address or name is needed")
        if not 1 <= self.pages <= MOST_PAGES:
            raise InvalidInput("--pages", f"{self.pages} is not from 1 to {MOST_PAGES}")
        if self.token == "off" and self.exposed:
            raise InvalidInput("--token", "off is possible only where no other machine can connect")

    @property
    def exposed(self) -> bool:
        """Whether other machines can reach the page, directly or through a proxy."""
        from paminsa_viz.explorer.server.names import Authority, is_loopback

        names = [Authority.parse(entry) for entry in self.allow_host]
        return not all(is_loopback(name) for name in (self.host, *(n.name for n in names if n)))

    def run(self) -> int:
        """Start the explorer and serve until it is stopped."""
        run(self)
        return 0


FLAGS = AppOptions


class App:
    """The running server and its sessions.

    Attributes:
        server: The guarded viser server.
        token: What browsers have to show, or None.
        sessions: Session of every connected tab, by client number.
        memory: Frees what closed tabs held.
    """

    def __init__(
        self,
        options: AppOptions,
        design: Design | None = None,
        requirements: Requirements | None = None,
    ) -> None:
        """Start to serve.

        Args:
            options: How.
            design: What pages open with; that of the paper's Appendix 4 if None, which is loaded
                once browsers can connect.
            requirements: What pages open with.
        """
        from paminsa_viz.explorer.browser import page_head
        from paminsa_viz.explorer.server.access import AccessToken
        from paminsa_viz.explorer.server.limits import Limits
        from paminsa_viz.explorer.server.listening import open_server
        from paminsa_viz.explorer.server.memory import Memory

        self._design, self.requirements = design, requirements
        self.sessions: dict[int, Session] = {}
        self.memory = Memory()
        self._first_tab = threading.Event()
        self._failures: SimpleQueue[OSError] = SimpleQueue()
        wanted = options.token == "on" or (options.token == "auto" and options.exposed)
        self.token = AccessToken() if wanted else None
        self.server = open_server(
            options.host, options.port, allowed_hosts=options.allow_host,
            limits=Limits(sessions=options.pages), token=self.token, head=page_head(),
        )  # fmt: skip
        self.server.on_client_connect(self._connect)
        self.server.on_client_disconnect(self._disconnect)
        threading.Thread(target=_warm_up, args=(self, self._first_tab), daemon=True).start()

    @property
    def design(self) -> Design:
        """What pages open with."""
        if self._design is None:
            from paminsa_viz.model import APPENDIX_4

            self._design = APPENDIX_4
        return self._design

    @property
    def url(self) -> str:
        """Address of the page, with the access token if there is one."""
        from paminsa_viz.explorer.server.listening import server_url

        return server_url(self.server, self.token)

    def _connect(self, client: viser.ClientHandle) -> None:
        from paminsa_viz.explorer.page import build

        self.sessions[client.client_id] = build(client, self.design, self.requirements)
        self._first_tab.set()
        # One that left while its page was built; a browser that is slow to connect tries again.
        if client.client_id not in self.server.get_clients():
            self._disconnect(client)

    def _disconnect(self, client: viser.ClientHandle) -> None:
        session = self.sessions.get(client.client_id)
        if session is not None:
            session.close()
            self.sessions.pop(client.client_id, None)
        self.memory.free_closed_page()

    def fail(self, error: OSError) -> None:
        """Let `serve` end with an error: no page can be built."""
        self._failures.put(error)

    def serve(self) -> None:
        """Wait for an error, which need not come.

        Raises:
            OSError: If what every page needs cannot be loaded.
        """
        raise self._failures.get()

    def stop(self) -> None:
        """Close every session and the server."""
        for session in list(self.sessions.values()):
            session.close()
        self.server.stop()
        self.memory.stop()


def motion_page(design: Design, trajectory: Trajectory) -> bytes:
    """Return a page that plays a motion without a server, for the command ``trajectory``.

    Args:
        design: The robot.
        trajectory: The motion.
    """
    from paminsa_viz.explorer.scene.html_pages import motion_html

    return motion_html(design, trajectory)


def _warm_up(app: App, first_tab: threading.Event) -> None:
    """Load what a page needs while the browser starts, make its bodies, then load the kernels.

    Args:
        app: The server.
        first_tab: Set when the first tab has connected. Until then the server sends the page, and
            nothing that can wait is in its way.
    """
    try:
        _load(app, first_tab)
    except OSError as error:  # as matplotlib's where no folder at all can be written
        app.fail(error)
    finally:
        app.memory.leave_loaded()


def _load(app: App, first_tab: threading.Event) -> None:
    """Do so."""
    importlib.import_module("paminsa_viz.explorer.page")
    from paminsa_viz.model.backend import compile_in_background, compile_later

    compile_later()  # the first maps may be drawn, and drawn again, before all of this is loaded
    first_tab.wait(FIRST_TAB_TIMEOUT)
    importlib.import_module("paminsa_viz.explorer.scene.bodies")
    from paminsa_viz.clearance import compile_in_background as compile_clearance
    from paminsa_viz.explorer import tabs
    from paminsa_viz.meshes import prepare
    from paminsa_viz.quantities import formulas

    prepare(app.design.geometry, fine=False)
    tabs.load()
    prepare(app.design.geometry, fine=True)
    compiling = compile_in_background(*formulas()), compile_clearance()
    importlib.import_module("scipy.optimize")  # or the first balance would wait for it
    for thread in compiling:
        thread.join(LOADED_WITHIN)


def set_up_process() -> None:
    """Set threads, memory and warnings of this process as a server needs them."""
    from paminsa_viz.explorer.server import memory

    # trimesh imports it for functions that no page calls, and goes without it: 12 MB and 0.1 s.
    sys.modules.setdefault("networkx", None)  # type: ignore[arg-type]
    # A tab may go while it is drawn; viser would report every message that it no longer got.
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    sys.setswitchinterval(SWITCH_INTERVAL)
    memory.set_up()


def run(options: AppOptions) -> None:
    """Start the server, open the browser, and serve until interrupted.

    Raises:
        PaminsaError: If the design file is not usable, asks for more than a page can keep, or the
            port is taken.
        OSError: If what every page needs cannot be loaded.
    """
    from paminsa_viz.explorer.server.listening import exposure_notice

    set_up_process()
    design, requirements = None, None
    if options.design is not None:
        from paminsa_viz.files.design_file import load_content

        found = load_content(options.design)
        design, requirements = found.design, found.requirements
        if requirements is not None:
            from paminsa_viz.explorer.core.saved_requirements import require_possible

            require_possible(requirements)
    app = App(options, design, requirements)
    notice = exposure_notice(options.host)
    if notice:
        print(notice, file=sys.stderr)
    with suppress(OSError):  # pages are served though nobody reads where
        print(f"PAMINSA explorer: {app.url}   (Ctrl+C ends it)", flush=True)
    if options.browser:
        threading.Thread(target=webbrowser.open, args=(app.url,), daemon=True).start()
    try:
        app.serve()
    finally:  # where Ctrl-C is an exception, as in a notebook
        app.stop()


if __name__ == "__main__":
    sys.exit(cli.main())
