"""Where the server listens, and under which names."""

from __future__ import annotations

import logging
import socket
from contextlib import suppress

import pytest
import viser
from viser import _messages
from websockets.exceptions import InvalidStatus

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.explorer.server.listening import (
    CannotListen,
    PortTaken,
    ViserChanged,
    exposure_notice,
    open_server,
    server_url,
)
from tests.support.raw_page import TIMEOUT, dial, get


def test_it_listens_on_this_machine_only_by_default(server: viser.ViserServer) -> None:
    assert server.get_host() == "127.0.0.1"
    assert server_url(server) == f"http://127.0.0.1:{server.get_port()}"
    with pytest.raises(
        (ConnectionError, TimeoutError)
    ):  # a server on every address would answer here, too
        socket.create_connection(("127.0.0.2", server.get_port()), timeout=1).close()


def test_a_taken_port_is_an_error_and_not_the_next_port(server: viser.ViserServer) -> None:
    with pytest.raises(PortTaken) as error:
        open_server(port=server.get_port())
    assert (error.value.host, error.value.port) == ("127.0.0.1", server.get_port())
    assert isinstance(error.value, PaminsaError)
    assert str(server.get_port()) in str(error.value)


@pytest.mark.parametrize(("host", "port"), [("203.0.113.1", 0), ("127.0.0.1", 70000)])
def test_an_impossible_address_is_an_error(host: str, port: int) -> None:
    with pytest.raises(CannotListen):
        open_server(host, port)


def test_a_viser_of_another_shape_is_refused_before_anything_listens(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(_messages, "GuiUpdateMessage", _messages.GuiButtonHoldMessage)
    with pytest.raises(ViserChanged, match="GuiUpdateMessage"):
        open_server(port=0)
    monkeypatch.undo()
    # A field of a kind that no limit is known for.
    monkeypatch.setitem(_messages.CommandTriggerMessage.__annotations__, "uuid", "Dict[str, Any]")
    with pytest.raises(ViserChanged, match=r"CommandTriggerMessage\.uuid"):
        open_server(port=0)
    monkeypatch.undo()
    monkeypatch.setattr(viser, "__version__", "1.2.0")
    with pytest.raises(ViserChanged, match=r"1\.2\.0"):
        open_server(port=0)


FOREIGN_HEADERS = [
    [("Host", "evil.example:{port}")],
    [("Host", "127.0.0.1:1")],
    [("Host", "127.0.0.1")],
    [("Host", "192.0.2.7:{port}")],
    [],
    [("Host", "127.0.0.1:{port}"), ("Host", "evil.example")],
    [("Host", "127.0.0.1:{port}"), ("Origin", "https://evil.example")],
    [("Host", "127.0.0.1:{port}"), ("Origin", "http://127.0.0.1:1")],
    [("Host", "127.0.0.1:{port}"), ("Origin", "null")],
    [("Host", "evil.example:{port}"), ("Origin", "http://evil.example:{port}")],
]


def _filled(headers: list[tuple[str, str]], port: int) -> list[tuple[str, str]]:
    return [(name, value.format(port=port)) for name, value in headers]


@pytest.mark.parametrize("headers", FOREIGN_HEADERS)
@pytest.mark.parametrize("upgrade", [False, True])
def test_a_foreign_name_is_refused(
    server: viser.ViserServer, headers: list[tuple[str, str]], upgrade: bool
) -> None:
    asked = _filled(headers, server.get_port())
    if upgrade:
        asked += [("Upgrade", "websocket"), ("Connection", "Upgrade")]
    assert get(server.get_port(), headers=asked).status == 403


def test_a_web_socket_with_a_foreign_origin_is_refused(server: viser.ViserServer) -> None:
    with pytest.raises(InvalidStatus) as refusal:
        dial(server.get_port(), origin="http://evil.example")
    assert refusal.value.response.status_code == 403


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_its_own_page_may_connect(server: viser.ViserServer, name: str) -> None:
    dial(server.get_port(), origin=f"http://{name}:{server.get_port()}").close()
    assert get(server.get_port(), headers=[("Host", f"{name}:{server.get_port()}")]).status == 200


def test_the_page_cannot_be_framed_or_made_to_show_another_server(
    server: viser.ViserServer,
) -> None:
    assert "frame-ancestors 'none'" in str(
        get(server.get_port()).headers["Content-Security-Policy"]
    )
    for query in ("?websocket=ws://evil.example", "?x&%77ebsocket=x", "?playbackPath=//evil"):
        assert get(server.get_port(), "/" + query).status == 403


@pytest.mark.parametrize(
    "garbage",
    [
        b"\0" * 9000,
        b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 300,
        b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET /%00 HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"\xff\xfe\r\n\r\n",
    ],
)
def test_a_connection_that_is_not_http_is_closed_without_a_report(
    server: viser.ViserServer, garbage: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    with socket.create_connection(("127.0.0.1", server.get_port()), timeout=TIMEOUT) as raw:
        raw.sendall(garbage)
        with suppress(ConnectionResetError):
            while raw.recv(4096):
                pass
    assert get(server.get_port()).status == 200
    assert [record for record in caplog.records if record.levelno >= logging.WARNING] == []


def test_beyond_loopback_it_goes_by_its_addresses_names_and_those_allowed() -> None:
    server = open_server("0.0.0.0", 0, allowed_hosts=["robot.example", "tunnel.example:9000"])
    port = server.get_port()

    def status(*headers: tuple[str, str]) -> int:
        return get(port, headers=list(headers)).status

    try:
        assert server_url(server) == f"http://127.0.0.1:{port}"
        assert status(("Host", f"127.0.0.1:{port}")) == 200
        assert status(("Host", f"{socket.gethostname()}:{port}")) == 200
        assert status(("Host", "robot.example")) == 200
        assert status(("Host", f"robot.example:{port}")) == 200
        assert status(("Host", "tunnel.example:9000")) == 200
        assert status(("Host", f"tunnel.example:{port}")) == 403
        assert status(("Host", f"evil.example:{port}")) == 403
        assert status(("Host", f"192.0.2.7:{port}")) == 403  # not the address that was reached
        assert status(("Host", "robot.example"), ("Origin", "https://robot.example")) == 200
        assert status(("Host", "robot.example"), ("Origin", "https://evil.example")) == 403
    finally:
        server.stop()


def test_a_name_that_cannot_be_read_is_an_error_and_frees_the_port() -> None:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with pytest.raises(InvalidInput):
        open_server(port=port, allowed_hosts=["http://robot.example/"])
    socket.create_server(("127.0.0.1", port)).close()


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "localhost", "LOCALHOST", "::1"])
def test_loopback_exposes_nothing(host: str) -> None:
    assert exposure_notice(host) is None


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.7", "robot.example"])
def test_anything_else_comes_with_a_warning(host: str) -> None:
    notice = exposure_notice(host)
    assert notice is not None
    assert "no encryption" in notice
    assert ("every network" in notice) == (host in ("0.0.0.0", "::"))
