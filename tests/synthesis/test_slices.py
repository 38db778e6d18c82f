"""Causes over a map against the pointwise functions."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import Limit, check_reach
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.synthesis.volume.causes import FIRST_REQUIREMENT, CauseKind, cause_slice
from tests.synthesis.robots import needs

X = np.linspace(-0.35, 0.35, 36)
Y = np.linspace(-0.35, 0.35, 31)


@pytest.mark.parametrize(("theta", "z"), [(0.0, -0.5), (0.4, -0.85), (-0.3, -0.2)])
def test_causes_are_those_of_each_pose(theta: float, z: float) -> None:
    found = cause_slice(APPENDIX_4, needs("condition <= 6", "max_torque <= 8 N m"), X, Y, theta, z)
    poses = np.empty((len(Y), len(X), 4))
    poses[..., 0], poses[..., 1] = X, Y[:, None]
    poses[..., 2], poses[..., 3] = theta, z
    reach = check_reach(APPENDIX_4.geometry, poses)
    singular = measure_singularity(APPENDIX_4.geometry, poses)
    torque = np.abs(static_torques(APPENDIX_4, poses)[..., :3]).max(axis=-1)
    kinds = np.array([cause.kind for cause in found.causes])[found.cause]
    np.testing.assert_array_equal(kinds == CauseKind.REACH, ~reach.ok)
    legs = np.array([-1 if c.leg is None else c.leg for c in found.causes])[found.cause]
    np.testing.assert_array_equal(legs, reach.leg)
    for code in np.unique(found.cause[kinds == CauseKind.REACH]):
        limit = {int(s) for s in reach.status[found.cause == code]}
        word = found.causes[code].word.partition(":")[0]
        assert {Limit(s).word for s in limit} == {word}
    beyond = reach.ok & (singular.position_distance <= 0.0)
    np.testing.assert_array_equal(kinds == CauseKind.SINGULAR, beyond)
    rest = reach.ok & ~beyond
    with np.errstate(invalid="ignore"):
        np.testing.assert_array_equal(found.broken[0][rest], singular.condition[rest] > 6.0)
        np.testing.assert_array_equal(found.broken[1][rest], torque[rest] > 8.0)
    np.testing.assert_array_equal(kinds[rest] == CauseKind.INSIDE, ~found.broken.any(axis=0)[rest])


def test_worst_of_two_requirements_is_named() -> None:
    found = cause_slice(APPENDIX_4, needs("condition <= 100", "condition <= 2"), X, Y, 0.0, -0.5)
    only = found.broken[1] & ~found.broken[0]
    assert (found.cause[only & (found.cause >= FIRST_REQUIREMENT)] == FIRST_REQUIREMENT + 1).all()


def test_requirement_of_other_headings_or_heights_does_not_count() -> None:
    at = (X, Y, 0.4, -0.5)
    assert not cause_slice(APPENDIX_4, needs("condition <= 1 for theta 0..20"), *at).broken.any()
    assert not cause_slice(APPENDIX_4, needs("condition <= 1 for z -900..-600"), *at).broken.any()
    assert cause_slice(APPENDIX_4, needs("condition <= 1 for z -900..-500"), *at).broken.any()
