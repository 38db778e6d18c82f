"""Log lines about what connections do, a few a minute: no page may fill a disk with them."""

from __future__ import annotations

import logging
import time

logger = logging.getLogger(__package__)

_PERIOD = 60.0  # s
_MANY = 10  # lines in a period


class Reports:
    """A log that goes quiet when it is made to repeat itself."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._count = 0

    def __call__(self, what: str, error: BaseException | None = None) -> None:
        """Log ``what`` and, if there is one, the traceback of ``error``."""
        now = time.monotonic()
        if now - self._since > _PERIOD:
            self._since, self._count = now, 0
        self._count += 1
        if self._count <= _MANY:
            logger.warning("%s", what, exc_info=error)
        elif self._count == _MANY + 1:
            logger.warning("more lines like these are left out for up to %.0f s", _PERIOD)


def socket_logger() -> logging.Logger:
    """Return a log for websockets that leaves out what any broken client can cause."""
    quiet = logging.getLogger(f"{__package__}.sockets")
    quiet.addFilter(_not_a_clients_fault)  # the same function again is not added again
    return quiet


def _not_a_clients_fault(record: logging.LogRecord) -> bool:
    return record.msg not in ("opening handshake failed", "keepalive ping failed")
