"""Requirements that no lengths within their ranges meet, by proofs in closed form.

Let D = |R_b - R_pl|. At theta = 0 the condition number depends on (x, y)/D alone; toward a leg it
grows fastest, and reaches K at q(K) D, q(10) = 0.736761. So a workspace that extends by t toward a
leg needs D >= t / q(K), and the singular circle, of radius D at theta = 0, has to be around it.

With R_pl < R_b, joint 5 of leg k is at least D + e from its axis when the platform is farthest from
that leg, where e is the workspace's extent away from it, and joint 8 by 1/(k - 1) of that on the
other side of the axis, at the radius R_b + (D + e)/(k - 1) about z. For a cylinder of radius r and
K = 10 that is R_f >= R_pl + 1.357 r + 2.357 r/(k - 1). Joint 5 is at R_pl + e on the other side of
the workspace, whichever of base and platform is larger.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from paminsa_viz.checks import kinds_checked
from paminsa_viz.model import measures
from paminsa_viz.model.geometry import Geometry
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.synthesis.search.case import GUIDE, Guide, Regime, SynthesisCase
from paminsa_viz.synthesis.search.region import extent, farthest, ray
from paminsa_viz.synthesis.volume.reach import cosine_range
from paminsa_viz.units import format_ascii


@cache
def critical_radius(condition: float) -> float:
    """Return q: how far toward a leg, over |R_b - R_pl|, the condition number is reached at 0°."""
    lengths = Geometry(
        base_radius=1.1, platform_radius=0.1, crank_length=5.0, coupler_length=5.0,
        guide_link_length=5.0,
    )  # fmt: skip
    m: Any = mechanism(lengths)
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        with np.errstate(all="ignore"):
            # toward leg 3, on its side of the axis
            found = measures.dexterity(m, 0.0, middle, 1.0, 0.0, -3.0)[1]
        low, high = (middle, high) if found < condition else (low, middle)
    return low


@kinds_checked
def refusal(case: SynthesisCase, regime: Regime) -> str | None:
    """Return why no lengths of a regime meet a case's requirements; None if none is proven."""
    return _turn(case, regime) or _offset(case, regime)


def _turn(case: SynthesisCase, regime: Regime) -> str | None:
    if regime is Regime.LARGER:
        return None
    least_cosine = float(cosine_range(*case.requirements.theta)[0])
    ratio = case.least("geometry.platform_radius") / case.most("geometry.base_radius")
    if ratio >= 1:
        return "R_pl is above R_b all over their ranges"
    if least_cosine > ratio:
        return None
    return (
        f"theta = {format_ascii(math.acos(least_cosine), 'rad')} is required, and with R_pl < R_b "
        "every position is singular at |theta| = acos(R_pl/R_b), which is below 90 deg; within the "
        f"ranges of R_pl and R_b it is at most {format_ascii(math.acos(ratio), 'rad', up=False)}"
    )


def _needed_offset(case: SynthesisCase, regime: Regime) -> tuple[float, str]:
    """Return the least |R_b - R_pl| of the workspace at theta = 0 [m], and why."""
    far = farthest(case.workspace)
    found = far, f"the singular circle has to be around {format_ascii(far, 'm', up=True)}"
    for bound in case.requirements.bounds:
        low, high = case.requirements.headings(bound)
        most = bound.high if bound.quantity == "condition" else None
        if bound.quantity == "conditioning" and bound.low:
            most = 1 / bound.low
        if most is None or most <= 1 or not low <= 0 <= high:
            continue
        q = critical_radius(most)
        toward = max(ray(case.workspace, regime.sign * axis) for axis in LEG_AXES)
        if toward / q > found[0]:
            found = (
                toward / q,
                (
                    f"the condition number reaches {most:g} at {q:.4g} |R_b - R_pl| toward a leg, "
                    f"and the workspace extends by {format_ascii(toward, 'm')} there"
                ),
            )
    return found


def _offset(case: SynthesisCase, regime: Regime) -> str | None:
    """Return what the least |R_b - R_pl| makes impossible, if theta = 0 is required."""
    low, high = case.requirements.theta
    if not low <= 0 <= high:
        return None
    if any(path in case.paths for path in ("workspace.width", "workspace.height")):
        return None
    least, reason = _needed_offset(case, regime)
    smaller = regime is Regime.SMALLER
    larger, other = ("base_radius", "platform_radius")[:: 1 if smaller else -1]
    possible = case.most(f"geometry.{larger}") - case.least(f"geometry.{other}")
    if possible <= least:
        return (
            f"|R_b - R_pl| has to be above {format_ascii(least, 'm', up=True)}: {reason}; within "
            f"the ranges it is at most {format_ascii(max(possible, 0.0), 'm', up=False)}"
        )
    return _footprint(case, regime, least, reason) or _reach(case, regime, least, reason)


def least_footprint(case: SynthesisCase, regime: Regime, offset: float) -> float:
    """Return a lower bound of R_f [m].

    Args:
        case: The case, with theta = 0 among its headings.
        regime: Which of base and platform is larger.
        offset: A lower bound of |R_b - R_pl| [m].
    """
    toward = max(extent(case.workspace, axis) for axis in LEG_AXES)
    away = max(extent(case.workspace, -axis) for axis in LEG_AXES)
    rp, rb = (case.least(f"geometry.{name}_radius") for name in ("platform", "base"))
    if regime is Regime.LARGER:
        return max(rp, rb + offset) + toward
    ratio = 1 / (case.most("geometry.magnification") - 1)
    return max(rp + toward, max(rb, rp + offset) + (offset + away) * ratio)


def _footprint(case: SynthesisCase, regime: Regime, offset: float, reason: str) -> str | None:
    limits = [limit.most for limit in case.limits if limit.objective == "footprint"]
    least = least_footprint(case, regime, offset)
    if not limits or min(limits) >= least:
        return None
    formula = (
        "R_f >= R_pl + D + (D + e)/(k - 1), the radius of joint 8"
        if regime is Regime.SMALLER
        else "R_f >= R_b + D + e, the radius of joint 5"
    )
    return (
        f"R_f <= {format_ascii(min(limits), 'm', 6)} is required, and it is at least "
        f"{format_ascii(least, 'm', up=True)}: {formula} for a workspace that extends by e from "
        f"the z-axis, where D = |R_b - R_pl| is at least {format_ascii(offset, 'm', up=True)}, as "
        f"{reason}"
    )


def _reach(case: SynthesisCase, regime: Regime, offset: float, reason: str) -> str | None:
    away = max(extent(case.workspace, -regime.sign * axis) for axis in LEG_AXES)
    k = case.most("geometry.magnification")
    rho = offset + away
    height = case.workspace.size[2] * (0.5 if case.above_guides else 1.0)
    bars = case.most("geometry.crank_length") + case.most("geometry.coupler_length")
    needed = math.hypot(k / (k - 1) * rho, height)
    text = f"as |R_b - R_pl| is at least {format_ascii(offset, 'm', up=True)}: {reason}"
    if needed >= bars:
        return (
            f"B4 and B8 together have to be longer than {format_ascii(needed, 'm', up=True)}, and "
            f"are at most {format_ascii(bars, 'm', up=False)}, {text}"
        )
    stroke = case.most(GUIDE)
    if case.guide is Guide.KEPT and case.reference.geometry.guide_stroke is not None:
        stroke = case.reference.geometry.guide_stroke
    if case.guide is Guide.KEPT and rho / (k - 1) > stroke:
        return (
            f"joint 8 needs a stroke of {format_ascii(rho / (k - 1), 'm', up=True)} or more, and "
            f"has {format_ascii(stroke, 'm', up=False)}, {text}"
        )
    return None
