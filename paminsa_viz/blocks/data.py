"""Results as data for JSON: attributes under keys that name their unit, and plain values."""

from __future__ import annotations

import math
import os
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from paminsa_viz.model.design import Design

UNITS = ("m", "rad", "s", "Hz", "kg", "N", "Nm", "N_per_m", "kg_m2", "W", "J", "rad_s", "m3", "95")
"""Endings of keys in JSON that name the unit of a value, or its confidence [%]."""


POSITION_KEYS = ("M1_rad", "M2_rad", "M3_rad", "M4_m")
"""Keys in JSON of positions of the actuators, or of what they are off by."""

POSE_KEYS = ("x_m", "y_m", "theta_rad", "z_m", "tilt_x_rad", "tilt_y_rad")
"""Keys in JSON of what a pose and a tilt are off by, `unequal_legs.SIX_COORDINATES`."""


def record(result: object, *keys: str) -> dict[str, Any]:
    """Return attributes of a result for JSON, by keys that end in the unit of the value.

    Args:
        result: What a command found.
        keys: Names of attributes, with one of `UNITS` behind: ``"noise_m"`` is its ``noise``.

    Raises:
        AttributeError: If the result has no such attribute.
    """
    return {key: getattr(result, _attribute(result, key)) for key in keys}


def robot(design: Design) -> dict[str, Any]:
    """Return which robot results are of: the design's name and the branch of its knees."""
    return {"design": design.name, "knee": design.geometry.knee.value}


def _attribute(result: object, key: str) -> str:
    known = (key.removesuffix(f"_{unit}") for unit in UNITS)
    return next((name for name in (key, *known) if hasattr(result, name)), key)


def plain(value: Any) -> Any:
    """Return a value as JSON has it: arrays as lists, enumerations by their value, paths as texts,
    records as objects, None in place of numbers that JSON does not have.
    """
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if is_dataclass(value) and not isinstance(value, type):
        return {item.name: plain(getattr(value, item.name)) for item in fields(value)}
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
