"""How much one page, and all of them together, may ask of the server."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Generous for a hand on a page, small for a program.

    A busy page sends about 100 messages a second: viser's page sends its camera at most every
    20 ms, and inputs, gizmos and pointers every 20 to 50 ms each.

    Attributes:
        sessions: Open pages at a time.
        sessions_per_second: New pages, in the long run [1/s]; as many as ``sessions`` at once.
        waiting: Connections at a time that have not become a session yet.
        message_bytes: Largest message [bytes]; a picture for ``get_render`` is one message.
        upload_bytes: Largest file that is taken [bytes], enough for the table of a motion of 10 s
            at 1 kHz. A larger one arrives empty.
        render_pixels: Largest picture that is taken from a page [pixels].
        frames_per_second: WebSocket frames of one connection, in the long run, and of all
            connections together that try to send more than that [1/s].
        frame_burst: The same, at once.
        bytes_per_second: Bytes of one connection, in the long run [bytes/s].
        byte_burst: The same, at once [bytes].
        patience: A connection is cut off when what it sent will take longer than this [s].
    """

    sessions: int = 24
    sessions_per_second: float = 4.0
    waiting: int = 64
    message_bytes: int = 16 * 2**20
    upload_bytes: int = 10 * 2**20
    render_pixels: int = 4096 * 4096
    frames_per_second: float = 200.0
    frame_burst: float = 100.0
    bytes_per_second: float = 4.0 * 2**20
    byte_burst: float = 32.0 * 2**20
    patience: float = 10.0
