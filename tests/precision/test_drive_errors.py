"""Errors of the pose from the drives: exact corners, dense sampling, what has no bound."""

from __future__ import annotations

import sys
import tracemalloc
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import size_of
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    Design,
    check_reach,
    forward_kinematics,
    inverse_kinematics,
    jacobian,
    measure_singularity,
    singular_radius,
    singular_rotation,
    solve_field,
    xy_grid,
)
from paminsa_viz.model.accuracy import DriveAccuracy
from paminsa_viz.model.grids import WRENCH_TORQUES
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.precision import drive_corners
from paminsa_viz.precision.drive_corners import CORNERS
from paminsa_viz.precision.drive_errors import Bound, DriveErrors, drive_errors, field_drive_errors
from tests.precision.boxes import boxes, edge_points, moved, random_boxes, samples
from tests.support.samples import each_robot, random_design, random_poses

GEOMETRY = APPENDIX_4.geometry
LENGTHS = [path for path, p in PARAMETER.items() if path.startswith("geometry.") and p.unit == "m"]
DEFAULT = DriveAccuracy()
HOME = (0.02, -0.01, 0.1, -0.5)


def wide(factor: float) -> DriveAccuracy:
    """The default accuracy, times a factor."""
    return DriveAccuracy(DEFAULT.resolution_rotary * factor, DEFAULT.resolution_linear * factor)


@each_robot(range(3))
def test_corners_are_forward_kinematics_in_the_same_assembly_mode(design: Design) -> None:
    rng = np.random.default_rng(1)
    poses = random_poses(rng, design, 60, natural=False)
    found = drive_errors(design.geometry, DEFAULT, poses)
    assert found.ok.all()
    half = np.array(DEFAULT.half_widths)
    steps = np.concatenate([CORNERS, np.ones((8, 1))], axis=1) * half
    exact = moved(design, poses, steps)
    np.testing.assert_allclose(found.corners, exact[..., :3], atol=1e-12)
    worst = found.worst[:, :3] - found.between[:, :3]
    np.testing.assert_allclose(worst, np.abs(exact[..., :3]).max(axis=1), atol=1e-12)
    np.testing.assert_allclose(found.worst[:, 3], exact[:, 0, 3], atol=1e-12)
    sideways = np.hypot(exact[..., 0], exact[..., 1]).max(axis=1)
    np.testing.assert_allclose(found.horizontal - found.between[:, 3], sideways, atol=1e-12)


def test_edge_that_is_worse_than_its_corners_is_bounded() -> None:
    """A box whose edge has 2.4 percent more of y than any corner."""
    geometry = replace(
        GEOMETRY, magnification=5.20317, base_radius=0.10045, platform_radius=0.12672,
        crank_length=1.16161, coupler_length=1.36778, platform_joint_height=0.15921,
    )  # fmt: skip
    poses = np.array([(-0.5795797, 0.1179652, -1.2845887, -0.5588531)])
    accuracy = DriveAccuracy(resolution_rotary=2 * np.radians(1.97))
    box = boxes(replace(APPENDIX_4, geometry=geometry), poses, accuracy)
    edges = box.worst(edge_points(box.half, 400))
    assert edges[0, 1] > 1.02 * box.corners[0, 1]
    assert (edges <= box.bounds * (1 + 1e-9)).all()
    np.testing.assert_allclose(box.bounds, edges, rtol=1e-5)


@pytest.mark.slow
def test_worst_errors_are_those_of_the_edges() -> None:
    """No point of a box is worse than stated, and some point of an edge is as bad."""
    rng = np.random.default_rng(21)
    exceeded = number = 0
    for box in random_boxes(rng, 24, 10):
        edges, inside = box.worst(edge_points(box.half, 41)), box.worst(samples(rng, box.half, 99))
        assert (np.maximum(edges, inside) <= box.bounds * (1 + 1e-9)).all()
        assert (box.bounds <= edges * (1 + 2e-3)).all()
        assert not box.found.between[:, 2].any()
        exceeded += int((edges > box.corners * (1 + 1e-3)).any(axis=1).sum())
        number += len(edges)
    assert number > 100
    assert exceeded > 0


@pytest.mark.slow
def test_theta_is_worst_in_a_corner_also_where_legs_become_parallel() -> None:
    """d theta / d q_j is zero where the two other legs are parallel, which q_j does not change."""
    rng = np.random.default_rng(4)
    parallel = 0
    for box in random_boxes(rng, 12):
        beta = inverse_kinematics(box.design.geometry, box.found.pose).beta
        apart = np.abs(np.sin(beta - np.roll(beta, 1, axis=1))).min(axis=1)
        chosen = apart < np.sin(2 * box.half[0])
        parallel += int(chosen.sum())
        inside = box.worst(samples(rng, box.half, 300))
        assert (inside[chosen, 2] <= box.corners[chosen, 2] * (1 + 1e-9)).all()
    assert parallel > 5


PLATFORM_WIDER = replace(GEOMETRY, base_radius=0.2, platform_radius=0.3)


@pytest.mark.slow
@pytest.mark.parametrize("geometry", [GEOMETRY, PLATFORM_WIDER], ids=["appendix4", "R_pl>R_b"])
def test_a_bounded_box_holds_no_singularity(geometry: Any) -> None:
    """Of wide boxes many are refused; in none of the others does a determinant change its sign."""
    rng = np.random.default_rng(4)
    poses = rng.uniform([-0.25, -0.25, -1.3, -0.6], [0.25, 0.25, 1.3, -0.2], (4000, 4))
    near, angle = poses[:3000], rng.uniform(0, 2 * np.pi, 3000)  # many at the singular circle
    radius = singular_radius(geometry, near[:, 2]) + rng.uniform(-0.06, 0.06, 3000)
    near[:, 0], near[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    poses = poses[check_reach(geometry, poses).ok]
    design = replace(APPENDIX_4, geometry=geometry)
    accuracy = DriveAccuracy(resolution_rotary=np.radians(6.0))
    found = drive_errors(geometry, accuracy, poses)
    counts = np.bincount(found.status, minlength=len(Bound))
    assert counts[Bound.OK] > 100
    assert counts[Bound.SINGULARITY] > 5
    assert counts[Bound.NOT_ASSEMBLED] > 20
    kept = poses[found.ok][:600]
    steps = samples(rng, np.array(accuracy.half_widths), 300)
    inside = moved(design, kept, steps) + kept[:, None]
    assert np.isfinite(inside).all()

    def side(pose: Any) -> Any:
        turn = geometry.base_radius * np.cos(pose[..., 2]) - geometry.platform_radius
        place = singular_radius(geometry, pose[..., 2]) - np.hypot(pose[..., 0], pose[..., 1])
        return np.sign(turn * place)

    assert (side(inside) == side(kept)[:, None]).all()


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.06, -0.03), (-0.02, 0.09)])
def test_the_box_is_refused_as_soon_as_it_reaches_the_fold(place: tuple[float, float]) -> None:
    """Toward the singular angle: as far as all its points have a platform, to two percent."""
    half = DEFAULT.half_widths[0]
    gaps = np.geomspace(1e-4, 0.5, 4000)
    poses = np.zeros((4000, 4))
    poses[:, :2], poses[:, 3] = place, -0.3
    poses[:, 2] = singular_rotation(GEOMETRY) - gaps
    found = drive_errors(GEOMETRY, DEFAULT, poses)
    actuators = inverse_kinematics(GEOMETRY, poses).actuators[:, None].repeat(8, axis=1)
    actuators[..., :3] += half * CORNERS
    assembled = np.isfinite(forward_kinematics(GEOMETRY, actuators).pose).all(axis=(-1, -2, -3))
    np.testing.assert_array_equal(found.status == Bound.NOT_ASSEMBLED, ~assembled)
    first_assembled, first_bounded = gaps[np.argmax(assembled)], gaps[np.argmax(found.ok)]
    assert first_assembled <= first_bounded < 1.02 * first_assembled
    # The linear estimate is a finite number there, and less than what is left to the singularity.
    last = np.argmax(assembled) - 1
    assert found.linear[last, 2] < gaps[last]
    assert np.isnan(found.worst[last]).all()


@each_robot(range(1))
def test_the_linear_estimate_is_the_jacobian_times_the_half_widths(design: Design) -> None:
    accuracy = DriveAccuracy(2e-4, 3e-5, 4e-4, 1e-5, 1e-4, 2e-5)
    poses = random_poses(np.random.default_rng(8), design, 30)
    found = drive_errors(design.geometry, accuracy, poses)
    j, half = jacobian(design.geometry, poses), np.array(accuracy.half_widths)
    np.testing.assert_allclose(found.linear, np.abs(j) @ half, rtol=1e-9)
    corners = CORNERS * half[:3] @ np.swapaxes(j[:, :2, :3], 1, 2)
    np.testing.assert_allclose(
        found.linear_horizontal, np.linalg.norm(corners, axis=-1).max(axis=-1), rtol=1e-9
    )


@pytest.mark.slow
def test_rms_is_that_of_independent_uniform_errors() -> None:
    accuracy = DriveAccuracy(2e-4, 3e-5, 4e-4, 1e-5, 1e-4, 2e-5)
    rng = np.random.default_rng(5)
    rotary = (rng.uniform(-0.5, 0.5, (2, 200_000, 3)) * [[[2e-4]], [[4e-4]]]).sum(axis=0)
    linear = rng.uniform(-0.5, 0.5, (2, 200_000, 1)) * [[[3e-5]], [[1e-5]]]
    rotary += rng.uniform(-1e-4, 1e-4, rotary.shape)
    lift = linear.sum(axis=0) + rng.uniform(-2e-5, 2e-5, (200_000, 1))
    steps = np.concatenate([rotary, lift], axis=1)
    found = drive_errors(GEOMETRY, accuracy, HOME)
    off = moved(APPENDIX_4, np.array([HOME]), steps)[0]
    np.testing.assert_allclose(found.rms, off.std(axis=0), rtol=0.01)
    distance = np.sqrt((off[:, :2] ** 2).sum(axis=1).mean())
    assert found.rms_horizontal == pytest.approx(distance, rel=0.01)
    assert (np.abs(steps).max(axis=0) <= accuracy.half_widths).all()
    assert np.abs(steps).max(axis=0) == pytest.approx(accuracy.half_widths, rel=0.1)


@pytest.mark.slow
def test_the_median_over_usable_poses_is_some_70_um_and_115_arcsec() -> None:
    """Half a count of 0.01 degrees and 10 um, away from limits and singularities.

    Of the tests' own poses: |theta| up to 69 degrees, 5 percent off every limit.
    """
    poses = random_poses(np.random.default_rng(6), APPENDIX_4, 5000)
    found = drive_errors(GEOMETRY, DEFAULT, poses)
    both = np.hypot(found.linear[:, 0], found.linear[:, 1])
    assert np.median(both) == pytest.approx(68e-6, rel=0.04)
    assert np.median(found.linear[:, 2]) == pytest.approx(np.radians(113 / 3600), rel=0.04)
    np.testing.assert_allclose(found.worst[:, 3], 15e-6, rtol=1e-12)


def test_limits_of_reach_within_the_errors_are_named() -> None:
    """A pose a micrometer from stretching a leg; at a tenth of the accuracy it has a bound."""
    low, high = -1.2, -0.5
    for _ in range(60):
        z = (low + high) / 2
        low, high = (low, z) if check_reach(GEOMETRY, (0.05, 0.02, 0.1, z)).ok else (z, high)
    pose = (0.05, 0.02, 0.1, high + 5e-6)
    reach = check_reach(GEOMETRY, (0.05, 0.02, 0.1, low))
    found = drive_errors(GEOMETRY, DEFAULT, pose)
    assert found.status == Bound.LIMIT
    assert found.leg == reach.leg
    assert f"leg {reach.leg + 1} passes a limit" in Bound.LIMIT.reason(int(found.leg))
    assert np.isfinite(found.linear).all()
    assert np.isnan(found.worst).all()
    assert drive_errors(GEOMETRY, wide(0.05), pose).ok
    lift_alone = replace(DEFAULT, resolution_rotary=0.0)
    assert drive_errors(GEOMETRY, lift_alone, pose).status == Bound.LIMIT


def test_poses_out_of_reach_and_singular_ones_have_no_numbers() -> None:
    radius = float(singular_radius(GEOMETRY, 0.3))
    poses = np.array([(0.0, 0.0, 0.0, -2.0), (radius, 0.0, 0.3, -0.3), HOME, [np.nan] * 4])
    assert measure_singularity(GEOMETRY, poses[1]).condition > 1e9
    found = drive_errors(GEOMETRY, DEFAULT, poses)
    assert found.status[[0, 2, 3]].tolist() == [Bound.UNREACHABLE, Bound.OK, Bound.UNREACHABLE]
    assert found.status[1] in (Bound.SINGULAR, Bound.SINGULARITY, Bound.NOT_ASSEMBLED)
    lost = check_reach(GEOMETRY, poses)
    np.testing.assert_array_equal(found.leg, np.where(lost.ok | (lost.leg < 0), -1, lost.leg))
    assert found.leg[0] >= 0
    assert np.isnan(found.linear[[0, 3]]).all()
    assert np.isnan(found.worst[[0, 1, 3]]).all()
    assert np.isfinite(found.horizontal).tolist() == [False, False, True, False]
    fold = (0.01, 0.0, singular_rotation(GEOMETRY), -0.3)
    at = drive_errors(GEOMETRY, DEFAULT, fold)
    assert at.status == Bound.SINGULAR
    assert np.isnan(at.linear).all()
    assert np.isnan(at.rms).all()


def test_perfect_drives_make_no_error() -> None:
    perfect = DriveAccuracy(0.0, 0.0)
    found = drive_errors(GEOMETRY, perfect, HOME)
    assert found.ok
    assert not found.linear.any()
    assert not found.rms.any()
    assert np.abs(found.worst).max() < 1e-14


def test_grids_and_batches_are_the_poses_one_by_one() -> None:
    design = random_design(np.random.default_rng(7))
    grid = xy_grid(np.linspace(-0.4, 0.4, 15), np.linspace(-0.3, 0.4, 13), 0.2, -0.4)
    over = field_drive_errors(solve_field(design.geometry, grid), DEFAULT)
    listed = drive_errors(design.geometry, DEFAULT, grid.poses())
    for name in (
        "linear",
        "worst",
        "rms",
        "linear_horizontal",
        "horizontal",
        "corners",
        "between",
        "rms_horizontal",
        "status",
        "leg",
    ):
        np.testing.assert_allclose(getattr(over, name), getattr(listed, name), rtol=1e-9)
    one = drive_errors(design.geometry, DEFAULT, grid.poses()[3, 4])
    assert (one.status.shape, one.worst.shape) == ((), (4,))
    np.testing.assert_allclose(one.worst, listed.worst[3, 4], rtol=1e-12)
    assert drive_errors(design.geometry, DEFAULT, np.zeros((0, 4))).worst.shape == (0, 4)


def test_over_a_map_they_take_the_memory_of_a_block_of_poses(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grid = xy_grid(np.linspace(-0.4, 0.4, 48), np.linspace(-0.4, 0.4, 48), 0.2, -0.5)
    field, found, most = solve_field(GEOMETRY, grid), [], []
    field.solve(WRENCH_TORQUES)
    for size in (grid.size, 400):
        monkeypatch.setattr(sys.modules[DriveErrors.__module__], "BLOCK", size)
        field_drive_errors.cache_clear()
        tracemalloc.start()
        found.append(field_drive_errors(field, DEFAULT))
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    at_once, in_blocks = (vars(one) for one in found)
    kept = [name for name, value in at_once.items() if isinstance(value, np.ndarray)]
    for name in kept:
        np.testing.assert_array_equal(in_blocks[name], at_once[name], err_msg=name)
    assert (0 < found[0].ok.mean() < 1, len(kept)) == (True, 10)
    assert most[1] < most[0] / 3
    # corners are 24 numbers a pose
    assert size_of(found[1]) < 28 * found[1].worst[..., 0].nbytes


def test_a_pose_has_four_numbers() -> None:
    with pytest.raises(InvalidInput, match="pose"):
        drive_errors(GEOMETRY, DEFAULT, (0.0, 0.0, 0.0))


@pytest.mark.slow
@pytest.mark.parametrize("geometry", [GEOMETRY, PLATFORM_WIDER], ids=["appendix4", "R_pl>R_b"])
def test_modes_that_are_proven_apart_stay_apart_in_the_box(geometry: Any) -> None:
    """By the closure equations at points of the box; most boxes are near what the proof refuses."""
    rng = np.random.default_rng(31)
    poses = rng.uniform([-0.25, -0.25, -1.3, -0.3], [0.25, 0.25, 1.3, -0.3], (3000, 4))
    half = np.radians([2.0, 5.0, 3.0])
    headings = inverse_kinematics(geometry, poses).beta
    proven = drive_corners.corner_errors(geometry, poses, half)[2]
    ratio2 = (geometry.base_radius / geometry.platform_radius) ** 2

    def apart(beta: Any) -> Any:
        axes = np.arctan2(LEG_AXES[:, 1], LEG_AXES[:, 0])
        turn = np.sin(np.roll(beta, -1, axis=-1) - np.roll(beta, -2, axis=-1))
        a = (turn * np.sin(beta - axes)).sum(axis=-1)
        b = (turn * np.cos(beta - axes)).sum(axis=-1)
        return b**2 - (ratio2 - 1.0) * a**2, b

    steps = samples(rng, np.append(half, 0.0), 150)[:, :3]
    room, side = apart(headings[:, None] + steps)
    center = apart(headings)[1]
    free = (room > 0.0).all(axis=1)
    if ratio2 > 1.0:
        free &= (np.sign(side) == np.sign(center)[:, None]).all(axis=1)
    assert not (proven & ~free).any()
    assert proven.sum() > 0.5 * free.sum()


@pytest.mark.slow
def test_a_robot_of_other_size_has_the_same_limits_and_errors_as_large() -> None:
    """Lengths times a factor and angles kept: a test of reach for one size only would miss some."""
    factor, rng = 100.0, np.random.default_rng(5)
    design = APPENDIX_4.vary({"geometry.platform_radius": 0.25, "geometry.base_radius": 0.5})
    large = design.vary({path: factor * design.value(path) for path in LENGTHS}).geometry
    pose = rng.uniform((-0.3, -0.3, -0.3, -0.95), (0.3, 0.3, 0.3, -0.4), (4000, 4))
    scale = np.array([factor, factor, 1.0, factor])
    drives = DriveAccuracy(DEFAULT.resolution_rotary * 200, DEFAULT.resolution_linear)
    other = replace(drives, resolution_linear=factor * drives.resolution_linear)
    found, wanted = (
        drive_errors(geometry, accuracy, poses)
        for geometry, accuracy, poses in (
            (large, other, pose * scale), (design.geometry, drives, pose)
        )
    )  # fmt: skip
    assert np.sum(wanted.status == Bound.LIMIT) > 20
    np.testing.assert_array_equal(found.status, wanted.status)
    np.testing.assert_allclose(found.worst, wanted.worst * scale, rtol=1e-6)


def test_edges_along_which_the_platform_hardly_turns_are_straight() -> None:
    # By symmetry the platform keeps its heading along an edge there, up to rounding.
    radius, angle = np.meshgrid([0.05, 0.125, 0.2], np.radians([30, 150, 270]))
    center = radius * np.cos(angle), radius * np.sin(angle)
    turns = np.concatenate([[0.0], np.logspace(-17, -5, 60)])
    poses = np.stack(
        [
            *(np.broadcast_to(c.reshape(-1, 1), (9, len(turns))) for c in center),
            np.broadcast_to(turns, (9, len(turns))),
            np.full((9, len(turns)), -0.6),
        ],
        axis=-1,
    )
    found = drive_errors(GEOMETRY, DEFAULT, poses)
    assert found.ok.all()
    beside = drive_errors(GEOMETRY, DEFAULT, poses[:, -1:] + [0.0, 0.0, 1e-4, 0.0])
    np.testing.assert_allclose(
        found.horizontal, np.broadcast_to(beside.horizontal, found.horizontal.shape), rtol=1e-3
    )
    np.testing.assert_allclose(
        found.worst, np.broadcast_to(beside.worst, found.worst.shape), rtol=1e-3
    )
