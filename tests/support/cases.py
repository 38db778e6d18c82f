"""Random robots for the property tests, and the comparisons they share."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, Design, Geometry, KneeBranch
from tests import oracle
from tests.support import samples

BOTH = pytest.mark.parametrize("knee", list(KneeBranch))
"""Runs a test on both branches of the knee."""

PROTOTYPES = pytest.mark.parametrize(
    "design",
    [APPENDIX_4.with_knee(knee) for knee in KneeBranch],
    ids=lambda d: d.geometry.knee.value,
)
"""Runs a test with the robot of Appendix 4 on both branches of the knee."""

OTHER = {KneeBranch.LOWER: KneeBranch.UPPER, KneeBranch.UPPER: KneeBranch.LOWER}
"""The branch of the knee that a robot is not on."""

BY_HAND = np.array([[0.0, 0.0, 0.0, -0.5], [0.05, -0.03, 0.4, -0.6], [-0.04, 0.06, -0.7, -0.45]])
"""Some poses that Appendix 4's robot can take."""


ROBOTS = int(os.environ.get("PAMINSA_VIZ_TEST_ROBOTS", "24"))
"""Different robots; tests share them, and with them what first principles say, worked out once."""


@dataclass(frozen=True)
class Case:
    """A random robot on one of the knee's branches, and poses and motions of it."""

    seed: int
    knee: KneeBranch

    @property
    def design(self) -> Design:
        return _design(self.seed, self.knee)

    @property
    def geometry(self) -> Geometry:
        return self.design.geometry

    def poses(self, n: int = 8, *, natural: bool = False) -> Any:
        """Poses (n, 4) on both sides of the guides, away from every limit and singularity."""
        return _poses(self.seed, self.knee, n, natural)

    def states(self, n: int = 8) -> tuple[Any, Any, Any]:
        """Poses, velocities and accelerations, each (n, 4)."""
        return _states(self.seed, self.knee, n)

    def static_torques(self, n: int = 8, *, natural: bool = False) -> Any:
        """What first principles say of `poses`, (n, 4)."""
        return _static_torques(self, n, natural)

    def driving_torques(self, n: int = 8) -> Any:
        """What first principles say of `states`, (n, 4)."""
        return _driving_torques(self, n)


@cache
def _design(seed: int, knee: KneeBranch) -> Design:
    design = samples.random_design(np.random.default_rng(seed)) if seed else APPENDIX_4
    return design.with_knee(knee)


@cache
def _poses(seed: int, knee: KneeBranch, n: int, natural: bool) -> Any:
    rng = np.random.default_rng(1000 + seed)
    poses = samples.random_poses(rng, _design(seed, knee), n, natural=natural)
    poses.setflags(write=False)
    return poses


@cache
def _states(seed: int, knee: KneeBranch, n: int) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(2000 + seed)
    states = samples.random_states(rng, _design(seed, knee), n)
    for array in states:
        array.setflags(write=False)
    return states


@cache
def _static_torques(case: Case, n: int, natural: bool) -> Any:
    torques = oracle.static_torques(case.design, case.poses(n, natural=natural))
    torques.setflags(write=False)
    return torques


@cache
def _driving_torques(case: Case, n: int) -> Any:
    torques = oracle.inverse_dynamics(case.design, *case.states(n))
    torques.setflags(write=False)
    return torques


def cases() -> st.SearchStrategy[Case]:
    """Draw a robot, number 0 being Appendix 4's, on one of the knee's branches."""
    return st.builds(Case, st.integers(0, ROBOTS - 1), st.sampled_from(KneeBranch))


def worst(actual: Any, expected: Any) -> float:
    """Largest difference over the largest entry of its row (last axis) of ``expected``."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    assert actual.shape == expected.shape
    assert np.isfinite(expected).all()
    size = np.abs(expected).max(axis=-1, keepdims=True)
    return float((np.abs(actual - expected) / size).max())


def assert_close(actual: Any, expected: Any, relative: float) -> None:
    """Each row (last axis) agrees to ``relative`` times its largest entry."""
    difference = worst(actual, expected)
    assert difference <= relative, f"rows differ by up to {difference:.3g} of their largest entry"


def assert_within(actual: Any, expected: Any, distance: float) -> None:
    """Every entry agrees to an absolute distance."""
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=distance)
