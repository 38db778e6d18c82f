"""What no lengths can do is refused in closed form, and only that."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, measure_singularity
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import (
    Evaluator,
    Guide,
    ObjectiveLimit,
    Regime,
    SearchRange,
    SynthesisCase,
    refusal,
)
from paminsa_viz.synthesis.search import refusals
from paminsa_viz.synthesis.search.refusals import critical_radius, least_footprint
from tests.synthesis.search_cases import CELL, CYLINDER
from tests.synthesis.test_trials import GOOD, random_numbers


def test_condition_toward_a_leg() -> None:
    # kappa at theta = 0 depends on (x, y)/(R_b - R_pl) alone, and is 10 at 0.736761 toward a leg
    assert critical_radius(10.0) == pytest.approx(0.736761, abs=5e-7)
    for offset in (0.15, 0.3):
        geometry = replace(APPENDIX_4.geometry, base_radius=0.1 + offset, guide_link_length=2.0)
        for at in (math.pi / 2, 7 * math.pi / 6, -math.pi / 6):
            r = 0.736761 * offset
            pose = (r * math.cos(at), r * math.sin(at), 0.0, -0.45)
            assert measure_singularity(geometry, pose).condition == pytest.approx(10, abs=1e-3)
        angle = np.linspace(0, 2 * np.pi, 200)
        poses = np.stack([r * np.cos(angle), r * np.sin(angle), 0 * angle, 0 * angle - 0.45], -1)
        found = measure_singularity(geometry, poses).condition
        assert np.nanmax(found) < 10.01


def with_limit(case: SynthesisCase, most: float) -> SynthesisCase:
    return replace(case, limits=(ObjectiveLimit("footprint", most),))


def test_least_footprint_is_that_of_the_formula() -> None:
    r, k, platform = 0.15, 5.0, 0.08
    expected = platform + 1.357 * r + 2.357 * r / (k - 1)
    offset = r / 0.736761
    assert least_footprint(CYLINDER, Regime.SMALLER, offset) == pytest.approx(expected, abs=2e-4)
    reason = refusal(with_limit(CYLINDER, 0.36), Regime.SMALLER)
    assert reason is not None
    assert "at least 372 mm" in reason
    assert refusal(with_limit(CYLINDER, 0.38), Regime.SMALLER) is None
    # with R_pl > R_b joint 5 alone is farther out; with smaller bases it is that
    assert refusal(with_limit(CYLINDER, 0.36), Regime.LARGER) is not None
    ranges = (replace(CYLINDER.ranges[0], low=0.01), replace(CYLINDER.ranges[1], high=0.5))
    free = replace(CYLINDER, ranges=(*ranges, *CYLINDER.ranges[2:]))
    reason = refusal(with_limit(free, 0.36), Regime.LARGER)
    assert reason is not None
    assert "joint 5" in reason


@pytest.mark.parametrize("shape", list(WorkspaceShape))
def test_footprint_of_a_workspace_off_the_center_is_that_of_its_points(
    shape: WorkspaceShape,
) -> None:
    """Joint 5 goes to the outermost point along a leg axis, joint 8 away from the innermost one."""
    workspace = Workspace(shape, (0.2, 0.2, 0.1), (0.07, -0.04, None))
    required = replace(CYLINDER.requirements, workspace=workspace)
    case = replace(CYLINDER, requirements=required)
    turn = np.linspace(0.0, 2 * np.pi, 3601)
    edge = 0.1 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    if shape is WorkspaceShape.BOX:
        edge = np.array([(a, b) for a in (-0.1, 0.1) for b in (-0.1, 0.1)])
    angle = np.radians([90.0, 210.0, 330.0])
    along = (edge + np.array([0.07, -0.04])) @ np.stack([np.cos(angle), np.sin(angle)])
    rp, rb = case.least("geometry.platform_radius"), case.least("geometry.base_radius")
    k = case.most("geometry.magnification")
    for offset in (0.3, 0.0):  # joint 8 is farther out, or joint 5
        outer = max(rb, rp + offset) + (offset - along.min()) / (k - 1)
        smaller = max(rp + along.max(), outer)
        assert (outer > rp + along.max()) == (offset > 0.0)
        assert least_footprint(case, Regime.SMALLER, offset) == pytest.approx(smaller, rel=1e-5)
        larger = max(rp, rb + offset) + along.max()
        assert least_footprint(case, Regime.LARGER, offset) == pytest.approx(larger, rel=1e-5)


def test_footprints_of_robots_are_above_the_bound() -> None:
    near = np.array(GOOD["cylinder"][1]) * np.random.default_rng(4).uniform(0.7, 1.3, (600, 6))
    found = Evaluator(replace(CYLINDER, margin=0.0), Regime.SMALLER).evaluate(near)
    feasible = [item for item in found if item.feasible]
    assert len(feasible) > 20
    least = least_footprint(CYLINDER, Regime.SMALLER, 0.15 / critical_radius(10.0))
    assert min(item.objective for item in feasible) > least
    for item in feasible:  # joint 8 alone is above what the proof says of it
        assert item.trial is not None
        g = item.trial.geometry
        bound = g.platform_radius + 1.357 * 0.15 + 2.357 * 0.15 / (g.magnification - 1)
        assert item.trial.radii[1] > bound


def test_quarter_turns_are_refused_where_the_platform_is_smaller() -> None:
    turned = replace(CELL.requirements, theta=(-math.pi / 2, math.pi / 2))
    reason = refusal(replace(CELL, requirements=turned), Regime.SMALLER)
    assert reason is not None
    assert reason.startswith("theta = 90 deg" if reason.isascii() else "theta = 90")
    assert "singular" in reason
    # 80 degrees are possible for a small platform on a large base
    turned = replace(CELL.requirements, theta=(-1.39, 1.39))
    assert refusal(replace(CELL, requirements=turned), Regime.SMALLER) is None
    # and 340 to 350 degrees are those from -20 to -10
    turned = replace(CELL.requirements, theta=(math.radians(340), math.radians(350)))
    assert refusal(replace(CELL, requirements=turned), Regime.SMALLER) is None


def test_singular_circle_bars_and_guide() -> None:
    assert "within the ranges" in (refusal(CELL, Regime.LARGER) or "")
    assert refusal(CELL, Regime.SMALLER) is None
    tall = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 1.7))
    high = replace(CYLINDER, requirements=replace(CYLINDER.requirements, workspace=tall))
    assert "B4 and B8 together" in (refusal(high, Regime.SMALLER) or "")
    kept = replace(CYLINDER, guide=Guide.KEPT)
    assert refusal(kept, Regime.SMALLER) is None
    short = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, guide_stroke=0.08))
    assert "stroke" in (refusal(replace(kept, reference=short), Regime.SMALLER) or "")


@pytest.mark.slow
def test_what_is_refused_has_no_robot() -> None:
    tall = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 1.7))
    cases = [
        (replace(CYLINDER, requirements=replace(CYLINDER.requirements, workspace=tall)),
         Regime.SMALLER),
        (CYLINDER, Regime.LARGER), (CELL, Regime.LARGER),
        (replace(CELL, requirements=replace(CELL.requirements, theta=(-1.6, 1.6))), Regime.SMALLER),
    ]  # fmt: skip
    for case, regime in cases:
        assert refusal(case, regime) is not None
        found = Evaluator(case, regime).evaluate(random_numbers(case, 2000))
        assert not any(item.feasible for item in found)


# ---------------------------------------------------------------- exactly at the limit


def searched(
    required: Requirements, guide: Guide = Guide.FOLLOWS, **ranges: tuple[float, float]
) -> SynthesisCase:
    """A case of some lengths, the others held."""
    found = tuple(SearchRange(f"geometry.{name}", *ends) for name, ends in ranges.items())
    return replace(CYLINDER, requirements=required, ranges=found, guide=guide)


def disc(radius: float, height: float, x: float = 0.0, y: float = 0.0) -> Workspace:
    return Workspace(WorkspaceShape.CYLINDER, (2 * radius, 2 * radius, height), (x, y, None))


@pytest.mark.parametrize(
    ("texts", "theta", "counts"),
    [
        (("condition <= 6",), (-0.5, 0.5), True), (("conditioning >= 0.1666667",), (0, 1), True),
        (("condition <= 6",), (-1.0, 0.0), True), (("condition <= 6",), (0.1, 0.5), False),
        (("condition <= 6",), (-0.5, -0.1), False), (("condition >= 6",), (-0.5, 0.5), False),
        (("condition <= 1",), (-0.5, 0.5), False), (("conditioning <= 0.5",), (0, 1), False),
        (("conditioning >= 1",), (-0.5, 0.5), False), (("f_4 <= 6",), (-0.5, 0.5), False),
        (("condition <= 9", "condition <= 1.5", "conditioning >= 0.12"), (-0.5, 0.5), True),
    ],
)  # fmt: skip
def test_the_offset_that_a_condition_number_needs_is_that_of_the_model(
    texts: tuple[str, ...], theta: tuple[float, float], counts: bool
) -> None:
    """At it the condition number is reached somewhere on the rays from the axis toward a leg."""
    space = disc(0.15, 0.2, 0.05, -0.03)
    bounds = tuple(replace(parse_requirement(text), theta=theta) for text in texts)
    case = searched(Requirements(bounds, (-1.5, 1.5), space), crank_length=(0.1, 0.9))
    far = np.hypot(0.05, 0.03) + 0.15
    along = np.linspace(0.0, far, 2001)
    angle = np.radians([90.0, 210.0, 330.0])
    xy = (along[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    for regime in Regime:
        offset, reason = refusals._needed_offset(case, regime)
        if not counts:
            assert offset == pytest.approx(far)
            assert "singular circle" in reason
            continue
        rays = regime.sign * xy
        rays = rays[np.hypot(*(rays - [0.05, -0.03]).T) <= 0.15]
        both = (0.1 + offset, 0.1)[:: 1 if regime is Regime.SMALLER else -1]
        lengths = replace(
            APPENDIX_4.geometry, base_radius=both[0], platform_radius=both[1], crank_length=5.0,
            coupler_length=5.0, guide_link_length=9.0,
        )  # fmt: skip
        pose = np.column_stack([rays, np.zeros(len(rays)), np.full(len(rays), -1.5)])
        worst = measure_singularity(lengths, pose).condition.max()
        most = 1.5 if len(texts) > 1 else 6.0
        assert worst == pytest.approx(most, abs=0.01)
        assert f"reaches {most:g} at" in reason


@pytest.mark.parametrize("regime", list(Regime))
def test_what_is_exactly_at_a_limit_of_singularities_is_refused(regime: Regime) -> None:
    """A circle as large as the workspace, and a turn as far as the singular one."""
    small, large = (0.125, 0.25), (0.125, 0.375)
    both = (large, small) if regime is Regime.SMALLER else (small, large)

    def case(radius: float, theta: tuple[float, float] = (0.0, 0.2), **more: Any) -> SynthesisCase:
        lengths = {"base_radius": both[0], "platform_radius": both[1]} | more
        return searched(Requirements((), theta, disc(radius, 0.01)), **lengths)

    for theta in ((0.0, 0.2), (-0.2, 0.0), (-0.1, 0.1)):
        assert refusal(case(0.2499, theta), regime) is None
        reason = refusal(case(0.25, theta), regime)
        assert reason is not None
        assert "within the ranges it is at most 250 mm" in reason
    for theta in ((0.01, 0.2), (-0.2, -0.01)):
        assert refusal(case(0.3, theta), regime) is None
    # where the size is searched no offset is needed, a turn still is possible or not
    for path in ("workspace.width", "workspace.height"):
        free = case(0.3)
        free = replace(free, ranges=(*free.ranges, SearchRange(path, 0.01, 0.3)))
        assert refusal(free, regime) is None
    for turn in ((-1.0, 0.4), (0.3, 1.0)):
        for share, refused in ((1.0, True), (1.0 - 1e-9, False)):
            radii = {"base_radius": (0.7, 2.0), "platform_radius": (2 * math.cos(1.0) * share, 3)}
            found = refusal(case(0.01, turn, **radii), regime)
            assert (found is not None) is (refused and regime is Regime.SMALLER)
    whole = refusal(case(0.01, (0.0, 2 * math.pi)), regime)
    assert (whole is not None) is (regime is Regime.SMALLER)
    for least, above in ((2.0, True), (1.999999, False)):
        radii = {"base_radius": (0.7, 2.0), "platform_radius": (least, 3.0)}
        found = refusal(case(0.0001, (0.0, 0.001), **radii), Regime.SMALLER)
        assert (found == "R_pl is above R_b all over their ranges") is above


@pytest.mark.parametrize("above", [False, True])
def test_bars_and_strokes_are_refused_at_the_lengths_of_a_right_triangle(above: bool) -> None:
    """X_1 of twice the radius, doubled by k = 2, and the height, as 4 and 3 to 5."""
    height = 0.75 if above else 0.375
    required = Requirements((), (0.0, 0.0), disc(0.125, height))
    radii = {"base_radius": (0.125, 0.5), "platform_radius": (0.125, 0.25)}
    wide = {**radii, "magnification": (1.5, 2.0)}

    def reason(guide: Guide, stroke: float | None = None, **lengths: Any) -> str:
        case = replace(searched(required, guide, **wide, **lengths), above_guides=above)
        own = replace(case.reference.geometry, guide_stroke=stroke, guide_link_length=0.3)
        case = replace(case, reference=replace(case.reference, geometry=own))
        return refusal(case, Regime.SMALLER) or ""

    for most, refused in ((0.375, True), (0.376, False)):
        found = reason(Guide.FOLLOWS, crank_length=(0.1, 0.25), coupler_length=(0.1, most))
        assert ("B4 and B8 together have to be longer than 625 mm" in found) is refused
    bars = {"crank_length": (0.1, 2.0), "coupler_length": (0.1, 2.0)}
    for stroke, refused in ((0.25, False), (0.2499, True)):
        assert ("joint 8 needs a stroke of 250" in reason(Guide.KEPT, stroke, **bars)) is refused
        assert not reason(Guide.FOLLOWS, stroke, **bars)
        guides = {**bars, "guide_link_length": (0.1, stroke)}
        assert ("joint 8 needs a stroke" in reason(Guide.KEPT, **guides)) is refused
    assert not reason(Guide.KEPT, **bars)  # of 300 mm


def test_bars_have_to_reach_what_is_farthest_from_a_leg() -> None:
    """Away from the leg with a smaller platform, toward it with a larger one."""
    required = Requirements((), (0.0, 0.0), disc(0.15, 0.2, 0.05, -0.03))
    offset = np.hypot(0.05, 0.03) + 0.15
    angle = np.radians([90.0, 210.0, 330.0])
    toward = np.array([0.05, -0.03]) @ np.stack([np.cos(angle), np.sin(angle)])
    for regime in Regime:
        rho = offset + (-regime.sign * toward).max() + 0.15
        needed = np.hypot(rho * 4.0 / 3.0, 0.2)
        for share, refused in ((0.9999, True), (1.0001, False)):
            case = searched(
                required, magnification=(2.0, 4.0), crank_length=(0.1, 0.3 * needed * share),
                coupler_length=(0.1, 0.7 * needed * share), base_radius=(0.1, 2.0),
                platform_radius=(0.1, 2.0),
            )  # fmt: skip
            assert ("B4 and B8" in (refusal(case, regime) or "")) is refused


def test_the_tighter_of_two_limits_on_the_footprint_counts() -> None:
    for first, second in ((0.36, 5.0), (5.0, 0.36)):
        limits = (ObjectiveLimit("footprint", first), ObjectiveLimit("footprint", second))
        limits = (ObjectiveLimit("moving_mass", 0.1), *limits)
        found = refusal(replace(CYLINDER, limits=limits), Regime.SMALLER)
        assert found is not None
        assert found.startswith("R_f <= 360 mm is required")
        assert "joint 8" in found
    light = replace(CYLINDER, limits=(ObjectiveLimit("moving_mass", 0.1),))
    assert refusal(light, Regime.SMALLER) is None
