"""Texts on the robot that several features show."""

from __future__ import annotations

import math

from paminsa_viz.explorer.core.frame import Frame, Health
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.model import APPENDIX_4, Design, Geometry, static_imbalance
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.resizing import length_ratio, plain_decimals
from paminsa_viz.units import fixed


def gray_if(stale: bool, *texts: str) -> str:
    """Return texts as one, grayed where their numbers are not of what is shown."""
    return f'<div class="pv-stale">{"".join(texts)}</div>' if stale else "".join(texts)


def of_pose(frame: Frame, *texts: str) -> str:
    """Return numbers of the last reachable pose; grayed where another one is requested."""
    return gray_if(frame.health is Health.UNREACHABLE, *texts)


def decimals(design: Design) -> tuple[int, int]:
    """Return with how many decimals torques [N m] and forces [N] of a robot at rest are written.

    Three and two at about Appendix 4's masses and lengths. Forces are in proportion to the masses,
    torques to masses times lengths: as many digits count in a robot of any size, and also in one
    whose bars alone are long. The payload is left out, with which digits would come and go.
    """
    weight = math.log10(_own_mass(design) / _own_mass(APPENDIX_4))
    size = weight + math.log10(length_ratio(design.geometry))
    # beyond -8 and -6 a line would be too short
    return max(3 - round(max(size, -8.0)), 0), max(2 - round(max(weight, -6.0)), 0)


def millimeter_decimals(geometry: Geometry) -> int:
    """Return with how many decimals places of a robot are written in mm: one, more in a small one.

    A tenth of a millimeter is a small part of the prototype's lengths, and a large one of bars of
    a few millimeters.
    """
    return plain_decimals(geometry) - 2


def line_texts(design: Design, torques: Array) -> list[str]:
    """Return torques of M1..M3 [N m] and the force of M4 [N] for one line, with `decimals`.

    Next to a singularity they have a decimal less for each digit more, so that the line stays one.
    """
    of_torque, of_force = decimals(design)
    texts = []
    for value, digits, usual in zip(
        torques.tolist(), (*[of_torque] * 3, of_force), (4, 4, 4, 5), strict=True
    ):
        whole = math.floor(math.log10(abs(value))) + 1 if value and math.isfinite(value) else 0
        texts.append(fixed(value, max(digits - max(whole + digits - usual, 0), 0)))
    return texts


def _own_mass(design: Design) -> float:
    legs = (*vars(design.links).values(), *vars(design.joints).values())
    return 3 * sum(legs) + design.platform.mass


def table_decimals(design: Design) -> tuple[int, int]:
    """Return with how many decimals tables have torques [N m] and forces [N], see `decimals`."""
    of_torque, of_force = decimals(design)
    return of_torque, of_force + 1


def gauge_html(frame: Frame) -> str:
    """Return M_p2 as a number and as a mark on a line from Appendix 4's value through zero."""
    reference = frame.state.document.reference
    values = {"zero": 0.0, "default": static_imbalance(APPENDIX_4)}
    if reference is not None:
        values["reference"] = static_imbalance(reference)
    values["current"] = frame.balance
    span = 1.25 * max(map(abs, values.values()))
    return render(
        "balance_gauge.j2", balance=frame.balance, default=values["default"],
        pinned=values.get("reference"), digits=table_decimals(frame.shown_design)[1],
        ticks=[(kind, 50 + 50 * value / span) for kind, value in values.items()],
    )  # fmt: skip


NEAR = 0.05
"""Share of a bound below which a margin is amber."""


def margin_share(margin: float, size: float) -> float:
    """Return a margin over the size of its bound, -1 to 1; no margin is as bad as can be."""
    return -1.0 if math.isnan(margin) else min(max(margin / size, -1.0), 1.0)


def margin_level(share: float) -> str:
    """Return the class of the color of a margin, see `margin_share`."""
    return "pv-bad" if share < 0 else "pv-warn" if share < NEAR else "pv-ok"
