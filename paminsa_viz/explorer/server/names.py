"""Which names this server answers to: the ``Host`` and ``Origin`` rules, and what a bind exposes.

A page on the web can make the browser open a socket to a server on this machine, and with DNS
rebinding it can even do so under a name of its own. The browser cannot be talked out of two
headers, though: ``Host`` carries the name that was asked for, ``Origin`` the page that asks. So a
request is served only under a name that is this server's, and only for a page from that same name.
"""

from __future__ import annotations

import re
import socket
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv6Address, ip_address

from paminsa_viz.errors import InvalidInput

_AUTHORITY = re.compile(r"(\[[0-9a-f:.]+\]|[^\s:/?#@\[\]\\,]+)(?::([0-9]{1,5}))?")
_ORIGIN = re.compile(r"(https?)://(.+)")
_DEFAULT_PORTS = {"http": 80, "https": 443}


def _address(name: str) -> IPv4Address | IPv6Address | None:
    """Return the IP address that ``name`` spells out, or None if it is not an IP literal."""
    try:
        address = ip_address(name.strip("[]").partition("%")[0])
    except ValueError:
        return None
    # A socket that takes both families reports 127.0.0.1 as ::ffff:127.0.0.1.
    return getattr(address, "ipv4_mapped", None) or address


def is_loopback(name: str) -> bool:
    """Say whether ``name`` (an IP literal or a host name) can only mean this machine itself."""
    address = _address(name)
    return name.lower() == "localhost" if address is None else address.is_loopback


def exposure_notice(host: str) -> str | None:
    """Say in plain words what listening on ``host`` means.

    Args:
        host: Address or name the server is bound to.

    Returns:
        None for loopback, which only programs on this machine can reach; otherwise the warning.
    """
    if is_loopback(host):
        return None
    address = _address(host)
    everywhere = address is not None and address.is_unspecified
    where = "every network this machine is on" if everywhere else f"the network, at {host}"
    return (
        f"The explorer is open to {where}. Whoever has the address with its token can open the "
        "page, in a session of their own. There is no encryption: the token, too, can be read on "
        "the way. Use 127.0.0.1 (the default) with an SSH tunnel, or a TLS proxy, unless you trust "
        "everyone on that network."
    )


@dataclass(frozen=True)
class Authority:
    """A host name, lower case and without brackets, and the port if one was given."""

    name: str
    port: int | None

    @classmethod
    def parse(cls, text: str) -> Authority | None:
        """Read ``name``, ``name:port`` or ``[v6]:port``; None if it is none of these."""
        match = _AUTHORITY.fullmatch(text.lower())
        if match is None:
            return None
        name, port = match.groups()
        return cls(name.strip("[]"), None if port is None else int(port))


def machine_names() -> frozenset[str]:
    """Return the names this machine calls itself, without asking the network."""
    own = socket.gethostname().lower()
    return frozenset({own, f"{own.partition('.')[0]}.local"})


@dataclass(frozen=True)
class NameRules:
    """Decides whether a request may be served.

    Attributes:
        port: Port the server listens on.
        names: Names it answers to at that port, besides the loopback names.
        exact: Further authorities it answers to (behind a proxy or a forwarded port).
    """

    port: int
    names: frozenset[str]
    exact: frozenset[Authority]

    @classmethod
    def for_server(cls, host: str, port: int, allowed_hosts: Iterable[str] = ()) -> NameRules:
        """Build the rules of a server bound to ``host``.

        Args:
            host: Address or name the server is bound to.
            port: Port it listens on.
            allowed_hosts: ``"name"`` (at this port, or with none as behind a proxy) or
                ``"name:port"``.

        Raises:
            InvalidInput: An entry of ``allowed_hosts`` is neither.
        """
        names = {host.lower()}
        if not is_loopback(host):
            names |= machine_names()
        exact: set[Authority] = set()
        for entry in allowed_hosts:
            authority = Authority.parse(entry)
            if authority is None:
                raise InvalidInput("allowed_hosts", f"{entry!r} is not a name or name:port")
            exact.add(authority)
            if authority.port is None:
                exact.add(Authority(authority.name, port))
        return cls(port, frozenset(names), frozenset(exact))

    def objection(
        self, hosts: Sequence[str], origins: Sequence[str], reached: str | None
    ) -> str | None:
        """Say what is wrong with a request, or None if it may be served.

        Args:
            hosts: Values of all its ``Host`` headers.
            origins: Values of all its ``Origin`` headers; none from a client that is no browser.
            reached: Local address the connection arrived at, if known.
        """
        host = Authority.parse(hosts[0]) if len(hosts) == 1 else None
        if host is None:
            return "one Host header is needed"
        if not self._is_ours(host, reached):
            return "this server does not go by the name in the Host header"
        if origins and not (len(origins) == 1 and self._same_site(origins[0], host)):
            return "pages from elsewhere may not use this server"
        return None

    def _is_ours(self, host: Authority, reached: str | None) -> bool:
        if host in self.exact:
            return True
        if (80 if host.port is None else host.port) != self.port:
            return False
        if is_loopback(host.name) or host.name in self.names:
            return True
        # An IP literal cannot be rebound, but it must be the one that was really reached.
        address = _address(host.name)
        return address is not None and reached is not None and address == _address(reached)

    @staticmethod
    def _same_site(origin: str, host: Authority) -> bool:
        match = _ORIGIN.fullmatch(origin.lower())
        asking = Authority.parse(match[2]) if match else None
        if match is None or asking is None:
            return False
        default = _DEFAULT_PORTS[match[1]]
        if (asking.port or default) != (host.port or default):
            return False
        # 127.0.0.1, ::1 and localhost are one machine: this one.
        both_loopback = is_loopback(asking.name) and is_loopback(host.name)
        return both_loopback or asking.name == host.name
