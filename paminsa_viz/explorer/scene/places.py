"""Finds what draws a layer: the registry names it, so that the state needs none of it."""

from __future__ import annotations

from importlib import import_module
from typing import Any

EXPLORER = "paminsa_viz.explorer"
"""The package that places are relative to."""


def found_at(place: Any) -> Any:
    """Return what is at a place, ``"scene.bodies:Bodies"``; anything else as it is."""
    if not isinstance(place, str):
        return place
    module, _, name = place.partition(":")
    return getattr(import_module(f"{EXPLORER}.{module}"), name)
