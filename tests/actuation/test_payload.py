"""A payload: nothing for M1..M3 at rest, and the time scalings at which it does not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.actuation import payload
from paminsa_viz.actuation.payload import _Torques, payload_change, payload_time_scaling
from paminsa_viz.balancing import balance
from paminsa_viz.engines.poses import workspace_poses
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, static_torques
from paminsa_viz.model.load import LoadCase
from paminsa_viz.trajectory import PRESET, analyze
from paminsa_viz.trajectory.integrals import mean_weights
from tests.support.samples import random_design


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_at_rest_the_lift_alone_carries_the_payload(seed: int | None) -> None:
    design = APPENDIX_4 if seed is None else random_design(np.random.default_rng(seed))
    poses = workspace_poses(design.geometry, 200, 0)
    carried = design.payload.mass
    more = design.vary({"payload.mass": carried + 7.0})
    change = static_torques(more, poses) - static_torques(design, poses)
    np.testing.assert_array_equal(change[:, :3], 0.0)
    weight = design.geometry.magnification * 7.0 * design.gravity
    np.testing.assert_allclose(change[:, 3], weight, rtol=1e-11)


RATE = 101.0
"""Of the samples of motions [Hz]: none is where the acceleration of the trapezoid jumps."""


@pytest.mark.slow
@pytest.mark.parametrize("key", ["paper-like", "trapezoid", "circle", "arch"])
def test_at_the_time_scaling_the_motion_itself_changes_by_the_share(key: str) -> None:
    plan = PRESET[key].build(APPENDIX_4.geometry)
    found = payload_time_scaling(APPENDIX_4, plan.sample(RATE), 5.0, 0.05)
    carrying = APPENDIX_4.vary({"payload.mass": 5.0})
    for reading, slower in zip(("largest", "peak", "rms"), found, strict=True):
        motion = plan.lasting(slower * plan.duration).sample(RATE / slower)
        one, two = (analyze(d, motion).torque[:, :3] for d in (APPENDIX_4, carrying))
        peak = np.abs(one).max(axis=0)
        summary = [[a.rms for a in analyze(d, motion).summary[:3]] for d in (APPENDIX_4, carrying)]
        value = {
            "largest": (np.abs(two - one).max(axis=0) / peak).max(),
            "peak": np.abs(np.abs(two).max(axis=0) / peak - 1).max(),
            "rms": np.abs(np.divide(*summary[::-1]) - 1).max(),
        }[reading]
        assert value == pytest.approx(0.05, rel=1e-3)
        quicker = payload_change(APPENDIX_4, plan.sample(RATE), 5.0, 0.99 * slower)
        assert getattr(quicker, reading) > 0.05
        assert getattr(payload_change(APPENDIX_4, plan.sample(RATE), 5.0, 20.0), reading) < 0.05


@pytest.mark.parametrize("seed", range(4))
def test_readings_are_those_of_the_actuator_that_changes_most(seed: int) -> None:
    """Torques with the payload may be larger or smaller; slower, the dynamic part is less."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.1, 0.2, 50))
    gravity, bare = rng.normal(size=(2, 50, 3))
    full = bare * rng.choice([0.5, 1.5], 3) + 0.1 * rng.normal(size=(50, 3))
    for slower in (0.5, 1.0, 3.0):
        one, two = (gravity + part / slower**2 for part in (bare, full))
        changes = []
        for a, b in zip(one.T, two.T, strict=True):
            peak, mean = max(abs(a)), np.sqrt(np.trapezoid(a**2, t) / np.trapezoid(b**2, t))
            changes.append((max(abs(b - a)) / peak, abs(max(abs(b)) / peak - 1), abs(1 / mean - 1)))
        found = _Torques(mean_weights(t), gravity, bare, full).change(slower)
        assert found[:2] == pytest.approx(np.max(changes, axis=0)[:2], rel=1e-12)
        assert found.rms == pytest.approx(max(change[2] for change in changes), rel=0.1)


@pytest.mark.parametrize(
    ("root", "found"),
    [(1050.0, np.nan), (1000.0, 1000.0), (990.0, 990.0), (1.0, 1.0), (1.05e-3, 1.05e-3), (9e-4, 0)],
)
def test_scalings_are_looked_for_between_a_thousandth_and_a_thousand(
    root: float, found: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the payload's torque is at its largest the robot's is zero: its share is c/s^2."""
    gravity, none = np.array([[1.0], [0.0]]) * np.ones(3), np.zeros((2, 3))
    full = np.array([[0.0], [0.05 * root**2]]) * np.ones(3)
    torques = _Torques(np.full(2, 0.5), gravity, none, full)
    monkeypatch.setattr(payload, "_torques", lambda *_: torques)
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(2)
    scaling = payload_time_scaling(APPENDIX_4, motion, 1.0)
    assert scaling.largest == pytest.approx(found, rel=1e-9, nan_ok=True)


@pytest.mark.slow
def test_the_load_stays_and_the_robots_own_payload_and_friction_do_not() -> None:
    design = APPENDIX_4.vary(
        {"payload.mass": 9.0, "payload.inertia": 0.3, "friction.viscous_rotary": 5.0}
    )
    design = replace(design, load=LoadCase(force_x=40.0, moment_z=3.0))
    motion = PRESET["arch"].build(design.geometry).sample(200)
    smooth = design.without_friction().vary({"payload.inertia": 0.0})
    one, two = (
        analyze(smooth.vary({"payload.mass": mass}), motion).torque[:, :3] for mass in (0.0, 5.0)
    )
    found = payload_change(design, motion, 5.0)
    peak = np.abs(one).max(axis=0)
    assert found.largest == pytest.approx((np.abs(two - one).max(axis=0) / peak).max(), rel=1e-9)
    assert found.peak == pytest.approx(np.abs(np.abs(two).max(axis=0) / peak - 1).max(), rel=1e-9)


@pytest.mark.slow
def test_a_balanced_robot_has_no_such_scaling() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(300)
    balanced = balance(APPENDIX_4).after
    assert np.isnan(payload_time_scaling(balanced, motion, 5.0)).all()
    shares = [payload_change(balanced, motion, 5.0, s).largest for s in (1.0, 3.0)]
    assert shares[0] == pytest.approx(shares[1], rel=1e-6)
    assert payload_time_scaling(APPENDIX_4, motion, 0.0).largest == 0
    with pytest.raises(InvalidInput):
        payload_time_scaling(APPENDIX_4, motion, 1.0, share=0.0)
