"""The room of counterweights: no pose needs more, and it is not much more than poses need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    Geometry,
    KneeBranch,
    leg_points,
    singular_radius,
    singular_rotation,
)
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.leg_points import CounterweightClearance, counterweight_clearance
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.reach import Limit
from tests.support.cases import BOTH
from tests.support.samples import random_design, with_knee

ENDS = [(bar, end) for bar, ends in BAR_ENDS.items() for end in ends]


def met(
    design: Design, weight: Counterweight, rng: np.random.Generator, n: int
) -> CounterweightClearance | None:
    """Return the same of random poses, from the joints' positions; None if none is reached."""
    g, sign = design.geometry, design.geometry.knee.sign
    turn = singular_rotation(g)
    theta = rng.uniform(-turn, turn, n)
    away = singular_radius(g, theta) * np.sqrt(rng.uniform(size=n))
    angle = rng.uniform(0, 2 * np.pi, n)
    depth = rng.uniform(0, g.crank_length + g.coupler_length, n)
    height = -sign * depth - g.platform_joint_height
    pose = np.stack([away * np.cos(angle), away * np.sin(angle), theta, height], axis=-1)
    configuration = inverse_kinematics(g, pose)
    good = configuration.reach.status == Limit.OK
    if not good.any():
        return None
    near, far, axis, five = (
        configuration.points[joint][good] for joint in (weight.joint, weight.other, 3, 5)
    )
    along = (near - far) / np.linalg.norm(near - far, axis=-1, keepdims=True)
    point = near + weight.beyond * along
    toward = (five - axis)[..., :2]
    rho = np.linalg.norm(toward, axis=-1)
    r = ((point - axis)[..., :2] * toward).sum(axis=-1) / rho
    z = point[..., 2]
    # By the time it comes to the robot's axis it has come near: 5 mm in so many random poses.
    meets = np.linalg.norm(point[..., :2], axis=-1) <= 0.005
    meets |= (sign * (z - five[..., 2]) <= 0) & (r >= rho)
    deep = np.where(meets, depth[good][:, None], 0.0)
    return CounterweightClearance(r.max(), -r.min(), z.min(), z.max(), deep.max())


@pytest.mark.slow
@given(
    st.integers(0, 10**6),
    st.sampled_from(ENDS),
    st.floats(-0.3, 0.3),
    st.sampled_from(list(KneeBranch)),
)
def test_no_random_pose_needs_more(seed, end, beyond, knee) -> None:
    rng = np.random.default_rng(seed)
    design, weight = random_design(rng), Counterweight(end[0], end[1], beyond, 1.0)
    found = met(with_knee(design, knee), weight, rng, 6_000)
    if found is None:
        return
    room = counterweight_clearance(with_knee(design.geometry, knee), weight)
    assert room is not None
    assert room.inward >= found.inward
    assert room.outward >= found.outward
    assert room.low <= found.low
    assert room.high >= found.high
    nearly = counterweight_clearance(with_knee(design.geometry, knee), weight, 0.005)
    assert nearly is not None
    assert nearly.clear_depth >= found.clear_depth


@pytest.mark.slow
@BOTH
def test_the_robot_of_appendix_4_comes_close_to_it(knee) -> None:
    weight = Counterweight("b3", 7, 0.2, 1.0)
    found = met(with_knee(APPENDIX_4, knee), weight, np.random.default_rng(1), 50_000)
    room = counterweight_clearance(with_knee(APPENDIX_4.geometry, knee), weight)
    assert found is not None
    assert room is not None
    for name in ("inward", "outward", "low", "high", "clear_depth"):
        assert getattr(room, name) == pytest.approx(getattr(found, name), abs=0.04), name


@BOTH
def test_a_platform_as_large_as_the_base_has_a_room(knee) -> None:
    wide = replace(with_knee(APPENDIX_4, knee).geometry, platform_radius=0.36)
    room = counterweight_clearance(wide, Counterweight("b3", 7, 0.2, 1.0))
    assert room is not None
    assert np.isfinite([room.inward, room.outward, room.low, room.high]).all()


def by_cells(
    g: Geometry, weight: Counterweight, radius: float, cells: int
) -> CounterweightClearance | None:
    """The same from the joints in the plane of the leg, at the middle of every cell (phi, psi).

    What is a sum of sines and cosines of both moves in half a cell by no more than its largest
    slopes say.
    """
    half, k, sign = np.pi / cells, g.magnification, g.knee.sign

    def joints(phi: Any, psi: Any) -> dict[int, Any]:
        """Places r + i z, from the leg axis toward the platform and up from the guides."""
        b8 = g.crank_length * np.stack([np.cos(phi) + 0 * psi, np.sin(phi) + 0 * psi])
        b4 = g.coupler_length * np.stack([np.cos(psi) + 0 * phi, np.sin(psi) + 0 * phi])
        eight = np.stack([-(b8 + b4)[0] / k, 0 * b8[0]])
        nine = eight + b8
        return {8: eight, 9: nine, 5: nine + b4, 4: nine + b4 / k, 7: eight + b4 / k}

    def point(phi: Any, psi: Any) -> Any:
        at = joints(phi, psi)
        near, far = at[weight.joint], at[weight.other]
        length = g.coupler_length if weight.bar == "b4" else g.crank_length
        length = g.coupler_length / k if weight.bar == "b7" else length
        return near + weight.beyond / length * (near - far)

    def change(place: Callable[[Any, Any], Any]) -> Any:
        """Most that r and z of a place move in half a cell."""
        right, up = np.array(np.pi / 2), np.array(0.0)
        step = 1e-30j
        slopes = [
            abs(place(at + step, at).imag) + abs(place(at, at + step).imag) for at in (right, up)
        ]
        return half / 1e-30 * np.array([slopes[0][0], slopes[1][1]])

    middle = (2 * np.arange(cells) + 1) * half - np.pi
    phi, psi = np.meshgrid(middle, middle, indexing="ij")
    (rho, height), (r, z) = joints(phi, psi)[5], point(phi, psi)
    rho_more, height_more = change(lambda *at: joints(*at)[5])
    r_more, z_more = change(point) + radius
    circle = singular_radius(g, np.nan_to_num(singular_rotation(g), nan=np.pi))
    farthest = min(2 * float(circle), g.stroke * (k - 1))
    taken = (rho >= g.axis_clearance - rho_more) & (rho <= farthest + rho_more)
    taken &= (sign * height <= height_more) & (sign * np.sin(psi - phi) >= -2 * half)
    if not taken.any():
        return None
    rho, height, r, z = rho[taken], height[taken], r[taken], z[taken]
    depth = height_more - sign * height
    meets = (sign * (z - height) <= z_more + height_more) & (r - rho >= -r_more - rho_more)
    rb, rp = g.base_radius, g.platform_radius
    behind = rb * np.cos(np.arcsin(rp / rb)) if rp < rb else rb + r
    meets |= np.where(r > 0, rb - r, behind) <= r_more
    deepest = depth[meets].max(initial=0.0)
    return CounterweightClearance(
        r.max() + r_more, r_more - r.min(), z.min() - z_more, z.max() + z_more,
        np.inf if deepest == depth.max() else deepest,
    )  # fmt: skip


@pytest.mark.parametrize("end", ENDS)
def test_rooms_are_those_of_the_joints_in_all_cells(
    end: tuple[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(ENDS.index(end))
    depths = set()
    for number in range(12):
        cells = 480 if number == 0 and end == ENDS[0] else 48
        monkeypatch.setattr(leg_points, "CELLS", cells)
        g = random_design(rng).geometry if number else APPENDIX_4.geometry
        # larger than the base, and nearly as large: legs turn far from the center
        wide = {2: 1.1 * g.base_radius, 3: 0.99 * g.base_radius}
        g = replace(
            g,
            knee=list(KneeBranch)[number % 2],
            axis_clearance=rng.choice([0.0, 0.3]) * g.base_radius,
            guide_stroke=g.stroke * rng.choice([0.4, 1.0, 3.0]),
            platform_radius=wide.get(number, g.platform_radius),
        )
        weight = Counterweight(*end, beyond=rng.uniform(-0.3, 0.3), mass=1.0)
        for radius in (0.0, 0.05):
            found = counterweight_clearance.__wrapped__(g, weight, radius)
            expected = by_cells(g, weight, radius, cells)
            assert (found is None) == (expected is None)
            if found is not None and expected is not None:
                assert astuple(found) == pytest.approx(astuple(expected), rel=1e-12)
                depths.add(np.inf if np.isinf(found.clear_depth) else found.clear_depth > 0)
    assert len(depths) > 1


def test_a_disc_needs_its_radius_more() -> None:
    weight = Counterweight("b8", 8, 0.2, 1.0)
    point = counterweight_clearance(APPENDIX_4.geometry, weight)
    disc = counterweight_clearance(APPENDIX_4.geometry, weight, 0.05)
    assert point is not None
    assert disc is not None
    assert disc.inward == pytest.approx(point.inward + 0.05)
    assert disc.outward == pytest.approx(point.outward + 0.05)
    assert disc.high - disc.low == pytest.approx(point.high - point.low + 0.1)
    assert disc.clear_depth >= point.clear_depth


def test_a_robot_that_reaches_nothing_has_no_room() -> None:
    short = replace(APPENDIX_4.geometry, crank_length=0.01, coupler_length=0.9)
    weight = Counterweight("b8", 8, 0.2, 1.0)
    assert counterweight_clearance(replace(short, axis_clearance=0.7), weight) is None


@pytest.mark.slow
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_knee_of_the_other_branch_needs_no_room(knee: KneeBranch) -> None:
    """Bars B4 and B7 lean the other way there, by decimeters; random poses come within some cm."""
    design, rng = with_knee(APPENDIX_4, knee), np.random.default_rng(3)
    for bar, joint in (("b4", 9), ("b7", 8)):
        weight = Counterweight(bar, joint, 0.15, 2.0)
        found = met(design, weight, rng, 40_000)
        room = counterweight_clearance(design.geometry, weight)
        assert found is not None
        assert room is not None
        assert found.inward < room.inward < found.inward + 0.1
        assert found.outward < room.outward < found.outward + 0.05
