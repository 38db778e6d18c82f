"""The simulated motion of a robot that drifts, beside MuJoCo's under the same torques."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.trajectory import Controller, ControlMode, point_to_point, simulate
from tests.samples import with_knee
from tests.trajectory.plans import A, B


@pytest.mark.parametrize("knee", KneeBranch)
def test_an_unknown_payload_makes_both_drift_alike(knee: KneeBranch) -> None:
    """MuJoCo's loops are springs, its steps finite and its torques linear between samples."""
    pytest.importorskip("mujoco", reason="mujoco comes with the extra 'verify'")
    from paminsa_viz.engines.simulation import play

    height = np.array([0, 0, 0, 0.0 if knee is KneeBranch.LOWER else 0.945])
    samples = point_to_point(A + height, B + height, 0.6).sample(400)
    loaded = APPENDIX_4.vary({"payload.mass": 0.5})
    blind = Controller(ControlMode.FEED_FORWARD)
    model = with_knee(APPENDIX_4, knee)
    ours = simulate(with_knee(loaded, knee), samples, model=model, controller=blind)
    part = slice(0, 101)  # a quarter of a second
    played = play(
        with_knee(loaded, knee), samples.t[part], samples.pose[part], samples.velocity[part],
        ours.torque[part],
    )  # fmt: skip
    drift = np.abs(ours.error[part]).max()
    assert drift > 0.01
    np.testing.assert_allclose(played.poses, ours.pose[part], atol=0.005 * drift)
