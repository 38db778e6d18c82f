"""How much one page, and all of them together, may send, how fast, and what of it is logged."""

from __future__ import annotations

import logging
import math
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Generous for a person at a page, small for a program.

    A busy page sends about 100 messages a second: viser's page sends its camera at most every
    20 ms, and inputs, gizmos and pointers every 20 to 50 ms each.

    Attributes:
        sessions: Open pages at a time.
        first_message: A WebSocket on which nothing was said for this long is closed [s]; a page
            says where its camera is as soon as it is drawn, which a slow one may take long for.
        silent: When all places are taken, one that has said nothing for this long gives way [s].
        answer: A page that does not answer a ping for this long has gone [s]; compiling the
            formulas for the first time can keep a slow machine busy for half a minute.
        sessions_per_second: New pages, in the long run [1/s]; as many as ``sessions`` at once.
        waiting: Connections at a time that have not become a session yet; hundreds may come in the
            moment before the first of them is answered.
        message_bytes: Largest message [bytes]; a picture for ``get_render`` is one message.
        upload_bytes: Largest file that is taken [bytes], enough for the table of a motion of 10 s
            at 1 kHz. The page sends no larger one, see ``files.js``.
        render_pixels: Largest picture that is taken from a page [pixels].
        frames_per_second: WebSocket frames of one connection, in the long run, and of all
            connections together that try to send more than that [1/s].
        frame_burst: The same, at once.
        bytes_per_second: Bytes of one connection, in the long run [bytes/s].
        byte_burst: The same, at once [bytes].
        flood_timeout: A connection is cut off when what it sent will take longer than this [s].
    """

    sessions: int = 24
    first_message: float = 120.0
    silent: float = 5.0
    answer: float = 90.0
    sessions_per_second: float = 4.0
    waiting: int = 512
    message_bytes: int = 16 * 2**20
    upload_bytes: int = 10 * 2**20
    render_pixels: int = 4096 * 4096
    frames_per_second: float = 200.0
    frame_burst: float = 100.0
    bytes_per_second: float = 4.0 * 2**20
    byte_burst: float = 32.0 * 2**20
    flood_timeout: float = 10.0


class RateLimit:
    """How much at once, and how much in the long run; what was taken too early is waited for.

    Args:
        rate: Amount in a second, in the long run [1/s].
        burst: Amount at once.
    """

    def __init__(self, rate: float, burst: float) -> None:
        self._rate, self._burst = rate, burst
        self._paid = -math.inf  # until when what was taken is paid for [s]

    def delay(self, amount: float, now: float) -> float:
        """Return how long ``amount`` has to wait at time ``now`` [s]."""
        return max(0.0, self._after(amount, now) - now)

    def take(self, amount: float, now: float) -> float:
        """Take ``amount``, allowed or not; return how long to wait before the next [s]."""
        self._paid = self._after(amount, now)
        return max(0.0, self._paid - now)

    def _after(self, amount: float, now: float) -> float:
        return max(self._paid, now - self._burst / self._rate) + amount / self._rate


class RepeatFilter(logging.Filter):
    """Passes a few records a minute: no page may fill a disk with them."""

    PERIOD = 60.0  # s
    MANY = 10  # records in a period

    def __init__(self) -> None:
        super().__init__()
        self._since, self._count = -math.inf, 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether to log a record; the last one of a period says that more are left out."""
        now = time.monotonic()
        if now - self._since > self.PERIOD:
            self._since, self._count = now, 0
        self._count += 1
        if self._count == self.MANY + 1:
            record.msg, record.args = "more lines like these are left out for up to a minute", None
            record.exc_info = None
        return self._count <= self.MANY + 1


def _not_a_clients_fault(record: logging.LogRecord) -> bool:
    return record.msg not in ("opening handshake failed", "keepalive ping failed")


logger = logging.getLogger(__package__)
"""What connections do."""
logger.addFilter(RepeatFilter())

socket_logger = logging.getLogger(f"{__package__}.sockets")
"""What websockets reports, without what any broken client can cause."""
socket_logger.setLevel(logging.WARNING)  # below INFO it writes whole requests, tokens included
socket_logger.addFilter(_not_a_clients_fault)
