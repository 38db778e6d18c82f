"""What ``paminsa-viz synthesize`` says, while it works and at its end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from paminsa_viz import __version__
from paminsa_viz.cli.output import print_table
from paminsa_viz.model.design import stated_parameters
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import (
    BoundOutcome,
    ObjectiveLimit,
    SearchProgress,
    SynthesisCase,
    SynthesisResult,
    find_objective,
)
from paminsa_viz.units import DEGREES, format_ascii

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


def print_result(result: SynthesisResult, seconds: float) -> None:
    """Print the answer, for people."""
    case = result.case
    objective = find_objective(case.objective)
    for regime, reason in result.refused.items():
        print(f"{regime.value}: not possible. {reason}.")
    tried = f"{result.trials} robots tried in {seconds:.1f} s, seed {case.seed}"
    if not result.feasible:
        print(f"{case.name}: no robot meets the requirements; {tried}")
        _print_closest(result)
        return
    assert result.regime is not None  # there is a robot
    value = format_ascii(result.objective, objective.unit)
    print(f"{case.name}: {objective.label} {value} with {result.regime.value}; {tried}")
    _print_changes(result)
    print()
    rows = [("", "requirement", "worst", "margin", "")]
    for outcome in result.outcomes:
        mark = "ok" if outcome.margin >= 0 else "no"
        rows.append((mark, *_cells(outcome), "active" if outcome.active else ""))
    print_table(rows)
    low, high = (DEGREES * angle for angle in case.requirements.theta)
    print(
        f"\nverified at {result.poses} poses of the workspace, theta {low:.4g} to {high:.4g} deg "
        f"from the heading where joints 5 are toward their leg axes"
    )
    if (proof := result.proof) is not None:
        print(f"proof over the whole workspace: {proof.verdict.value}")
        for item in proof.evidence:
            print(f"  {item.name}: {item.verdict.value}, by {item.method.value}")


def _print_changes(result: SynthesisResult) -> None:
    before, after = result.case.reference, result.design
    rows = [("", result.case.reference.name, "robot", "")]
    for item in stated_parameters(after):
        first, second = before.value(item.path), after.value(item.path)
        if item.path == "geometry.guide_stroke" or first == second:
            continue  # the stroke follows B10
        texts = (format_ascii(first, item.unit), format_ascii(second, item.unit))
        rows.append((item.symbol, *texts, item.label))
    place = result.workspace.center[2]
    if place is not None:
        rows.append(("z", "", format_ascii(place, "m"), "height of the workspace's center"))
    print_table(rows)


def _print_closest(result: SynthesisResult) -> None:
    if result.outcomes and any(math.isfinite(item.value) for item in result.outcomes):
        print("the closest robot:")
        print_table([("requirement", "worst", "margin"), *map(_cells, result.outcomes)], indent=2)
    possible = [item for item in result.relaxed if math.isfinite(item.nearest)]
    if possible:
        print("one of these would have to be relaxed, the others kept; the nearest found:")
        rows = [("requirement", "possible", "change")]
        for item in possible:
            change = f"{100 * item.change:+.3g} %"
            rows.append(
                (bound_text(item.bound), format_ascii(item.nearest, _unit(item.bound)), change)
            )
        print_table(rows, indent=2)
    elif result.relaxed:
        print("relaxing a single one of the requirements does not help")


def _cells(outcome: BoundOutcome) -> tuple[str, str, str]:
    unit = _unit(outcome.bound)
    known = math.isfinite(outcome.value)
    texts = [format_ascii(v, unit) if known else "-" for v in (outcome.value, outcome.margin)]
    return bound_text(outcome.bound), texts[0], texts[1]


def bound_text(bound: Requirement | ObjectiveLimit) -> str:
    """Return a requirement or a limit as text."""
    if isinstance(bound, Requirement):
        return requirement_text(bound)
    objective = find_objective(bound.objective)
    sign = ">=" if objective.largest else "<="
    return f"{objective.key} {sign} {format_ascii(bound.most, objective.unit)}"


def _unit(bound: Requirement | ObjectiveLimit) -> str:
    if isinstance(bound, Requirement):
        return bound.entry.unit
    return find_objective(bound.objective).unit


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
