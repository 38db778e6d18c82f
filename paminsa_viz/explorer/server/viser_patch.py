"""What the guard needs of viser that is not public, and why.

viser 1.1 starts its WebSocket server inside one function without parameters for what we need, and
keeps its bookkeeping in private attributes. What is used of it:

* ``viser.infra._infra.websockets``: the name under which viser finds ``serve``. While a server is
  made, that name stands for an overlay whose ``serve`` adds public options of websockets: a socket
  that is already bound, our connection class, our request hooks, a smaller message limit.
* ``ViserServer._websock_server`` (``infra.WebsockServer``): its ``_incoming_handlers``, to take off
  the handlers that are shared by all pages, and ``_live_connections``, to find the connection of a
  session.
* ``AsyncMessageBuffer.message_event`` of every page, which viser sets from any thread, although an
  ``asyncio.Event`` is for its loop alone: a waiter that comes or goes meanwhile breaks the sender.
* ``GuiApi._gui_input_handle_from_uuid``: the inputs of a session.
* ``viser._assignable_props_api.get_type_hints``: read for every handle that is made, although it is
  the same for all of a kind; that would be half of the time that the panels of a page take.
* ``viser._messages``: the messages of a page, from which ``message_filter`` makes stricter types.

Each is looked for at the start, and a viser that has another shape is refused with
:class:`ViserChanged`. This is why the project pins ``viser>=1.1.1,<1.2``.
"""

from __future__ import annotations

import asyncio
import inspect
import socket
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache, partial
from types import SimpleNamespace
from typing import Any, get_type_hints

import rich
import viser
from viser import _assignable_props_api as props
from viser.infra import _infra
from websockets.asyncio.server import ServerConnection
from websockets.asyncio.server import serve as websockets_serve

from .connection import ConnectionGuard, GuardedConnection
from .limits import logger, socket_logger
from .message_filter import Decode, UnknownMessage, page_decoder

SERIES = "1.1."
"""The releases of viser that this file was written for."""

_NEEDED_OF_SERVE = {"process_request", "process_response", "create_connection", "max_size"}
_NEEDED_OF_CONNECTION = {"connection_made", "connection_lost", "data_received", "process_event"}
_CLOSE_TIMEOUT = 3.0  # s; a page answers at once, a hostile socket should not linger

_hints_once = cache(get_type_hints)

_making = threading.Lock()  # the overlay is seen by all of viser while it is in place
_console_lock = threading.RLock()  # so is the console that viser prints on


class ViserChanged(RuntimeError):
    """The installed viser is not built the way the guards need it; nothing is served."""

    def __init__(self, what: str) -> None:
        super().__init__(
            f"viser {viser.__version__} cannot be guarded: {what}; viser {SERIES}x is needed"
        )


def require_known_viser() -> Decode:
    """Compare viser's messages and names with what the guards were written for.

    Returns:
        What reads the messages of a page.

    Raises:
        ViserChanged: Something differs.
    """
    if not viser.__version__.startswith(SERIES):
        raise ViserChanged("it is of another series")
    if not hasattr(_infra, "websockets"):
        raise ViserChanged("it finds websockets in another way")
    if not hasattr(props, "get_type_hints"):
        raise ViserChanged("its handles find the types of their properties in another way")
    if not inspect.signature(websockets_serve).parameters.keys() >= _NEEDED_OF_SERVE:
        raise ViserChanged("websockets' serve() takes other options")
    if not set(dir(ServerConnection)) >= _NEEDED_OF_CONNECTION:
        raise ViserChanged("websockets' connections are built differently")
    try:
        return page_decoder()
    except UnknownMessage as error:
        raise ViserChanged(str(error)) from error


def start_viser(bound: socket.socket, host: str, guard: ConnectionGuard) -> viser.ViserServer:
    """Start viser on a socket that is already bound, behind a guard, which is still closed after.

    Args:
        bound: Listening socket.
        host: Name it was bound under, for viser's messages.
        guard: Decides what is served.

    Raises:
        ViserChanged: viser did not start its server the way it used to.
    """
    props.__dict__["get_type_hints"] = _hints_once
    port = bound.getsockname()[1]
    pages: list[Any] = []

    # Must not raise: viser waits for this thread without end. What is amiss is found out below,
    # while the guard is closed.
    def serve(handler: Any, *_address: Any, **options: Any) -> websockets_serve:
        pages.append(options.get("process_request"))
        ours = {
            "process_request": guard.answering(pages[-1]),
            "process_response": guard.process_response,
            "create_connection": partial(GuardedConnection, guard=guard),
            "max_size": guard.limits.message_bytes,
            "ping_timeout": guard.limits.answer,
            "close_timeout": _CLOSE_TIMEOUT,
            "logger": socket_logger,
        }
        return websockets_serve(handler, sock=bound, **(options | ours))

    names = _infra.__dict__
    with _making:
        real = names["websockets"]
        patched = _with(real.asyncio, server=_with(real.asyncio.server, serve=serve))
        names["websockets"] = _with(real, asyncio=patched)
        try:
            with quiet():
                server = viser.ViserServer(host, port, verbose=False)
        finally:
            names["websockets"] = real
    try:
        if len(pages) != 1 or not callable(pages[0]) or server.get_port() != port:
            raise ViserChanged("it does not serve through websockets' serve()")
        _separate_pages(server)
    except BaseException:
        server.stop()
        raise
    return server


def _with(module: Any, **replaced: Any) -> SimpleNamespace:
    """Return the names of a module, with some replaced."""
    return SimpleNamespace(**(vars(module) | replaced))


@contextmanager
def quiet() -> Iterator[None]:
    """Keep viser from announcing a server; whoever starts one says what is to be known of it."""
    console = rich.get_console()  # where viser prints
    with _console_lock:
        before, console.quiet = console.quiet, True
        try:
            yield
        finally:
            console.quiet = before


def _separate_pages(server: viser.ViserServer) -> None:
    """Take off what one page could use to reach another, or the world; find a session's inputs."""
    try:
        shared = server._websock_server
        connections: Mapping[int, Any] = shared._live_connections
        # Share tunnels, the forms' broadcast, and inputs on ``server.gui``, which all pages see.
        for message_type in list(shared._incoming_handlers):
            shared.unregister_handler(message_type)
        _inputs(server.gui)  # every session's GUI is built like the server's
        loop = server.get_event_loop()
        _wake_on_loop(shared.get_message_buffer(), loop)
    except AttributeError as error:
        raise ViserChanged(str(error)) from error

    # viser awaits async callbacks in the order of registration: this one comes before the page's.
    @server.on_client_connect
    async def find_inputs(client: viser.ClientHandle) -> None:
        connection = connections.get(client.client_id)
        if isinstance(connection, GuardedConnection):
            connection.filter.inputs = _inputs(client.gui)
        _wake_on_loop(client._websock_connection.get_message_buffer(), loop)


def _inputs(gui: viser.GuiApi) -> Mapping[str, Any]:
    return gui._gui_input_handle_from_uuid


def _wake_on_loop(buffer: Any, loop: asyncio.AbstractEventLoop) -> None:
    """Let what is sent from another thread wake the page's sender through its loop alone.

    viser asks the loop for it anyway, at once or at the end of an atomic block; what is left out is
    the call before that, in the thread that sends.
    """
    event: asyncio.Event = buffer.message_event
    set_event = event.set

    def set_on_loop() -> None:
        if asyncio._get_running_loop() is loop:
            set_event()

    event.set = set_on_loop


def log_failures(loop: asyncio.AbstractEventLoop) -> None:
    """Log what goes wrong in viser's tasks, instead of printing it on the console every time."""

    def handle(_loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        logger.warning("%s", context["message"], exc_info=context.get("exception"))

    loop.call_soon_threadsafe(loop.set_exception_handler, handle)
