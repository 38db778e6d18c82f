"""The robot's formulas in other languages, its controller kit in C, and FMUs around it."""

from __future__ import annotations

from paminsa_viz.codegen.fmu import build_fmu
from paminsa_viz.codegen.kit import controller_kit

__all__ = ["build_fmu", "controller_kit"]
