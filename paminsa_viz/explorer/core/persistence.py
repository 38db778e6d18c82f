"""A document as text, for the tab's own store, and as a share code; read back with every check.

A share code is one line that fits into a mail: ``PMZ1-`` and then base64url of the deflated text.
It may come from anywhere, so it is short, is unpacked to a bounded length, and every value is
checked.
"""

from __future__ import annotations

import base64
import binascii
import json
import re
import zlib
from dataclasses import replace
from typing import Any

import msgspec

from paminsa_viz.errors import printable
from paminsa_viz.explorer.browser import LONGEST_LINK
from paminsa_viz.explorer.core.saved_requirements import requirements_data, requirements_from_data
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.motion import motion_data, motion_from_data
from paminsa_viz.explorer.state.settings import changed_data
from paminsa_viz.files.design_schema import knee_of
from paminsa_viz.files.design_writer import NAME_CHARACTERS
from paminsa_viz.files.errors import shown
from paminsa_viz.files.plain_data import parse_json
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    Design,
    InvalidInput,
    LoadFrame,
    PaminsaError,
)
from paminsa_viz.model.drive import NO_DRIVES, Drive
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.parameters import Counterweight

VERSION = 1


FARTHEST = 1e6
"""Largest coordinate of a saved pose [m, rad]; it need not be in reach."""


PREFIX = "PMZ1-"
"""What a code begins with; the figure is the version of the packing."""

LONGEST_CODE = LONGEST_LINK
"""Longest code that is looked at [characters]; two designs with all numbers have some 6,500."""

LONGEST_TEXT = 40_000
"""Longest text that is unpacked [bytes]."""


def _numbers(design: Design) -> dict[str, float]:
    """Return the numbers that differ from Appendix 4, as they were given."""
    values = {path: design.stored(path) for path in PARAMETER}
    return {
        path: value
        for path, value in values.items()
        if value is not None and value != APPENDIX_4.stored(path)
    }


def _described(design: Design) -> dict[str, Any]:
    """Return a design as plain data: its name, its numbers, its counterweights if it has any."""
    weights = [[w.bar, w.joint, w.beyond, w.mass] for w in design.counterweights]
    described: dict[str, Any] = {"name": design.name, "design": _numbers(design)}
    if design.load.frame is not LoadFrame.WORLD:
        described["load_frame"] = design.load.frame.value
    drives = [None if drive is None else changed_data(drive, Drive()) for drive in design.drives]
    described |= {"counterweights": weights} if weights else {}
    return described | ({"drives": drives} if any(design.drives) else {})


def dump(document: Document) -> str:
    """Write a document as text; without a motion that is a file's, which may be long."""
    reference = document.reference
    described = _described(document.design) | {
        "version": VERSION,
        "knee": document.design.geometry.knee.value,
        "pose": document.pose,
        "reference": None if reference is None else _described(reference),
    }
    optional = {
        "motion": motion_data(document.motion),
        "requirements": requirements_data(document.requirements),
    }
    return json.dumps(described | {name: data for name, data in optional.items() if data})


def load(text: str) -> Document:
    """Read a document.

    Raises:
        PaminsaError: If the text is not a document or a value in it is not possible.
    """
    try:
        data = parse_json(text)
        if data["version"] != VERSION:
            raise InvalidInput("saved state", f"version {shown(data['version'])} is not known")
        x, y, theta, z = (_number(value) for value in data["pose"])
        for name, value in zip(COORDINATES, (x, y, theta, z), strict=True):
            if not abs(value) <= FARTHEST:
                limit = f"up to {FARTHEST:g} m or rad in size is possible, not {value:g}"
                raise InvalidInput("saved state", f"{name} of its pose: {limit}")
        reference = data["reference"]
        # Tabs and codes of before have the key "assembly".
        knee = knee_of(data["knee"] if "knee" in data else data["assembly"])
        return Document(
            design=_design(data).with_knee(knee),
            pose=(x, y, theta, z),
            reference=None if reference is None else _design(reference).with_knee(knee),
            motion=motion_from_data(data.get("motion", {})),
            requirements=requirements_from_data(data.get("requirements", {})),
        )
    except PaminsaError:
        raise
    except (
        ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError,
        msgspec.ValidationError,
    ):  # fmt: skip
        raise InvalidInput("saved state", "it cannot be read") from None


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InvalidInput("saved state", "a number is needed where there is none")
    return float(value)


def _design(data: dict[str, Any]) -> Design:
    """Read what `_described` returned."""
    design = APPENDIX_4.vary({path: _number(value) for path, value in data["design"].items()})
    weights = data.get("counterweights", [])
    drives: Any = tuple(
        None if drive is None else _drive(drive) for drive in data.get("drives", NO_DRIVES)
    )
    return replace(
        design,
        name=printable(str(data["name"]))[:NAME_CHARACTERS],
        load=replace(design.load, frame=LoadFrame(data.get("load_frame", "world"))),
        drives=drives,
        counterweights=tuple(
            Counterweight(bar, joint, _number(beyond), _number(mass))
            for bar, joint, beyond, mass in weights
        ),
    )


def _drive(values: dict[str, Any]) -> Drive:
    """Read what `changed_data` returned."""
    known: Any = values | {"name": printable(str(values.get("name", "")))[:NAME_CHARACTERS]}
    return Drive(**known)


def share_code(document: Document) -> str:
    """Return the share code of a document."""
    packed = zlib.compress(dump(document).encode(), 9)
    return PREFIX + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def open_share_code(code: str) -> Document:
    """Return the document of a share code; blanks and line ends that a mail put in do not matter,
    nor what a link says after it of what is shown.

    Raises:
        PaminsaError: If the code is none, is damaged, or describes what is not possible.
    """
    if len(code) > LONGEST_CODE:
        raise InvalidInput("share code", f"it is too long (at most {LONGEST_CODE:,} characters)")
    code = re.sub(r"\s+", "", code.partition("&")[0])
    if not code.startswith(PREFIX):
        version = re.match(r"PMZ(\d+)-", code)
        raise InvalidInput(
            "share code",
            f"it is from another version of paminsa_viz (packing {version[1]})"
            if version
            else f"a share code begins with {PREFIX}",
        )
    return load(_unpacked(code.removeprefix(PREFIX)))


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
