"""The drawing of the robot: to one scale in both views, and on the page."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch, inverse_kinematics
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots.formats import drawing
from paminsa_viz.report.workspace_section import draw_sketch
from tests.support import samples


@pytest.mark.parametrize("knee", list(KneeBranch), ids=lambda a: a.value)
def test_bars_have_their_projected_lengths(knee: KneeBranch) -> None:
    design = APPENDIX_4.with_knee(knee)
    pose = samples.random_poses(np.random.default_rng(4), design)[0]
    points = inverse_kinematics(design.geometry, pose).points
    with drawing():
        page = draw_sketch(inverse_kinematics(design.geometry, pose))
        page.draw_without_rendering()
    top, side = page.axes
    scale = top.transData.transform((1.0, 0.0))[0] - top.transData.transform((0.0, 0.0))[0]
    for area, view in ((top, [0, 1]), (side, [0, 2])):
        bars = [
            area.transData.transform(line.get_xydata())
            for line in area.lines
            if line.get_color() in LEG_COLORS and line.get_linewidth() == 2.2
        ]
        expected = [
            scale * np.linalg.norm((points[first] - points[second])[leg, view])
            for leg in range(3)
            for first, second in ((9, 5), (8, 9), (4, 7), (7, 8))
        ]
        found = [np.linalg.norm(start - end) for start, end in bars]
        np.testing.assert_allclose(sorted(found), sorted(expected), rtol=1e-9)
        assert page.bbox.fully_contains(*np.min(bars, axis=(0, 1)))
        assert page.bbox.fully_contains(*np.max(bars, axis=(0, 1)))
