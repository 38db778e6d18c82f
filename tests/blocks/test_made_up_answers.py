"""Words, marks and data of checks and answers that are made up: every case, no two numbers alike.

What a cell says follows from one field of the result, whatever a solver would find.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import proofs
from paminsa_viz.blocks import requirements as words
from paminsa_viz.blocks.answer_checks import (
    conflict_blocks,
    mujoco_blocks,
    price_blocks,
    yield_blocks,
)
from paminsa_viz.blocks.kinds import Note
from paminsa_viz.blocks.synthesis import (
    bound_label,
    bound_text,
    inner_blocks,
    lengths_table,
    outcomes_table,
    relaxed_blocks,
)
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck, MujocoRow
from paminsa_viz.synthesis.answer.prices import RequirementPrice
from paminsa_viz.synthesis.proof.evidence import Evidence, Proof, Verdict
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.search.case import UNLIMITED, ObjectiveLimit
from paminsa_viz.synthesis.search.case_conflict import CaseConflict
from paminsa_viz.synthesis.search.result import BoundOutcome, RelaxedBound
from paminsa_viz.synthesis.volume.check import Over
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said

# ------------------------------------------------------------------------------------ requirements

CONDITION = Requirement("condition", high=8.0)
TORQUE = Requirement("max_torque", high=15.0)
STIFF = Requirement("stiffness_x", low=2e4)
BOTH = Requirement("tau_1", low=-5.0, high=12.0)
PLACE = Workspace(WorkspaceShape.BOX, (0.2, 0.1, 0.3), (0.01, None, -0.5))


def checked(*items: Any, **changes: Any) -> Any:
    values: dict[str, Any] = {
        "items": items, "over": Over.WORKSPACE, "center": None, "volume": None,
        "holds": all(item.holds for item in items),
    }  # fmt: skip
    return SimpleNamespace(**values | changes)


def item(**changes: Any) -> Any:
    values: dict[str, Any] = {
        "label": "reach", "requirement": None, "holds": True, "reason": "", "value": 0.02,
        "margin": 0.012, "unit": "m", "pose": None,
    }  # fmt: skip
    return SimpleNamespace(**values | changes)


def test_verdicts_on_requirements() -> None:
    pose = (0.01, 0.02, 0.1, -0.5)
    found = checked(
        item(),
        item(requirement=1, holds=False, value=16.0, margin=-1.0, unit="N m", pose=pose),
        item(requirement=0, holds=False, reason="leg 1", value=9.0, margin=math.nan, unit="1"),
    )
    asked = Requirements((CONDITION, TORQUE), (-0.1, 0.2), PLACE)
    place, table, verdict_note = words.check_blocks(asked, found, text=lambda bound: bound.quantity)
    assert [row[:4] for row in cells(table)] == [
        ("reach", "holds", "20 mm", "12 mm"), ("max_torque", "broken", "16 N·m", "−1 N·m"),
        ("condition", "leg 1", "9", NONE),
    ]  # fmt: skip
    assert [row[4] == NONE for row in cells(table)] == [True, False, True]
    assert table.words == 2  # type: ignore
    for margin, told in ((0.0123956, "12.3 mm"), (-0.0123123, "−12.4 mm")):
        assert words.check_row(item(margin=margin), asked).cells[3] == told  # not better than it is
    assert [row.kind for row in table.rows] == ["plain", "marked", "marked"]
    assert "over the required workspace, from θ −5.73° to 11.46°" in table.caption
    assert said([place, verdict_note]) == [
        ("Required workspace: box 200 × 100 × 300 mm about x 10 mm, y free, z −500 mm.", "plain"),
        ("A requirement is broken.", "bad"),
    ]
    chosen = checked(item(), center=(0.01, 0.02, -0.5))
    blocks = words.check_blocks(asked, chosen)
    assert "y 20 mm" in blocks[0].text  # type: ignore
    assert said(blocks)[1] == ("All requirements hold.", "ok")
    assert len(words.check_blocks(replace(asked, workspace=None), chosen)) == 2
    data = words.check_data(APPENDIX_4, asked, found, None)
    assert [one["requirement"] for one in data["items"]] == [
        "reach", "max_torque <= 15 N m", "condition <= 8",
    ]  # fmt: skip
    # as values are in SI units, so are their names, also where people are shown micrometers
    assert [one["unit"] for one in data["items"]] == ["m", "N m", "1"]
    small = checked(item(unit="m:um"))
    assert words.check_data(APPENDIX_4, asked, small, None)["items"][0]["unit"] == "m"
    units = {one["unit"] for one in words.quantities_data().values()}
    assert {"m", "rad", "N/m"} <= units
    assert not any(":" in unit for unit in units)
    assert not {"volume", "conflict"} & data.keys()


def test_what_would_have_to_give_way() -> None:
    asked = Requirements((CONDITION, BOTH), (-0.1, 0.1), None)

    def relaxed(index: int, by: float | None, **sides: float) -> Any:
        bound = replace(asked.bounds[index], **sides) if sides else None
        return SimpleNamespace(requirement=index, relaxed=bound, by=by)

    def notes(requirements: Requirements, places: tuple[int, ...], *items: Any) -> list[str]:
        conflict: Any = SimpleNamespace(requirements=places, relaxations=items)
        blocks = words.conflict_notes(requirements, conflict, lambda bound: bound.quantity)
        return [block.text for block in blocks if isinstance(block, Note)]

    assert notes(
        asked, (0, 1), relaxed(0, 1.23456, high=9.23451), relaxed(1, 2.0, low=-7.00041),
        relaxed(1, None), relaxed(1, 3.0, low=-8.0, high=15.0), relaxed(1, None, low=-8.0),
    ) == [
        "No pose meets these together: condition; tau_1.",
        "condition: would do with at most 9.235 (moved by 1.23).",
        "tau_1: would do with at least −7.001 N·m (moved by 2 N·m).",
        "tau_1: no other bound of it helps while the others stay as they are.",
        "tau_1: would do with at least −8 N·m and at most 15 N·m (moved by 3 N·m).",
        "tau_1: no other bound of it helps while the others stay as they are.",
    ]  # fmt: skip
    alone = Requirements((CONDITION,), (-0.1, 0.1), None)
    assert notes(alone, (0,), relaxed(0, None))[1:] == ["condition: no other bound of it helps."]
    placed = replace(asked, workspace=PLACE)
    assert notes(placed, (0,)) == ["No place of the workspace meets condition."]
    for requirements, what in ((asked, "No pose"), (placed, "No place for the workspace")):
        assert notes(requirements, ()) == [
            f"{what} can be reached with every heading, whatever the bounds."
        ]
    conflict: Any = SimpleNamespace(
        requirements=(0,), relaxations=(relaxed(0, None), relaxed(1, 2.0, low=-7.0))
    )
    data = words.check_data(APPENDIX_4, asked, checked(item()), conflict)["conflict"]
    assert [(one["low"], one["high"]) for one in data["relaxations"]] == [
        (None, None),
        (-7.0, 12.0),
    ]


@pytest.mark.parametrize("value", [0.0, 1.0, -1.0, 123456.0, -0.00123456, 9.9999])
def test_a_relaxed_bound_is_rounded_to_the_side_on_which_it_helps(value: float) -> None:
    unit = Requirement("max_torque", high=1.0).entry.display
    for up, side in ((False, -1.0), (True, 1.0)):
        text = unit.format(value, up=up).removesuffix(" N·m").replace("−", "-")
        mantissa, _, power = text.partition("·10")
        scale = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))) if power else 0
        shown = float(mantissa) * 10.0**scale
        assert 0.0 <= side * (shown - value) <= 1.001e-3 * abs(value)
    stiff = Requirement("stiffness_x", low=1.0).entry.display
    assert stiff.format(12345.6, up=False) == "12.34 N/mm"


def test_a_worst_value_and_its_margin_never_read_as_better_than_they_are() -> None:
    """In the check, in the proof and of the best robot; the verdict is that of the number told."""
    asked = Requirements((CONDITION, STIFF, BOTH), (-0.1, 0.2), PLACE)
    proof: Any = SimpleNamespace()
    for index, value, told in (
        (0, 8.00004, "8.001"), (0, 7.99996, "8"), (0, 7.12341, "7.124"), (1, 19999.6, "19.99 N/mm"),
        (1, 20000.4, "20 N/mm"), (2, 12.0001, "12.01 N·m"), (2, -5.00004, "−5.001 N·m"),
    ):  # fmt: skip
        bound = asked.bounds[index]
        margin = float(bound.margin(value))
        checking = item(requirement=index, value=value, margin=margin, holds=margin >= 0.0)
        assert words.check_row(checking, asked).cells[2] == told
        if bound is not BOTH:
            proof.evidence = [Evidence.of(bound, Method.BISECTION, Verdict.UNDECIDED, margin)]
            assert cells(proofs.evidence_table(proof))[0][3] == told
        outcome = BoundOutcome(bound, value, margin, False)
        result: Any = SimpleNamespace(outcomes=(outcome,))
        assert cells(outcomes_table(result))[0][2] == told
    near: Any = SimpleNamespace(outcomes=(BoundOutcome(CONDITION, 7.12341, 0.87659, False),))
    assert cells(outcomes_table(near))[0][3] == "0.8765"
    proof.evidence = [Evidence("reach", Method.CLOSED_FORM, Verdict.PROVEN, 0.0123456)]
    assert cells(proofs.evidence_table(proof))[0][3] == "12.34 mm"


def test_what_a_proof_rests_on() -> None:
    pose = (0.01, 0.02, 0.1, -0.5)
    evidence = (
        Evidence("reach", Method.CLOSED_FORM, Verdict.PROVEN, 0.003),
        Evidence("home", Method.CLOSED_FORM, Verdict.PROVEN),
        Evidence.of(CONDITION, Method.SAMPLED, Verdict.SAMPLED, 1.5),
        Evidence.of(TORQUE, Method.BISECTION, Verdict.PROVEN, 2.0),
        Evidence.of(STIFF, Method.BISECTION, Verdict.PROVEN, 1000.0),
        Evidence.of(STIFF, Method.BISECTION, Verdict.UNDECIDED, -500.0),
        Evidence.of(BOTH, Method.BISECTION, Verdict.REFUTED, -0.5, np.array(pose)),
    )
    proof: Any = SimpleNamespace(
        evidence=evidence, verdict=Verdict.REFUTED, sampled=(CONDITION,), pose=pose, boxes=12345,
        seconds=1.25, remaining=np.zeros((1234, 2, 4)),
    )  # fmt: skip
    table = proofs.evidence_table(proof, lambda bound: bound.quantity)
    assert [(row[0], row[1], row[3]) for row in cells(table)] == [
        ("reachable: margin to every limit", "proven", "3 mm"),
        ("joined to home", "proven", ""),
        ("condition", "holds at samples", "6.5"),
        ("max_torque", "proven", "≤ 13 N·m"),
        ("stiffness_x", "proven", "≥ 21 N/mm"),
        ("stiffness_x", "undecided", "19.5 N/mm"),
        ("tau_1", "refuted", "margin −0.5 N·m"),
    ]
    assert [row.level for row in table.rows] == ["ok", "ok", "warn", "ok", "ok", "bad", "bad"]
    assert table.words == 3
    region = SimpleNamespace(
        shape=WorkspaceShape.BOX, center=(0.1, 0.2, 0.3), theta=(-0.1, 0.2), half=(0.4, 0.5, 0.6)
    )
    whole: Any = Proof(Verdict.REFUTED, region, evidence, boxes=7, seconds=1.5)  # type: ignore
    data = proofs.proof_data(whole)
    units = [one["unit"] for one in data["evidence"]]
    assert units == ["m", "m", "1", "N m", "N/m", "N/m", "N m"]
    assert (data["size_m"], data["center_m"]) == ([0.8, 1.0, 1.2], (0.1, 0.2, 0.3))
    assert [one["requirement"] for one in data["evidence"]] == [
        "reach", "home", "condition <= 8", "max_torque <= 15 N m", "stiffness_x >= 20 N/mm",
        "stiffness_x >= 20 N/mm", "-5 <= tau_1 <= 12 N m",
    ]  # fmt: skip
    for workspace, broken in ((PLACE, TORQUE), (None, None)):
        found: Any = SimpleNamespace(
            workspace=workspace, requirement=broken, proof=whole, gap=0.01, limit=(1.0, 2.0, 3.0),
            cause="max_torque", pose=pose, boxes=99, seconds=9.5,
        )  # fmt: skip
        data = proofs.largest_data(APPENDIX_4, found)
        assert data["found"] == (workspace is not None)
        assert data["broken"] == (broken and "max_torque <= 15 N m")
        assert (data["boxes"], data["seconds"], data["gap_m"]) == (99, 9.5, 0.01)
    asked = Requirements((CONDITION,), (-0.1, 0.2), PLACE)
    notes = said(proofs.proof_blocks(asked, proof))
    assert notes[0][0].startswith("Requirements over the box 200 × 100 × 300 mm about x 10 mm, ")
    assert notes[0][0].endswith("θ −5.73° to 11.46°: refuted")
    one = proofs.proof_blocks(replace(asked, theta=(0.1, 0.1)), proof)
    assert said(one)[0][0].endswith(", θ 5.73°: refuted")
    assert notes[0][1] == "bad"
    assert notes[1][0].startswith("broken at x 10 mm")
    assert notes[2][0] == "12,345 boxes, 1.2 s; 1,234 open"
    proven = SimpleNamespace(**vars(proof) | {"verdict": Verdict.PROVEN, "pose": None})
    notes = said(proofs.proof_blocks(asked, proven))  # type: ignore
    assert len(notes) == 2
    for remaining, advice in ((proof.remaining, ["more"]), ([], [])):  # a path is no matter of time
        changes = {"verdict": Verdict.UNDECIDED, "pose": None, "remaining": remaining}
        undecided: Any = SimpleNamespace(**vars(proof) | changes)
        blocks = proofs.proof_blocks(asked, undecided, advice="more")
        assert [note for note, _ in said(blocks)[2:]] == advice
    assert notes[0][0].endswith("proven, but for requirements that are only sampled")
    assert notes[0][1] == "ok"
    whole: Any = SimpleNamespace(**vars(proven) | {"sampled": ()})
    assert proofs.verdict_text(whole) == "proven"


def test_requirements_of_a_report_are_checked_finely_and_the_largest_workspace_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def check(design: Any, requirements: Any, *, fine: bool, volume: Any) -> Any:
        asked.append((fine, volume))
        return checked(item())

    def largest(design: Any, requirements: Any, *, time_limit: float) -> Any:
        raise InvalidInput("workspace", "there is none")

    monkeypatch.setattr(words, "solve_volume", lambda design, requirements: "volume")
    monkeypatch.setattr(words, "check_requirements", check)
    monkeypatch.setattr(words, "largest_workspace", largest)
    for bounds, place, tried in (
        ((CONDITION,), PLACE, True), ((CONDITION,), None, False), ((), PLACE, False),
        ((), None, False),
    ):  # fmt: skip
        blocks = words.requirements_blocks(APPENDIX_4, Requirements(bounds, (-0.1, 0.2), place))
        kinds = [kind for text, kind in said(blocks) if text.startswith("The largest workspace")]
        assert kinds == ["warn"] * tried
    assert asked == [(True, "volume")] * 4
    table = words.quantities_table()
    assert table.words == 3


def test_the_largest_workspace_and_what_ends_it() -> None:
    asked = Requirements((CONDITION,), (-0.1, 0.2), PLACE)
    proof: Any = SimpleNamespace(verdict=Verdict.UNDECIDED, evidence=(), sampled=())
    found = SimpleNamespace(
        workspace=None, proof=proof, cause="home", requirement=None, pose=None, gap=0.0123,
        limit=(0.4, 0.2, 0.6), boxes=1500, seconds=2.25,
    )  # fmt: skip

    def text(**changes: Any) -> list[tuple[str, str]]:
        one: Any = SimpleNamespace(**vars(found) | changes)
        blocks = proofs.largest_blocks(asked, one, lambda bound: bound.quantity)
        return said(blocks)

    begin = "Largest workspace: "
    refuted = SimpleNamespace(**vars(proof) | {"verdict": Verdict.REFUTED})
    pose = (0.01, 0.02, 0.1, -0.5)
    assert text() == [(f"{begin}undecided: no path from home to its center", "bad")]
    assert text(proof=refuted, cause="volume") == [
        (f"{begin}none: no position meets all requirements", "bad")
    ]
    others = "about every other center that was tried a requirement breaks as well"
    assert text(proof=refuted, cause="reach")[1:] == [(others, "plain")]
    assert len(text(proof=refuted, cause="home")) == 1
    given = replace(asked, workspace=replace(PLACE, center=(0.0, 0.0, -0.5)))
    one: Any = SimpleNamespace(**vars(found) | {"proof": refuted, "cause": "reach"})
    assert len(proofs.largest_blocks(given, one)) == 1
    longer = ("more time may decide it", "plain")
    assert text(cause="") == [(f"{begin}undecided", "bad"), longer]
    assert text(cause="reach")[0][0].endswith(": reach")
    broken = text(cause="condition", requirement=TORQUE, pose=pose)[0][0]
    assert ": max_torque breaks at x 10 mm" in broken
    notes = text(workspace=PLACE, cause="reach")
    assert notes[0] == (
        "Largest proven workspace: box 200 × 100 × 300 mm about x 10 mm, y free, "
        "z −500 mm, θ −5.73° to 11.46°", "ok",
    )  # fmt: skip
    assert notes[1][0].startswith("gap 12.3 mm to box 400 × 200 × 600 mm about x 10 mm")
    assert notes[2:] == [("1,500 boxes, 2.2 s", "plain")]
    uneven = replace(PLACE, size=(0.29905, 0.10002, 0.398789))
    notes = text(workspace=uneven, limit=(0.30002, 0.10002, 0.400012))
    assert notes[0][0].startswith("Largest proven workspace: box 299 × 100 × 398.7 mm about")
    assert notes[1][0].startswith("gap 12.3 mm to box 300.1 × 100.1 × 400.1 mm about")
    assert text(workspace=PLACE, boxes=1)[2][0] == "1 box, 2.2 s"
    sampled = SimpleNamespace(**vars(proof) | {"sampled": (CONDITION,)})
    head, kind = text(workspace=PLACE, proof=sampled)[0]
    assert head.startswith("Largest workspace by proof and samples: box 200")
    assert kind == "warn"
    assert text(workspace=PLACE, proof=sampled)[3] == (
        "what is only sampled is not proven: a pose between samples may break it, whatever the gap",
        "warn",
    )  # fmt: skip


# --------------------------------------------------------------------------------------- synthesis

RADIUS = ObjectiveLimit("footprint", 0.578)
VOLUME = ObjectiveLimit("volume", 0.02)


def answer(**changes: Any) -> Any:
    case = SimpleNamespace(objective="footprint")
    return SimpleNamespace(**{"case": case, "objective": 0.6, "inner": None} | changes)


def test_bounds_and_limits_as_text() -> None:
    assert bound_label(RADIUS) == "footprint radius ≤ 578 mm"
    assert bound_label(VOLUME).endswith("≥ 0.02 m³")
    assert bound_text(RADIUS) == "footprint <= 578 mm"
    assert bound_text(VOLUME).startswith("volume >= 0.02")
    assert (bound_label(TORQUE), bound_text(TORQUE)) == ("max |τ| ≤ 15 N·m", "max_torque <= 15 N m")


def test_how_an_answer_meets_its_bounds() -> None:
    outcomes = (
        BoundOutcome(TORQUE, 14.5, 0.5, False), BoundOutcome(RADIUS, 0.578, 0.0, True),
        BoundOutcome(CONDITION, 9.0, -1.0, False), BoundOutcome(STIFF, math.nan, math.nan, False),
    )  # fmt: skip
    free = (ObjectiveLimit("moving_mass", UNLIMITED), ObjectiveLimit("volume", -UNLIMITED))
    values = tuple(BoundOutcome(one, 0.03, one.margin(0.03), False) for one in free)
    table = outcomes_table(answer(outcomes=(*outcomes, *values)))
    assert [row[1:] for row in cells(table)] == [
        ("", "14.5 N·m", "0.5 N·m"), ("active", "578 mm", "0 mm"), ("", "9", "−1"),
        ("", NONE, NONE),
    ]  # fmt: skip
    assert [row.level for row in table.rows] == ["ok", "ok", "bad", "none"]
    assert table.words == 2


def test_prices_are_changes_of_the_objective() -> None:
    prices = [
        RequirementPrice("κ", "", 8.0, 0.16, 0.62, 0.5902345, 0.1),
        RequirementPrice("F", "N", 450.0, 9.0, 0.65, math.nan, 0.004),
    ]
    (table,) = price_blocks(answer(), prices)
    assert cells(table) == [
        ("κ", "8", "0.16", "−9.77 mm", "20 mm", "0.1 m per 1"),
        ("F", "450 N", "9 N", NONE, "50 mm", "0.004 m per N"),
    ]
    assert len(said(price_blocks(answer(), []))) == 1


def test_what_is_relaxed_is_listed_where_that_helps() -> None:
    helps = RelaxedBound(TORQUE, 15.42123, 0.0281)
    none = RelaxedBound(CONDITION, math.nan, math.nan)
    lower = RelaxedBound(TORQUE, 14.25, -0.05)
    (table,) = relaxed_blocks(answer(relaxed=(none, helps, lower)))
    assert cells(table) == [
        ("max |τ| ≤ 15 N·m", "15.43 N·m", "+2.81 %"), ("max |τ| ≤ 15 N·m", "14.25 N·m", "−5 %"),
    ]  # fmt: skip
    limits = (RelaxedBound(RADIUS, 0.60012, 0.04), RelaxedBound(VOLUME, 0.0188888, -0.06))
    (table,) = relaxed_blocks(answer(relaxed=limits))
    assert [row[1].split()[0] for row in cells(table)] == ["600.2", "0.01888"]
    assert len(said(relaxed_blocks(answer(relaxed=(none,))))) == 1
    assert relaxed_blocks(answer(relaxed=())) == []


def test_robots_built_to_an_answer() -> None:
    fraction = SimpleNamespace(low=0.91, high=0.987, confidence=0.95, passed=96, samples=100)
    missed = {"reach": 3, "κ": 1}
    built: Any = SimpleNamespace(fraction=fraction, missed=missed)
    note, table = yield_blocks(built)
    assert said([note])[0][0] == (
        "Built within tolerances: 96 of 100 robots meet all requirements, 91.0 to 98.7 % of all "
        "with 95 % confidence."
    )
    assert cells(table) == [("reach", "3"), ("κ", "1")]
    fraction.passed = 1
    assert "1 of 100 robots meets all" in said(yield_blocks(built))[0][0]
    assert len(yield_blocks(SimpleNamespace(fraction=fraction, missed={}))) == 1  # type: ignore


def test_an_engine_confirms_an_answer_or_not() -> None:
    rows = (MujocoRow("a", "N", 3, 1.0, 2.0, True), MujocoRow("b", "m", 3, 1.0, -0.002, False))
    note, table, left = mujoco_blocks(MujocoCheck("3.1", rows, ("condition", "reach"), 1e-12))
    assert said([note, left]) == [
        ("MuJoCo 3.1 does NOT confirm it; torques differ by 1·10⁻¹² of the largest.", "bad"),
        ("Without a meaning in MuJoCo: condition, reach.", "plain"),
    ]  # fmt: skip
    assert cells(table) == [("yes", "a", "2 N"), ("no", "b", "−2 mm")]
    assert [row.kind for row in table.rows] == ["plain", "marked"]  # type: ignore
    assert table.words == 2  # type: ignore
    (note, _) = mujoco_blocks(MujocoCheck("3.1", rows[:1], (), 1e-12))
    assert said([note])[0][0].startswith("MuJoCo 3.1 confirms it")
    assert said([note])[0][1] == "ok"
    assert said(mujoco_blocks("missing")) == [("MuJoCo has not checked it: missing", "warn")]


def test_requirements_of_a_case_that_contradict() -> None:
    items = (TORQUE, RADIUS)
    for proven, how in ((True, "proven in closed form"), (False, "by searches that found no")):
        (table,) = conflict_blocks(CaseConflict(items, proven, 3, False))
        assert cells(table) == [("max |τ| ≤ 15 N·m",), ("footprint radius ≤ 578 mm",)]
        assert how in table.caption  # type: ignore
    assert said(conflict_blocks(CaseConflict((), True, 0, False)))[0][1] == "bad"


def test_masses_and_springs_of_an_answer() -> None:
    weight = SimpleNamespace(place="B3", mass=0.75)
    spring = SimpleNamespace(
        first=SimpleNamespace(name="A"), second=SimpleNamespace(name="B"), stiffness=1234.0,
        free_length=0.05,
    )  # fmt: skip
    active = [
        SimpleNamespace(name=name, side="at most", bound=2.0, unit="kg", price=price)
        for name, price in (("m", 0.5), ("free", 0.0))
    ]
    inner = SimpleNamespace(
        design=SimpleNamespace(counterweights=(weight,)), springs=(spring,), active=active, gap=0.01
    )
    (table,) = inner_blocks(answer(inner=inner))
    assert cells(table) == [
        ("counterweight on B3", "0.75 kg"),
        ("spring from A to B", "1.234 N/mm, free length 50 mm"),
        ("m, at most 2 kg", "price 0.5 per kg"),
    ]
    assert table.words == 2  # type: ignore
    assert inner_blocks(answer()) == []


def test_lengths_that_changed() -> None:
    after = APPENDIX_4.vary({"geometry.guide_link_length": 0.4, "links.b1": 1.5})
    assert [row[3:] for row in cells(lengths_table(APPENDIX_4, after))] == [
        ("363.5", "400", "+10.0 %"), ("1.221", "1.5", "+22.9 %"),
    ]  # fmt: skip
    (only,) = cells(lengths_table(APPENDIX_4, after, "links"))
    assert only[2:4] == ("links.b1", "1.221")
