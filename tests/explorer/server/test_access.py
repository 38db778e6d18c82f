"""The access token, directly and behind a TLS proxy."""

from __future__ import annotations

import http.client
import logging
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.http11 import Request
from websockets.sync.client import connect

from paminsa_viz.explorer.server.access import AccessToken
from paminsa_viz.explorer.server.listening import server_url
from tests.support.guarded import GuardedServer
from tests.support.raw_page import CAMERA, PROTOCOL, TIMEOUT, dial, eventually, get, pack

pytestmark = pytest.mark.slow

TOKEN = AccessToken()


@pytest.fixture(scope="module")
def closed() -> Iterator[GuardedServer]:
    """A server that asks for a token."""
    server = GuardedServer(token=TOKEN)
    yield server
    server.close()


def _get(server: GuardedServer, path: str = "/", cookie: str = "") -> http.client.HTTPResponse:
    headers = [("Host", f"127.0.0.1:{server.port}")]
    return get(server.port, path, headers + ([("Cookie", cookie)] if cookie else []))


def _cookie(server: GuardedServer) -> str:
    granted = _get(server, f"/?token={TOKEN.value}").headers["Set-Cookie"]
    assert granted is not None
    assert {"HttpOnly", "SameSite=Lax", "Path=/"} <= set(granted.split("; "))
    return granted.partition(";")[0]


def test_the_address_with_its_token_gives_a_cookie_that_is_enough(closed: GuardedServer) -> None:
    assert server_url(closed.server, TOKEN).endswith(f"/?token={TOKEN.value}")
    redirect = _get(closed, f"/?token={TOKEN.value}&lang=en")
    assert (redirect.status, redirect.headers["Location"]) == (303, "/?lang=en")
    cookie = _cookie(closed)
    assert _get(closed, cookie=cookie).status == 200
    dial(closed.port, additional_headers={"Cookie": f"other=1; {cookie}"}).close()


def test_a_redirect_stays_on_this_server(closed: GuardedServer) -> None:
    found = _get(closed, f"//evil.example/?token={TOKEN.value}")
    assert found.headers["Location"] == "/evil.example/"


def test_a_program_may_open_a_web_socket_with_the_token(closed: GuardedServer) -> None:
    address = f"ws://127.0.0.1:{closed.port}/?token={TOKEN.value}"
    connect(address, subprotocols=[PROTOCOL]).close()  # type: ignore[list-item]


@settings(max_examples=60, deadline=None)
@given(
    query=st.text(st.characters(min_codepoint=33, max_codepoint=126, exclude_characters="#")),
    cookie=st.text(st.characters(min_codepoint=32, max_codepoint=126)),
    token=st.sampled_from(["", "token=", f"token={TOKEN.value[:-1]}", "token=%FF%00"]),
)
def test_nothing_else_passes(closed: GuardedServer, query: str, cookie: str, token: str) -> None:
    status = _get(closed, f"/?{query}&{token}", cookie.strip()).status
    assert status in (400, 401, 403)


FOREIGN = st.one_of(
    st.sampled_from(
        ['theme={"dark":true}', "a[b]=1", "x=a b", "=", "a", "", "a=b=c", 'q="un;closed', "$Path=/"]
    ),
    st.text(st.characters(min_codepoint=32, max_codepoint=255, exclude_characters="\x7f")),
)
"""What other programs on this host may have set."""


@settings(max_examples=200, deadline=None)
@given(before=st.lists(FOREIGN, max_size=4), after=st.lists(FOREIGN, max_size=4), own=st.data())
def test_cookies_of_other_programs_lock_nobody_out(
    before: list[str], after: list[str], own: st.DataObject
) -> None:
    granted = TOKEN.respond(Request(f"/?token={TOKEN.value}", Headers()))
    assert granted is not None
    cookie = granted.headers["Set-Cookie"].partition(";")[0]
    name, _, _ = cookie.partition("=")
    # Another program on the host may have set one of the same name, for a longer path.
    before = own.draw(st.sampled_from([before, [*before, f"{name}=other"]]))
    after = own.draw(st.sampled_from([after, [f"{name}=other", *after]]))
    joint = own.draw(st.sampled_from(["; ", ";"]))
    assert TOKEN.respond(_with_cookies(joint.join([*before, cookie, *after]))) is None
    assert TOKEN.respond(_with_cookies(*before, cookie, *after)) is None  # a header each, HTTP/2
    refused = TOKEN.respond(_with_cookies(joint.join([*before, f"{cookie[:-1]}", *after])))
    assert refused is not None
    assert refused.status_code == 401


def _with_cookies(*headers: str) -> Request:
    return Request("/", Headers([("Cookie", header) for header in headers]))


@pytest.mark.parametrize("cookie", ["", "{name}=wrong", "{name}=", "={value}", "{name}"])
def test_no_web_socket_opens_without_the_token(closed: GuardedServer, cookie: str) -> None:
    name, _, value = _cookie(closed).partition("=")
    headers = {"Cookie": cookie.format(name=name, value=value)} if cookie else None
    with pytest.raises(InvalidStatus) as refusal:
        dial(closed.port, additional_headers=headers)
    assert refusal.value.response.status_code == 401


def test_the_token_is_not_logged(closed: GuardedServer, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG):
        _get(closed, f"/?token={TOKEN.value}")
        _get(closed, cookie=_cookie(closed))
    assert TOKEN.value not in caplog.text


def test_crowd_of_wrong_tokens_is_answered_and_logged_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    server = GuardedServer(token=AccessToken())
    try:
        with ThreadPoolExecutor(150) as crowd:
            found = list(crowd.map(lambda n: _get(server, f"/?token=guess{n}").status, range(300)))
    finally:
        server.close()
    assert set(found) == {401}
    (record,) = caplog.records
    assert "access token" in record.getMessage()
    assert "guess" not in record.getMessage()


def _needed(program: str) -> str:
    found = shutil.which(program) or shutil.which(program, path="/usr/sbin")
    if found is None:
        pytest.skip(f"{program} is not installed (on Debian: apt install {program})")
    return found


@pytest.fixture
def proxy(tmp_path: Path) -> Iterator[tuple[GuardedServer, int, ssl.SSLContext]]:
    """A server behind nginx with TLS, the proxy's port, and what trusts its certificate."""
    nginx, openssl = _needed("nginx"), _needed("openssl")
    subprocess.run(
        [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj",
         "/CN=localhost", "-addext", "subjectAltName=DNS:localhost", "-keyout", "key.pem",
         "-out", "cert.pem"],
        cwd=tmp_path, check=True, capture_output=True,
    )  # fmt: skip
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    server = GuardedServer(token=TOKEN, allowed_hosts=[f"localhost:{port}"])
    documented = (Path(__file__).parents[3] / "docs" / "network.md").read_text("utf-8")
    location = documented.partition("```nginx\n")[2].partition("```")[0]
    location = location.replace("127.0.0.1:8080", f"127.0.0.1:{server.port}")
    (tmp_path / "nginx.conf").write_text(
        f"""daemon off; pid {tmp_path}/pid; error_log {tmp_path}/error.log;
events {{}}
http {{
    access_log off; client_body_temp_path {tmp_path}/body; proxy_temp_path {tmp_path}/proxy;
    fastcgi_temp_path {tmp_path}/f; uwsgi_temp_path {tmp_path}/u; scgi_temp_path {tmp_path}/s;
    server {{
        listen 127.0.0.1:{port} ssl;
        ssl_certificate {tmp_path}/cert.pem; ssl_certificate_key {tmp_path}/key.pem;
        {location}
    }}
}}
"""
    )
    process = subprocess.Popen([nginx, "-e", "stderr", "-c", str(tmp_path / "nginx.conf")])

    def listens() -> bool:
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1):
            return True
        time.sleep(0.05)
        return False

    try:
        eventually(listens)
        yield server, port, ssl.create_default_context(cafile=str(tmp_path / "cert.pem"))
    finally:
        process.terminate()
        process.wait(TIMEOUT)
        server.close()


def test_behind_a_tls_proxy_the_page_and_its_web_socket_work(
    proxy: tuple[GuardedServer, int, ssl.SSLContext],
) -> None:
    server, port, trusted = proxy

    def fetch(path: str, cookie: str = "") -> http.client.HTTPResponse:
        connection = http.client.HTTPSConnection(
            "localhost", port, context=trusted, timeout=TIMEOUT
        )
        connection.request("GET", path, headers={"Cookie": cookie} if cookie else {})
        response = connection.getresponse()
        response.read()
        connection.close()
        return response

    assert fetch("/").status == 401
    granted = fetch(f"/?token={TOKEN.value}")
    assert (granted.status, granted.headers["Location"]) == (303, "/")
    assert "Secure" in granted.headers["Set-Cookie"]
    cookie = granted.headers["Set-Cookie"].partition(";")[0]
    assert fetch("/", cookie).status == 200
    page = connect(
        f"wss://localhost:{port}/", ssl=trusted, subprotocols=[PROTOCOL],  # type: ignore[list-item]
        origin=f"https://localhost:{port}", additional_headers={"Cookie": cookie},  # type: ignore[arg-type]
    )  # fmt: skip
    page.send(pack(CAMERA))
    assert page.recv(timeout=TIMEOUT)
    assert eventually(server.server.get_clients)
    page.close()
    with pytest.raises(InvalidStatus):
        connect(
            f"wss://localhost:{port}/", ssl=trusted, subprotocols=[PROTOCOL],  # type: ignore[list-item]
            origin="https://evil.example", additional_headers={"Cookie": cookie},  # type: ignore[arg-type]
        )  # fmt: skip
