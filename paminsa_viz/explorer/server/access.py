"""The access token: who may use a server that others can reach.

The token is part of the address that the program prints. The first request with it gets a cookie
and is sent on to the address without it, so that it is neither in the address bar nor in what is
copied from there; from then on the cookie is enough, for HTTP and WebSocket alike.
"""

from __future__ import annotations

import hmac
import secrets
from urllib.parse import parse_qsl, urlencode

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from .limits import logger

TOKEN_BYTES = 32

REFUSAL = (
    "This page needs its access token: open the address that the program printed when it started, "
    "with ?token=... at its end.\n"
)


class AccessToken:
    """A secret that is new at each start.

    Attributes:
        value: The secret, as it is in the address.
    """

    def __init__(self) -> None:
        self.value = secrets.token_urlsafe(TOKEN_BYTES)
        self._reported = False
        # All servers of a machine share its cookies, whatever their ports are.
        self._cookie = f"paminsa-viz-{secrets.token_hex(4)}"

    def respond(self, request: Request) -> Response | None:
        """Return None where a request may pass, or what to answer: a redirect, or a refusal.

        Args:
            request: A request to the server, for a page or to open a WebSocket.
        """
        path, _, query = request.path.partition("?")
        fields = parse_qsl(query, keep_blank_values=True)
        if any(name == "token" and self._matches(value) for name, value in fields):
            if "Upgrade" in request.headers:
                return None
            rest = urlencode([(name, value) for name, value in fields if name != "token"])
            # Never to another server, which is what a path with two slashes would name.
            place = "/" + path.lstrip("/") + (f"?{rest}" if rest else "")
            secure = "; Secure" if request.headers.get("X-Forwarded-Proto") == "https" else ""
            cookie = f"{self._cookie}={self.value}; HttpOnly; SameSite=Lax; Path=/{secure}"
            return text_response(303, "See Other", "", Location=place, Set_Cookie=cookie)
        if any(map(self._matches, self._cookies(request.headers))):
            return None
        if not self._reported and any(name == "token" for name, _ in fields):
            self._reported = True  # once: whoever guesses fills no log
            logger.warning("a request with a wrong access token was refused, as all others will be")
        return text_response(401, "Unauthorized", REFUSAL, WWW_Authenticate="Token")

    def _cookies(self, headers: Headers) -> list[str]:
        """Return the values of all cookies with this program's name.

        A browser sends the cookies of all programs of a host, whose values may be anything but a
        semicolon. Parsers of cookies give up at the first that is not as the standard has it.
        """
        fields = (field for line in headers.get_all("Cookie") for field in line.split(";"))
        pairs = (field.partition("=") for field in fields)
        return [value.strip(" \t") for name, _, value in pairs if name.strip(" \t") == self._cookie]

    def _matches(self, value: str) -> bool:
        return hmac.compare_digest(value.encode(errors="surrogateescape"), self.value.encode())


def text_response(
    status: int, reason: str, text: str, kind: str = "text/plain", **headers: str
) -> Response:
    """Return an answer that no browser keeps; of a header's name, ``_`` stands for a hyphen."""
    body = text.encode()
    all_headers = Headers(
        {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Length": str(len(body)),
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "Connection": "close",
        }
    )
    for name, value in headers.items():
        all_headers[name.replace("_", "-")] = value
    return Response(status, reason, all_headers, body)
