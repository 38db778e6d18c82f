"""From requirements to a robot.

`solve_volume` finds where requirements hold, `check_requirements` which do, `smallest_conflict`
which contradict; `prove` and `largest_workspace` prove workspaces. A `SynthesisCase` says what is
required over which workspace, what may be changed and what is to be least; `synthesize` looks for
the robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:  # the search brings the compiler, which a check does not need
    from paminsa_viz.synthesis.proof.certificate import prove
    from paminsa_viz.synthesis.proof.evidence import Evidence, Proof, Verdict
    from paminsa_viz.synthesis.proof.largest import LargestWorkspace, largest_workspace
    from paminsa_viz.synthesis.proof.regions import Growth
    from paminsa_viz.synthesis.search.buildability import (
        Buildability,
        buildability,
    )
    from paminsa_viz.synthesis.search.case import (
        DIMENSIONS,
        Effort,
        Guide,
        ObjectiveLimit,
        Regime,
        SearchRange,
        SynthesisCase,
    )
    from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case
    from paminsa_viz.synthesis.search.evaluation import Evaluator, TrialEvaluation
    from paminsa_viz.synthesis.search.objectives import OBJECTIVES, Objective, find_objective
    from paminsa_viz.synthesis.search.outer import RegimeState
    from paminsa_viz.synthesis.search.refusals import refusal
    from paminsa_viz.synthesis.search.region import Density
    from paminsa_viz.synthesis.search.result import BoundOutcome, RelaxedBound, SynthesisResult
    from paminsa_viz.synthesis.search.solve import relaxations, synthesize
    from paminsa_viz.synthesis.search.trial import TrialRobot
    from paminsa_viz.synthesis.volume.causes import CauseKind, VolumeCause, cause_slice
    from paminsa_viz.synthesis.volume.check import RequirementsCheck, check_requirements
    from paminsa_viz.synthesis.volume.conflict import Conflict, smallest_conflict
    from paminsa_viz.synthesis.volume.grid import COARSE, FINE, Resolution
    from paminsa_viz.synthesis.volume.solve import Volume, solve_volume
    from paminsa_viz.synthesis.volume.surface import (
        VolumeSurface,
        volume_bytes,
        volume_surface,
        volume_table,
    )

__all__ = [
    "COARSE",
    "DIMENSIONS",
    "EXAMPLES",
    "FINE",
    "OBJECTIVES",
    "BoundOutcome",
    "Buildability",
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
    "SearchRange",
    "SynthesisCase",
    "SynthesisResult",
    "TrialEvaluation",
    "TrialRobot",
    "Verdict",
    "Volume",
    "VolumeCause",
    "VolumeSurface",
    "buildability",
    "cause_slice",
    "check_requirements",
    "find_objective",
    "largest_workspace",
    "load_case",
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

__getattr__ = late_names(__name__)
