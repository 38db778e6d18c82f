"""A page without a browser, for tests: it speaks to the server over a socket of its own."""

from __future__ import annotations

import http.client
import time
from collections.abc import Callable
from typing import Any

import msgspec
import viser
import zstandard
from websockets.sync.client import ClientConnection, connect

TIMEOUT = 10.0  # s, for things that take milliseconds
PROTOCOL = f"viser-v{viser.__version__}"
CAMERA: dict[str, Any] = {
    "type": "ViewerCameraMessage",
    "wxyz": [1, 0, 0, 0],
    "position": [3.0, 3, 3],
    "fov": 1.3,
    "near": 0.01,
    "far": 1000,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0, 0, 0],
    "up_direction": [0, 0, 1],
}


def eventually(condition: Callable[[], Any]) -> Any:
    """Return the first true value of ``condition``; fail if there is none for long."""
    end = time.monotonic() + TIMEOUT
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.005)
    raise AssertionError("it did not happen")


def pack(message: dict[str, Any]) -> bytes:
    """Return ``message`` as it goes over the wire."""
    return msgspec.msgpack.encode(message)


def update(uuid: str, value: Any) -> bytes:
    """Return what the page sends when an input is moved."""
    return pack({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})


def upload_messages(
    button: str, content: bytes, name: str = "a.toml", transfer: str = "t"
) -> list[dict[str, Any]]:
    """Return what the page sends when a file is given to an upload button."""
    parts = [content[i : i + 2**19] for i in range(0, len(content), 2**19)]
    same = {"source_component_uuid": button, "transfer_uuid": transfer}
    start = {"filename": name, "mime_type": "", "size_bytes": len(content)}
    return [
        {"type": "FileTransferStartUpload", "part_count": len(parts), **start, **same},
        *(
            {"type": "FileTransferPart", "part_index": index, "content": part, **same}
            for index, part in enumerate(parts)
        ),
    ]


def dial(port: int, **options: Any) -> ClientConnection:
    """Open a WebSocket as viser's page does; it takes all that is sent, read or not."""
    options = {"subprotocols": [PROTOCOL], "compression": None, "max_size": None} | options
    return connect(f"ws://127.0.0.1:{port}/", max_queue=None, **options)


def get(
    port: int, path: str = "/", headers: list[tuple[str, str]] | None = None
) -> http.client.HTTPResponse:
    """Ask for a page with just these headers."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=TIMEOUT)
    connection.putrequest("GET", path, skip_host=True, skip_accept_encoding=True)
    for name, value in [("Host", f"127.0.0.1:{port}")] if headers is None else headers:
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    response.read()
    connection.close()
    return response


def messages_in(window: bytes) -> list[dict[str, Any]]:
    """Return the messages that viser packed into one WebSocket message."""
    size = int.from_bytes(window[8:16], "little")
    plain = zstandard.ZstdDecompressor().decompress(window[16 : 16 + size])
    return msgspec.msgpack.decode(plain)["messages"]


class RawPage:
    """One session.

    Attributes:
        socket: Its WebSocket.
        client: Its handle on the server.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        before = set(server.get_clients())
        self.socket = dial(server.get_port())
        self.socket.send(pack(CAMERA))
        (number,) = eventually(lambda: set(server.get_clients()) - before)
        self.client = server.get_clients()[number]

    def send(self, message: dict[str, Any] | bytes) -> None:
        """Send a message, or bytes as they are."""
        self.socket.send(message if isinstance(message, bytes) else pack(message))

    def received(self) -> list[dict[str, Any]]:
        """Return what the server has sent and sends within a moment."""
        found: list[dict[str, Any]] = []
        while True:
            try:
                window = self.socket.recv(timeout=0.2)
            except TimeoutError:
                return found
            assert isinstance(window, bytes)
            found += messages_in(window)
