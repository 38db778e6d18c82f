"""A document as text: for the tab's own store and for share codes, read back with every check."""

from __future__ import annotations

import json
import math
from dataclasses import replace

from paminsa_viz.explorer.state import Document
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    Assembly,
    Design,
    InvalidInput,
    PaminsaError,
)

VERSION = 1


def _numbers(design: Design) -> dict[str, float]:
    """Return the numbers that differ from Appendix 4."""
    values = {p.path: design.value(p.path) for p in PARAMETERS}
    if design.geometry.guide_stroke is None:
        del values["geometry.guide_stroke"]
    return {path: v for path, v in values.items() if v != APPENDIX_4.value(path)}


def dump(document: Document) -> str:
    """Write a document as text."""
    reference = document.reference
    return json.dumps(
        {
            "version": VERSION,
            "name": document.design.name,
            "design": _numbers(document.design),
            "assembly": document.assembly.value,
            "pose": document.pose,
            "reference": None
            if reference is None
            else {"name": reference.name, "design": _numbers(reference)},
        }
    )


def load(text: str) -> Document:
    """Read a document.

    Raises:
        PaminsaError: If the text is not a document or a value in it is not possible.
    """
    try:
        data = json.loads(text)
        if data["version"] != VERSION:
            raise InvalidInput("saved state", f"version {data['version']!r} is not known")
        x, y, theta, z = (float(value) for value in data["pose"])
        if not all(map(math.isfinite, (x, y, theta, z))):
            raise InvalidInput("saved state", "the pose is not finite")
        reference = data["reference"]
        return Document(
            design=_design(data["name"], data["design"]),
            assembly=Assembly(data["assembly"]),
            pose=(x, y, theta, z),
            reference=None
            if reference is None
            else _design(reference["name"], reference["design"]),
        )
    except PaminsaError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InvalidInput("saved state", f"it can not be read ({error})") from None


def _design(name: object, numbers: dict[str, float]) -> Design:
    design = APPENDIX_4.vary({path: float(value) for path, value in numbers.items()})
    return replace(design, name=str(name)[:80])
