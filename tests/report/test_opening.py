"""What a report opens with, the order of its work, and the page of the claims."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

import pytest

from paminsa_viz.balancing import whole_mass
from paminsa_viz.blocks.balance import mass_facts
from paminsa_viz.blocks.kinds import Fact
from paminsa_viz.blocks.trajectory import trajectory_facts
from paminsa_viz.blocks.verification import verification_fact
from paminsa_viz.cli.report import Report
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.report import claims, claims_page, page
from paminsa_viz.report.claim import Claim, MeasuredClaim
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import NONE

TIME = datetime(2026, 1, 2, 3, 4, tzinfo=UTC)
MOTION = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)


def request(**changes: Any) -> ReportRequest:
    values: dict[str, Any] = {
        "design": APPENDIX_4, "trajectory": MOTION, "pose": (0.0, 0.0, 0.1, -0.5),
        "made": TIME, "command": "report",
    }  # fmt: skip
    return ReportRequest(**values | changes)


def claim(page_: str, text: str, allowed: float = 0.5) -> Claim:
    return Claim(page_, text, "check", "m", allowed, lambda: 0.1)


def made(passed: bool) -> Any:
    return SimpleNamespace(
        passed=passed, worst=1.5e-13, design=APPENDIX_4, trajectory=MOTION,
    )  # fmt: skip


def opening(analysis: Any, found: Any) -> dict[str, Fact]:
    facts = [*mass_facts(APPENDIX_4), *trajectory_facts(analysis), verification_fact(found)]
    return {fact.label: fact for fact in facts}


def test_a_report_from_python_is_that_of_the_command() -> None:
    assert (ReportRequest.verified, ReportRequest.seed) == (Report.verify, Report.seed)


def test_numbers_that_a_report_opens_with() -> None:
    loads = [SimpleNamespace(peak=peak) for peak in (-4.0, 3.0, -2.0, -250.0)]
    shown: Any = SimpleNamespace(summary=loads, failure=None)
    facts = opening(shown, made(True))
    assert facts["Moving mass"].value == f"{whole_mass(APPENDIX_4):.2f} kg"
    assert (facts["Peak torque"].value, facts["Peak force"].value) == ("4 N·m", "250 N")
    assert "Trajectory" not in facts
    assert (facts["Verification"].value, facts["Verification"].kind) == ("passed", "ok")
    assert facts["Verification"].note.startswith("largest difference 1.5·10⁻¹³ of")
    found = opening(shown, made(False))
    assert (found["Verification"].value, found["Verification"].kind) == ("failed", "bad")
    none: Any = SimpleNamespace(summary=[], failure=object())
    facts = opening(none, None)
    assert (facts["Peak torque"].value, facts["Peak force"].value) == (NONE, NONE)
    assert facts["Trajectory"].kind == "bad"
    assert (facts["Verification"].value, facts["Verification"].note) == (NONE, "not done")


def test_a_report_is_made_step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """All that is asked for, in the order of the steps; nothing of what is not."""

    def section(name: str, blocks: bool = True) -> Any:
        return SimpleNamespace(key=name, title=name, blocks=(1,) if blocks else ())

    names = [name for name in vars(page) if name.endswith("_section")]
    for name in names:
        kept = name != "loads_section"
        monkeypatch.setattr(page, name, lambda *a, n=name, k=kept: section(n, k))
    monkeypatch.setattr(page, "checked", lambda request: "not done")
    monkeypatch.setattr(page, "investigate", lambda log, design: None)
    rendered: list[dict] = []
    monkeypatch.setattr(
        page, "template", lambda: SimpleNamespace(render=lambda **k: rendered.append(k) or "html")
    )
    steps: list[tuple[float, str]] = []

    def watch(done: float, *, step: str) -> None:
        steps.append((done, step))

    assert page.report_html(request(), watch) == "html"
    usual, optional = list(steps), {"requirements", "synthesis", "calibration", "identification"}
    shown = [one.key for _, one in rendered[0]["sections"]]
    assert "loads_section" not in shown  # which has no blocks
    absent = {f"{name}_section" for name in (*optional, "loads")}
    assert set(shown) == set(names) - absent
    assert [number for number, _ in rendered[0]["sections"]] == list(range(1, len(shown) + 1))
    steps.clear()
    whole = request()
    for name in ("requirements", "synthesis", "measured", "log"):
        object.__setattr__(whole, name, object())
    page.report_html(whole, watch)
    assert len(steps) == len(names) == len(usual) + len(optional)  # one a section
    assert [step for _, step in steps if step not in optional] == [step for _, step in usual]
    for told in (usual, steps):
        assert [done for done, _ in told] == pytest.approx(
            [place / len(told) for place in range(len(told))]
        )
    assert {one.key for _, one in rendered[1]["sections"]} == set(names) - {"loads_section"}


def test_a_pose_of_a_report_has_four_numbers() -> None:
    for pose in ((0.0, 0.0, 0.1), (0.0, 0.0, 0.1, -0.5, 0.0)):
        with pytest.raises(InvalidInput, match=f"four numbers are needed, not {len(pose)}"):
            request(pose=pose)


def test_the_page_of_the_claims_says_how_many_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    rendered: list[dict] = []
    monkeypatch.setattr(
        claims_page, "template",
        lambda: SimpleNamespace(render=lambda **k: rendered.append(k) or "html"),
    )  # fmt: skip
    monkeypatch.setattr(claims_page, "verification_section", lambda found: found)
    right = [MeasuredClaim(claim("a.md", "one"), 0.1), MeasuredClaim(claim("b.md", "two"), -0.2)]
    wrong = MeasuredClaim(claim("a.md", "three"), 0.7)
    for measured, value, kind in (
        (right, "2 of 2 hold", "ok"), ([*right, wrong], "2 of 3 hold", "bad"),
        ([right[0], wrong], "1 of 2 holds", "bad"),
    ):  # fmt: skip
        assert claims_page.claims_html(made(kind == "ok"), measured, TIME) == "html"
        facts = rendered[-1]["opening"]
        assert (facts[0].value, facts[0].kind) == (value, kind)
        assert facts[1].value == ("passed" if kind == "ok" else "failed")
        assert facts[1].kind == kind
        assert [number for number, _ in rendered[-1]["sections"]] == [1, 2]
        count, verb = value.split(" of ")[0], value.split()[-1]
        holding = claims_page.holding_text(measured)
        assert holding == f"{count} of {len(measured)} claims of the documentation {verb}"
    data = claims_page.claims_data([*right, wrong])
    assert [one["holds"] for one in data] == [True, True, False]
    assert (data[2]["measured"], data[2]["page"], data[2]["claim"]) == (0.7, "a.md", "three")
    table: Any = claims_page.claims_section([*right, wrong]).blocks[-1]
    assert [(row.kind, row.cells[0]) for row in table.rows] == [
        ("group", "a.md"), ("plain", "one"), ("marked", "three"), ("group", "b.md"),
        ("plain", "two"),
    ]  # fmt: skip
    assert [row.cells[-1] for row in table.rows if row.kind != "group"] == [
        "holds", "FAILS", "holds",
    ]  # fmt: skip
    assert table.rows[1].cells[2:5] == ("0.1 m", "0", "± 0.5 m")


def test_single_figures_have_two_digits_and_stated_ones_four() -> None:
    stated = replace(claim("a.md", "one", 0.12345), stated=3.14159)
    shown = claims_page._single(MeasuredClaim(stated, 3.151515))
    assert shown == ("one", "check", "3.152 m", "3.142 m", "± 0.12 m")
    about = claims_page._single(MeasuredClaim(claim("a.md", "one", 0.12345), 0.98765))
    assert about == ("one", "check", "0.99 m", "0", "± 0.12 m")


def test_claims_are_measured_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(claims, "CLAIMS", (claim("a.md", "one"), claim("b.md", "two")))
    found = claims.measured_claims()
    assert next(found).claim.text == "one"
    assert [(one.claim.text, one.value) for one in found] == [("two", 0.1)]
