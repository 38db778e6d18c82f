"""A whole document as one line of text that fits into a mail: to hand a design and pose on.

``PMZ1-`` and then base64url of the deflated saved text (`paminsa_viz.explorer.saving`). A code may
come from anywhere, so it is short, is unpacked to a bounded length, and every value is checked.
"""

from __future__ import annotations

import base64
import binascii
import re
import zlib

from paminsa_viz.explorer import saving
from paminsa_viz.explorer.state import Document
from paminsa_viz.model import InvalidInput

PREFIX = "PMZ1-"
"""What a code begins with; the figure is the version of the packing."""

LONGEST_CODE = 8_000
"""Longest code that is looked at [characters]; the longest of two full designs has about 2,500."""

LONGEST_TEXT = 20_000
"""Longest text that is unpacked [bytes]."""


def encode(document: Document) -> str:
    """Return the share code of a document."""
    packed = zlib.compress(saving.dump(document).encode(), 9)
    return PREFIX + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def decode(code: str) -> Document:
    """Return the document of a share code; blanks and line ends that a mail put in do not matter.

    Raises:
        PaminsaError: If the code is none, is damaged, or describes what is not possible.
    """
    if len(code) > LONGEST_CODE:
        raise InvalidInput("share code", f"it is too long (at most {LONGEST_CODE} characters)")
    code = re.sub(r"\s+", "", code)
    if not code.startswith(PREFIX):
        version = re.match(r"PMZ(\d+)-", code)
        raise InvalidInput(
            "share code",
            f"it is from another version of paminsa_viz (packing {version[1]})"
            if version
            else f"a share code begins with {PREFIX}",
        )
    return saving.load(_unpacked(code.removeprefix(PREFIX)))


def _unpacked(body: str) -> str:
    try:
        if not re.fullmatch(r"[A-Za-z0-9_-]*", body):
            raise ValueError
        packed = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))
        unpacker = zlib.decompressobj()
        text = unpacker.decompress(packed, LONGEST_TEXT)
        if not unpacker.eof or unpacker.unused_data:
            raise ValueError
        return text.decode()
    except (binascii.Error, zlib.error, ValueError):
        raise InvalidInput("share code", "it is damaged or incomplete") from None
