"""Floods, crowds, sessions that reach for each other; rates, and repeated lines of the log."""

from __future__ import annotations

import logging
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from paminsa_viz.explorer.server.connection import GuardedConnection
from paminsa_viz.explorer.server.limits import Limits, RateLimit, RepeatFilter
from tests.support.guarded import GuardedServer
from tests.support.raw_page import TIMEOUT, dial, eventually, get, update


@pytest.mark.slow
@given(st.floats(1, 1000), st.floats(0, 1000), st.lists(st.floats(0, 50), max_size=60))
def test_who_waits_as_requested_never_gets_more_than_rate_and_burst(
    rate: float, burst: float, amounts: list[float]
) -> None:
    limit = RateLimit(rate, burst)
    now = taken = 0.0
    for amount in amounts:
        now += limit.take(amount, now)
        taken += amount
        assert taken <= (burst + rate * now) * (1 + 1e-9) + 1e-6


def test_burst_is_free_and_comes_back_by_waiting() -> None:
    limit = RateLimit(rate=2.0, burst=4.0)
    assert [limit.take(1.0, 100.0) for _ in range(5)] == [0.0, 0.0, 0.0, 0.0, 0.5]
    assert limit.delay(1.0, 100.0) == 1.0
    assert limit.delay(4.0, 1000.0) == 0.0
    assert limit.delay(5.0, 1000.0) == 0.5


def test_repeated_lines_of_the_log_are_left_out(caplog: pytest.LogCaptureFixture) -> None:
    logger = logging.getLogger("tests.repeated_reports")
    logger.addFilter(RepeatFilter())
    for i in range(1000):
        logger.warning("line %d", i, exc_info=ValueError("why"))
    assert "line 0" in caplog.text
    assert "left out" in caplog.text
    assert len(caplog.records) < 20


@pytest.mark.slow
def test_one_session_cannot_write_into_another(guarded: GuardedServer) -> None:
    (page, inputs), (other, theirs) = guarded.page(), guarded.page()
    page.send(update(theirs.slider._impl.uuid, 0.75))
    for owner in (str(other.client.client_id), ""):
        pose = {"wxyz": [1, 0, 0, 0], "position": [9, 9, 9], "owner": owner}
        page.send({"type": "TransformControlsUpdateMessage", "name": "/gizmo", **pose})
    guarded.still_answers(page, inputs)
    assert theirs.slider.value == 0.5
    assert theirs.received == []
    assert tuple(theirs.gizmo.position) == (0.0, 0.0, 0.0)


@pytest.mark.slow
def test_shared_inputs_can_be_seen_but_not_set(guarded: GuardedServer) -> None:
    slider = guarded.server.gui.add_slider("shared", 0.0, 1.0, 0.1, 0.5)
    gizmo = guarded.server.scene.add_transform_controls("/shared")
    command = guarded.server.gui.add_command("shared")
    called: list[object] = []
    command.on_trigger(called.append)
    (page, inputs), (other, _) = guarded.page(), guarded.page()
    page.send(update(slider._impl.uuid, 1.0))
    page.send({"type": "CommandTriggerMessage", "uuid": command._impl.uuid})
    page.send({"type": "GuiFormDirtyMessage", "uuid": "a form"})
    pose = {"wxyz": [1, 0, 0, 0], "position": [9, 9, 9], "owner": ""}
    page.send({"type": "TransformControlsUpdateMessage", "name": "/shared", **pose})
    guarded.still_answers(page, inputs)
    assert slider.value == 0.5
    assert tuple(gizmo.position) == (0.0, 0.0, 0.0)
    assert not called
    kinds = {message["type"] for message in other.received()}
    assert "GuiSliderMessage" in kinds
    assert "GuiFormDirtyMessage" not in kinds
    for each in (slider, gizmo, command):
        each.remove()


@pytest.mark.slow
def test_flood_is_slowed_down_and_loses_nothing(guarded: GuardedServer) -> None:
    (flooder, flooded), (other, theirs) = guarded.page(), guarded.page()
    values = [round(0.001 * (i % 1000), 3) for i in range(400)]

    def flood() -> None:
        for value in values:
            flooder.send(update(flooded.slider._impl.uuid, value))

    thread = threading.Thread(target=flood)
    thread.start()
    for i in range(20):
        guarded.still_answers(other, theirs, 0.1 + 0.01 * i)
    assert len(flooded.received) < len(values)  # still behind, while the other was served
    thread.join()
    eventually(lambda: len(flooded.received) == len(values))
    assert flooded.received == values


@pytest.mark.slow
@pytest.mark.parametrize("opcode", [0x82, 0x89, 0x8A], ids=["data", "ping", "pong"])
def test_flood_that_goes_on_is_disconnected(
    start_guarded: Callable[[Limits], GuardedServer], opcode: int
) -> None:
    guarded = start_guarded(Limits(flood_timeout=0.5))
    (flooder, _), (other, theirs) = guarded.page(), guarded.page()
    empty_frames = bytes([opcode, 0x80, 0, 0, 0, 0]) * 1_000_000

    def flood() -> None:
        with suppress(OSError):  # cut while sending
            flooder.socket.socket.sendall(empty_frames)

    threading.Thread(target=flood, daemon=True).start()
    guarded.still_answers(other, theirs)
    eventually(lambda: flooder.client.client_id not in guarded.server.get_clients())


@pytest.mark.slow
def test_message_in_endless_pieces_is_disconnected(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(frame_burst=1e6))
    page, _ = guarded.page()
    page.socket.socket.sendall(bytes([0x02, 0x80, 0, 0, 0, 0]))
    with suppress(OSError):
        # Pings in between must not hide the pieces.
        page.socket.socket.sendall(bytes([0, 0x80, 0, 0, 0, 0, 0x89, 0x80, 0, 0, 0, 0]) * 5000)
    eventually(lambda: page.client.client_id not in guarded.server.get_clients())


@pytest.mark.slow
def test_reads_are_small_enough_for_the_event_loop(
    guarded: GuardedServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes: list[int] = []
    received = GuardedConnection.data_received

    def record(self: GuardedConnection, data: bytes) -> None:
        sizes.append(len(data))
        received(self, data)

    monkeypatch.setattr(GuardedConnection, "data_received", record)
    page, inputs = guarded.page()
    page.send(bytes(1_000_000))  # in frames of the smallest size, this were 160,000
    guarded.still_answers(page, inputs)
    assert sum(sizes) > 1_000_000
    assert max(sizes) <= 4096


@pytest.mark.slow
def test_message_that_is_too_large_is_refused(guarded: GuardedServer) -> None:
    (page, _), (other, theirs) = guarded.page(), guarded.page()
    size = Limits().message_bytes
    with suppress(ConnectionClosed):
        page.send(b"\xc6" + size.to_bytes(4, "big") + bytes(size))
        while True:  # what the server had sent before
            page.socket.recv(timeout=TIMEOUT)
    assert page.socket.close_code == 1009
    guarded.still_answers(other, theirs)


@pytest.mark.slow
def test_silent_connections_do_not_keep_a_page_out(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(waiting=4))
    silent = [socket.create_connection(("127.0.0.1", guarded.port)) for _ in range(20)]
    for each in silent:
        each.sendall(b"GET / HTT")
    page, inputs = guarded.page()
    guarded.still_answers(page, inputs)
    silent[0].settimeout(TIMEOUT / 2)  # long before it would have been given up anyway
    with suppress(ConnectionResetError):
        assert silent[0].recv(1) == b""
    for each in silent:
        each.close()


@pytest.mark.slow
def test_pages_are_counted_and_a_closed_one_makes_room(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(sessions=2, sessions_per_second=1000.0))
    (first, _), _ = guarded.page(), guarded.page()
    with pytest.raises(InvalidStatus) as refusal:
        dial(guarded.port)
    assert refusal.value.response.status_code == 503
    first.socket.close()
    eventually(lambda: len(guarded.server.get_clients()) == 1)
    guarded.page()


def _wait_until_closed(connection: ClientConnection) -> None:
    with suppress(ConnectionClosed):
        while True:
            connection.recv(timeout=TIMEOUT)  # what was sent before


@pytest.mark.slow
def test_page_without_a_place_waits_for_one(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(sessions=1))
    (first, _) = guarded.page()
    waiting = get(guarded.port)
    assert waiting.status == 503
    assert waiting.headers["Retry-After"] == "3"
    assert waiting.headers["Content-Type"].startswith("text/html")
    with pytest.raises(HTTPError) as refused:
        urlopen(f"http://127.0.0.1:{guarded.port}/")
    assert b">All places are taken: 1<" in refused.value.read()
    first.socket.close()
    eventually(lambda: get(guarded.port).status == 200)


@pytest.mark.slow
def test_silent_web_sockets_give_way(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(sessions=5, silent=0.1, sessions_per_second=1000.0))
    page, inputs = guarded.page()
    silent = [dial(guarded.port) for _ in range(4)]
    eventually(lambda: get(guarded.port).status == 200)  # a page would find a place
    other, theirs = guarded.page()
    _wait_until_closed(silent[0])
    eventually(lambda: get(guarded.port).status == 200)  # the next has been silent long enough
    guarded.still_answers(page, inputs)  # who has spoken keeps the place
    guarded.still_answers(other, theirs)
    for each in silent:
        each.close()


@pytest.mark.slow
def test_silent_web_socket_is_closed(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(first_message=0.2))
    page, inputs = guarded.page()
    silent = dial(guarded.port)
    silent.send(b"not a message of a page")
    _wait_until_closed(silent)
    guarded.still_answers(page, inputs)


def test_documentation_says_when_a_silent_web_socket_is_closed() -> None:
    text = (Path(__file__).parents[3] / "docs" / "network.md").read_text("utf-8")
    assert f"says nothing is closed after {Limits().first_message:g} s" in " ".join(text.split())


@pytest.mark.slow
def test_upload_ends_with_its_page(guarded: GuardedServer) -> None:
    page, inputs = guarded.page()
    content = bytes(1000)
    upload = {"source_component_uuid": inputs.upload._impl.uuid, "transfer_uuid": "half"}
    start = {"filename": "f", "mime_type": "", "part_count": 2, "size_bytes": 2000}
    page.send({"type": "FileTransferStartUpload", **start, **upload})
    page.send({"type": "FileTransferPart", "part_index": 0, "content": content, **upload})
    states = page.client.gui._current_file_upload_states
    eventually(lambda: states and states["half"]["transferred_bytes"])
    page.socket.close()
    eventually(lambda: not states)


@pytest.mark.slow
def test_pages_cannot_be_opened_faster_than_they_can_be_built(
    start_guarded: Callable[[Limits], GuardedServer],
) -> None:
    guarded = start_guarded(Limits(sessions=3, sessions_per_second=0.001))
    for _ in range(3):
        dial(guarded.port).close()
    with pytest.raises(InvalidStatus):
        dial(guarded.port)
