"""The rules for ``Host`` and ``Origin`` over all names, not only the ones somebody thought of."""

from __future__ import annotations

import string

from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.server.names import Authority, NameRules, is_loopback

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
        assert LOCAL.objection([host], [], reached) is not None
        assert LOCAL.objection([host], [f"http://{host}"], reached) is not None


@given(NAMES, NAMES, PORTS)
def test_a_page_is_served_exactly_if_it_comes_from_the_name_it_asks_for(
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
    for host, origin in ((text, None), (f"localhost:{PORT}", text), (f"{text}:{PORT}", None)):
        origins = [] if origin is None else [origin]
        assert LOCAL.objection([host], origins, "127.0.0.1") is not None


@given(NAMES, st.none() | PORTS)
def test_an_authority_is_read_as_written(name: str, port: int | None) -> None:
    written = name.upper() if port is None else f"{name.upper()}:{port}"
    assert Authority.parse(written) == Authority(name, port)
    assert Authority.parse(f"user@{written}") is None
    assert Authority.parse(f"{written}/path") is None


@given(st.ip_addresses())
def test_an_address_is_served_exactly_if_it_was_reached(address: object) -> None:
    literal = f"[{address}]" if ":" in str(address) else str(address)
    rules = NameRules.for_server("0.0.0.0", PORT)
    assert rules.objection([f"{literal}:{PORT}"], [], str(address)) is None
    reached_elsewhere = rules.objection([f"{literal}:{PORT}"], [], "198.51.100.200")
    known = is_loopback(str(address)) or str(address) in ("0.0.0.0", "198.51.100.200")
    assert (reached_elsewhere is None) == known


def test_an_address_that_came_over_a_socket_for_both_families_is_the_same_address() -> None:
    rules = NameRules.for_server("::", PORT)
    assert rules.objection([f"192.0.2.1:{PORT}"], [], "::ffff:192.0.2.1") is None
