"""What ``paminsa-viz synthesize`` says besides the answer: prices, tolerances, MuJoCo, fronts."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.synthesis import buildability_blocks
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.output import print_blocks, print_table
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


def print_checks(result: SynthesisResult, found: AnswerChecks) -> None:
    """Print them, for people, and the masses and springs that were chosen."""
    _print_inner(result)
    objective = find_objective(result.case.objective)
    if found.prices is not None:
        print(f"\nwhat requirements cost, by the search again near the answer ({objective.label}):")
        rows: list[tuple[str, ...]] = [
            ("requirement", "is", "tightened by", "", "relaxed", "price")
        ]
        for p in found.prices:
            ends = [_number(v, objective.unit) for v in (p.tightened, p.relaxed)]
            price = f"{p.price:.4g} {objective.unit or '1'} per {p.unit or '1'}"
            amounts = format_ascii(p.bound, p.unit), format_ascii(p.step, p.unit)
            rows.append((p.label, *amounts, *ends, price))
        print_table(rows, indent=2)
    if found.built is not None:
        part = found.built.fraction
        print(
            f"\nbuilt within tolerances: {part.passed} of {part.samples} robots meet all "
            f"requirements, {PERCENT * part.low:.1f} to {PERCENT * part.high:.1f} % of all with "
            f"{PERCENT * part.confidence:.0f} % confidence"
        )
        for name, count in found.built.missed.items():
            print(f"  {count} miss: {name}")
    if isinstance(found.mujoco, str):
        print(f"\nMuJoCo has not checked it: {found.mujoco}")
    elif found.mujoco is not None:
        check = found.mujoco
        verdict = "confirms" if check.passed else "does NOT confirm"
        print(
            f"\nMuJoCo {check.version} {verdict} it; torques differ by {check.difference:.1e} of "
            f"the largest"
        )
        for row in check.rows:
            margin = format_ascii(row.engine, row.unit)
            print(f"  {'ok' if row.met else 'no'}  {row.label}: margin {margin}")
        if check.left_out:
            print(f"  without a meaning in MuJoCo: {', '.join(check.left_out)}")
    if found.conflict is not None:
        _print_conflict(found.conflict)


def _print_inner(result: SynthesisResult) -> None:
    if result.inner is None:
        return
    inner = result.inner
    print(
        f"\nmasses and springs for these lengths are the best; others are better by "
        f"{inner.gap:.2g} at most"
    )
    for weight in inner.design.counterweights:
        print(f"  counterweight of {format_ascii(weight.mass, 'kg')} on {weight.place}")
    for spring in inner.springs:
        print(
            f"  spring from {spring.first.name} to {spring.second.name}: "
            f"{format_ascii(spring.stiffness, 'N/m')}, free length "
            f"{format_ascii(spring.free_length, 'm')}"
        )
    for item in inner.active:
        if item.price > 0:
            print(
                f"  {item.name}, {item.side} {item.bound:.6g} {item.unit}: price "
                f"{item.price:.4g} per {item.unit}"
            )


def _print_conflict(found: CaseConflict) -> None:
    if not found.items:
        print("\nthe workspace is out of reach within the ranges, whatever else is required")
        return
    how = "proven in closed form" if found.proven else "by searches that found no robot"
    print(f"\nwithin the ranges these contradict, {how}:")
    for item in found.items:
        print(f"  {bound_text(item)}")


def _number(value: float, unit: str) -> str:
    return "-" if value != value else format_ascii(value, unit)


def checks_data(result: SynthesisResult, found: AnswerChecks) -> dict[str, Any]:
    """Return them as data for JSON, in SI units."""
    data: dict[str, Any] = {}
    if result.inner is not None:
        inner = result.inner
        data["inner"] = {
            "goal": inner.goal, "value": inner.objective, "lower_bound": inner.lower_bound,
            "counterweights": [
                {"place": w.place, "mass_kg": w.mass} for w in inner.design.counterweights
            ],
            "springs": [
                {
                    "first": s.first.name, "second": s.second.name,
                    "stiffness_N_per_m": s.stiffness, "free_length_m": s.free_length,
                }
                for s in inner.springs
            ],
            "active": [vars(item) for item in inner.active],
        }  # fmt: skip
    if found.prices is not None:
        data["prices"] = [vars(item) for item in found.prices]
    if found.built is not None:
        data["built"] = {
            **vars(found.built.fraction), "missed": found.built.missed, "worst": found.built.worst
        }  # fmt: skip
    if isinstance(found.mujoco, str):
        data["mujoco"] = {"passed": None, "reason": found.mujoco}
    elif found.mujoco is not None:
        check = found.mujoco
        data["mujoco"] = {
            "version": check.version, "passed": check.passed, "difference": check.difference,
            "rows": [vars(row) for row in check.rows], "left_out": check.left_out,
        }  # fmt: skip
    if found.conflict is not None:
        data["conflict"] = {
            "items": [bound_text(item) for item in found.conflict.items],
            "proven": found.conflict.proven,
        }
    return data


def print_front(case: SynthesisCase, front: DesignFront, seconds: float) -> None:
    """Print a front, for people."""
    entries = [find_objective(name) for name in front.objectives]
    print(
        f"{case.name}: {len(front.points)} robots of which none is better in all, by "
        f"{front.searches} searches in {seconds:.1f} s, seed {case.seed}; {front.dominated} "
        f"dominated, {front.failed} without a robot"
    )
    paths = [path for path in case.paths if path.startswith("geometry.")]
    rows = [("", *(e.label for e in entries), *(p.partition(".")[2] for p in paths))]
    for number, point in enumerate(front.points, 1):
        values = [format_ascii(v, e.unit) for v, e in zip(point.values, entries, strict=True)]
        lengths = [f"{point.result.design.value(path):.4g}" for path in paths]
        rows.append((str(number), *values, *lengths))
    print_table(rows)
    for number, point in enumerate(front.points, 1):
        print(f"\nrobot {number}")
        print_blocks(buildability_blocks(point.result))


def front_data(case: SynthesisCase, front: DesignFront, seconds: float) -> dict[str, Any]:
    """Return a front as data for JSON, in SI units."""
    return {
        "case": case.name, "overlap_allowed": not case.clear, "seed": case.seed,
        "seconds": round(seconds, 3), "objectives": front.objectives, "dominated": front.dominated,
        "searches": front.searches, "failed": front.failed, "canceled": front.canceled,
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
