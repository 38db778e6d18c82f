"""The page of `paminsa-viz verify --report`: claims as they are measured, and the engines."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np

from paminsa_viz.blocks.kinds import Fact, Note, Row, Table
from paminsa_viz.blocks.verification import verification_fact
from paminsa_viz.engines.verification import Verification
from paminsa_viz.model.arrays import Array
from paminsa_viz.report.claim import MeasuredClaim
from paminsa_viz.report.page import COLORS, template
from paminsa_viz.report.request import Section
from paminsa_viz.report.sections import verification_section
from paminsa_viz.units import counted, number
from paminsa_viz.version import __version__


def claims_html(found: Verification, claims: Sequence[MeasuredClaim], made: datetime) -> str:
    """Return the page.

    Args:
        found: The formulas against the engines, on a robot and a motion.
        claims: The claims, as just measured.
        made: When.
    """
    sections = [claims_section(claims), verification_section(found)]
    return template().render(
        kind="verification",
        title=f"PAMINSA verification: {found.design.name}",
        design=found.design.name,
        lines=[
            "The claims are those of the documentation, on Appendix 4 and its balanced robot; the "
            f"engines look at this design on “{found.trajectory.name}”"
        ],
        opening=[
            Fact(
                "Claims", _holding_text(claims, ""), "measured in this run",
                "ok" if _holding(claims) == len(claims) else "bad",
            ),
            verification_fact(found),
        ],
        sections=list(enumerate(sections, 1)),
        colors=COLORS,
        version=__version__,
        made=made.strftime("%Y-%m-%d %H:%M %Z"),
    )  # fmt: skip


def claims_section(claims: Sequence[MeasuredClaim]) -> Section:
    """Return the table of the claims."""
    note = Note(
        "Every figure was worked out in this run; the second column says how. What takes minutes "
        "or another program to check is held by the tests alone."
    )
    rows: list[Row] = []
    for one in claims:
        claim = one.claim
        if not rows or claim.page not in (row.cells[0] for row in rows if row.kind == "group"):
            rows += [Row((claim.page,), "group")]
            rows += [_row(other) for other in claims if other.claim.page == claim.page]
    head = ("Claim", "Checked by", "Measured", "Stated", "Allowed", "")
    return Section(
        "claims", "Claims of the documentation", (note, Table(head, tuple(rows), words=2))
    )


def _row(one: MeasuredClaim) -> Row:
    claim = one.claim
    figures = _several(one) if isinstance(claim.stated, tuple) else _single(one)
    return Row((*figures, "holds" if one.holds else "FAILS"), "plain" if one.holds else "marked")


def _single(one: MeasuredClaim) -> tuple[str, ...]:
    claim = one.claim
    stated = "0" if claim.stated is None else _shown(claim.stated, 4, claim.unit)
    measured = _shown(one.value, 4 if claim.stated else 2, claim.unit)
    return claim.text, claim.check, measured, stated, f"± {_shown(claim.allowed, 2, claim.unit)}"


def _several(one: MeasuredClaim) -> tuple[str, ...]:
    """Return cells with the figures in the words, and how far the worst of them is off."""
    claim = one.claim
    aim = np.asarray(claim.stated)
    worst = float(100.0 * np.max(np.abs(np.asarray(one.value) / aim - 1.0)))
    return (
        f"{claim.text}: {_shown(aim, 4, claim.unit)}",
        f"{claim.check}: {_shown(one.value, 4, claim.unit)}",
        f"{number(worst, 2)} % off", "", f"± {number(100.0 * claim.allowed, 2)} %",
    )  # fmt: skip


def _shown(figures: float | tuple[float, ...] | Array, digits: int, unit: str) -> str:
    text = ", ".join(number(float(figure), digits) for figure in np.atleast_1d(figures))
    return f"{text} {unit}".rstrip()


def _holding(claims: Sequence[MeasuredClaim]) -> int:
    return sum(one.holds for one in claims)


def holding_text(claims: Sequence[MeasuredClaim]) -> str:
    """Return how many claims hold, as a sentence."""
    return _holding_text(claims, " claims of the documentation")


def _holding_text(claims: Sequence[MeasuredClaim], what: str) -> str:
    of = f"of {len(claims)}{what}"
    return counted(_holding(claims), f"{of} holds", f"{of} hold")


def claims_data(claims: Sequence[MeasuredClaim]) -> list[dict[str, Any]]:
    """Return the claims for JSON, in SI units."""
    return [
        {
            "page": one.claim.page, "claim": one.claim.text, "check": one.claim.check,
            "measured": one.value, "stated": one.claim.stated,
            "allowed": one.claim.allowed, "unit": one.claim.unit, "holds": one.holds,
        }
        for one in claims
    ]  # fmt: skip
