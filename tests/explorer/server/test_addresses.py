"""Where the server listens, and which names and origins it serves."""

from __future__ import annotations

import errno
import logging
import socket
import string
from contextlib import suppress

import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
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
from paminsa_viz.explorer.server.names import Authority, NameRules, is_loopback
from tests.support.guarded import GuardedServer
from tests.support.raw_page import TIMEOUT, dial, get


def test_server_listens_on_this_machine_only_by_default(server: viser.ViserServer) -> None:
    assert server.get_host() == "127.0.0.1"
    assert server_url(server) == f"http://127.0.0.1:{server.get_port()}"
    with pytest.raises((ConnectionError, TimeoutError)):  # a server on every address would answer
        socket.create_connection(("127.0.0.2", server.get_port()), timeout=1).close()


def test_taken_port_is_an_error_and_not_the_next_port(server: viser.ViserServer) -> None:
    with pytest.raises(PortTaken) as error:
        open_server(port=server.get_port())
    assert (error.value.host, error.value.port) == ("127.0.0.1", server.get_port())
    assert isinstance(error.value, PaminsaError)
    assert str(server.get_port()) in str(error.value)


@pytest.mark.parametrize(("host", "port"), [("203.0.113.1", 0), ("127.0.0.1", 70000)])
def test_impossible_address_is_an_error(host: str, port: int) -> None:
    with pytest.raises(CannotListen):
        open_server(host, port)


def test_a_port_that_the_system_keeps_is_an_error_that_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As Windows keeps many for virtual machines, and others those below 1024."""

    def refuse(*_: object, **__: object) -> socket.socket:
        raise PermissionError(errno.EACCES, "access to a socket in a forbidden way")

    monkeypatch.setattr(socket, "create_server", refuse)
    with pytest.raises(CannotListen, match="keeps the port for others; choose another one, or po"):
        open_server(port=8080)


def test_unreadable_name_is_an_error_and_frees_the_port() -> None:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    with pytest.raises(InvalidInput):
        open_server(port=port, allowed_hosts=["http://robot.example/"])
    socket.create_server(("127.0.0.1", port)).close()


def test_unknown_viser_is_refused_before_anything_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    fields = _messages.CommandTriggerMessage.__annotations__
    for patch, name in (
        ((_messages, "GuiUpdateMessage", _messages.GuiButtonHoldMessage), "GuiUpdateMessage"),
        # A field of a kind that no limit is known for.
        ((fields, "uuid", "Dict[str, Any]"), r"CommandTriggerMessage\.uuid"),
        ((viser, "__version__", "1.2.0"), r"1\.2\.0"),
    ):
        with monkeypatch.context() as patched:
            (patched.setitem if patch[0] is fields else patched.setattr)(*patch)
            with pytest.raises(ViserChanged, match=name):
                open_server(port=0)


def test_types_of_properties_are_found_once_for_all_handles_of_a_kind(
    guarded: GuardedServer,
) -> None:
    page, inputs = guarded.page()
    same = page.client.gui.add_number("another", 0)
    assert same._prop_hints is inputs.count._prop_hints
    assert same._prop_hints is not inputs.slider._prop_hints


@pytest.mark.parametrize(
    "headers",
    [
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
    ],
    ids=str,
)
@pytest.mark.parametrize("upgrade", [False, True], ids=["page", "WebSocket"])
def test_foreign_name_is_refused(
    server: viser.ViserServer, headers: list[tuple[str, str]], upgrade: bool
) -> None:
    sent = [(name, value.format(port=server.get_port())) for name, value in headers]
    if upgrade:
        sent += [("Upgrade", "websocket"), ("Connection", "Upgrade")]
    assert get(server.get_port(), headers=sent).status == 403


def test_web_socket_with_a_foreign_origin_is_refused(server: viser.ViserServer) -> None:
    with pytest.raises(InvalidStatus) as refusal:
        dial(server.get_port(), origin="http://evil.example")
    assert refusal.value.response.status_code == 403


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_own_page_may_connect(server: viser.ViserServer, name: str) -> None:
    dial(server.get_port(), origin=f"http://{name}:{server.get_port()}").close()
    assert get(server.get_port(), headers=[("Host", f"{name}:{server.get_port()}")]).status == 200


def test_page_cannot_be_framed_or_made_to_show_another_server(server: viser.ViserServer) -> None:
    policy = get(server.get_port()).headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in str(policy)
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
    ids=["zeros", "many headers", "POST", "zero in the path", "no text"],
)
def test_connection_that_is_not_http_is_closed_without_a_report(
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
    port, name = server.get_port(), ("Host", "robot.example")
    served = {
        f"127.0.0.1:{port}": 200,
        f"{socket.gethostname()}:{port}": 200,
        "robot.example": 200,
        f"robot.example:{port}": 200,
        "tunnel.example:9000": 200,
        f"tunnel.example:{port}": 403,
        f"evil.example:{port}": 403,
        f"192.0.2.7:{port}": 403,  # not the address that was reached
    }
    try:
        assert server_url(server) == f"http://127.0.0.1:{port}"
        found = {host: get(port, headers=[("Host", host)]).status for host in served}
        assert found == served
        for origin, status in (("https://robot.example", 200), ("https://evil.example", 403)):
            assert get(port, headers=[name, ("Origin", origin)]).status == status
    finally:
        server.stop()


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "localhost", "LOCALHOST", "::1"])
def test_loopback_exposes_nothing(host: str) -> None:
    assert exposure_notice(host) is None


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.7", "robot.example"])
def test_any_other_address_comes_with_a_warning(host: str) -> None:
    notice = exposure_notice(host)
    assert notice is not None
    assert "no encryption" in notice
    assert ("every network" in notice) == (host in ("0.0.0.0", "::"))


# The rules for Host and Origin over all names.

PORT = 8080
LOCAL = NameRules.for_server("127.0.0.1", PORT)
LABELS = st.text(string.ascii_lowercase + string.digits + "-", min_size=1, max_size=12)
NAMES = (
    st.lists(LABELS, min_size=1, max_size=4)
    .map(".".join)
    .filter(lambda name: not is_loopback(name) and any(c.isalpha() for c in name))
)
PORTS = st.integers(0, 65535)


@given(NAMES, PORTS, st.sampled_from([None, "127.0.0.1", "::1"]))
def test_no_other_name_is_served_on_loopback(name: str, port: int, reached: str | None) -> None:
    for host in (name, f"{name}:{port}", f"{name}:{PORT}"):
        for origins in ([], [f"http://{host}"]):
            assert LOCAL.objection([host], origins, reached) is not None


@given(NAMES, NAMES, PORTS)
def test_page_is_served_exactly_if_it_comes_from_the_name_it_requests(
    name: str, other: str, port: int
) -> None:
    rules = NameRules.for_server("0.0.0.0", PORT, [name])
    host = [f"{name}:{PORT}"]
    assert rules.objection(host, [], "192.0.2.1") is None
    assert rules.objection(host, [f"http://{name.upper()}:{PORT}"], "192.0.2.1") is None
    same = (other, port) == (name, PORT)
    assert (rules.objection(host, [f"http://{other}:{port}"], "192.0.2.1") is None) == same


@given(st.text(st.characters(max_codepoint=255), max_size=30))
def test_any_other_text_is_refused(text: str) -> None:
    for host, origins in ((text, []), (f"localhost:{PORT}", [text]), (f"{text}:{PORT}", [])):
        assert LOCAL.objection([host], origins, "127.0.0.1") is not None


@given(NAMES, st.none() | PORTS)
def test_authority_is_read_as_written(name: str, port: int | None) -> None:
    written = name.upper() if port is None else f"{name.upper()}:{port}"
    assert Authority.parse(written) == Authority(name, port)
    assert Authority.parse(f"user@{written}") is None
    assert Authority.parse(f"{written}/path") is None


@given(st.ip_addresses())
def test_address_is_served_exactly_if_it_was_reached(address: object) -> None:
    literal = f"[{address}]" if ":" in str(address) else str(address)
    rules = NameRules.for_server("0.0.0.0", PORT)
    assert rules.objection([f"{literal}:{PORT}"], [], str(address)) is None
    elsewhere = rules.objection([f"{literal}:{PORT}"], [], "198.51.100.200")
    known = is_loopback(str(address)) or str(address) in ("0.0.0.0", "198.51.100.200")
    assert (elsewhere is None) == known


def test_address_reached_over_a_socket_for_both_families_is_the_same() -> None:
    rules = NameRules.for_server("::", PORT)
    assert rules.objection([f"192.0.2.1:{PORT}"], [], "::ffff:192.0.2.1") is None
