"""From requirements to a robot.

A `SynthesisCase` says what is required over which workspace, what may be changed and what is to be
least; `synthesize` looks for the robot.
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
from paminsa_viz.synthesis.evaluation import Evaluation, Evaluator
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
    "Guide",
    "Objective",
    "ObjectiveLimit",
    "Regime",
    "RegimeState",
    "RelaxedBound",
    "SearchProgress",
    "SearchRange",
    "SynthesisCase",
    "SynthesisResult",
    "Trial",
    "find_objective",
    "refusal",
    "relaxations",
    "synthesize",
]
