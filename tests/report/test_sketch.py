"""The drawing of the robot: valid, and to scale in both views."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch, inverse_kinematics
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.report.sketch import sketch
from tests.support import samples

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("knee", list(KneeBranch), ids=lambda a: a.value)
def test_bars_have_their_projected_lengths(knee: KneeBranch) -> None:
    design = APPENDIX_4.with_knee(knee)
    pose = samples.random_poses(np.random.default_rng(4), design)[0]
    configuration = inverse_kinematics(design.geometry, pose)
    root = ET.fromstring(sketch(configuration))
    width, height = map(float, root.attrib["viewBox"].split()[2:])
    circle = root.find(f"{SVG}circle")
    assert circle is not None
    scale = float(circle.attrib["r"]) / APPENDIX_4.geometry.base_radius
    bars = [
        line.attrib
        for line in root.iter(f"{SVG}line")
        if line.attrib["stroke"] in LEG_COLORS and line.attrib["stroke-width"] == "3"
    ]
    assert len(bars) == 3 * 2 * 4
    found = sorted(
        np.hypot(float(bar["x2"]) - float(bar["x1"]), float(bar["y2"]) - float(bar["y1"]))
        for bar in bars
    )
    expected = []
    for axes in ([0, 1], [0, 2]):
        for first, second in ((9, 5), (8, 9), (4, 7), (7, 8)):
            along = (configuration.points[first] - configuration.points[second])[:, axes]
            expected += (scale * np.hypot(*along.T)).tolist()
    np.testing.assert_allclose(found, sorted(expected), atol=0.02)
    places = [(float(b[x]), float(b[y])) for b in bars for x, y in (("x1", "y1"), ("x2", "y2"))]
    assert all(0 <= x <= width and 0 <= y <= height for x, y in places)
