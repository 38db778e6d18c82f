"""Random robots of both regimes, and boxes of poses that they can take."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st

from paminsa_viz.model import Design, KneeBranch, LoadCase, LoadFrame, check_reach
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import WorkspaceShape
from paminsa_viz.synthesis.proof.regions import PoseRegion, from_unit
from tests.support.samples import random_design


@st.composite
def robots(draw: st.DrawFn) -> Design:
    """Draw a robot with either knee, R_pl below or above R_b, with or without a load."""
    rng = np.random.default_rng(draw(st.integers(0, 2**16)))
    design = random_design(rng)
    g = replace(design.geometry, knee=draw(st.sampled_from(KneeBranch)))
    if draw(st.booleans()):
        g = replace(g, base_radius=g.platform_radius, platform_radius=g.base_radius)
    load = LoadCase()
    if draw(st.booleans()):
        numbers = rng.uniform(-20.0, 20.0, 6).tolist(), rng.uniform(-0.2, 0.2, 3).tolist()
        load = LoadCase(*numbers[0], *numbers[1], draw(st.sampled_from(LoadFrame)))
    return replace(design, geometry=g, load=load)


def boxes(design: Design, seed: int, n: int, widest: float = 0.03) -> tuple[Any, Any]:
    """Return centers and half widths, (n, 4), of boxes of all sizes; the centers are reachable."""
    rng = np.random.default_rng(seed)
    g = design.geometry
    size = abs(g.base_radius - g.platform_radius)
    middle = home_pose(g) + rng.uniform(-1, 1, (40 * n, 4)) * [
        size,
        size,
        0.6,
        0.5 * g.crank_length,
    ]
    middle = middle[check_reach(g, middle).ok][:n]
    width = widest * size * 10.0 ** rng.uniform(-6, 0, (len(middle), 1))
    half = width * rng.uniform(0.1, 1, (len(middle), 4)) / [1, 1, size, 1]
    return middle, np.where(rng.random(half.shape) < 0.1, 0.0, half)


def poses_of_boxes(middle: Any, half: Any, seed: int) -> Any:
    """Return a random pose of each box (n, 4), often on its faces."""
    rng = np.random.default_rng(seed)
    return middle + half * np.clip(rng.uniform(-1.5, 1.5, middle.shape), -1, 1)


def random_poses(region: PoseRegion, count: int, rng: np.random.Generator) -> Array:
    """Return random poses of a region, (n, 4); a quarter of each coordinate's are at its ends."""
    unit = 1.3 * rng.uniform(-1.0, 1.0, (count, 4))
    if region.shape is WorkspaceShape.CYLINDER:
        angle = rng.uniform(0.0, 2.0 * np.pi, count)
        radius = 1.15 * np.sqrt(rng.uniform(0.0, 1.0, count))
        unit[:, 0], unit[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    return from_unit(region, unit)
