"""What the application is started with; the command line and Python callers share it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from paminsa_viz.model.errors import InvalidInput


@dataclass(frozen=True)
class AppOptions:
    """How to start the application.

    Attributes:
        host: Address to listen on; a loopback address keeps the page to this machine.
        port: Port to listen on, 0 for any free one.
        browser: Whether to open the page in the browser.
        design: Design file to start with, or None for the paper's Appendix 4.
        allow_host: Further names under which the page may be opened, besides the address itself.

    Raises:
        InvalidInput: If the port is not one.
    """

    host: str = "127.0.0.1"
    port: int = 8080
    browser: bool = True
    design: Path | None = None
    allow_host: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not 0 <= self.port <= 65535:
            raise InvalidInput("--port", f"{self.port} is not from 0 to 65535")
        if not self.host.strip():
            raise InvalidInput("--host", "an address or name is needed")
