"""From requirements to a robot.

A `SynthesisCase` says what is required over which workspace, what may be changed and what is to be
least; `synthesize` looks for the robot. `prove` proves requirements over a whole workspace, and
`largest_workspace` finds the largest for which that is possible.
"""

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
from paminsa_viz.synthesis.certificate import prove
from paminsa_viz.synthesis.evaluation import Evaluation, Evaluator
from paminsa_viz.synthesis.evidence import Evidence, Proof, Verdict
from paminsa_viz.synthesis.largest import Growth, LargestWorkspace, largest_workspace
from paminsa_viz.synthesis.objectives import OBJECTIVES, Objective, find_objective
from paminsa_viz.synthesis.outer import RegimeState, SearchProgress
from paminsa_viz.synthesis.refusals import refusal
from paminsa_viz.synthesis.samples import Density
from paminsa_viz.synthesis.search import relaxations, synthesize
from paminsa_viz.synthesis.trial import Trial

__all__ = [
    "DIMENSIONS",
    "OBJECTIVES",
    "BoundOutcome",
    "Density",
    "Effort",
    "Evaluation",
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
    "SearchProgress",
    "SearchRange",
    "SynthesisCase",
    "SynthesisResult",
    "Trial",
    "Verdict",
    "find_objective",
    "largest_workspace",
    "prove",
    "refusal",
    "relaxations",
    "synthesize",
]
