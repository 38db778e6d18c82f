"""Random robots for the property tests, and the comparisons they share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from paminsa_viz.model import APPENDIX_4, Assembly, Design, Geometry
from tests import samples

BOTH = pytest.mark.parametrize("assembly", list(Assembly))
"""Runs a test in both assembly modes."""

BY_HAND = np.array([[0.0, 0.0, 0.0, -0.5], [0.05, -0.03, 0.4, -0.6], [-0.04, 0.06, -0.7, -0.45]])
"""Some poses that Appendix 4's robot can take."""


@dataclass(frozen=True)
class Case:
    """A random robot in one of the assembly modes, and poses and motions of it."""

    seed: int
    assembly: Assembly
    design: Design

    @property
    def geometry(self) -> Geometry:
        return self.design.geometry

    def poses(self, n: int = 8, *, natural: bool = False) -> Any:
        """Poses (n, 4) on both sides of the guides, away from every limit and singularity."""
        rng = np.random.default_rng(self.seed + 1)
        return samples.random_poses(rng, self.design, self.assembly, n, natural=natural)

    def states(self, n: int = 8) -> tuple[Any, Any, Any]:
        """Poses, velocities and accelerations, each (n, 4)."""
        rng = np.random.default_rng(self.seed + 2)
        return samples.random_states(rng, self.design, self.assembly, n)


@st.composite
def cases(draw: st.DrawFn, *, payload: bool = True) -> Case:
    """Draw a robot: Appendix 4's now and then, a random one otherwise."""
    seed = draw(st.integers(0, 2**32 - 1))
    assembly = draw(st.sampled_from(Assembly))
    if seed == 0:
        return Case(seed, assembly, APPENDIX_4)
    return Case(seed, assembly, samples.random_design(np.random.default_rng(seed), payload=payload))


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
