"""What ``paminsa-viz synthesize`` says, while it works and at its end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from paminsa_viz import __version__
from paminsa_viz.model.design import stated_parameters
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import (
    ObjectiveLimit,
    SearchProgress,
    SynthesisCase,
    SynthesisResult,
    find_objective,
)
from paminsa_viz.units import format_ascii

Show = Callable[[SearchProgress], bool | None]


@contextmanager
def progress_line(case: SynthesisCase) -> Iterator[Show]:
    """Show the best so far while the work goes on, to people: not to files and other programs."""
    from rich.console import Console

    console = Console(stderr=True)
    objective = find_objective(case.objective)
    if not console.is_terminal:
        yield lambda progress: None
        return
    with console.status("searching") as status:

        def show(progress: SearchProgress) -> None:
            best = "no robot yet"
            if progress.feasible:
                best = format_ascii(objective.sign * progress.cost, objective.unit)
            status.update(
                f"{progress.regime.value}: generation {progress.generation}, "
                f"{progress.trials} robots, {objective.label} {best}"
            )

        yield show


def bound_text(bound: Requirement | ObjectiveLimit) -> str:
    """Return a requirement or a limit as text."""
    if isinstance(bound, Requirement):
        return requirement_text(bound)
    objective = find_objective(bound.objective)
    sign = ">=" if objective.largest else "<="
    return f"{objective.key} {sign} {format_ascii(bound.most, objective.unit)}"


def result_data(result: SynthesisResult, seconds: float) -> dict[str, Any]:
    """Return the answer as data for JSON, in SI units."""
    case = result.case
    return {
        "made_by": f"paminsa_viz {__version__}",
        "case": case.name,
        "feasible": result.feasible,
        "objective": {"key": case.objective, "value": result.objective},
        "regime": result.regime and result.regime.value,
        "refused": {regime.value: reason for regime, reason in result.refused.items()},
        "seed": case.seed,
        "trials": result.trials,
        "seconds": round(seconds, 3),
        "poses": result.poses,
        "workspace_center_m": result.workspace.center,
        "design": {
            item.path: result.design.value(item.path)
            for item in stated_parameters(result.design)
        },
        "requirements": [
            {
                "text": bound_text(item.bound), "worst": item.value, "margin": item.margin,
                "active": item.active,
            }
            for item in result.outcomes
        ],
        "relaxed": [
            {"text": bound_text(item.bound), "nearest": item.nearest, "change": item.change}
            for item in result.relaxed
        ],
        "proof": result.proof and result.proof.verdict.value,
    }  # fmt: skip
