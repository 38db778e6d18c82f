"""A guarded server whose sessions have one input of each kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import viser

from paminsa_viz.explorer.server.listening import Limits, open_server
from tests.support.raw_page import RawPage, eventually, get, update


@dataclass
class Inputs:
    """Inputs of a session of the test server, and the values that their callbacks received."""

    slider: Any
    count: Any
    vector: Any
    choice: Any
    upload: Any
    gizmo: Any
    received: list[Any]


def _add_inputs(server: viser.ViserServer) -> dict[int, Inputs]:
    sessions: dict[int, Inputs] = {}

    @server.on_client_connect
    async def build(client: viser.ClientHandle) -> None:
        gui = client.gui
        inputs = Inputs(
            gui.add_slider("x", 0.0, 1.0, 0.001, 0.5),
            gui.add_number("n", 3),
            gui.add_vector3("v", (1.0, 2.0, 3.0)),
            gui.add_dropdown("c", ("a", "b")),
            gui.add_upload_button("file"),
            client.scene.add_transform_controls("/gizmo"),
            [],
        )
        for each in (inputs.slider, inputs.count, inputs.vector, inputs.choice):

            @each.on_update
            async def note(event: Any) -> None:
                inputs.received.append(event.target.value)

        sessions[client.client_id] = inputs

    return sessions


class GuardedServer:
    """A running server with sessions."""

    def __init__(self, limits: Limits | None = None, **options: Any) -> None:
        self.server = open_server(port=0, limits=limits, **options)
        self.port = self.server.get_port()
        self._sessions = _add_inputs(self.server)
        self._pages: list[RawPage] = []

    def page(self) -> tuple[RawPage, Inputs]:
        """Open one more page."""
        page = RawPage(self.server)
        self._pages.append(page)
        return page, eventually(lambda: self._sessions.get(page.client.client_id))

    def still_answers(self, page: RawPage, inputs: Inputs, value: float = 0.25) -> None:
        """Wait until all that ``page`` sent was handled; check that page and server answer."""
        page.send(update(inputs.slider._impl.uuid, value))
        eventually(lambda: inputs.received and inputs.received[-1] == value)
        assert get(self.port).status == 200

    def close_pages(self) -> None:
        """Close all pages."""
        for page in self._pages:
            page.socket.close()
        self._pages.clear()

    def close(self) -> None:
        """Close all pages and the server."""
        self.close_pages()
        self.server.stop()
