"""What is checked of a robot that a search found: prices, tolerances, an engine, contradictions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from paminsa_viz.blocks.data import record
from paminsa_viz.blocks.kinds import Block, Note, Row, Table, rows
from paminsa_viz.blocks.synthesis import BoundText, bound_label, bound_text, inner_blocks
from paminsa_viz.synthesis import SynthesisResult, find_objective
from paminsa_viz.synthesis.answer.checks import BuildYield
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck
from paminsa_viz.synthesis.answer.prices import RequirementPrice
from paminsa_viz.synthesis.search.case_conflict import CaseConflict
from paminsa_viz.units import counted, format_value, number, unit_text


def price_blocks(result: SynthesisResult, prices: Sequence[RequirementPrice]) -> list[Table | Note]:
    """Return what each active requirement costs the objective."""
    objective = find_objective(result.case.objective)
    if not prices:
        return [Note("No requirement is active, and no length at an end of its range.")]
    cells = (
        (
            one.label, format_value(one.bound, one.unit or "1"),
            format_value(one.step, one.unit or "1"),
            *(
                format_value(end - result.objective, objective.unit, 3)
                for end in (one.relaxed, one.tightened)
            ),
            f"{number(one.price)} {unit_text(objective.unit) or '1'} per "
            f"{unit_text(one.unit) or '1'}",
        )
        for one in prices
    )  # fmt: skip
    head = ("Requirement", "Is", "Moved by", "Relaxed", "Tightened", "Price")
    caption = (
        f"Change of the {objective.label} where a requirement is moved, by the search again near "
        "the answer, and what a unit of it costs."
    )
    return [Table(head, rows(*cells), caption)]


def yield_blocks(built: BuildYield) -> list[Table | Note]:
    """Return how many robots built within tolerances meet everything, and what others miss."""
    part = built.fraction
    low, high, confidence = (100 * share for share in (part.low, part.high, part.confidence))
    of = f"of {counted(part.samples, 'robot')}"
    meeting = counted(part.passed, f"{of} meets", f"{of} meet")
    text = (
        f"Built within tolerances: {meeting} all requirements, "
        f"{low:.1f} to {high:.1f} % of all with {confidence:.0f} % confidence."
    )
    missed = rows(*((name, str(count)) for name, count in built.missed.items()))
    return [Note(text), *([Table(("Missed", "By"), missed)] if missed else [])]


def mujoco_blocks(check: MujocoCheck | str) -> list[Block]:
    """Return what MuJoCo says of the answer, or why it has not checked it."""
    if isinstance(check, str):
        return [Note(f"MuJoCo has not checked it: {check}", "warn")]
    verdict = "confirms" if check.passed else "does NOT confirm"
    text = f"MuJoCo {check.version} {verdict} it; torques differ by {number(check.difference, 2)} "
    cells = tuple(
        Row(
            ("yes" if row.met else "no", row.label, format_value(row.engine, row.unit)),
            "plain" if row.met else "marked",
        )
        for row in check.rows
    )
    blocks: list[Block] = [
        Note(f"{text}of the largest.", "ok" if check.passed else "bad"),
        Table(("Met", "Requirement", "Margin"), cells, words=2),
    ]
    if check.left_out:
        blocks.append(Note(f"Without a meaning in MuJoCo: {', '.join(check.left_out)}."))
    return blocks


def conflict_blocks(found: CaseConflict, text: BoundText = bound_label) -> list[Block]:
    """Return the fewest requirements of a case that contradict."""
    if not found.items:
        problem = "The workspace is out of reach within the ranges, whatever else is required."
        return [Note(problem, "bad")]
    how = "proven in closed form" if found.proven else "by searches that found no robot"
    items = rows(*((text(item),) for item in found.items))
    return [Table(("",), items, f"Within the ranges these contradict, {how}:")]


@dataclass(frozen=True, eq=False)
class AnswerChecks:
    """What was asked for besides an answer; None for what was not."""

    prices: tuple[RequirementPrice, ...] | None
    built: BuildYield | None
    mujoco: MujocoCheck | str | None
    conflict: CaseConflict | None


def answer_blocks(result: SynthesisResult, found: AnswerChecks) -> list[Block]:
    """Return them, and the masses and springs that were chosen."""
    blocks = inner_blocks(result)
    if found.prices is not None:
        blocks += price_blocks(result, found.prices)
    if found.built is not None:
        blocks += yield_blocks(found.built)
    if found.mujoco is not None:
        blocks += mujoco_blocks(found.mujoco)
    if found.conflict is not None:
        blocks += conflict_blocks(found.conflict, bound_text)
    return blocks


def checks_data(result: SynthesisResult, found: AnswerChecks) -> dict[str, Any]:
    """Return them as data for JSON, in SI units."""
    data: dict[str, Any] = {}
    if result.inner is not None:
        inner = result.inner
        data["inner"] = {
            "goal": inner.goal, "value": inner.objective, "lower_bound": inner.lower_bound,
            "counterweights": [
                record(weight, "place", "mass_kg") for weight in inner.design.counterweights
            ],
            "springs": [
                {"first": spring.first.name, "second": spring.second.name}
                | record(spring, "stiffness_N_per_m", "free_length_m")
                for spring in inner.springs
            ],
            "active": inner.active,
        }  # fmt: skip
    if found.prices is not None:
        data["prices"] = found.prices
    if found.built is not None:
        data["built"] = {
            **vars(found.built.fraction), "missed": found.built.missed, "worst": found.built.worst
        }  # fmt: skip
    if isinstance(found.mujoco, str):
        data["mujoco"] = {"passed": None, "reason": found.mujoco}
    elif found.mujoco is not None:
        data["mujoco"] = record(found.mujoco, "version", "passed", "difference", "rows", "left_out")
    if found.conflict is not None:
        items = [bound_text(item) for item in found.conflict.items]
        data["conflict"] = {"items": items, "proven": found.conflict.proven}
    return data
