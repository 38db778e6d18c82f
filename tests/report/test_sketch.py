"""The drawing of the robot: to one scale in both views, and on the page."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch, inverse_kinematics
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR
from paminsa_viz.plots.formats import drawing
from paminsa_viz.report import workspace_section
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


@pytest.mark.parametrize(("x", "singular"), [(0.0, 0.2), (0.15, 0.2), (0.0, 0.9)])
def test_both_views_hold_the_robot_and_its_circles_with_a_margin(
    x: float, singular: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 4 % of the width; the page is as high as the higher view and a line of words."""
    monkeypatch.setattr(workspace_section, "singular_radius", lambda *_: singular)
    g = APPENDIX_4.geometry
    configuration = inverse_kinematics(g, (x, -0.03, 0.3, -0.52))
    points = np.concatenate([np.asarray(configuration.points[n]) for n in (2, 3, 4, 5, 7, 8, 9)])
    plate = np.asarray(configuration.points[5]) - [0.0, 0.0, g.platform_joint_height]
    around = max(g.base_radius, singular)
    circle = np.array([[around, around, 0.0], [-around, -around, 0.0]])
    corners = np.concatenate([points, plate, circle])
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.04 * (high - low)[0]
    with drawing():
        page = draw_sketch(configuration)
    top, side = page.axes
    for area, up in ((top, 1), (side, 2)):
        assert area.get_xlim() == pytest.approx((low[0] - margin, high[0] + margin))
        assert area.get_ylim() == pytest.approx((low[up] - margin, high[up] + margin))
    size = high - low + 2 * margin
    wanted = (9.0, 0.48 * 9.0 * max(size[1], size[2]) / size[0] + 0.35)
    assert tuple(page.get_size_inches()) == pytest.approx(wanted)
    # from the side: the platform's posts, and the lift's arms from the axis
    posts = [line for line in side.lines if line.get_color() == INK]
    arms = [line for line in side.lines if line.get_color() == LIFT_COLOR][:3]
    assert [line.get_linewidth() for line in (*posts, *arms)] == [1.3] * 3 + [2.2] * 3
    for line, place, joint in zip(posts, plate, configuration.points[5], strict=True):
        np.testing.assert_allclose(line.get_xydata(), [place[[0, 2]], joint[[0, 2]]])
    for line, joint in zip(arms, configuration.points[2], strict=True):
        hub = [0.0, float(configuration.actuators[3])]
        np.testing.assert_allclose(line.get_xydata(), [hub, joint[[0, 2]]])
