"""The robot's formulas in other languages, and its controller kit in C."""

from __future__ import annotations

from paminsa_viz.codegen.kit import controller_kit

__all__ = ["controller_kit"]
