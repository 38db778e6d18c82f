"""A payload: nothing for M1..M3 at rest, and the time scalings at which it does not matter."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.actuation.payload import payload_change, payload_time_scaling
from paminsa_viz.balancing import balance
from paminsa_viz.engines.poses import workspace_poses
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, static_torques
from paminsa_viz.trajectory import PRESET, analyze
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


@pytest.mark.parametrize("key", ["paper-like", "trapezoid", "circle", "arch"])
def test_at_the_time_scaling_the_motion_itself_changes_by_the_share(key: str) -> None:
    plan = PRESET[key].build(APPENDIX_4.geometry)
    found = payload_time_scaling(APPENDIX_4, plan.sample(500), 5.0, 0.05)
    carrying = APPENDIX_4.vary({"payload.mass": 5.0})
    for reading, slower in zip(("largest", "peak", "rms"), found, strict=True):
        motion = plan.lasting(slower * plan.duration).sample(500 / slower)
        one, two = (analyze(d, motion).torque[:, :3] for d in (APPENDIX_4, carrying))
        peak = np.abs(one).max(axis=0)
        summary = [[a.rms for a in analyze(d, motion).summary[:3]] for d in (APPENDIX_4, carrying)]
        value = {
            "largest": (np.abs(two - one).max(axis=0) / peak).max(),
            "peak": np.abs(np.abs(two).max(axis=0) / peak - 1).max(),
            "rms": np.abs(np.divide(*summary[::-1]) - 1).max(),
        }[reading]
        assert value == pytest.approx(0.05, rel=1e-3)
        quicker = payload_change(APPENDIX_4, plan.sample(500), 5.0, 0.99 * slower)
        assert getattr(quicker, reading) > 0.05
        assert getattr(payload_change(APPENDIX_4, plan.sample(500), 5.0, 20.0), reading) < 0.05


def test_a_balanced_robot_has_no_such_scaling() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(300)
    balanced = balance(APPENDIX_4).after
    assert np.isnan(payload_time_scaling(balanced, motion, 5.0)).all()
    shares = [payload_change(balanced, motion, 5.0, s).largest for s in (1.0, 3.0)]
    assert shares[0] == pytest.approx(shares[1], rel=1e-6)
    assert payload_time_scaling(APPENDIX_4, motion, 0.0).largest == 0
    with pytest.raises(InvalidInput):
        payload_time_scaling(APPENDIX_4, motion, 1.0, share=0.0)
