"""Loads along a motion, over a grid, and what bearings and bars get of them."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.elastostatics.bar_loads import (
    arm_tip,
    bar_loads,
    bar_stress,
    field_bar_loads,
    utilization,
)
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS, joint_forces
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.reach import Limit
from paminsa_viz.quantities import QUANTITIES, families
from paminsa_viz.trajectory import PRESET, Trajectory, analyze
from tests import oracle


@pytest.fixture(scope="module")
def moved() -> MotionLoads:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(500)
    found = motion_loads(analyze(APPENDIX_4, trajectory))
    assert found is not None
    return found


def test_peak_and_rms_are_those_of_the_samples(moved: MotionLoads) -> None:
    t, size = moved.trajectory.t, moved.magnitude
    np.testing.assert_allclose(moved.peak, size.max(axis=0))
    at_peak = [
        [np.interp(moved.peak_time[i, j], t, size[:, i, j]) for j in range(10)] for i in range(3)
    ]
    np.testing.assert_allclose(at_peak, moved.peak)
    mean = np.trapezoid(size**2, t, axis=0) / (t[-1] - t[0])
    np.testing.assert_allclose(moved.rms, np.sqrt(mean), rtol=1e-4)
    assert (moved.rms <= moved.peak).all()


def test_joints_turn_as_their_bodies_do(moved: MotionLoads) -> None:
    """Against angular velocities from first principles."""
    motion = moved.trajectory
    jets = oracle.jets(motion.pose, motion.velocity, motion.acceleration)
    every = oracle.bodies(APPENDIX_4, jets)
    for leg in range(3):
        turn = {
            body.name.rpartition(" ")[2]: np.stack(np.broadcast_arrays(*oracle.turning(body)), -1)
            for body in every
            if body.name.startswith(f"leg {leg + 1}: B") or body.name == "platform"
        }
        pairs = {
            "m": ("B10", None), "8_b8": ("B8", "B10"), "8_b7": ("B7", "B10"), "9": ("B4", "B8"),
            "4": ("B4", "B3"), "7": ("B3", "B7"), "3": ("B3", "B2"), "2": ("B2", None),
            "5": ("platform", "B4"),
        }  # fmt: skip
        assert {joint.key for joint in JOINTS if joint.turning} == set(pairs)
        for key, (on, by) in pairs.items():
            relative = turn[on] - (turn[by] if by else 0.0)
            found = moved.speed[:, leg, JOINT_INDEX[key]]
            np.testing.assert_allclose(found, np.linalg.norm(relative, axis=-1), atol=1e-12)
        solved = oracle.leg(APPENDIX_4, jets, leg)
        along = oracle.dot(oracle.rate(solved.points[8]), oracle.value(solved.heading))
        np.testing.assert_allclose(
            moved.speed[:, leg, JOINT_INDEX["guide"]], np.abs(along), atol=1e-12
        )


def test_equivalent_load_is_the_force_where_it_is_constant(moved: MotionLoads) -> None:
    assert (moved.equivalent <= moved.peak * (1 + 1e-9)).all()
    constant = replace(moved)
    constant.__dict__["magnitude"] = np.full_like(moved.magnitude, 7.0)
    constant.__dict__["speed"] = moved.speed
    np.testing.assert_allclose(constant.equivalent, 7.0, rtol=1e-12)
    # and of one that grows evenly while a joint turns evenly it is the third root of a fourth
    growing = replace(moved)
    t = moved.trajectory.t
    growing.__dict__["magnitude"] = np.ones_like(moved.magnitude) * (t / t[-1])[:, None, None]
    growing.__dict__["speed"] = np.ones_like(moved.speed)
    np.testing.assert_allclose(growing.equivalent, 0.25 ** (1 / 3), rtol=1e-4)
    # rounding is no motion: of 1e-12 rad/s on nothing is known, a little more is as good as any
    for speed, known in ((0.95e-12, False), (1.05e-12, True)):
        constant = replace(moved)
        constant.__dict__["magnitude"] = np.full_like(moved.magnitude, 7.0)
        constant.__dict__["speed"] = np.full_like(moved.speed, speed)
        np.testing.assert_allclose(constant.equivalent, 7.0 if known else np.nan, rtol=1e-12)
    # a force only while the joint does not turn wears nothing
    still = moved.speed < 1e-3 * moved.speed.max(axis=0)
    resting = replace(moved)
    resting.__dict__["magnitude"] = np.where(still, 1.0, 0.0)
    resting.__dict__["speed"] = np.where(still, 0.0, moved.speed)
    np.testing.assert_allclose(resting.equivalent, 0.0, atol=1e-6)


def test_a_joint_that_does_not_turn_has_no_equivalent_load() -> None:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(100)
    still = replace(
        trajectory,
        pose=np.tile(trajectory.pose[:1], (trajectory.size, 1)),
        velocity=np.zeros((trajectory.size, 4)),
        acceleration=np.zeros((trajectory.size, 4)),
    )
    found = motion_loads(analyze(APPENDIX_4, still))
    assert found is not None
    assert np.isnan(found.equivalent).all()
    at_rest = joint_forces(APPENDIX_4, trajectory.pose[0]).magnitude
    np.testing.assert_allclose(found.peak, at_rest, rtol=1e-12)


def test_a_motions_own_load_acts_and_a_failing_motion_ends_early() -> None:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(100)
    wrench = np.zeros((trajectory.size, 6))
    wrench[:, 2] = -40.0
    pushed = motion_loads(analyze(APPENDIX_4, replace(trajectory, load=wrench)))
    design = replace(APPENDIX_4, load=LoadCase(force_z=-40.0))
    same = motion_loads(analyze(design, trajectory))
    assert pushed is not None
    assert same is not None
    np.testing.assert_allclose(pushed.peak, same.peak, rtol=1e-12)
    far = replace(trajectory, pose=trajectory.pose + np.linspace(0, 1, trajectory.size)[:, None])
    analysis = analyze(APPENDIX_4, far)
    found = motion_loads(analysis)
    assert 0 < analysis.check.until < trajectory.size
    assert found is not None
    assert found.trajectory.size == analysis.check.until
    assert np.isfinite(found.peak).all()
    assert motion_loads(analyze(APPENDIX_4, replace(far, pose=far.pose + 9.0))) is None


@pytest.mark.parametrize("until", [1, 2])
def test_one_sample_that_can_be_taken_is_no_motion(until: int) -> None:
    pose = np.tile([0.0, 0.0, 0.0, -0.5], (until + 1, 1))
    pose[-1, 0] = 9.0  # out of reach
    still = np.zeros_like(pose)
    analysis = analyze(APPENDIX_4, Trajectory(np.arange(until + 1.0), pose, still, still))
    assert analysis.check.until == until
    assert (motion_loads(analysis) is None) is (until == 1)


def test_samples_without_a_force_are_left_out(
    moved: MotionLoads, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As next to a planned crossing; of a motion of such samples alone nothing is known."""
    trajectory = moved.trajectory.take(np.arange(0, moved.trajectory.size, 50))
    analysis = analyze(APPENDIX_4, trajectory)
    lost = trajectory.pose[[2, 5]]

    def flawed(design, pose, *rates, load=None):
        near = (pose[:, None] == lost).all(axis=-1).any(axis=-1)
        return replace(joint_forces(design, pose, *rates, load=load), status=near.astype(np.uint8))

    monkeypatch.setattr(sys.modules[motion_loads.__module__], "joint_forces", flawed)
    found = motion_loads(analysis)
    kept = np.delete(np.arange(trajectory.size), [2, 5])
    assert found is not None
    np.testing.assert_array_equal(found.trajectory.t, trajectory.t[kept])
    states = trajectory.pose, trajectory.velocity, trajectory.acceleration
    every = joint_forces(APPENDIX_4, *states).magnitude
    np.testing.assert_allclose(found.magnitude, every[kept], rtol=1e-12)
    lost = trajectory.pose
    assert motion_loads(analysis) is None
    lost = trajectory.pose[1:]
    assert motion_loads(analysis) is None


def test_bars_have_their_largest_loads_of_the_whole_motion(moved: MotionLoads) -> None:
    short = replace(moved, trajectory=(part := moved.trajectory.take(np.arange(0, 500, 100))),
        forces=joint_forces(APPENDIX_4, part.pose, part.velocity, part.acceleration))  # fmt: skip
    for number, bar in enumerate(BARS):
        values = bar_loads(short.forces, bar).extremes()
        np.testing.assert_array_equal(short.bars[..., number, :], values)
        largest = short.bar_peak[:, number]
        np.testing.assert_array_equal(np.abs(largest), np.abs(values).max(axis=0))
        assert ((values == largest).any(axis=0)).all()  # with their sign
    np.testing.assert_array_equal(short.utilization, utilization(short.forces))


def test_joints_have_names_and_others_are_refused(moved: MotionLoads) -> None:
    assert [joint.name for joint in JOINTS[:2]] == ["bearing of M", "guide"]
    assert JOINTS[JOINT_INDEX["9"]].name == "joint 9"
    np.testing.assert_array_equal(
        moved.forces.of("9"), moved.forces.force[..., JOINT_INDEX["9"], :]
    )
    with pytest.raises(InvalidInput, match=r"joint: there is no '6'"):
        moved.forces.of("6")


def test_stress_is_that_of_dense_samples() -> None:
    forces = joint_forces(APPENDIX_4, [[0.05, -0.03, 0.2, -0.5], [0.0, 0.1, -0.1, -0.6]])
    for bar in BARS:
        loads, section = bar_loads(forces, bar), APPENDIX_4.elastic.section(bar)
        inner = np.abs(loads.at(np.linspace(0, loads.length, 5001)))
        dense = inner[..., 0] / section.area + inner[..., 2] * section.radius / section.inertia_in
        found = bar_stress(forces, loads)
        expected = dense.max(axis=-1)
        if bar == "b1":  # bent sideways as well, most at the carriage
            root = np.abs(arm_tip(forces).sideways) * loads.length
            expected = expected + root * section.radius / section.inertia_out
        np.testing.assert_allclose(found, expected, rtol=2e-3)
        use = utilization(forces)[..., BARS.index(bar)]
        np.testing.assert_allclose(use, found / APPENDIX_4.elastic.yield_stress)
    weaker = APPENDIX_4.vary({"elastic.yield_stress": 120e6})
    again = joint_forces(weaker, [[0.05, -0.03, 0.2, -0.5], [0.0, 0.1, -0.1, -0.6]])
    np.testing.assert_allclose(utilization(again), 2 * utilization(forces), rtol=1e-12)


def test_quantities_are_the_pointwise_functions() -> None:
    design = replace(APPENDIX_4, load=LoadCase(10, 5, -30, 1, 2, 0.5))
    axis = np.linspace(-0.3, 0.45, 9)
    field = solve_field(design.geometry, Grid.over((0, 0, 0.3, -0.5), y=axis, x=axis))
    poses = field.grid.poses()
    forces = joint_forces(design, poses)
    found = {q.key: q.over(field, design) for q in families()["joint forces"]}
    good = field.status == Limit.OK
    assert good.any()
    assert not good.all()
    expected = {
        "joint_force": forces.magnitude.max(axis=(-1, -2)),
        "guide_force": np.abs(forces.of("guide")[..., 2]).max(axis=-1),
        "force_9": np.hypot(*np.moveaxis(forces.of("9")[..., [0, 2]], -1, 0)).max(axis=-1),
        "force_5": np.linalg.norm(forces.of("5"), axis=-1).max(axis=-1),
        "bearing_moment": np.abs(forces.moment[..., JOINT_INDEX["m"]]).max(axis=-1),
        "arm_moment": np.abs(forces.moment[..., JOINT_INDEX["2"]]).max(axis=-1),
        "bar_moment": np.max(
            [np.abs(bar_loads(forces, b).extremes()[..., 2]) for b in BARS], axis=0
        ).max(axis=-1),
        "utilization": utilization(forces).max(axis=(-1, -2)),
    }
    for key, values in expected.items():
        np.testing.assert_allclose(found[key][good], values[good], rtol=1e-12)
    axial = np.max([np.abs(bar_loads(forces, b).extremes()[..., 0]) for b in BARS], axis=0)
    largest = field_bar_loads(field, design)[0]
    np.testing.assert_allclose(largest[good], axial.max(axis=-1)[good], rtol=1e-12)
    for key, values in found.items():
        assert np.isfinite(values[good]).all(), key
        assert np.isnan(values[~good]).all(), key
    assert set(found) <= set(QUANTITIES)
