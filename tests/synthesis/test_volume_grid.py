"""The grid of a volume against closed forms of what it spans and against the time that it takes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, Geometry, KneeBranch
from paminsa_viz.model.reach import workspace_radius
from paminsa_viz.synthesis.volume import grid
from paminsa_viz.synthesis.volume.grid import COARSE, FINE, Resolution, axes_of
from tests.synthesis.robots import needs

G = APPENDIX_4.geometry
ROBOTS = {
    "published": G,
    "upper knee": replace(G, knee=KneeBranch.UPPER),
    "high joints": replace(G, platform_joint_height=0.3),
    "short guides": replace(G, guide_stroke=0.15),
    "wide platform": replace(G, base_radius=0.2, platform_radius=0.5),
    "bars that do not reach": replace(G, crank_length=0.19, coupler_length=0.2),
    "equal radii": replace(G, platform_radius=G.base_radius),
    "joints above all": replace(G, platform_joint_height=3.0, knee=KneeBranch.UPPER),
}


def spanned(g: Geometry, nearest: float, both_sides: bool) -> tuple[float, float, float]:
    """Return radius and heights of what can be reached, from the heading nearest to 0.

    Positions are within the circle of singular ones at that heading, and joint 5 is at least as far
    out of its leg axis at some leg; the bars then leave it a height.
    """
    circle = abs(g.base_radius - g.platform_radius * np.exp(1j * nearest))
    bars = g.crank_length + g.coupler_length
    radius = min(workspace_radius(g), circle)
    height = np.sqrt(max(bars**2 - (circle * g.magnification / (g.magnification - 1)) ** 2, 0.0))
    if min(radius, height) == 0.0:  # a tenth of the robot
        radius, height = max(radius, 0.1 * g.base_radius), max(height, 0.1 * bars)
    low, high = -height - g.platform_joint_height, height - g.platform_joint_height
    if not both_sides and g.knee is KneeBranch.LOWER:
        high = min(high, 0.0)
    elif not both_sides:
        low = max(low, -g.platform_joint_height)
    return radius, low, max(high, low + 0.1 * bars)


@pytest.mark.parametrize("both_sides", [False, True])
@pytest.mark.parametrize("name", ROBOTS)
def test_nodes_span_what_can_be_reached_and_one_beyond(name: str, both_sides: bool) -> None:
    g = ROBOTS[name]
    design = replace(APPENDIX_4, geometry=g)
    for theta, nearest in (((-0.5, 0.3), 0.0), ((0.4, 0.9), 0.4), ((-0.7, -0.2), -0.2)):
        radius, low, high = spanned(g, nearest, both_sides)
        for nodes in (1_000, 64):
            asked = needs(theta=theta)
            x, z, headings = axes_of(design, asked, Resolution(nodes, 7, 5.0), both_sides)
            step = ((2.0 * radius) ** 2 * (high - low) / nodes) ** (1 / 3)
            assert headings == 7
            assert np.diff(x) == pytest.approx(np.full(len(x) - 1, step))
            assert np.diff(z) == pytest.approx(np.full(len(z) - 1, step))
            assert x == pytest.approx(-x[::-1], abs=1e-12)
            assert x[-1] / step == pytest.approx(np.ceil(radius / step) + 1)
            assert z[0] + z[-1] == pytest.approx(low + high)
            assert len(z) % 2 == 1
            beyond = (high - z[-1]) / -step  # one node or more, and no more than needed
            assert 1.0 - 1e-9 <= beyond < 2.0


def test_costly_quantities_get_fewer_nodes_and_then_fewer_headings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A tenth of the nodes asked for is enough, as are five headings; 300 nodes are the least."""
    seen: list[tuple[int, int]] = []
    time = 0.0

    def per_position(design: Any, requirements: Any, headings: int, heights: int) -> float:
        seen.append((headings, heights))
        return time * headings * heights

    monkeypatch.setattr(grid, "time_per_position", per_position)
    asked = needs("condition <= 9", theta=(-0.2, 0.2))
    radius, low, high = spanned(G, 0.0, False)
    size = (2.0 * radius) ** 2 * (high - low)
    for headings, each, nodes, expected in (
        (17, 0.0, 10_000, 17), (17, 2.0 / 10_000, 10_000, 17), (17, 2.0 / 5_000, 5_000, 17),
        (17, 2.0 / 1_000, 1_000, 17), (17, 2.0 / 999, 999 * 17 / 9, 9),
        (17, 2.0 / 500, 500 * 17 / 5, 5), (17, 2.0 / 90, 90 * 17 / 5, 5), (17, 2.0 / 80, 300, 5),
        (21, 2.0 / 900, 900 * 21 / 11, 11), (21, 2.0 / 400, 400 * 21 / 5, 5),
        (5, 2.0 / 999, 999, 5), (3, 2.0 / 400, 400, 3),
    ):  # fmt: skip
        time = each / headings
        seen.clear()
        x, _, found = axes_of(APPENDIX_4, asked, Resolution(10_000, headings, 2.0), False)
        assert found == expected
        assert size / (x[1] - x[0]) ** 3 == pytest.approx(nodes)
        assert seen[0][0] == headings
        assert {row[1] for row in seen} == {round((high - low) / (size / 10_000) ** (1 / 3))}
    seen.clear()  # of a body so flat two heights count
    flat = replace(APPENDIX_4, geometry=replace(G, base_radius=5.0, platform_radius=5.0))
    axes_of(flat, needs("condition <= 9", theta=(0.4, 0.5)), Resolution(64, 3, 2.0), False)
    assert seen == [(3, 2)]


@pytest.mark.parametrize("resolution", [FINE, COARSE, Resolution(64, 3, 5.0)])
def test_a_body_as_thin_as_a_needle_has_few_nodes_beyond_it(resolution: Resolution) -> None:
    """R_pl nearly R_b: a radius of 1 um and a height of 2 m, a node beyond on each side of it."""
    for difference in (1e-6, -1e-6, 1e-7):
        thin = replace(APPENDIX_4, geometry=replace(G, platform_radius=G.base_radius + difference))
        x, z, headings = axes_of(thin, needs(), resolution, True)
        assert len(x) == 5
        assert headings == resolution.headings
        assert 0.8 * resolution.nodes < len(x) ** 2 * len(z) <= 3 * resolution.nodes + 5_000
        assert np.diff(z) == pytest.approx(np.full(len(z) - 1, x[1] - x[0]))
        assert z[-1] - z[0] > spanned(thin.geometry, 0.0, True)[2] * 2
