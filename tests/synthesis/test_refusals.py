"""What no lengths can do is refused in closed form, and only that."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, measure_singularity
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis import Evaluator, Guide, ObjectiveLimit, Regime, SynthesisCase, refusal
from paminsa_viz.synthesis.search.refusals import critical_radius, least_footprint
from tests.synthesis.search_cases import CELL, CYLINDER
from tests.synthesis.test_trials import random_numbers


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
    k, offset = case.most("geometry.magnification"), 0.3
    outer = max(rb, rp + offset) + (offset - along.min()) / (k - 1)
    smaller = max(rp + along.max(), outer)
    assert outer > rp + along.max()
    assert least_footprint(case, Regime.SMALLER, offset) == pytest.approx(smaller, rel=1e-5)
    larger = max(rp, rb + offset) + along.max()
    assert least_footprint(case, Regime.LARGER, offset) == pytest.approx(larger, rel=1e-5)


def test_footprints_of_robots_are_above_the_bound() -> None:
    found = Evaluator(replace(CYLINDER, margin=0.0), Regime.SMALLER).evaluate(
        random_numbers(CYLINDER, 15000)
    )
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
