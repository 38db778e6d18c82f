"""Trial robots: reach, footprint and values over a workspace are those of the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    BarLaw,
    Counterweight,
    KneeBranch,
    LoadCase,
    check_reach,
    inverse_kinematics,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.lumped import lumped_coefficients, mass_vector
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Evaluator, Guide, Regime, SynthesisCase
from paminsa_viz.synthesis.search.evaluation import STAGES
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.region import SPARSE
from paminsa_viz.synthesis.search.trial import Robots
from tests.synthesis.search_cases import CELL, CONDITION, CYLINDER

GOOD = {
    "cylinder": (CYLINDER, (0.295, 0.085, 4.8, 0.79, 0.28, -0.77)),
    "cell": (CELL, (0.6702834, 0.1002359, 2.920975, 0.7759312, 1.5903797, -1.6207451)),
}
"""Cases with numbers that meet all their requirements."""


def poses_of(workspace: Workspace, theta: tuple[float, float], count: int, seed: int) -> np.ndarray:
    """Random poses of a workspace, a part of them on its outline and at the ends of theta."""
    rng = np.random.default_rng(seed)
    share = np.where(
        rng.random(count) < 0.5, rng.choice([-0.5, 0.5], count), rng.uniform(-0.5, 0.5, count)
    )
    z = workspace.center[2] + workspace.size[2] * share
    turn = np.where(rng.random(count) < 0.5, rng.choice(theta, count), rng.uniform(*theta, count))
    if workspace.shape is WorkspaceShape.CYLINDER:
        angle = rng.uniform(0, 2 * np.pi, count)
        radius = 0.5 * workspace.size[0] * np.where(rng.random(count) < 0.7, 1, rng.random(count))
        xy = radius * np.array([np.cos(angle), np.sin(angle)])
    else:
        xy = rng.uniform(-0.5, 0.5, (2, count))
        pinned = rng.integers(0, 4, count)
        for axis in (0, 1):
            on_side = (pinned == axis) | (pinned == 2)
            xy[axis] = np.where(on_side, rng.choice([-0.5, 0.5], count), xy[axis])
        xy = xy * np.array(workspace.size[:2])[:, None]
    x, y = xy + np.array(workspace.center[:2])[:, None]
    return np.stack([x, y, turn, z], axis=-1)


@pytest.mark.parametrize("name", GOOD)
def test_trial_agrees_with_the_model_at_dense_poses(name: str) -> None:
    case, numbers = GOOD[name]
    found = Evaluator(case, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    assert found.stage == STAGES
    trial = found.trial
    assert trial is not None
    design = trial.design
    poses = poses_of(trial.workspace, case.requirements.theta, 20000, 2)
    assert check_reach(design.geometry, poses).ok.all()
    expected = {
        "condition": measure_singularity(design.geometry, poses).condition,
        "max_torque": np.abs(static_torques(design, poses)[:, :3]).max(axis=1),
        "f_4": static_torques(design, poses)[:, 3],
    }
    for bound, value in zip(case.requirements.bounds, found.worst, strict=True):
        assert value == pytest.approx(expected[bound.quantity].max(), rel=0.01)
    points = inverse_kinematics(design.geometry, poses).points
    swept = [np.hypot(*np.moveaxis(points[j], -1, 0)[:2]).max() for j in (5, 8, 9)]
    assert trial.radii[:3] == pytest.approx(swept, rel=0.005)
    # the guide's end is on the line from the leg axis through joint 8
    axis, eight = points[3][..., :2], points[8][..., :2]
    away = (eight - axis) / np.linalg.norm(eight - axis, axis=-1, keepdims=True)
    end = np.linalg.norm(axis + design.geometry.guide_link_length * away, axis=-1).max()
    assert trial.radii[3] == pytest.approx(end, rel=0.005)
    assert trial.footprint == max(trial.radii) == trial.radii[2]


def test_appendix_4_has_the_footprint_of_its_knees() -> None:
    # R_f of Appendix 4 over this cylinder, its center 550 mm below the guides: 0.818 m
    held = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4), (0.0, 0.0, -0.55))
    case = replace(
        CYLINDER, requirements=replace(CYLINDER.requirements, workspace=held), guide=Guide.KEPT,
        ranges=CYLINDER.ranges[:1],
    )  # fmt: skip
    found = Evaluator(case, Regime.SMALLER).evaluate(np.array([[0.35]]))[0]
    assert found.objective == pytest.approx(0.818, abs=5e-4)
    trial = found.trial
    assert trial is not None
    assert trial.design.geometry == APPENDIX_4.geometry
    assert trial.radii[0] == pytest.approx(0.15 + 0.1)


def random_numbers(case: SynthesisCase, count: int) -> np.ndarray:
    low, high = case.bounds.T
    return np.random.default_rng(4).uniform(low, high, (count, len(low)))


@pytest.mark.parametrize("bars", [BarLaw(), BarLaw(grow=True, tubes=True)])
def test_masses_of_a_batch_are_those_of_single_designs(bars: BarLaw) -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.5), Counterweight("b3", 7, 0.2, 0.7))
    case = replace(
        CELL, bars=bars, reference=replace(CELL.reference, counterweights=weights),
        requirements=replace(CELL.requirements, bounds=()),
    )  # fmt: skip
    found = Evaluator(case, Regime.SMALLER).evaluate(random_numbers(case, 300))
    trials = [item.trial for item in found if item.trial is not None]
    assert len(trials) > 3
    for trial in trials:
        grown = trial.geometry.base_radius - case.reference.geometry.base_radius
        assert trial.geometry.arm_length == pytest.approx(0.308 + grown)
        assert trial.masses == pytest.approx(mass_vector(trial.design), rel=1e-12)
        c = lumped_coefficients(trial.design)
        assert trial.coefficients == pytest.approx(c, rel=1e-11, abs=1e-12)


def test_guide_that_follows_is_as_long_as_the_workspace_takes() -> None:
    case, numbers = GOOD["cylinder"]
    trial = Evaluator(case, Regime.SMALLER).evaluate(np.array([numbers]))[0].trial
    assert trial is not None
    poses = poses_of(trial.workspace, case.requirements.theta, 20000, 3)
    margin = check_reach(trial.geometry, poses).margins[..., 2].min()
    assert case.margin < margin < case.margin + 1e-3


def test_symmetry_of_the_legs_changes_no_value() -> None:
    for case, numbers in GOOD.values():
        single = tuple(Requirement(f"tau_{n}", low=-1e3, high=1e3) for n in (1, 2, 3))
        bounds = case.requirements.bounds + single
        whole = replace(case, requirements=replace(case.requirements, bounds=bounds))
        part, all_of_it = (
            Evaluator(c, Regime.SMALLER).evaluate(np.array([numbers]))[0] for c in (case, whole)
        )
        count = len(case.requirements.bounds)
        assert all_of_it.worst[:count] == pytest.approx(part.worst, rel=1e-9)
        assert all_of_it.objective == pytest.approx(part.objective, rel=1e-9)
        assert np.abs(all_of_it.worst[count:]).max() > 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "quantity", ["error_x", "selective_y", "pressure_2", "stiffness_x", "clearance_platform"]
)
def test_what_is_of_one_leg_or_one_direction_is_looked_for_in_the_whole_workspace(
    quantity: str,
) -> None:
    """Though the legs are alike, and headings the same to both sides."""
    case, numbers = GOOD["cylinder"]
    bound = Requirement(quantity, low=-1e9, high=1e9)
    case = replace(case, requirements=replace(case.requirements, bounds=(CONDITION, bound)))
    one = Evaluator(case, Regime.SMALLER, density=SPARSE)
    assert one._poses.alike
    (trial,) = Robots.of(case, np.array([numbers])).trials(one._poses, [0])
    ((_, found),) = one._others(trial)
    pose = Extent(trial.workspace, case.requirements.theta).samples(SPARSE)
    values = [
        bound.entry.over(solve_field(trial.geometry, Grid.over(p, theta=p[2:3])), trial.design)
        for p in pose
    ]
    assert found == pytest.approx((np.min(values), np.max(values)), rel=1e-6)


@pytest.mark.slow
def test_quantities_without_a_kernel_come_from_the_registry() -> None:
    case, numbers = GOOD["cylinder"]
    bounds = (
        *case.requirements.bounds,
        Requirement("conditioning", low=0.1),
        Requirement("determinant", high=0.0),
        Requirement("transmission", low=0.05),
    )
    more = replace(case, requirements=replace(case.requirements, bounds=bounds))
    found = Evaluator(more, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    assert found.feasible
    assert found.worst[1] == pytest.approx(1 / found.worst[0])
    worse = replace(bounds[3], low=float(found.worst[3]) + 1e-6)
    more = replace(case, requirements=replace(case.requirements, bounds=(*bounds[:3], worse)))
    failed = Evaluator(more, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    assert failed.stage == STAGES - 1


def test_load_and_upper_knee() -> None:
    case, numbers = GOOD["cell"]
    load = LoadCase(30.0, -20.0, -80.0, moment_z=4.0, point_x=0.05)
    loaded = replace(case, reference=replace(case.reference, load=load))
    found = Evaluator(loaded, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    trial = found.trial
    assert trial is not None
    poses = poses_of(trial.workspace, case.requirements.theta, 20000, 5)
    torque = static_torques(trial.design, poses)
    low, high = trial.torques(case.requirements.theta)
    assert high[:4] == pytest.approx(torque.max(axis=0), rel=0.02)
    assert low[:4] == pytest.approx(torque.min(axis=0), rel=0.02)

    offset = 2 * case.reference.geometry.platform_joint_height
    above = replace(case, reference=case.reference.with_knee(KneeBranch.UPPER))
    mirrored = (*numbers[:-1], -numbers[-1] - offset)
    other = Evaluator(above, Regime.SMALLER).evaluate(np.array([mirrored]))[0]
    plain = Evaluator(case, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    assert other.trial is not None
    assert other.objective == pytest.approx(plain.objective, rel=1e-9)
    assert other.worst[:2] == pytest.approx(plain.worst[:2], rel=1e-9)


def test_bounds_over_a_part_of_headings_and_heights() -> None:
    case, numbers = GOOD["cell"]
    z = numbers[-1]
    parts = (
        Requirement("max_torque", high=1e4, z=(z, z + 0.1)),
        Requirement("max_torque", high=1e4, theta=(0.1, 0.3)),
        Requirement("max_torque", high=0.0, z=(z + 1.0, z + 2.0)),
    )
    some = replace(case, requirements=replace(case.requirements, bounds=parts))
    found = Evaluator(some, Regime.SMALLER).evaluate(np.array([numbers]))[0]
    assert found.feasible  # heights outside the workspace ask for nothing
    assert np.isnan(found.worst[2])
    trial = found.trial
    assert trial is not None
    poses = poses_of(trial.workspace, case.requirements.theta, 40000, 7)
    torque = np.abs(static_torques(trial.design, poses)[:, :3]).max(axis=1)
    high = (poses[:, 3] >= z) & (poses[:, 3] <= z + 0.1)
    turned = (poses[:, 2] >= 0.1) & (poses[:, 2] <= 0.3)
    assert found.worst[0] == pytest.approx(torque[high].max(), rel=0.01)
    assert found.worst[1] == pytest.approx(torque[turned].max(), rel=0.01)
    assert torque.max() > torque[high].max() * 1.02
    assert torque.max() > torque[turned].max() * 1.02
