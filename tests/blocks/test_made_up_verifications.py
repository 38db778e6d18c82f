"""Words, marks and data of verifications that are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import verification
from paminsa_viz.blocks.kinds import Figure
from paminsa_viz.engines.verification import Comparison, EngineCheck, Verification
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said


def compared(size: float, count: int = 2) -> Comparison:
    """Differences of two sizes for each actuator, over scales of their own."""
    off = size * np.array([[1.0, 2.0, 3.0, 4.0]] * (count - 1) + [[0.0] * 4])
    return Comparison(off, np.zeros_like(off), np.array([10.0, 20.0, 40.0, 500.0]))


def verified(**changes: Any) -> Any:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    check = EngineCheck("MuJoCo", "3.1", compared(1e-9), compared(2e-9))
    played = SimpleNamespace(
        until=motion.size, drift=np.arange(4.0 * motion.size).reshape(-1, 4) * 1e-5,
        stray=np.arange(float(motion.size)) * 1e-6,
        gap=np.array([1e-6, np.nan, 3e-6]),
    )  # fmt: skip
    values: dict[str, Any] = {
        "design": APPENDIX_4, "trajectory": motion, "poses": np.zeros((7, 4)), "tolerance": 1e-6,
        "engines": (check,), "missing": (), "wanted": motion, "played": played,
        "published": {Misprint.APP3_MC4: compared(0.1), Misprint.ALL: compared(0.2)},
    }  # fmt: skip
    return Verification(**values | changes)


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> None:
    drawings = [SimpleNamespace(title=title) for title in ("first", "other", "last")]
    monkeypatch.setattr(verification, "verification_figures", lambda found: drawings)


@pytest.mark.usefixtures("figures")
def test_formulas_beside_engines() -> None:
    found = verified()
    verdict, method, table, first, run, misprints, last = verification.verification_blocks(found)
    assert said([verdict]) == [
        ("Passed: the largest difference between the formulas and MuJoCo 3.1 is 2·10⁻¹⁰ of the "
         "actuator’s largest torque; 1·10⁻⁶ is allowed.", "ok"),
    ]  # fmt: skip
    assert "7 random poses at rest and 25 states" in method.text  # type: ignore
    assert [getattr(one, "alt", "").partition(":")[0] for one in (first, last)] == ["first", "last"]
    assert all(isinstance(one, Figure) for one in (first, last))
    rows = table.rows  # type: ignore
    assert [(row.cells[0], row.kind) for row in (rows[0], rows[5])] == [
        ("At rest", "group"), ("Moving", "group"),
    ]  # fmt: skip
    assert [row.color for row in rows[1:5]] == list(ACTUATOR_COLORS)
    rms = math.sqrt(0.5)
    for row, size, unit, scale in zip(
        rows[1:5], (1, 2, 3, 4), ("N·m",) * 3 + ("N",), (10, 20, 40, 500), strict=True
    ):
        assert row.cells[1] == f"{scale} {unit}"
        shown = [float(cell.partition("·10⁻")[0]) for cell in row.cells[2:]]
        relative = size / scale
        relative *= 10.0 ** -math.floor(math.log10(relative))
        roots = rms * size
        roots *= 10.0 ** -math.floor(math.log10(roots))
        assert shown[:3] == pytest.approx([size, roots, relative], rel=0.05)
    assert cells(misprints) == [
        (verification.MISPRINTS[Misprint.APP3_MC4], "0.01", "0.01", "0.0075", "0.0008"),
        (verification.MISPRINTS[Misprint.ALL], "0.02", "0.02", "0.015", "0.0016"),
    ]
    assert [row.kind for row in misprints.rows] == ["plain", "total"]  # type: ignore
    duration = found.wanted.t[-1] - found.wanted.t[0]
    text = said([run])[0][0]
    assert f"MuJoCo ran {duration:.3g} s (to the end)" in text
    assert "off by 0.96 mm in x, 0.97 mm in y, 0.056° in θ and 0.99 mm in z" in text
    assert text.endswith("loops opened by at most 3 µm.")
    data = verification.verification_data(found)
    assert data["simulation"]["stray_m"] == pytest.approx(2.4e-5)
    assert (data["static_poses"], data["dynamic_states"]) == (7, 25)
    assert data["engines"][0]["passed"]
    assert list(data["as_published"]) == ["APP3_MC4", "ALL"]


def test_the_verdict_of_a_verification_in_a_word() -> None:
    fact = verification.verification_fact(None)
    assert (fact.value, fact.note, fact.kind) == (NONE, "not done", "plain")
    wrong = EngineCheck("MuJoCo", "3.1", compared(1.23456), compared(1e-9))
    for found, word, kind, size in (
        (verified(), "passed", "ok", "2·10⁻¹⁰"),
        (verified(engines=(wrong,)), "failed", "bad", "0.12"),
    ):
        fact = verification.verification_fact(found)
        assert (fact.value, fact.kind) == (word, kind)
        assert fact.note == f"largest difference {size} of the largest torque"


def test_digits_of_differences_and_names_of_misprints(monkeypatch: pytest.MonkeyPatch) -> None:
    off = compared(1.23456)
    *_, relative, rms = (cell for cell in verification._rows("", off)[1].cells)
    assert verification._rows("", off)[1].cells[2:4] == ("1.2 N·m", "0.87 N·m")
    assert (relative, rms) == ("0.12", "0.087")
    misprints = verification._misprints(verified(published={Misprint.ALL: off}))
    assert cells(misprints)[0][1:] == ("0.12", "0.12", "0.093", "0.0099")
    assert verification.misprint_name(Misprint.APP3_MC4 | Misprint.EQ13_LEG_SPIN) == "ALL"
    later = SimpleNamespace(t=5.0 + np.arange(25.0), size=25)
    assert verification.verification_data(verified(wanted=later))["simulation"]["until_s"] == 24.0
    drawn: list[Any] = []
    monkeypatch.setattr(
        "paminsa_viz.plots.series_figure.render_series", lambda *a, **k: drawn.append((a, k))
    )
    verification._figure(SimpleNamespace(data="d", title="t"))  # type: ignore
    assert drawn == [(("d", "svg"), {"title": "t", "caption": False})]


@pytest.mark.usefixtures("figures")
def test_an_engine_that_differs_or_is_missing_and_a_robot_that_strayed() -> None:
    played = SimpleNamespace(**vars(verified().played) | {"until": 12})
    wrong = EngineCheck("Pinocchio", "2", compared(1.0), compared(1e-9))
    found = verified(
        engines=(*verified().engines, wrong), missing=("Pinocchio",), played=played,
    )  # fmt: skip
    verdict, _, one, two, *rest = verification.verification_blocks(found)
    assert said([verdict])[0][0].startswith("Failed: ")
    assert said([verdict])[0][1] == "bad"
    assert "MuJoCo 3.1 and Pinocchio 2" in said([verdict])[0][0]
    assert one.caption.startswith("Formulas and MuJoCo 3.1")  # type: ignore
    assert two.caption.startswith("Formulas and Pinocchio 2")  # type: ignore
    assert "Pinocchio is not installed" in said(rest)[0][0]
    run = said(rest)[1][0]
    assert f"ran {found.wanted.t[11] - found.wanted.t[0]:.3g} s (until it had strayed" in run
    assert "off by 0.44 mm in x" in run
    data = verification.verification_data(replace(found))
    assert [one["passed"] for one in data["engines"]] == [True, False]
    assert not data["simulation"]["complete"]
