"""A leg in its plane, the nine equations of three of them, and their derivatives by differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.model import APPENDIX_4, KneeBranch, check_reach, inverse_kinematics
from paminsa_viz.precision import unequal_legs
from paminsa_viz.precision.closure_equations import (
    ACTUATORS,
    SLIDES,
    STATE,
    _turns,
    closure_equations,
)
from paminsa_viz.precision.leg_lengths import INDEX, nominal_lengths
from paminsa_viz.precision.leg_plane import PLANE_INPUTS, joint_5_derivatives, solve_leg
from paminsa_viz.precision.unequal_legs import nominal_pose, solve_actuators, solve_pose
from tests.precision.deviations import random_deviations
from tests.support.samples import random_poses

COUNT = 6
BOTH = pytest.mark.parametrize("knee", list(KneeBranch))


def states(knee: KneeBranch, tilt: float = 0.05) -> tuple[Any, Any]:
    """Lengths and states near solutions, which fulfill no equation exactly."""
    design = APPENDIX_4.with_knee(knee)
    rng = np.random.default_rng(1)
    found = nominal_pose(design.geometry, random_poses(rng, design, COUNT))
    state = np.concatenate([found.coordinates, found.slides, found.actuators], axis=1)
    state += rng.uniform(-3e-3, 3e-3, state.shape)
    state[:, 4:6] = rng.uniform(-tilt, tilt, (COUNT, 2))
    return nominal_lengths(design.geometry) + random_deviations(2, 4e-3, COUNT), state


def sized(lengths: Any, name: str) -> Any:
    return lengths[..., INDEX[name]]


@BOTH
def test_bars_of_a_leg_are_as_long_as_they_are_and_meet(knee: KneeBranch) -> None:
    """From 8 over 7 to 3, and over 9 and 4; joints 7 and 9 are on the sides of the nominal leg."""
    lengths, state = states(knee)
    slide, lift = state[:, SLIDES], state[:, 12:13]
    plane = solve_leg(lengths, slide, lift, knee.sign)
    joint_8 = np.stack([slide, sized(lengths, "guide_height")], axis=-1)
    joint_3 = np.stack([0 * slide, lift - sized(lengths, "shaft")], axis=-1)

    def along(bar: str, *names: str) -> Any:
        return sum(sized(lengths, name) for name in names)[..., None] * getattr(plane, bar)

    for bar in ("bar_89", "bar_94", "bar_43", "bar_87"):
        np.testing.assert_allclose(np.linalg.norm(getattr(plane, bar), axis=-1), 1.0, rtol=1e-12)
    joint_7 = joint_8 + along("bar_87", "bar_87")
    np.testing.assert_allclose(joint_3 + along("bar_43", "bar_37"), joint_7, atol=1e-12)
    joint_9 = joint_8 + along("bar_89", "bar_89")
    joint_4 = joint_9 + along("bar_94", "bar_94")
    np.testing.assert_allclose(joint_4 + along("bar_43", "bar_43"), joint_3, atol=1e-12)
    np.testing.assert_allclose(
        plane.joint_5, joint_9 + along("bar_94", "bar_94", "bar_45"), atol=1e-12
    )
    for joint, end, side in ((joint_7, joint_3, 1.0), (joint_9, joint_4, -1.0)):
        line, off = end - joint_8, joint - joint_8
        left = line[..., 0] * off[..., 1] - line[..., 1] * off[..., 0]
        np.testing.assert_array_equal(np.sign(left), side * knee.sign)


@BOTH
def test_joint_5_moves_with_each_length_as_differences_say(knee: KneeBranch) -> None:
    lengths, state = states(knee)
    slide, lift = state[:, SLIDES], np.repeat(state[:, 12:13], 3, axis=1)

    def joint_5(name: str, step: float) -> Any:
        given = {"slide": slide, "lift": lift}
        changed = lengths.copy()
        if name in given:
            given[name] = given[name] + step
        else:
            changed[..., INDEX[name]] += step
        return solve_leg(changed, given["slide"], given["lift"], knee.sign).joint_5

    found = joint_5_derivatives(lengths, solve_leg(lengths, slide, lift, knee.sign))
    for index, name in enumerate(PLANE_INPUTS):
        slope = (joint_5(name, 1e-6) - joint_5(name, -1e-6)) / 2e-6
        np.testing.assert_allclose(found[..., index], slope, atol=1e-7, err_msg=name)


@BOTH
def test_gaps_are_joints_5_of_the_legs_minus_those_of_the_platform(knee: KneeBranch) -> None:
    lengths, state = states(knee)
    gap = closure_equations(lengths, state, knee.sign).gap.reshape(COUNT, 3, 3)
    plane = solve_leg(lengths, state[:, SLIDES], state[:, 12:13], knee.sign)
    tilt = np.column_stack([state[:, 4:6], np.zeros(COUNT)])
    turn = Rotation.from_euler("z", state[:, 2:3]) * Rotation.from_rotvec(tilt)
    for leg, axis in enumerate(np.radians([210.0, -30.0, 90.0])):
        outward, inner = (sized(lengths, name)[:, leg] for name in ("axis_angle", "joint_angle"))
        np.testing.assert_allclose(np.mod(outward - axis + 1.0, 2 * np.pi), 1.0, atol=0.01)
        heading = state[:, 9 + leg] + sized(lengths, "actuator_zero")[:, leg]
        # theta_k = 0 where the leg points from its axis to the middle
        beta = heading + axis + np.pi
        r, z = plane.joint_5[:, leg].T
        away = sized(lengths, "axis_radius")[:, leg]
        own = np.stack(
            [
                away * np.cos(outward) + r * np.cos(beta),
                away * np.sin(outward) + r * np.sin(beta),
                z,
            ],
            axis=-1,
        )
        beside = sized(lengths, "joint_radius")[:, leg]
        height = sized(lengths, "joint_height")[:, leg]
        held = turn.apply(np.stack([beside * np.cos(inner), beside * np.sin(inner), height], -1))
        np.testing.assert_allclose(gap[:, leg], own - held - state[:, [0, 1, 3]], atol=1e-12)


@BOTH
@pytest.mark.parametrize("tilt", [0.0, 0.004, 0.3], ids=["none", "small", "large"])
def test_derivatives_of_the_equations_are_their_differences(knee: KneeBranch, tilt: float) -> None:
    lengths, state = states(knee, tilt)
    found = closure_equations(lengths, state, knee.sign)
    for column in range(STATE):
        step = 1e-6 * np.eye(STATE)[column]
        ahead, behind = (
            closure_equations(lengths, state + s, knee.sign).gap for s in (step, -step)
        )
        slope = (ahead - behind) / 2e-6
        np.testing.assert_allclose(found.by_state[:, :, column], slope, atol=1e-7)
    for name, index in INDEX.items():
        step = np.zeros(14)
        step[index] = 1e-6
        ahead, behind = (
            closure_equations(lengths + s, state, knee.sign).gap for s in (step, -step)
        )
        slope = ((ahead - behind) / 2e-6).reshape(COUNT, 3, 3)
        np.testing.assert_allclose(found.by_length[..., index], slope, atol=1e-7, err_msg=name)
    # another leg's length changes nothing
    own = lengths.copy()
    own[:, 0] += 1e-3
    changed = closure_equations(own, state, knee.sign).gap - found.gap
    assert not changed[:, 3:].any()


def test_tilts_turn_as_their_exponentials_from_tiny_to_large_ones() -> None:
    """exp(t + dt) = exp(t) exp(J dt), also next to where a series takes over."""
    rng = np.random.default_rng(3)
    for size in (0.0, 1e-9, 1e-4, 0.00999, 0.01001, 0.5, 2.5):
        way = rng.normal(size=2)
        tilt = size * way / np.linalg.norm(way)
        jacobian = _turns(np.zeros(1), tilt[None])[1][0]
        for axis in range(2):
            step = 1e-5 * np.eye(3)[axis]
            ahead, behind = (Rotation.from_rotvec(np.append(tilt, 0.0) + s) for s in (step, -step))
            turned = (behind.inv() * ahead).as_rotvec() / 2e-5
            np.testing.assert_allclose(jacobian[:, axis], turned, atol=1e-9)


def test_steps_of_the_search_are_at_most_a_tenth_and_lead_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a meter or a radian, from a start some way off; the last one is done without a look."""
    geometry, seen = APPENDIX_4.geometry, []

    def noted(lengths: Any, state: Any, root: float) -> Any:
        seen.append(state.copy())
        return closure_equations(lengths, state, root)

    monkeypatch.setattr(unequal_legs, "closure_equations", noted)
    pose = np.array([0.02, -0.03, 0.2, -0.5])
    lengths = nominal_lengths(geometry) + random_deviations(1, 1e-3)
    wanted = solve_actuators(geometry, lengths, pose)
    seen.clear()
    found = solve_pose(geometry, lengths, wanted.actuators, pose + np.array([0.0, 0.0, -0.55, 0.0]))
    np.testing.assert_allclose(found.pose, pose, atol=1e-12)
    steps = np.abs(np.diff(np.concatenate(seen), axis=0)).max(axis=1)
    assert steps.max() == pytest.approx(0.1, rel=1e-12)
    assert steps[:3].tolist() == pytest.approx([0.1] * 3)
    assert steps[-1] > 1e-9 > np.abs(seen[-1][0, :4] - found.pose).max()
    assert len(seen) < 15
    np.testing.assert_array_equal(seen[0][0, ACTUATORS], wanted.actuators)


def test_a_pose_farther_than_a_singularity_is_not_found_beyond_it() -> None:
    """The sign of the determinant is that at the start: the other assembly is none."""
    geometry = APPENDIX_4.geometry
    turned = np.array([0.0, 0.0, 1.5, -0.5])  # beyond the singular angle of 1.281
    lengths = nominal_lengths(geometry)
    actuators = solve_actuators(geometry, lengths, turned).actuators
    there = solve_pose(geometry, lengths, actuators, turned)
    np.testing.assert_allclose(there.pose, turned, atol=1e-12)
    before = solve_pose(geometry, lengths, actuators, [0.0, 0.0, 1.0, -0.5])
    assert not before.ok or abs(before.pose[2]) < 1.281


@pytest.mark.slow
def test_a_step_that_leads_nowhere_is_halved_until_nothing_is_left_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Trials go back to where the last good one was: each time half of what is left of the way."""
    geometry, seen = APPENDIX_4.geometry, []
    drawn = np.random.default_rng(0).uniform(
        [-0.3, -0.3, -1.2, -0.96], [0.3, 0.3, 1.2, -0.1], (1000, 4)
    )
    poses = drawn[check_reach(geometry, drawn).ok]
    lengths = nominal_lengths(geometry) + random_deviations(0, 1e-3, len(poses))
    actuators = inverse_kinematics(geometry, poses).actuators
    lost = np.flatnonzero(~solve_pose(geometry, lengths, actuators, poses).ok)

    def noted(lengths: Any, state: Any, root: float) -> Any:
        seen.append(state[0].copy())
        return closure_equations(lengths, state, root)

    monkeypatch.setattr(unequal_legs, "closure_equations", noted)
    halved = 0
    for place in lost[:5]:
        seen.clear()
        solve_pose(geometry, lengths[place], actuators[place], poses[place])
        way = np.linalg.norm(np.diff(seen[-4:], axis=0), axis=1)
        if len(seen) > 25:  # some end where they began
            np.testing.assert_allclose(way[1:] / way[:-1], 0.5, rtol=1e-3)
            halved += 1
    assert halved > 2
