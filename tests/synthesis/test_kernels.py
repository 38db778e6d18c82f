"""Compiled extremes over poses against the model's own functions, pose by pose."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.clearance.nearest import PRISM
from paminsa_viz.clearance.solids import Primitive
from paminsa_viz.model import (
    APPENDIX_4,
    LoadCase,
    inverse_kinematics,
    lift_constant,
    measure_singularity,
    static_imbalance,
    static_torques,
)
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.reach import home_pose
from paminsa_viz.synthesis.search import kernels
from tests.clearance.pairs_of_solids import outside
from tests.support.samples import random_design

SEEDS = st.integers(0, 10_000)
BLIND = np.zeros((0, 3))


def poses(design: Any, seed: int) -> tuple[Any, Any, Any, Any]:
    """Positions, headings, heights near home, and all poses of them (n, 4)."""
    rng = np.random.default_rng(seed)
    size = 0.1 * design.geometry.base_radius
    home = home_pose(design.geometry)
    xy, theta = rng.uniform(-size, size, (5, 2)), rng.uniform(-0.3, 0.3, 3)
    z = home[3] + rng.uniform(-size, size, 4)
    grid = np.meshgrid(np.arange(5), theta, z, indexing="ij")
    place = grid[0].ravel()
    every = np.column_stack([xy[place], grid[1].ravel(), grid[2].ravel()])
    return xy, theta, z, every


def turns(theta: Any) -> Any:
    return np.stack([np.cos(theta), np.sin(theta)], axis=-1)


@given(seed=SEEDS)
def test_least_and_largest_condition_numbers(seed: int) -> None:
    design = random_design(np.random.default_rng(seed))
    xy, theta, z, every = poses(design, seed)
    conditions = kernels.load()[0]
    found = conditions(mechanism(design.geometry), xy, turns(theta), z[0])
    expected = measure_singularity(design.geometry, every).condition
    assert found == pytest.approx((expected.min(), expected.max()), rel=1e-9)


@given(seed=SEEDS, loaded=st.booleans())
def test_least_and_largest_torques(seed: int, loaded: bool) -> None:
    rng = np.random.default_rng(seed)
    some = loaded * rng.integers(0, 2, 3)  # a force without a moment, or along one axis, as well
    x, y, moment = some * rng.uniform(-30, 30, 3)
    load = LoadCase(x, y, moment_z=moment)
    design = replace(random_design(rng), load=load)
    xy, theta, z, every = poses(design, seed)
    out = np.empty((2, len(kernels.TORQUE_COLUMNS)))
    wrench = np.tile([load.force_x, load.force_y, load.moment_z], (len(theta), 1))
    kernels.load()[1](
        mechanism(design.geometry), static_imbalance(design), lift_constant(design), wrench,
        xy, turns(theta), z, out,
    )  # fmt: skip
    torque = static_torques(design, every)
    columns = [*torque.T, np.abs(torque[:, :3]).max(axis=1)]
    columns.append(np.sqrt((torque[:, :3] ** 2).mean(axis=1)))
    expected = [[c.min() for c in columns], [c.max() for c in columns]]
    assert len(columns) == len(kernels.TORQUE_COLUMNS)
    np.testing.assert_allclose(out, expected, rtol=1e-8, atol=1e-8 * np.abs(torque).max())


def test_poses_that_cannot_be_taken_have_no_bound() -> None:
    design = APPENDIX_4
    m, far, still = mechanism(design.geometry), np.array([[0.0, 0.0], [5.0, 0.0]]), turns([0.0])
    conditions, torques, radii, _ = kernels.load()
    singular = np.array([[0.0, 0.0], [0.25, 0.0]])
    assert conditions(m, singular, still, -0.5)[1] == np.inf
    out = np.empty((2, 6))
    torques(m, 1.0, 1.0, np.zeros((1, 3)), far, still, np.array([-0.5]), out)
    assert (out[0] == -np.inf).all()
    assert (out[1] == np.inf).all()
    largest = np.empty(4)
    radii(m, 0.3, far, still, np.array([-0.5]), largest)
    assert largest[2] == np.inf


@given(seed=SEEDS)
def test_largest_radii_are_those_of_the_joints_and_the_guides_end(seed: int) -> None:
    design = random_design(np.random.default_rng(seed))
    g = design.geometry
    xy, theta, z, every = poses(design, seed)
    out = np.empty(4)
    guide = 0.9 * g.guide_link_length
    kernels.load()[2](mechanism(g), guide, xy, turns(theta), z, out)
    points = inverse_kinematics(g, every).points
    radius = [np.hypot(points[j][..., 0], points[j][..., 1]).max() for j in (5, 8, 9)]
    axis = g.base_radius * np.asarray(LEG_AXES)[:, :2]
    toward = points[5][..., :2] - axis
    toward /= np.linalg.norm(toward, axis=-1, keepdims=True)
    radius.append(np.linalg.norm(axis - guide * toward, axis=-1).max())
    np.testing.assert_allclose(np.sqrt(out), radius, rtol=1e-9)


def plate(rng: np.random.Generator) -> tuple[Any, float, float]:
    """A convex polygon with the heights of a prism over it."""
    angle = np.sort(rng.uniform(0.0, 2 * np.pi / 7, 5)) + 2 * np.pi * np.arange(5) / 5
    corners = rng.uniform(0.05, 0.2) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    low = rng.uniform(-0.02, 0.01)
    return corners, low, low + rng.uniform(0.005, 0.03)


def signed_distance(corners: Any, low: float, top: float, points: Any) -> Any:
    """Distances (n,) of points (n, 3) from the prism, inside those from its nearest face."""
    middle = np.array([0.0, 0.0, (low + top) / 2])
    size = np.array([*np.abs(corners).max(axis=0), (top - low) / 2])
    out = outside(Primitive(PRISM, size, 0.0, corners, np.eye(3), middle), points)
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sides = np.einsum("nij,ij->ni", points[:, None, :2] - corners, normals)
    faces = np.column_stack([sides, low - points[:, 2], points[:, 2] - top])
    return np.where(out > 0.0, out, faces.max(axis=1))


@given(seed=SEEDS)
def test_distance_from_a_plate_is_that_of_its_faces(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners, low, top = plate(rng)
    size = np.abs(corners).max()
    points = rng.uniform(-1.2, 1.2, (300, 3)) * [size, size, 0.04]
    found = np.array([kernels.plate_distance(corners, low, top, *p) for p in points])
    expected = signed_distance(corners, low, top, points)
    assert (expected < 0).any()
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.slow
@given(seed=SEEDS)
def test_distance_of_the_bars_from_the_plate_is_that_of_their_places(seed: int) -> None:
    """B4 of each leg from joint 5 to 9, off the leg plane, as seen from the platform."""
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    g = design.geometry
    corners, low, top = plate(rng)
    layer, radius = rng.uniform(-0.05, 0.05), 0.02
    xy, theta, z, every = poses(design, seed)
    found = kernels.load()[3](
        mechanism(g), layer, radius, corners, low, top, np.inf, xy, turns(theta), z
    )
    points = inverse_kinematics(g, every).points
    axis = g.base_radius * np.asarray(LEG_AXES)[:, :2]
    toward = points[5][..., :2] - axis
    toward /= np.linalg.norm(toward, axis=-1, keepdims=True)
    across = np.stack([-toward[..., 1], toward[..., 0]], axis=-1)
    share = np.linspace(0.0, 1.0, 201)[:, None, None, None]
    line = points[5] + share * (points[9] - points[5])
    line[..., :2] += layer * across
    line[..., 2] -= points[5][..., 2]
    line[..., :2] -= every[:, None, :2]
    c, s = np.cos(every[:, 2:3]), np.sin(every[:, 2:3])
    x, y = c * line[..., 0] + s * line[..., 1], c * line[..., 1] - s * line[..., 0]
    flat = np.stack([x, y, line[..., 2]], axis=-1).reshape(-1, 3)
    least = signed_distance(corners, low, top, flat).min() - radius
    step = g.coupler_length / 200
    assert least - step <= found <= least + 1e-4
    enough = kernels.load()[3](
        mechanism(g), layer, radius, corners, low, top, found - 0.01, xy, turns(theta), z
    )
    assert enough == found - 0.01
