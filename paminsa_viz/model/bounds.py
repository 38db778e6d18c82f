"""How large a design's numbers may be in a program: beyond any machine, within the arithmetic."""

from __future__ import annotations

from dataclasses import fields

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS, Drive
from paminsa_viz.model.parameters import PARAMETER, PARAMETERS

LARGEST = {"": 100.0, "m": 100.0, "kg": 1e4, "kg m^2": 1e4, "m/s^2": 1e3}
"""Largest number of each unit; any other unit has `LARGEST_OTHER`."""

LARGEST_OTHER = 1e4

SMALLEST = 1e-6
"""Smallest number where zero is refused."""

MOST_COUNTERWEIGHTS = 12
"""Most counterweights of a leg: each is a body of the scene and a row of the page."""

DRIVE_RANGE = (1e-12, 1e9)
"""Range of any number of a drive that is not zero [SI]."""


def largest(path: str) -> float:
    """Return the largest number that is taken at a dotted path [SI]."""
    return LARGEST.get(PARAMETER[path].unit, LARGEST_OTHER)


def validate_limits(design: Design) -> Design:
    """Return the design if its numbers are of a size that can be worked with.

    The model takes any finite number, and some overflow in its formulas. What comes from a page, a
    file or a share code goes through here.

    Raises:
        InvalidDesign: If a number is too large, or too small where zero is refused, or if there
            are too many counterweights.
    """
    count = len(design.counterweights)
    if count > MOST_COUNTERWEIGHTS:
        raise InvalidDesign(
            "counterweights", count, f"here, a leg has at most {MOST_COUNTERWEIGHTS}"
        )
    for number, weight in enumerate(design.counterweights):
        for name, value, unit in (("mass", weight.mass, "kg"), ("beyond", weight.beyond, "m")):
            if not abs(value) <= LARGEST[unit]:
                raise InvalidDesign(
                    f"counterweights.{number}.{name}", value,
                    f"here, its size is at most {LARGEST[unit]:g} [{unit}]",
                )  # fmt: skip
    for name, drive in zip(ACTUATORS, design.drives, strict=True):
        if drive is not None:
            validate_drive(drive, f"drives.{name}")
    for parameter in PARAMETERS:
        path, value = parameter.path, design.value(parameter.path)
        low, high = (SMALLEST if parameter.positive else 0.0), largest(path)
        if not low <= value <= high:
            unit = f" [{parameter.unit}]" if parameter.unit else ""
            raise InvalidDesign(path, value, f"here, it is from {low:g} to {high:g}{unit}")
    return design


def validate_drive(drive: Drive, path: str) -> Drive:
    """Return a drive if its numbers are of a size that can be worked with.

    Raises:
        InvalidDesign: If a number is out of `DRIVE_RANGE`.
    """
    low, high = DRIVE_RANGE
    for item in fields(Drive):
        value = getattr(drive, item.name)
        if "unit" in item.metadata and value and not low <= value <= high:
            allowed = f"here, it is from {low:g} to {high:g}"
            raise InvalidDesign(f"{path}.{item.name}", value, allowed)
    return drive
