"""From requirements to a robot.

`solve_volume` finds where requirements hold, `check_requirements` which do, `smallest_conflict`
which contradict; `prove` and `largest_workspace` prove workspaces. A `SynthesisCase` says what is
required over which workspace, what may be changed and what is to be least; `synthesize` looks for
the robot.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from paminsa_viz.synthesis.answer import BoundOutcome, RelaxedBound, SynthesisResult
    from paminsa_viz.synthesis.case import (
        DIMENSIONS,
        Effort,
        Guide,
        ObjectiveLimit,
        Regime,
        SearchRange,
        SynthesisCase,
    )
    from paminsa_viz.synthesis.causes import CauseKind, VolumeCause
    from paminsa_viz.synthesis.certificate import prove
    from paminsa_viz.synthesis.check import RequirementsCheck, check_requirements
    from paminsa_viz.synthesis.conflict import Conflict, smallest_conflict
    from paminsa_viz.synthesis.evaluation import Evaluator, TrialEvaluation
    from paminsa_viz.synthesis.evidence import Evidence, Proof, Verdict
    from paminsa_viz.synthesis.largest import Growth, LargestWorkspace, largest_workspace
    from paminsa_viz.synthesis.objectives import OBJECTIVES, Objective, find_objective
    from paminsa_viz.synthesis.outer import RegimeState, SearchProgress
    from paminsa_viz.synthesis.refusals import refusal
    from paminsa_viz.synthesis.samples import Density
    from paminsa_viz.synthesis.search import relaxations, synthesize
    from paminsa_viz.synthesis.slices import cause_slice
    from paminsa_viz.synthesis.surface import VolumeSurface, volume_surface
    from paminsa_viz.synthesis.trial import TrialRobot
    from paminsa_viz.synthesis.volume import COARSE, FINE, Resolution, Volume, solve_volume
    from paminsa_viz.synthesis.volume_files import volume_bytes, volume_table

__all__ = [
    "COARSE",
    "DIMENSIONS",
    "FINE",
    "OBJECTIVES",
    "BoundOutcome",
    "CauseKind",
    "Conflict",
    "Density",
    "Effort",
    "Evaluator",
    "Evidence",
    "Growth",
    "Guide",
    "LargestWorkspace",
    "Objective",
    "ObjectiveLimit",
    "Proof",
    "Regime",
    "RegimeState",
    "RelaxedBound",
    "RequirementsCheck",
    "Resolution",
    "SearchProgress",
    "SearchRange",
    "SynthesisCase",
    "SynthesisResult",
    "TrialEvaluation",
    "TrialRobot",
    "Verdict",
    "Volume",
    "VolumeCause",
    "VolumeSurface",
    "cause_slice",
    "check_requirements",
    "find_objective",
    "largest_workspace",
    "prove",
    "refusal",
    "relaxations",
    "smallest_conflict",
    "solve_volume",
    "synthesize",
    "volume_bytes",
    "volume_surface",
    "volume_table",
]

_HOMES = {
    "answer": (
        "BoundOutcome",
        "RelaxedBound",
        "SynthesisResult",
    ),
    "case": (
        "DIMENSIONS",
        "Effort",
        "Guide",
        "ObjectiveLimit",
        "Regime",
        "SearchRange",
        "SynthesisCase",
    ),
    "causes": (
        "VolumeCause",
        "CauseKind",
    ),
    "certificate": ("prove",),
    "check": (
        "RequirementsCheck",
        "check_requirements",
    ),
    "conflict": (
        "Conflict",
        "smallest_conflict",
    ),
    "evaluation": (
        "TrialEvaluation",
        "Evaluator",
    ),
    "evidence": (
        "Evidence",
        "Proof",
        "Verdict",
    ),
    "largest": (
        "Growth",
        "LargestWorkspace",
        "largest_workspace",
    ),
    "objectives": (
        "OBJECTIVES",
        "Objective",
        "find_objective",
    ),
    "outer": (
        "RegimeState",
        "SearchProgress",
    ),
    "refusals": ("refusal",),
    "samples": ("Density",),
    "search": (
        "relaxations",
        "synthesize",
    ),
    "slices": ("cause_slice",),
    "surface": (
        "VolumeSurface",
        "volume_surface",
    ),
    "trial": ("TrialRobot",),
    "volume": (
        "COARSE",
        "FINE",
        "Resolution",
        "Volume",
        "solve_volume",
    ),
    "volume_files": (
        "volume_bytes",
        "volume_table",
    ),
}
"""Modules of the names. They are imported on first use: the search brings the compiler, which a
check does not need."""


def __getattr__(name: str) -> object:
    for module, names in _HOMES.items():
        if name in names:
            found = getattr(import_module(f"{__name__}.{module}"), name)
            globals()[name] = found
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
