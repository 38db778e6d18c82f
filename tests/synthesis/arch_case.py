"""Worked case (c): 0.5 kg on an arch, within a cylinder."""

from __future__ import annotations

from functools import cache

from paminsa_viz.synthesis import SynthesisCase
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case


@cache
def arch_case() -> SynthesisCase:
    """Return the case that comes with the program."""
    return load_case(EXAMPLES["arch"])
