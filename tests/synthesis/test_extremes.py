"""Least values over a workspace: of the worst samples, and of a search from them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.synthesis.search import extremes
from paminsa_viz.synthesis.search.extremes import (
    OVER_POSES,
    Extent,
    Valued,
    least_of,
    least_on_samples,
    least_over,
)
from paminsa_viz.synthesis.search.region import SPARSE, Density
from tests.synthesis.search_cases import TURN

SPACE = Workspace(WorkspaceShape.BOX, (0.2, 0.4, 0.3), (0.1, 0.0, -0.6))


@pytest.mark.parametrize("density", [Density(4, 2, 3, 5), Density(4, 2, 1, 1)])
def test_a_pattern_search_starts_with_steps_to_the_next_sample(
    monkeypatch: pytest.MonkeyPatch, density: Density
) -> None:
    """Along the axes and eight directions to both sides, halved where nothing is better."""
    monkeypatch.setattr(Extent, "clipped", lambda self, pose: pose)
    extent, asked = Extent(SPACE, (-0.2, 0.4)), []
    start = extent.samples(density)[3]

    def values(poses: Any) -> Any:
        asked.append(poses)
        return Valued(np.where((poses == start).all(axis=1), 0.0, 1.0))

    found = least_over(values, extent, density, starts=1)
    assert (found.value, found.pose.tolist()) == (0.0, start.tolist())
    size = 0.5 * np.array([0.2, 0.4, 0.6, 0.3])
    steps = size / [2.0, 2.0, max(density.theta - 1.0, 1.0), max(density.z - 1.0, 1.0)]
    turned = np.random.default_rng(0).normal(size=(8, 4))
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    axes = np.concatenate([np.eye(4), -np.eye(4), turned, -turned])
    for number, near in enumerate(asked[1:4]):
        np.testing.assert_allclose((near - start) / steps * 2.0**number, axes, atol=1e-9)
    assert len(asked) == 1 + 24


def test_a_search_ends_at_the_first_pose_without_a_value() -> None:
    """From one start in the first round; the other one would find such a pose later."""
    box = Workspace(WorkspaceShape.BOX, (0.2, 0.2, 0.2), (0.0, 0.0, -0.5))

    def values(poses: Any) -> Any:
        x, y, theta, z = poses.T
        low = np.minimum(1.0 + np.abs(x + 0.093), 1.02 + np.abs(x - 0.1))
        none = (np.abs(x + 0.093) < 5e-4) | (np.abs(x - 0.05) < 1e-3)
        off = 10.0 * (np.abs(y - 0.1) + np.abs(theta) + np.abs(z + 0.5))
        return Valued(np.where(none, -np.inf, low + off))

    found = least_over(values, Extent(box, (-0.1, 0.1)), SPARSE, starts=2)
    assert found.value == -np.inf
    assert found.pose == pytest.approx([0.05, 0.1, 0.0, -0.5])


def test_least_value_is_found_between_samples_and_on_the_boundary() -> None:
    space = Workspace(WorkspaceShape.CYLINDER, (0.4, 0.4, 0.2), (0.0, 0.0, -0.5))
    extent = Extent(space, (-TURN, TURN))
    inside = np.array([0.07, -0.05, 0.31, -0.46])
    found = least_over(lambda p: Valued(((p - inside) ** 2).sum(axis=-1)), extent, SPARSE)
    assert found.pose == pytest.approx(inside, abs=1e-3)
    assert found.value < 1e-6
    outside = np.array([0.5, 0.3, 2.0, -1.0])
    found = least_over(lambda p: Valued(((p - outside) ** 2).sum(axis=-1)), extent, SPARSE)
    edge = 0.2 * outside[:2] / np.linalg.norm(outside[:2])
    assert found.pose == pytest.approx([*edge, TURN, -0.6], abs=1e-3)
    for pose in extent.random(200), extent.clipped(np.random.default_rng(0).normal(size=(50, 4))):
        assert (np.hypot(pose[:, 0], pose[:, 1]) <= 0.2 + 1e-12).all()
        assert (np.abs(pose[:, 2]) <= TURN).all()
        assert (np.abs(pose[:, 3] + 0.5) <= 0.1).all()
    upper = extent.within((-0.45, 1.0))
    assert upper is not None
    assert upper.heights == pytest.approx((-0.45, -0.4))
    assert extent.within((0.0, 1.0)) is None


def test_least_value_of_what_is_worse_between_samples_than_at_them() -> None:
    """Two wells: one has the worst samples, the other, between samples, the least value."""
    extent = Extent(Workspace(WorkspaceShape.BOX, (2.0, 2.0, 2.0), (0.0, 0.0, -3.0)), (-1.0, 1.0))
    sampled = extent.samples(SPARSE)
    wide = sampled[np.argmin(np.linalg.norm(sampled - [0.5, 0.5, 0.0, -3.0], axis=1))]
    away = np.linalg.norm(sampled - [-0.6, -0.6, 0.0, -3.0], axis=1)
    narrow = sampled[np.argmin(away)] + 0.05

    def wells(pose: np.ndarray) -> np.ndarray:
        first = 0.02 * np.maximum(np.linalg.norm(pose - wide, axis=-1) - 1.0, 0.0)
        second = 4.8 * np.linalg.norm(pose - narrow, axis=-1) - 0.475
        return np.stack([first, second])

    def of_two(pose: np.ndarray) -> Valued:
        return Valued(wells(pose).min(axis=0), wells(pose).argmin(axis=0))

    alike = least_over(lambda pose: Valued(of_two(pose).value), extent, SPARSE)
    assert alike.value == pytest.approx(0.0, abs=1e-6)
    found = least_over(of_two, extent, SPARSE)
    assert -0.475 <= found.value < -0.4
    assert found.pose == pytest.approx(narrow, abs=0.02)


def test_samples_that_do_not_count_do_not_end_the_search_from_the_others() -> None:
    """They are of a kind of their own: no pair of bodies is the nearest in a pose out of reach."""
    box = Workspace(WorkspaceShape.BOX, (0.2, 0.2, 0.2), (0.0, 0.0, -0.5))
    least = np.array([0.05, 0.013, 0.021, -0.47])

    def values(pose: np.ndarray) -> Valued:
        away = np.linalg.norm(pose - least, axis=1)
        return Valued(np.where(pose[:, 0] < 0.0, np.inf, away), np.where(pose[:, 0] < 0.0, -1, 0))

    found = least_over(values, Extent(box, (-0.1, 0.1)), SPARSE)
    assert found.pose == pytest.approx(least, abs=1e-3)


@pytest.mark.parametrize("quantity", OVER_POSES)
def test_quantities_of_single_poses_are_those_of_the_registry(quantity: str) -> None:
    """And minus infinity, of which nothing is worse, where there is none."""
    pose = np.array([[0.05, -0.03, 0.2, -0.5], [-0.02, 0.04, -0.3, -0.6], [0.0, 0.0, 0.0, -3.0]])
    found = OVER_POSES[quantity](APPENDIX_4, pose).value
    entry = Requirement(quantity, low=0.0).entry
    for place, value in zip(pose[:2], found, strict=False):
        field = solve_field(APPENDIX_4.geometry, Grid.over(place, theta=place[2:3]))
        assert value == pytest.approx(float(entry.over(field, APPENDIX_4)[0]), rel=1e-9)
    assert found[2] == -np.inf


@pytest.mark.slow
def test_samples_alone_have_the_least_of_themselves() -> None:
    """With a search from them it is less, by as much as it is between them."""
    extent = Extent(Workspace(WorkspaceShape.BOX, (0.1, 0.1, 0.1), (0.0, 0.0, -0.5)), (-0.1, 0.1))
    pose = extent.samples(SPARSE)
    for quantity in ("clearance", "stiffness_horizontal"):
        values = OVER_POSES[quantity](APPENDIX_4, pose).value
        assert least_on_samples(quantity, APPENDIX_4, extent) == values.min()
        found = least_of(quantity, APPENDIX_4, extent, SPARSE, starts=1)
        assert found.value <= values.min()
        again = OVER_POSES[quantity](APPENDIX_4, found.pose).value
        assert found.value == pytest.approx(float(again))


def test_samples_are_measured_once_though_the_search_goes_on_from_every_pair(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def measured(design: Any, pose: Any) -> Any:
        asked.append(len(pose))
        return SimpleNamespace(least=pose[:, 0], pair=np.arange(len(pose)) % 2)

    monkeypatch.setattr(extremes, "clearance", measured)
    extent = Extent(SPACE, (-0.2, 0.4))
    least_of("clearance", APPENDIX_4, extent, SPARSE, starts=1)
    assert asked[0] == len(extent.samples(SPARSE))
    assert asked[1:] == [2 * 24] * extremes.ROUNDS  # the worst sample of each of two pairs


@pytest.mark.parametrize("starts", [0, 1, 3])
def test_the_first_of_equal_samples_stays_and_none_is_worse_than_none(starts: int) -> None:
    extent = Extent(SPACE, (-0.2, 0.4))
    samples = extent.samples(SPARSE)
    flat = least_over(lambda pose: Valued(np.zeros(len(pose))), extent, SPARSE, starts=starts)
    assert (flat.value, flat.pose.tolist()) == (0.0, samples[0].tolist())

    def values(pose: Any) -> Any:
        return Valued(np.where((pose == samples[5]).all(axis=1), -np.inf, pose[:, 0]))

    def between(pose: Any) -> Any:
        return Valued(np.linalg.norm(pose - samples[5] - 0.01, axis=1))

    found = least_over(between, extent, SPARSE, starts=starts)
    assert (found.value == between(samples).value.min()) == (starts == 0)
    none = least_over(values, extent, SPARSE, starts=starts)
    assert (none.value, none.pose.tolist()) == (-np.inf, samples[5].tolist())
