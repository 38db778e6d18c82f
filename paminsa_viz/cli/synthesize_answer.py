"""What ``paminsa-viz synthesize`` says besides the answer: prices, tolerances, MuJoCo, fronts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.kinds import Block
from paminsa_viz.blocks.synthesis import (
    conflict_blocks,
    inner_blocks,
    mujoco_blocks,
    price_blocks,
    yield_blocks,
)
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.output import record
from paminsa_viz.engines import EngineMissing
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.studies import Workers
from paminsa_viz.synthesis import ObjectiveLimit, SynthesisCase, SynthesisResult, find_objective
from paminsa_viz.synthesis.answer.checks import AnswerMargins, BuildYield, build_yield
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck, check_by_mujoco
from paminsa_viz.synthesis.answer.prices import RequirementPrice, requirement_prices
from paminsa_viz.synthesis.search.case_conflict import CaseConflict, case_conflict
from paminsa_viz.synthesis.search.front import DesignFront
from paminsa_viz.units import format_ascii

PERCENT = 100.0


@dataclass(frozen=True, kw_only=True)
class AnswerFlags:
    """What to say besides the answer."""

    prices: bool = False
    """What each active requirement costs: the search again near the answer, with it moved."""
    built: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Build so many robots within tolerances: the part of them that meets all requirements."""
    mass_tolerance: Annotated[float, tyro.conf.arg(metavar="%")] = 2.0
    """Tolerance of each mass to either side [%]; those of lengths are the design's."""
    mujoco: bool = False
    """Check torques and forces in MuJoCo."""
    conflict: bool = False
    """Where no robot meets the requirements, look for the fewest that contradict."""
    front: Annotated[tuple[str, ...], tyro.conf.arg(metavar="OBJECTIVE")] = ()
    """An objective of a front: robots of which none is better than another in all of them, instead
    of one; at least twice. --out FILE.toml writes them to FILE-1.toml, FILE-2.toml ..."""
    points: int = 8
    """Points of the front."""

    def check_flags(self) -> None:
        """Refuse what cannot be.

        Raises:
            UsageError: If two flags exclude each other, or a number is not possible.
        """
        if self.built is not None and self.built < 1:
            raise UsageError(f"--built {self.built}: at least one robot is needed")
        if not 0 <= self.mass_tolerance < PERCENT:
            raise UsageError("--mass-tolerance: at least 0 % and below 100 % is needed")
        if self.front and (self.prices or self.built or self.mujoco or self.conflict):
            raise UsageError("--front excludes --prices, --built, --mujoco and --conflict")

    def checks(self, result: SynthesisResult, workers: Workers) -> AnswerChecks:
        """Return what the flags ask for."""
        ok = result.feasible
        return AnswerChecks(
            requirement_prices(result, workers=workers) if ok and self.prices else None,
            build_yield(
                result.design, AnswerMargins.of(result), samples=self.built, workers=workers,
                seed=result.case.seed, mass_tolerance=self.mass_tolerance / PERCENT,
            )
            if ok and self.built
            else None,
            _mujoco(result) if ok and self.mujoco else None,
            case_conflict(result.case, workers=workers) if self.conflict and not ok else None,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class AnswerChecks:
    """What was asked for besides an answer; None for what was not."""

    prices: tuple[RequirementPrice, ...] | None
    built: BuildYield | None
    mujoco: MujocoCheck | str | None
    conflict: CaseConflict | None


def _mujoco(result: SynthesisResult) -> MujocoCheck | str:
    """Return what MuJoCo says, or why it has no such robot."""
    try:
        return check_by_mujoco(result.design, AnswerMargins.of(result))
    except (EngineMissing, InvalidDesign) as error:
        return str(error)


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


def front_data(case: SynthesisCase, front: DesignFront, seconds: float) -> dict[str, Any]:
    """Return a front as data for JSON, in SI units."""
    return {
        "case": case.name, "overlap_allowed": not case.clear, "seed": case.seed,
        "seconds": round(seconds, 3),
        **record(front, "objectives", "dominated", "searches", "failed", "canceled"),
        "points": [
            {
                "values": point.values,
                "numbers": {p: point.result.design.value(p) for p in case.paths if "geometry" in p},
                "workspace_center_m": point.result.workspace.center,
                "buildability": buildability_data(point.result),
            }
            for point in front.points
        ],
    }  # fmt: skip


def buildability_data(result: SynthesisResult) -> dict[str, Any] | None:
    """Return whether the robot and the reference can be built, as data for JSON, in SI units."""
    if result.buildability is None:
        return None
    robot, reference = (one.data() for one in result.buildability)
    return {"robot": robot, "reference": reference}


def numbered(path: Path, number: int) -> Path:
    """Return the file of a point of a front."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


def bound_text(bound: Requirement | ObjectiveLimit) -> str:
    """Return a requirement or a limit as text."""
    if isinstance(bound, Requirement):
        return requirement_text(bound)
    objective = find_objective(bound.objective)
    sign = ">=" if objective.largest else "<="
    return f"{objective.key} {sign} {format_ascii(bound.most, objective.unit)}"
