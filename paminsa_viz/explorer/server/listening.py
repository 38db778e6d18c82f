"""Start the explorer's web server, safe by default.

viser's server listens on every network, takes the next port when one is taken, lets any web page
connect, opens a public tunnel for whoever asks, and believes what a socket says. The server started
here listens on this machine only, on the port asked for, answers only pages of its own, has no
tunnel, and passes on only what such a page sends, at a rate a person can reach.

Two rules for the page that is built on it:

* Everything a person can touch belongs to ``client.gui`` and ``client.scene``. Inputs, gizmos,
  clicks and commands on ``server.gui`` and ``server.scene`` are shared by all pages; they are shown
  but do not answer.
* A value that arrives is finite and of its input's kind, but may lie outside its range. Whoever
  reads it limits it and writes the limited value back.
"""

from __future__ import annotations

import errno
import socket
from collections.abc import Iterable

import viser

from paminsa_viz.errors import PaminsaError

from . import viser_patch
from .access import AccessToken
from .connection import ConnectionGuard
from .icons import keep_icons_open
from .limits import Limits
from .names import NameRules, exposure_notice
from .viser_patch import ViserChanged

__all__ = [
    "CannotListen",
    "Limits",
    "PortTaken",
    "ViserChanged",
    "exposure_notice",
    "open_server",
    "server_url",
]


_ANOTHER_PORT = "choose another one, or port 0 for any that is free"


class CannotListen(PaminsaError):
    """The server cannot listen where it was asked to.

    Attributes:
        host: Address or name asked for.
        port: Port asked for.
        reason: What stands in the way, in words.
    """

    def __init__(self, host: str, port: int, reason: str) -> None:
        self.host, self.port, self.reason = host, port, reason
        super().__init__(f"cannot listen on {host}, port {port}: {reason}")


class PortTaken(CannotListen):
    """Another program, or another explorer, listens on that port."""

    def __init__(self, host: str, port: int) -> None:
        super().__init__(host, port, f"the port is taken; {_ANOTHER_PORT}")


def open_server(
    host: str = "127.0.0.1",
    port: int = 8080,
    *,
    allowed_hosts: Iterable[str] = (),
    limits: Limits | None = None,
    token: AccessToken | None = None,
    head: str = "",
) -> viser.ViserServer:
    """Start a guarded viser server.

    Args:
        host: Address or name to listen on. Only programs on this machine reach the default; see
            :func:`exposure_notice` for any other.
        port: Port to listen on; 0 takes any free one (``server.get_port()`` tells which).
        allowed_hosts: Further names under which the server may be asked for, ``"name"`` or
            ``"name:port"``: needed behind a proxy, or when a forwarded port has another number.
        limits: How much is served; the defaults suit a person at a desk.
        token: What requests have to show, or None if they are served without.
        head: HTML that the page has at the start of its head.

    Returns:
        The running server, without anything on its page.

    Raises:
        PortTaken: The port is in use.
        CannotListen: The address is not one of this machine, or may not be used.
        InvalidInput: An entry of ``allowed_hosts`` cannot be read.
        ViserChanged: The installed viser is not one that can be guarded.
    """
    decode = viser_patch.require_known_viser()
    keep_icons_open()
    bound = _bind(host, port)
    try:
        rules = NameRules.for_server(host, bound.getsockname()[1], allowed_hosts)
        guard = ConnectionGuard(rules, limits or Limits(), decode, token, head)
        server = viser_patch.start_viser(bound, host, guard)
    except BaseException:
        bound.close()
        raise
    viser_patch.log_failures(server.get_event_loop())
    server.gui.configure_theme(show_share_button=False)
    guard.open = True
    return server


def server_url(server: viser.ViserServer, token: AccessToken | None = None) -> str:
    """Return the address to open in a browser on this machine, with the access token if needed."""
    host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(server.get_host(), server.get_host())
    query = "" if token is None else f"/?token={token.value}"
    return f"http://{f'[{host}]' if ':' in host else host}:{server.get_port()}{query}"


def _bind(host: str, port: int) -> socket.socket:
    # Bound here and not by viser, which would go on to the next port without a word.
    if not 0 <= port <= 65535:
        raise CannotListen(host, port, "a port is a number from 0 to 65535")
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        # "localhost" is both; IPv4 first, as that is what the address in the README says.
        family, *_, address = min(found, key=lambda entry: entry[0] != socket.AF_INET)
        both = family == socket.AF_INET6 and host == "::" and socket.has_dualstack_ipv6()
        return socket.create_server((address[0], port), family=family, dualstack_ipv6=both)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortTaken(host, port) from error
        if error.errno == errno.EACCES:  # below 1024, and what Windows keeps for virtual machines
            problem = f"the system keeps the port for others; {_ANOTHER_PORT}"
            raise CannotListen(host, port, problem) from error
        raise CannotListen(host, port, error.strerror or str(error)) from error
