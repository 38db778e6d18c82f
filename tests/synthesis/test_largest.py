"""The largest proven workspace: closed-form anchors, poses inside, a pose outside."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, check_reach, measure_singularity, static_torques
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof.bisection import Gauge
from paminsa_viz.synthesis.proof.certificate import prove, region_of
from paminsa_viz.synthesis.proof.evidence import Verdict
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.proof.largest import GrowingRegion, LargestWorkspace, largest_workspace
from paminsa_viz.synthesis.proof.regions import Growth
from paminsa_viz.synthesis.volume.check import check_requirements
from tests.support.samples import enlarged
from tests.synthesis.certificate_robots import random_poses
from tests.synthesis.robots import NEEDED, TURN, cylinder

CONDITION = Requirements((Requirement("condition", high=10.0),))
CYLINDER = cylinder(0.3, 0.2)


@cache
def largest() -> LargestWorkspace:
    return largest_workspace(APPENDIX_4, NEEDED, CYLINDER, tolerance=0.01)


def size(found: LargestWorkspace) -> tuple[float, float, float]:
    assert found.workspace is not None
    assert found.proof.verdict is Verdict.PROVEN
    return found.workspace.size


@pytest.mark.slow
@pytest.mark.parametrize(("base", "platform"), [(0.35, 0.1), (0.12, 0.3)])
def test_condition_of_ten_at_theta_zero_is_on_its_closed_form_circle(
    base: float, platform: float
) -> None:
    # kappa depends there on (x, y)/(R_b - R_pl) alone, and is 10 at r = 0.736761 of it
    lengths = {
        "geometry.base_radius": base,
        "geometry.platform_radius": platform,
        "geometry.guide_stroke": 1.0,
    }
    workspace = replace(CYLINDER, size=(0.1, 0.1, 0.05))
    found = largest_workspace(
        APPENDIX_4.vary(lengths), CONDITION, workspace, growth=Growth.HORIZONTAL, tolerance=1e-4
    )
    expected = 2 * 0.736761 * abs(base - platform)
    assert size(found)[0] <= expected * (1 + 1e-6)
    assert found.limit[0] >= expected * (1 - 1e-6)
    assert found.gap <= 1e-4
    assert size(found)[2] == pytest.approx(0.05)
    assert found.cause == "condition"


@pytest.mark.slow
def test_poses_of_the_largest_cylinder_meet_all_bounds_and_one_outside_does_not() -> None:
    found = largest()
    assert found.gap <= 0.01
    poses = random_poses(found.proof.region, 100_000, np.random.default_rng(4))
    torque = static_torques(APPENDIX_4, poses)
    assert check_reach(APPENDIX_4.geometry, poses).ok.all()
    assert measure_singularity(APPENDIX_4.geometry, poses).condition.max() <= 10
    assert np.abs(torque[:, :3]).max() <= 15
    assert torque[:, 3].max() <= 450
    assert found.pose is not None
    outside = measure_singularity(APPENDIX_4.geometry, np.array(found.pose))
    assert outside.condition > 10
    region = region_of(CYLINDER, NEEDED)
    gauge = Gauge(region, (True, True, True)).of_poses(np.array([found.pose]))[0]
    assert size(found)[0] < gauge * 0.3 <= found.limit[0] * (1 + 1e-12)
    assert prove(APPENDIX_4, NEEDED, found.workspace).verdict is Verdict.PROVEN


@pytest.mark.parametrize("growth", list(Growth))
def test_without_bounds_reach_and_singularity_are_the_limit(growth: Growth) -> None:
    needed = Requirements((), (-TURN, TURN))
    found = largest_workspace(APPENDIX_4, needed, CYLINDER, growth=growth)
    assert found.gap < 1e-6
    assert found.boxes == 0
    assert found.cause in ("reach", "singularity")
    grown = replace(CYLINDER, size=tuple(s * (1 + 1e-5) for s in size(found)))
    assert prove(APPENDIX_4, needed, grown).verdict is Verdict.REFUTED


@pytest.mark.slow
def test_extents_that_do_not_grow_are_kept() -> None:
    box = Workspace(WorkspaceShape.BOX, (0.2, 0.1, 0.3), (0.0, 0.05, -0.6))
    kept = largest_workspace(APPENDIX_4, NEEDED, box, growth=Growth.VERTICAL, tolerance=0.05)
    assert size(kept)[:2] == pytest.approx((0.2, 0.1), rel=1e-8)
    assert size(kept)[2] > 0.3
    whole = largest_workspace(APPENDIX_4, NEEDED, box, tolerance=0.05)
    assert np.divide(size(whole), box.size) == pytest.approx(size(whole)[0] / 0.2)


@pytest.mark.slow
def test_a_small_robot_has_the_same_answer_in_proportion() -> None:
    """By as many boxes: tolerance, stages and the way boxes are cut follow its lengths."""
    headings, answers = replace(CONDITION, theta=(-0.1, 0.1)), []
    for factor in (1.0, 0.01):
        extents, (x, y, z) = [factor * extent for extent in CYLINDER.size], (0.0, 0.0, -0.6)
        shape = Workspace(CYLINDER.shape, (extents[0], extents[1], extents[2]), (x, y, factor * z))
        found = largest_workspace(
            enlarged(APPENDIX_4, factor), headings, shape, growth=Growth.HORIZONTAL
        )
        answers.append((*np.divide((size(found)[0], found.gap), factor), found.boxes))
    assert answers[1] == pytest.approx(answers[0])
    assert 0.5e-3 < answers[0][1] <= 1e-3


@pytest.mark.slow
def test_an_open_height_is_the_best_of_many() -> None:
    workspace = replace(CYLINDER, center=(0.0, 0.0, None))
    free = largest_workspace(
        APPENDIX_4, NEEDED, workspace, growth=Growth.VERTICAL, tolerance=0.06, time_limit=60
    )
    for z in (-0.57, -0.5):  # one on either side of the best
        fixed = largest_workspace(
            APPENDIX_4,
            NEEDED,
            replace(CYLINDER, center=(0.0, 0.0, z)),
            growth=Growth.VERTICAL,
            tolerance=0.06,
        )
        assert size(fixed)[2] <= free.limit[2] * 1.005
        assert size(fixed)[2] <= size(free)[2] + 0.04
    assert free.workspace is not None
    assert free.workspace.center[:2] == (0.0, 0.0)


@pytest.mark.slow
def test_an_open_center_is_found_near_the_axis() -> None:
    workspace = replace(CYLINDER, center=(None, None, None))
    found = largest_workspace(
        APPENDIX_4, CONDITION, workspace, growth=Growth.HORIZONTAL, time_limit=60
    )
    assert found.workspace is not None
    assert np.hypot(*found.workspace.center[:2]) < 2e-3  # type: ignore[arg-type]
    assert size(found)[0] == pytest.approx(2 * 0.736761 * 0.25, abs=3e-3)


@pytest.mark.slow
def test_an_open_height_stays_on_the_side_of_home() -> None:
    workspace = replace(CYLINDER, center=(0.0, 0.0, None))
    found = largest_workspace(APPENDIX_4, CONDITION, workspace, tolerance=0.02)
    assert found.workspace is not None
    center = found.workspace.center[2]
    assert center is not None
    assert center + 0.5 * size(found)[2] <= 1e-9


@pytest.mark.slow
def test_samples_limit_what_cannot_be_proven() -> None:
    sampled = Requirement("transmission", low=0.45)
    needed = replace(NEEDED, bounds=(*NEEDED.bounds, sampled))
    found = largest_workspace(APPENDIX_4, needed, CYLINDER, tolerance=0.02)
    assert size(found)[0] < 0.98 * size(largest())[0]
    assert found.requirement == sampled
    assert found.proof.sampled == (sampled,)
    assert found.proof.evidence[-1].method is Method.SAMPLED


@pytest.mark.slow
def test_the_wall_of_a_cylinder_limits_what_is_sampled() -> None:
    """The least speed is on the wall: by brute force the diameter is about 148.7 mm."""
    center = (0.02, -0.01, home_pose(APPENDIX_4.geometry)[3])
    space = Workspace(WorkspaceShape.CYLINDER, (0.16, 0.16, 0.06), center)
    needed = Requirements((Requirement("speed", low=0.46),), (-0.35, 0.5), space)
    found = largest_workspace(APPENDIX_4, needed)
    assert found.workspace is not None
    assert 0.147 < found.workspace.size[0] < 0.1490
    assert 0.0 < found.gap <= 1e-3
    assert check_requirements(APPENDIX_4, replace(needed, workspace=found.workspace)).holds
    assert prove(APPENDIX_4, needed, found.workspace).verdict is Verdict.PROVEN
    wider = replace(found.workspace, size=tuple(1.01 * extent for extent in found.limit))
    assert prove(APPENDIX_4, needed, wider).verdict is Verdict.REFUTED


def test_a_margin_of_reach_shrinks_the_workspace() -> None:
    needed = Requirements((Requirement("reach_margin", low=0.05),), (-TURN, TURN))
    found = largest_workspace(APPENDIX_4, needed, CYLINDER)
    poses = random_poses(found.proof.region, 20_000, np.random.default_rng(0))
    least = check_reach(APPENDIX_4.geometry, poses).margins.min()
    assert 0.05 <= least < 0.052
    assert found.cause == "reach_margin"


@pytest.mark.parametrize("growth", Growth)
def test_a_bound_that_the_center_breaks_leaves_nothing(growth: Growth) -> None:
    needed = Requirements((Requirement("f_4", high=100.0),), (-TURN, TURN))
    found = largest_workspace(APPENDIX_4, needed, CYLINDER, growth=growth)
    assert found.workspace is None
    assert found.proof.verdict is Verdict.REFUTED
    assert found.cause == "f_4"
    if growth is not Growth.ALL:
        return
    nowhere = largest_workspace(APPENDIX_4, needed, replace(CYLINDER, center=(0.0, 0.0, None)))
    assert nowhere.workspace is None


@pytest.mark.slow
def test_a_free_height_at_which_none_holds_is_said_at_once_with_the_bound() -> None:
    """Of a bound that is proven, and of one that is sampled."""
    place = replace(CYLINDER, center=(0.0, 0.0, None))
    for bound, growth in (
        (Requirement("tau_1", high=0.0), Growth.HORIZONTAL),
        (Requirement("transmission", low=0.9), Growth.VERTICAL),
    ):
        needed = Requirements((bound,), (-TURN, TURN))
        found = largest_workspace(APPENDIX_4, needed, place, growth=growth)
        assert (found.workspace, found.proof.verdict) == (None, Verdict.REFUTED)
        assert found.requirement == bound
        assert found.pose is not None


def test_without_time_the_answer_is_open_or_smaller() -> None:
    found = largest_workspace(APPENDIX_4, NEEDED, CYLINDER, time_limit=1e-6)
    assert found.gap > 0.02
    if found.workspace is None:
        assert found.proof.verdict is Verdict.UNDECIDED


@pytest.mark.slow
def test_samples_before_the_proof_end_with_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    sample, sampled = GrowingRegion._sampled, []

    def counted(*given: Any) -> bool:
        sampled.append(given)
        return sample(*given)

    monkeypatch.setattr(GrowingRegion, "_sampled", counted)
    stiff = replace(NEEDED, bounds=(*NEEDED.bounds, Requirement("stiffness_z", low=1e3)))
    found = largest_workspace(APPENDIX_4, stiff, CYLINDER, progress=lambda _: len(sampled) == 2)
    assert len(sampled) == 2
    assert found.workspace is None
    assert found.proof.verdict is Verdict.UNDECIDED
    assert found.cause == "stiffness_z"


def test_numbers_that_are_not_possible_are_refused() -> None:
    with pytest.raises(InvalidInput, match="a shape"):
        largest_workspace(APPENDIX_4, NEEDED)
    with pytest.raises(InvalidInput, match="tolerance"):
        largest_workspace(APPENDIX_4, NEEDED, CYLINDER, tolerance=0.0)
    with pytest.raises(InvalidInput, match="time_limit"):
        largest_workspace(APPENDIX_4, NEEDED, CYLINDER, time_limit=math.nan)
