"""The documentation's claims hold, are in the pages they name, and fail where the formulas do."""

from __future__ import annotations

import json
import re
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from paminsa_viz.blocks.kinds import Figure
from paminsa_viz.cli import main
from paminsa_viz.model.lumped import Misprint, lumped_coefficients
from paminsa_viz.report import claims, worked_claims
from paminsa_viz.report.claim import Claim, MeasuredClaim
from paminsa_viz.report.claims import CLAIMS
from paminsa_viz.report.claims_page import claims_section
from tests.support.commands import write_short_motion

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


def page_of(claim: Claim) -> Path:
    return ROOT / ("." if claim.page == "README.md" else "docs") / claim.page


class Written(NamedTuple):
    """What the command that measures all claims has returned, printed and written."""

    code: int
    printed: dict[str, Any]
    path: Path


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory, mujoco: Any) -> Written:
    folder = tmp_path_factory.mktemp("verify")
    motion, report = folder / "motion.csv", folder / "claims.html"
    write_short_motion(motion)
    words = f"verify --poses 9 --file {motion} --report {report} --json"
    with redirect_stdout(StringIO()) as printed, pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "svg", b"")  # `verify --figures` is tested to draw the same
        code = main(words.split())
    return Written(code, json.loads(printed.getvalue()), report)


@pytest.mark.parametrize("claim", [pytest.param(one, id=one.text) for one in CLAIMS])
def test_claim_holds(claim: Claim, written: Written) -> None:
    (measured,) = (one for one in written.printed["claims"] if one["claim"] == claim.text)
    assert measured["holds"], measured


def test_report_has_every_claim_with_its_figure(written: Written) -> None:
    assert written.code == 0
    assert written.printed["files"] == [str(written.path)]
    assert [one["claim"] for one in written.printed["claims"]] == [one.text for one in CLAIMS]
    text = written.path.read_text(encoding="utf-8")
    assert text.count("<td>holds</td>") + text.count(">holds<") >= len(CLAIMS)
    assert "FAILS" not in text
    assert f"{len(CLAIMS)} of {len(CLAIMS)} hold" in text


@pytest.mark.parametrize("claim", [pytest.param(one, id=one.text) for one in CLAIMS if one.stated])
def test_stated_figure_is_on_its_page(claim: Claim) -> None:
    text = page_of(claim).read_text(encoding="utf-8")
    for figure in np.atleast_1d(claim.stated):
        assert re.search(rf"\b{figure:.3g}0?\b|\b{figure:.4g}\b", text), figure


def test_pages_exist() -> None:
    assert all(page_of(claim).is_file() for claim in CLAIMS)


def _fails(text: str) -> bool:
    claim = next(one for one in CLAIMS if one.text.startswith(text))
    return not MeasuredClaim(claim, claim.measure()).holds


def test_claims_fail_where_a_formula_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each by one: a misprint, statics that are 1 ppm off, a slow law, a heavier payload."""
    assert not _fails("Torques are linear")
    monkeypatch.setattr(
        claims, "lumped_coefficients", lambda design: lumped_coefficients(design, Misprint.ALL)
    )
    assert _fails("Torques are linear")
    right = claims.static_torques
    monkeypatch.setattr(claims, "static_torques", lambda *given: right(*given) * (1 + 1e-6))
    assert _fails("Static torques are the gradient")
    assert _fails("Joint forces give")
    best = claims.shortest_motion
    monkeypatch.setattr(
        claims,
        "shortest_motion",
        lambda *given: (lambda one: replace(one, plan=one.plan.lasting(1.01 * one.plan.duration)))(
            best(*given)
        ),
    )
    assert _fails("On a circle")
    monkeypatch.setattr(worked_claims, "PAYLOAD", 1.01 * worked_claims.PAYLOAD)
    assert _fails("Times that motions")


def test_a_claim_without_a_figure_or_beyond_its_bound_is_marked() -> None:
    claim = replace(CLAIMS[0], allowed=1.0)
    shown = claims_section([MeasuredClaim(claim, np.nan), MeasuredClaim(claim, 0.5)])
    table = shown.blocks[-1]
    kinds = [row.kind for row in table.rows]  # type: ignore[union-attr]
    assert kinds == ["group", "marked", "plain"]


def test_several_figures_are_shown_with_the_worst_of_them() -> None:
    claim = replace(CLAIMS[0], stated=(2.0, 10.0), allowed=0.02, unit="mm", text="Two", check="how")
    for second, verdict in ((10.1, "holds"), (10.3, "FAILS"), (9.7, "FAILS")):
        shown = claims_section([MeasuredClaim(claim, np.array([2.0, second]))])
        cells = shown.blocks[-1].rows[-1].cells  # type: ignore[union-attr]
        assert cells[:2] == ("Two: 2, 10 mm", f"how: 2, {second} mm")
        assert cells[2] == f"{100 * abs(second / 10.0 - 1.0):.2g} % off"
        assert cells[-2:] == ("± 2 %", verdict)
