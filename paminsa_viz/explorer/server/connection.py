"""One guarded connection, and the guard that all of them pass."""

from __future__ import annotations

import asyncio
import gzip
import math
import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any, cast
from urllib.parse import unquote_plus

from websockets.asyncio.server import ServerConnection
from websockets.frames import Frame, Opcode
from websockets.http11 import Request, Response

from .access import AccessToken, text_response
from .limits import Limits, RateLimit, logger
from .message_filter import Decode, MessageFilter
from .names import NameRules

_READ_BYTES = 4096  # read at a time: at most some 700 of the smallest frames, a few ms
_PAUSE = 1.0  # s without a message after which a flood is over
_MANY_FRAGMENTS = 4096  # of one message; a browser splits a large one into some hundreds

_PAGE_HEADERS = {
    # A page elsewhere may not show this one in a frame and have it clicked through.
    "Content-Security-Policy": "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
}

_FOREIGN_SOURCES = ("websocket", "playbackpath")
"""Parameters of viser's page that fetch the scene, and script with it, from another server."""

_FULL = """\
<!doctype html><html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="3">
<title>PAMINSA explorer: waiting</title></head>
<body style="font: 16px system-ui, sans-serif; margin: 15vh auto; max-width: 32em">
<h1 style="font-size: 20px">All places are taken: {count}</h1>
<p>This page tries again every three seconds and opens as soon as another one is closed. More places
are an option of the program: <code>--pages</code>.</p></body></html>
"""

HttpHandler = Callable[[ServerConnection, Request], Response | None]


class ConnectionGuard:
    """Decides which connections are served, and counts them. Lives on viser's event loop.

    Args:
        rules: Names that are served.
        limits: How much is served.
        decode: Reads one message of a page.
        token: What a request has to show, or None if it is served without.
        head: HTML that the page has at the start of its head.

    Attributes:
        open: Requests are answered with 503 until the server is ready.
        limits: As given.
        decode: As given.
        held: Connections that sent too much and have to wait. They share what one may send.
    """

    def __init__(
        self,
        rules: NameRules,
        limits: Limits,
        decode: Decode,
        token: AccessToken | None = None,
        head: str = "",
    ) -> None:
        self.open = False
        self.limits = limits
        self.decode = decode
        self.held: set[GuardedConnection] = set()
        self._rules = rules
        self._token = token
        self._head = head.encode()
        self._starts = RateLimit(limits.sessions_per_second, limits.sessions)
        self._waiting: dict[GuardedConnection, None] = {}
        self._sessions: dict[GuardedConnection, float] = {}

    def arrived(self, connection: GuardedConnection) -> None:
        """Note a new connection. Of too many that say nothing, the oldest gives way."""
        self._waiting[connection] = None
        if len(self._waiting) > self.limits.waiting:
            oldest = next(iter(self._waiting))
            del self._waiting[oldest]
            oldest.transport.abort()

    def left(self, connection: GuardedConnection) -> None:
        """Note that a connection is gone."""
        self._waiting.pop(connection, None)
        self._sessions.pop(connection, None)
        self.held.discard(connection)

    def answering(self, serve_page: HttpHandler) -> HttpHandler:
        """Return a handler that refuses what is not for us and leaves the rest to viser's own."""

        def process_request(connection: ServerConnection, request: Request) -> Response | None:
            refusal = self._refusal(connection, request)
            if refusal is not None:
                status, reason = refusal
                return connection.respond(status, f"{reason}\n")
            if self._token is not None and (answer := self._token.respond(request)) is not None:
                return answer
            return self._without_place(connection, request) or self._with_head(
                serve_page(connection, request)
            )

        return process_request

    def _with_head(self, response: Response | None) -> Response | None:
        """Return what viser serves, a page with our part of its head."""
        if response is None or not self._head:
            return response
        headers = response.headers
        if response.status_code == 200 and headers["Content-Type"].startswith("text/html"):
            packed = headers["Content-Encoding"] == "gzip"
            response.body = _inserted(bytes(response.body), self._head, packed)
            del headers["Content-Length"]
            headers["Content-Length"] = str(len(response.body))
        return response

    def _refusal(self, connection: ServerConnection, request: Request) -> tuple[int, str] | None:
        headers = request.headers
        local = connection.local_address
        reached = local[0] if isinstance(local, tuple) else None
        objection = self._rules.objection(
            headers.get_all("Host"), headers.get_all("Origin"), reached
        )
        if objection is not None:
            return 403, objection
        query = unquote_plus(request.path.partition("?")[2]).lower()
        if any(parameter in query for parameter in _FOREIGN_SOURCES):
            return 403, "this page shows only what this server sends"
        if not self.open:
            return 503, "the server is starting"
        return None

    def _without_place(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return what to answer if all places are taken: a page that waits for one."""
        now = time.monotonic()
        full = len(self._sessions) >= self.limits.sessions
        if "Upgrade" not in request.headers:
            if not full or request.path.partition("?")[0] != "/" or self._silent(now):
                return None
            page = _FULL.format(count=self.limits.sessions)
            headers = {"Retry-After": "3"}
            return text_response(503, "Service Unavailable", page, "text/html", **headers)
        if full and (silent := self._silent(now)) is not None:
            self.left(silent)
            silent.transport.abort()
        elif full:
            return connection.respond(503, "too many pages are open; close one\n")
        if self._starts.delay(1.0, now) > 0.0:
            return connection.respond(
                503, "too many pages were opened at once; try again in a second\n"
            )
        return None

    def _silent(self, now: float) -> GuardedConnection | None:
        """Return the oldest session that has a place and has said nothing, or None."""
        for session, since in self._sessions.items():
            if session.silent and now - since > self.limits.silent:
                return session
        return None

    def process_response(
        self, connection: ServerConnection, _request: Request, response: Response
    ) -> None:
        """Count an accepted WebSocket as a session; add the headers that protect a page."""
        if response.status_code == 101:
            guarded = cast(GuardedConnection, connection)
            self._waiting.pop(guarded, None)
            now = time.monotonic()
            self._sessions[guarded] = now
            self._starts.take(1.0, now)
            guarded.expect_message()
        else:
            for name, value in _PAGE_HEADERS.items():
                response.headers[name] = value


@lru_cache(maxsize=2)
def _inserted(page: bytes, head: bytes, packed: bool) -> bytes:
    """Return a page, which may be packed by gzip, with more in its head; kept, as it is large."""
    plain = gzip.decompress(page) if packed else page
    plain = plain.replace(b"<head>", b"<head>" + head, 1)
    return gzip.compress(plain) if packed else plain


class GuardedConnection(ServerConnection):
    """A WebSocket connection that reads no faster than allowed and passes on only what is expected.

    A flood is not answered by dropping messages, which would lose the last value of a fast drag,
    but by reading more slowly, so that the sender has to wait; other connections do not notice. One
    that goes on regardless is cut off.

    Args:
        protocol: As in :class:`~websockets.asyncio.server.ServerConnection`.
        server: As there.
        guard: The guard this connection passes.
        options: As there.

    Attributes:
        filter: What is passed on.
        silent: Whether it has not sent a message yet that a page would send.
    """

    def __init__(
        self, protocol: Any, server: Any, *, guard: ConnectionGuard, **options: Any
    ) -> None:
        # Flow control is this class's own; that of websockets counts data frames only, and only
        # after a whole read of up to 256 kB, some 40,000 of the smallest frames, has been parsed.
        options["max_queue"] = None
        super().__init__(protocol, server, **options)
        limits = guard.limits
        self.filter = MessageFilter(guard.decode, limits, logger.warning)
        self._guard = guard
        self._frame_limit = RateLimit(limits.frames_per_second, limits.frame_burst)
        self._byte_limit = RateLimit(limits.bytes_per_second, limits.byte_burst)
        self.silent = True
        self._resume: asyncio.TimerHandle | None = None
        self._deadline: asyncio.TimerHandle | None = None
        self._held_since = self._held_until = -math.inf
        self._frames = 0
        self._fragments = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Report to the guard; read in small pieces."""
        super().connection_made(transport)
        # asyncio's sockets read up to this much at a time.
        transport.max_size = _READ_BYTES  # pyright: ignore[reportAttributeAccessIssue]
        self._guard.arrived(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Give the place free."""
        self._guard.left(self)
        for timer in (self._resume, self._deadline):
            if timer is not None:
                timer.cancel()
        super().connection_lost(exc)

    def expect_message(self) -> None:
        """Close the connection unless a page's first message comes in time."""
        self._deadline = self.loop.call_later(self._guard.limits.first_message, self._end_silence)

    def _end_silence(self) -> None:
        if self.silent:
            self.transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take in bytes; where they come faster than allowed, wait before reading more."""
        before = self._frames
        super().data_received(data)
        now = self.loop.time()
        delay = max(
            self._frame_limit.take(self._frames - before, now),
            self._byte_limit.take(len(data), now),
        )
        if delay == 0.0:
            self._guard.held.discard(self)
        elif not self.transport.is_closing():
            self._hold(now, delay)

    def _hold(self, now: float, delay: float) -> None:
        if now - self._held_until > _PAUSE:
            self._held_since = now
        self._guard.held.add(self)
        self._held_until = now + delay * len(self._guard.held)
        if self._held_until - self._held_since > self._guard.limits.flood_timeout:
            logger.warning("a connection that sent far too much was cut off")
            self.transport.abort()
            return
        self.transport.pause_reading()
        self._resume = self.loop.call_at(self._held_until, self.transport.resume_reading)

    def process_event(self, event: Any) -> None:
        """Count frames of every kind; cut off a message in endless pieces."""
        self._frames += 1
        if isinstance(event, Frame):
            if event.opcode is Opcode.CONT:
                self._fragments += 1
            elif event.opcode in (Opcode.TEXT, Opcode.BINARY):
                self._fragments = 0
            if self._fragments > _MANY_FRAGMENTS:
                self.transport.abort()
        super().process_event(event)

    async def recv(self, decode: bool | None = None) -> Any:
        """Return the next message that a page of ours could have sent."""
        while True:
            passed = self.filter.passed(await super().recv(decode))
            if passed is not None:
                self.silent = False
                return passed
