"""Requirements as plain data, for the tab's own store and share codes."""

from __future__ import annotations

from typing import Any

import msgspec

from paminsa_viz.explorer.state.settings import changed_data
from paminsa_viz.model import InvalidInput
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.units import format_value

MOST_REQUIREMENTS = 24
"""Most bounds on quantities of a document."""

FARTHEST = 1e3
"""Largest size and coordinate of a workspace, and largest angle [m, rad]."""

DIGITS = 6
"""Digits of what is refused, and of the largest angle, which is not rounded up."""


def asked(requirements: Requirements) -> bool:
    """Whether anything is required."""
    return bool(requirements.bounds) or requirements.workspace is not None


def of_file(requirements: Requirements) -> Requirements | None:
    """Return what a design file says of requirements; None, and nothing is written, of none."""
    return requirements if asked(requirements) else None


def require_possible(requirements: Requirements) -> None:
    """Check what a page may ask for.

    Raises:
        InvalidInput: If there are too many requirements, or a number of a workspace is too large.
    """
    if len(requirements.bounds) > MOST_REQUIREMENTS:
        raise InvalidInput("requirements", f"at most {MOST_REQUIREMENTS} are possible here")
    workspace, own = requirements.workspace, requirements.bounds
    _require_near("θ", "rad", requirements.theta, *(bound.theta or () for bound in own))
    _require_near("z", "m", *(bound.z or () for bound in own))
    if workspace is not None:
        _require_near("workspace size", "m", workspace.size)
        center = tuple(place for place in workspace.center if place is not None)
        _require_near("workspace center", "m", center)


def _require_near(name: str, unit: str, *parts: tuple[float, ...]) -> None:
    """Check numbers of one kind [SI].

    Raises:
        InvalidInput: If one is larger than `FARTHEST`.
    """
    for value in (value for part in parts for value in part):
        if abs(value) > FARTHEST:
            limit, held = (format_value(number, unit, DIGITS) for number in (FARTHEST, value))
            raise InvalidInput(name, f"at most {limit} in size is possible, not {held}")


def requirements_data(requirements: Requirements) -> dict[str, Any]:
    """Return what differs from no requirements at all; nothing if there are none."""
    data = changed_data(requirements, Requirements())
    for bound in data.get("bounds", ()):
        for name in [name for name, value in bound.items() if value is None]:
            del bound[name]
    return data


def requirements_from_data(data: dict[str, Any]) -> Requirements:
    """Read what `requirements_data` returned.

    Raises:
        PaminsaError: If a value is not possible.
        msgspec.ValidationError: If it is something else.
    """
    requirements = msgspec.convert(data, Requirements)
    require_possible(requirements)
    return requirements
