"""Which requirements hold over a workspace and over a volume."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from paminsa_viz.synthesis.volume import check
from paminsa_viz.synthesis.volume.check import Over, _refined, _relative, check_requirements
from paminsa_viz.synthesis.volume.grid import COARSE, FINE, Resolution
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.workspace import (
    RequirementCheck,
    Samples,
    best_center,
    sample_workspace,
    worst_over,
)
from tests.synthesis.robots import TURN, needs

CYLINDER = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.3), (0.0, 0.0, -0.55))
BOX = Workspace(WorkspaceShape.BOX, (0.16, 0.2, 0.3), (0.02, 0.0, -0.55))


def over(workspace: Workspace | None, *texts: str) -> Requirements:
    return replace(needs(*texts), workspace=workspace)


@pytest.mark.parametrize("workspace", [CYLINDER, BOX])
def test_worst_values_are_those_of_the_poses_named(workspace: Workspace) -> None:
    requirements = over(workspace, "condition <= 10", "max_torque <= 15", "f_4 <= 450")
    found = check_requirements(APPENDIX_4, requirements, fine=True)
    assert found.over is Over.WORKSPACE
    assert found.holds
    _, singular, condition, torque, lift = found.items
    for item in found.items:
        assert item.pose is not None
    measured = measure_singularity(APPENDIX_4.geometry, condition.pose)
    assert condition.value == pytest.approx(float(measured.condition), rel=1e-12)
    torques = static_torques(APPENDIX_4, [torque.pose, lift.pose])
    assert torque.value == pytest.approx(np.abs(torques[0, :3]).max(), rel=1e-12)
    assert lift.value == pytest.approx(torques[1, 3], rel=1e-12)
    assert condition.margin == pytest.approx(10.0 - condition.value)
    x, y = singular.pose[:2] if singular.pose else (0.0, 0.0)
    assert singular.value == pytest.approx(0.25 - math.hypot(x, y))


def test_margins_are_compared_by_the_size_of_their_bounds_and_of_the_robot() -> None:
    """Lengths over that of the bars from 8 to 9 and from 9 to 5, all others over their bound."""
    requirements = over(CYLINDER, "condition <= 10", "f_4 <= 450")
    items = check_requirements(APPENDIX_4, requirements).items
    sizes = [0.42 + 0.63, 0.42 + 0.63, 10.0, 450.0]
    found = [_relative(APPENDIX_4, requirements, item) for item in items]
    assert found == pytest.approx([i.margin / s for i, s in zip(items, sizes, strict=True)])


@pytest.mark.parametrize("workspace", [CYLINDER, BOX])
def test_no_random_pose_of_the_workspace_is_worse(workspace: Workspace) -> None:
    requirements = over(workspace, "condition <= 10", "max_torque <= 15", "f_4 <= 450")
    found = check_requirements(APPENDIX_4, requirements, fine=True)
    rng = np.random.default_rng(2)
    offset = rng.uniform(-0.5, 0.5, (40_000, 3)) * workspace.size
    if workspace.shape is WorkspaceShape.CYLINDER:
        offset = offset[np.hypot(offset[:, 0], offset[:, 1]) <= 0.1]
    points = offset + np.array([place or 0.0 for place in workspace.center])
    theta = rng.uniform(-TURN, TURN, len(points))
    poses = np.column_stack([points[:, :2], theta, points[:, 2]])
    reach, _, condition, torque, lift = found.items
    measured = measure_singularity(APPENDIX_4.geometry, poses).condition
    torques = static_torques(APPENDIX_4, poses)
    assert check_reach(APPENDIX_4.geometry, poses).margins.min() >= reach.value
    assert measured.max() <= condition.value * 1.005
    assert np.abs(torques[:, :3]).max() <= torque.value * 1.005
    assert torques[:, 3].max() <= lift.value * 1.005


def test_broken_requirement_is_named_with_its_margin() -> None:
    found = check_requirements(APPENDIX_4, over(CYLINDER, "condition <= 2.5", "f_4 <= 450"))
    assert not found.holds
    assert [item.holds for item in found.items] == [True, True, False, True]
    assert found.items[2].margin == pytest.approx(2.5 - found.items[2].value)
    assert found.items[2].margin < 0.0


def test_workspace_out_of_reach_says_which_leg() -> None:
    far = replace(CYLINDER, center=(0.0, 0.0, -0.95))
    found = check_requirements(APPENDIX_4, over(far, "max_torque <= 15"))
    reach, _, torque = found.items
    assert not reach.holds
    assert reach.reason.startswith("out of reach: leg")
    assert reach.margin < 0.0
    assert math.isnan(torque.value)
    assert torque.margin == -math.inf
    assert torque.reason.startswith("out of reach: leg")
    assert not torque.holds


def test_headings_beyond_the_singular_rotation_break_singularity() -> None:
    requirements = replace(over(CYLINDER, "condition <= 10"), theta=(-1.4, 1.4))
    found = check_requirements(APPENDIX_4, requirements)
    assert not found.items[1].holds
    assert "rotation" in found.items[1].reason


def test_free_center_is_chosen_where_the_workspace_fits() -> None:
    tall = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.6), (None, None, None))
    requirements = over(tall, "condition <= 10", "max_torque <= 15 N m")
    found = check_requirements(APPENDIX_4, requirements)
    assert found.center is not None
    assert math.hypot(*found.center[:2]) < 0.05
    assert found.holds
    high = replace(tall, center=(0.0, 0.0, -0.25))
    assert not check_requirements(APPENDIX_4, replace(requirements, workspace=high)).holds


def test_a_free_center_is_moved_to_where_no_step_is_better() -> None:
    """Of the least margin over the size of its bound, of lengths over that of B4 and B8."""
    g = APPENDIX_4.geometry
    tall = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.4), (0.01, None, None))
    requirements = over(tall, "max_torque <= 15 N m", "condition <= 10")

    def least(center: tuple[float, float, float]) -> float:
        at = replace(requirements, workspace=replace(tall, center=center))
        reach, singular, torque, condition = check_requirements(APPENDIX_4, at).items
        lengths = min(reach.margin, singular.margin) / (g.crank_length + g.coupler_length)
        return min(lengths, torque.margin / 15.0, condition.margin / 10.0)

    start = (0.01, 0.05, -0.4)
    x, y, z = _refined(APPENDIX_4, requirements, start, 0.05)
    assert x == 0.01
    best = least((x, y, z))
    assert best > least(start) + 0.01
    for step in (-0.02, 0.02):
        assert least((x, y + step, z)) <= best + 1e-3
        assert least((x, y, z + step)) <= best + 1e-3


def test_what_takes_long_is_looked_at_in_fewer_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many as the budget allows, with the whole outline and more than one heading."""
    taken: dict[str, tuple[Samples, np.ndarray]] = {}

    def noted(design, bound, index, samples, theta):
        taken[bound.quantity] = samples, theta
        return worst_over(design, bound, index, samples, theta)

    monkeypatch.setattr("paminsa_viz.synthesis.volume.check.worst_over", noted)
    texts = ("condition <= 10", "frequency_1 >= 1 Hz", "clearance >= -1000 mm")
    check_requirements(APPENDIX_4, over(CYLINDER, *texts))
    poses = {key: len(s.positions) * len(s.z) * len(t) for key, (s, t) in taken.items()}
    for key, count in poses.items():
        assert QUANTITIES[key].cost * count <= COARSE.budget
        samples, theta = taken[key]
        assert np.hypot(*samples.positions.T).max() == pytest.approx(0.1)
        assert (theta[0], theta[-1]) == (-TURN, TURN)
    assert poses["frequency_1"] < poses["clearance"] == poses["condition"]


@pytest.mark.parametrize("fine", [False, True])
def test_samples_and_headings_are_the_most_that_can_be_paid_for(
    monkeypatch: pytest.MonkeyPatch, fine: bool
) -> None:
    """One sample less from center to boundary and half the headings, down to one and to five."""
    taken: list[tuple[Samples, np.ndarray]] = []
    item = RequirementCheck("a", "", 0.0, 1.0, None, True)
    monkeypatch.setattr(check, "reach_items", lambda *_: (item, item))
    monkeypatch.setattr(check, "worst_over", lambda *given: taken.append(given[3:]) or item)
    plan = [(3, 5), (2, 5), (1, 5)]
    if fine:
        plan = [(8, 65), (7, 32), (6, 16), (5, 8), (4, 5), *plan]
    budget = (FINE if fine else COARSE).budget
    samples = [sample_workspace(BOX, (0.02, 0.0, -0.55), few) for few, _ in plan]
    counts = [len(s.positions) * len(s.z) * n for s, (_, n) in zip(samples, plan, strict=True)]
    told: list[float] = []
    for number, count in enumerate(counts):
        for share, used in ((0.999, number), (1.001, min(number + 1, len(plan) - 1))):
            entry = replace(QUANTITIES["condition"], cost=share * budget / count)
            monkeypatch.setattr(Requirement, "entry", entry)
            taken.clear()
            told.clear()
            asked = over(BOX, "condition <= 10", "condition <= 5")
            check_requirements(
                APPENDIX_4, asked, fine=fine, progress=lambda done: bool(told.append(done))
            )
            for got, theta in taken:
                np.testing.assert_array_equal(got.positions, samples[used].positions)
                np.testing.assert_array_equal(got.z, samples[used].z)
                assert len(theta) == plan[used][1]
            assert told == [0.0, 0.5]


def test_a_robot_that_takes_no_pose_with_every_heading_says_so() -> None:
    requirements = replace(needs("condition <= 10", "f_4 <= 450"), theta=(-math.pi, math.pi))
    found = check_requirements(APPENDIX_4.vary({"geometry.guide_stroke": 0.05}), requirements)
    assert not found.holds
    assert found.center is None
    assert len(found.items) == 4
    assert not found.items[0].holds
    for index, item in enumerate(found.items[2:]):
        assert (item.requirement, item.pose, item.holds) == (index, None, False)
        assert math.isnan(item.value)
        assert item.margin == -math.inf
        assert item.reason == "no pose can be taken with every heading"


def test_best_center_is_the_deepest_of_all_nodes() -> None:
    box = Workspace(WorkspaceShape.BOX, (0.1, 0.1, 0.2), (None, 0.0, None))
    volume = solve_volume(APPENDIX_4, needs("condition <= 10"), resolution=COARSE)
    x, y, z = best_center(box, volume)
    assert y == 0.0
    half = [round(0.5 * size / volume.cell) for size in box.size]

    def least(i: int, k: int) -> float:
        j = len(volume.y) // 2
        block = volume.depth[
            max(0, i - half[0]) : i + half[0] + 1, j - half[1] : j + half[1] + 1,
            max(0, k - half[2]) : k + half[2] + 1,
        ]  # fmt: skip
        whole = (2 * half[0] + 1) * (2 * half[2] + 1) == block.shape[0] * block.shape[2]
        return float(block.min()) if whole else -math.inf

    scores = [[least(i, k) for k in range(len(volume.z))] for i in range(len(volume.x))]
    chosen = least(int(np.abs(volume.x - x).argmin()), int(np.abs(volume.z - z).argmin()))
    assert chosen == np.max(scores)


def test_over_a_volume_the_worst_of_its_nodes_counts() -> None:
    requirements = needs("condition <= 10", "max_torque <= 15 N m")
    volume = solve_volume(APPENDIX_4, requirements, resolution=COARSE)
    found = check_requirements(APPENDIX_4, requirements, volume=volume)
    assert found.over is Over.VOLUME
    assert found.holds
    for index, item in enumerate(found.items[2:]):
        assert item.margin == pytest.approx(volume.margins[index][volume.inside].min(), rel=1e-9)
    for item in found.items:  # each is shown at a pose of the volume
        assert item.pose is not None
        x, y, _, z = item.pose
        axes = zip((volume.x, volume.y, volume.z), (x, y, z), strict=True)
        at = [int(np.abs(axis - one).argmin()) for axis, one in axes]
        assert volume.inside[tuple(at)]
        assert check_reach(APPENDIX_4.geometry, np.array(item.pose)).ok


def test_empty_volume_shows_the_best_pose_of_each() -> None:
    requirements = needs("condition <= 1.2", "max_torque <= 15 N m")
    found = check_requirements(APPENDIX_4, requirements)
    assert found.over is Over.BEST
    assert [item.holds for item in found.items] == [True, True, False, True]
    # at the center kappa is f or 1/f, f = X_1/(sqrt(2) |R_b cos theta - R_pl|); at theta = 0 it is
    # the root of 2, its largest over these headings and the least of all positions
    assert found.items[2].value == pytest.approx(math.sqrt(2), rel=1e-9)


def test_requirement_at_other_heights_does_not_count() -> None:
    found = check_requirements(APPENDIX_4, over(CYLINDER, "condition <= 1.1 for z -200..-100"))
    assert found.holds
    assert "no height" in found.items[2].reason


def test_samples_have_the_boundary_and_the_corners() -> None:
    cylinder = sample_workspace(CYLINDER, (0.1, 0.2, -0.5), 4)
    radius = np.hypot(*(cylinder.positions - [0.1, 0.2]).T)
    assert radius.max() == pytest.approx(0.1)
    assert radius.min() == 0.0
    assert cylinder.z[[0, -1]].tolist() == pytest.approx([-0.65, -0.35])
    box = sample_workspace(BOX, (0.0, 0.0, -0.5), 4)
    assert np.abs(box.positions).max(axis=0).tolist() == pytest.approx([0.08, 0.1])


def test_same_answer_every_time() -> None:
    requirements = over(replace(CYLINDER, center=(None, None, None)), "condition <= 10")
    first, second = (check_requirements(APPENDIX_4, requirements) for _ in range(2))
    assert first.items == second.items
    assert first.center == second.center


def test_resolution_has_limits() -> None:
    with pytest.raises(ValueError, match="odd number"):
        Resolution(1000, 4, 1.0)
