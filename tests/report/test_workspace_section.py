"""Geometry and workspace of a report: sizes, shares of poses, torques, maps, and the drawing."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.files.design_file import read_content
from paminsa_viz.model import (
    APPENDIX_4,
    inverse_kinematics,
    singular_radius,
)
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.palette import LEG_COLORS, LIFT_COLOR
from paminsa_viz.plots.formats import drawing
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.report import design_section, workspace_section
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.trajectory import PRESET
from tests.blocks.said import cells

G = APPENDIX_4.geometry
POSE = (0.05, -0.03, 0.3, -0.52)
REQUEST = ReportRequest(
    design=APPENDIX_4, trajectory=PRESET["arch"].build(G).sample(5), pose=POSE,
    made=datetime(2026, 1, 2, 3, 4, tzinfo=UTC), command="report",
)  # fmt: skip


def test_maps_of_a_report_take_the_width_that_they_are_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The torques all of it with their caption, force and condition number half of it each."""
    note, *figures = workspace_section.maps_section(REQUEST).blocks
    assert "θ = 17.19°, z = −520 mm" in note.text  # type: ignore
    made = [(one.half, one.draw.keywords) for one in figures]  # type: ignore
    assert [half for half, _ in made] == [False, True, True]
    assert [options["caption"] for _, options in made] == [True, False, False]
    assert [options["dpi"] for _, options in made] == [150.0] * 3  # sharp in print
    widths = [options["width_mm"] for _, options in made]
    assert widths == [170.0, 85.0, 85.0]  # of a page with margins of 20 mm
    choices: list[str] = []

    def chosen(data: Any, choice: Any) -> None:
        choices.append(choice.kind)
        assert choice.shared

    monkeypatch.setattr(workspace_section, "choose_scales", chosen)
    for signed, unit in ((True, "N m"), (False, "N"), (False, "1")):
        data: Any = SimpleNamespace(signed=signed, unit=unit, title="t")
        workspace_section._map_figure(data, 1.0, half=False)
    assert choices == ["linear", "linear", "symlog"]


def test_shares_of_poses_are_those_at_the_heading_and_by_the_seed_of_the_report(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(workspace_section, "workspace_blocks", lambda *a: asked.append(a) or ())
    section = workspace_section.workspace_section(REQUEST)
    assert asked == [(APPENDIX_4, POSE[2], REQUEST.seed)]
    assert len(section.blocks) == 1


@pytest.fixture(scope="module")
def drawn() -> Any:
    """Both views with all their lines, in meters."""
    configuration = inverse_kinematics(G, POSE)
    with drawing():
        page = workspace_section.draw_sketch(configuration)
        page.draw_without_rendering()
    return configuration, page


def test_rings_are_drawn_at_the_joints_and_feet(drawn: Any) -> None:
    configuration, page = drawn
    for area, view in zip(page.axes, ([0, 1], [0, 2]), strict=True):
        marked = [line for line in area.lines if line.get_marker() == "o"]
        for leg, color in enumerate(LEG_COLORS):
            own = [line for line in marked if line.get_markeredgecolor() == color]
            foot, rings = sorted(own, key=lambda line: len(line.get_xdata()))
            axis = 0.35 * np.array([*LEG_AXES[leg], 0.0])
            np.testing.assert_allclose(foot.get_xydata(), axis[None, view], atol=1e-12)
            joints = [configuration.points[n][leg][view] for n in (3, 4, 5, 7, 8, 9)]
            np.testing.assert_allclose(rings.get_xydata(), joints, atol=1e-12)
            assert foot.get_markersize() > rings.get_markersize()


def test_frame_platform_and_loci_are_where_they_are(drawn: Any) -> None:
    configuration, page = drawn
    top, side = page.axes
    circles = [
        line for line in top.lines
        if line.get_marker() != "o" and len(line.get_xdata()) > 100
    ]  # fmt: skip
    radii = [np.hypot(*line.get_xydata().T) for line in circles]
    for found, radius in zip(radii, (0.35, float(singular_radius(G, POSE[2]))), strict=True):
        np.testing.assert_allclose(found, radius, rtol=1e-12)
    turns = np.unwrap(np.arctan2(*circles[0].get_xydata().T[::-1]))
    assert turns[-1] - turns[0] == pytest.approx(2 * np.pi)
    (cross,) = [line for line in top.lines if line.get_marker() == "+"]
    np.testing.assert_array_equal(cross.get_xydata(), [[0.0, 0.0]])
    plate = np.array(configuration.points[5]) - [0.0, 0.0, G.platform_joint_height]
    for area, view in ((top, [0, 1]), (side, [0, 2])):
        (patch,) = area.patches
        np.testing.assert_allclose(patch.get_xy()[:3], plate[:, view], atol=1e-12)
    # from the side: arms from the carriage to joints 2, shafts, and the joints 5 on their plate
    hub = [0.0, float(configuration.actuators[3])]
    lift = [line.get_xydata() for line in side.lines if line.get_color() == LIFT_COLOR]
    arms = [ends for ends in lift if np.allclose(ends[0], hub)]
    np.testing.assert_allclose(
        sorted(tuple(ends[1]) for ends in arms),
        sorted(tuple(point[[0, 2]]) for point in np.array(configuration.points[2])), atol=1e-12,
    )  # fmt: skip
    assert len(lift) == 6
    shafts = [line.get_xydata() for line in top.lines if line.get_color() == LIFT_COLOR]
    assert all(np.allclose(ends[0], ends[1]) for ends in shafts)  # they are upright
    guides = [line for area in (top, side) for line in area.lines if line.get_linestyle() == "--"]
    assert len(guides) == 7  # of the legs, and the circle of singular positions
    level = [line for line in side.lines if line.get_linestyle() == ":"]
    assert [set(line.get_ydata()) for line in level] == [{0.0}]
    posts = [
        line.get_xydata() for line in side.lines
        if np.isclose(np.ptp(line.get_ydata()), G.platform_joint_height)
        and np.allclose(line.get_xdata(), line.get_xdata()[0]) and len(line.get_xdata()) == 2
        and line.get_color() not in LEG_COLORS
    ]  # fmt: skip
    assert len(posts) == 3


def test_lines_are_as_wide_as_what_they_stand_for(drawn: Any) -> None:
    """Bars above guides above frame and loci, all as a printer draws them; letters as in a text."""
    _, page = drawn
    letters = [*page.texts, *(text for area in page.axes for text in area.texts)]
    assert len({text.get_fontsize() for text in letters}) == 1
    assert 9.0 <= letters[0].get_fontsize() <= 11.0
    thin: list[float] = []
    for area, solid in zip(page.axes, (15, 18), strict=True):  # from the side the lift's arms too
        lines = [line for line in area.lines if line.get_marker() == "None"]
        robot = [line for line in lines if line.get_color() in {*LEG_COLORS, LIFT_COLOR}]
        bars = [line.get_linewidth() for line in robot if line.get_linestyle() == "-"]
        guides = [line.get_linewidth() for line in robot if line.get_linestyle() == "--"]
        assert (len(bars), len(guides)) == (solid, 3)
        (bar,), (guide,) = set(bars), set(guides)
        (plate,) = area.patches
        others = [line.get_linewidth() for line in lines if line not in robot]
        assert bar == 2.0 * guide
        assert bar > plate.get_linewidth() > guide
        thin.append(min(others))
        posts = {width for width in others if width > thin[0]}
        assert posts <= {plate.get_linewidth()}
        assert 0.5 <= min(others) < guide
        assert plate.get_alpha() == 0.8  # a fifth of the bars is seen through it
        feet, joints = (
            {line.get_markersize() for line in area.lines
             if line.get_marker() == "o" and (len(line.get_xdata()) == 1) == single}
            for single in (True, False)
        )  # fmt: skip
        assert set(feet) == {2.0 * size for size in joints}
        assert max(joints) > bar  # rings, with their bars inside
        crosses = [line.get_markersize() for line in area.lines if line.get_marker() == "+"]
        assert all(max(joints) < size < min(feet) for size in crosses)
        rings = [line for line in area.lines if line.get_marker() == "o"]
        assert all(line.get_markeredgewidth() < guide for line in rings)
    assert thin[0] == thin[1]  # frame, loci and level alike


def test_views_stand_side_by_side_with_their_words_and_legs_are_numbered(drawn: Any) -> None:
    configuration, page = drawn
    top, side = (area.get_position(original=True) for area in page.axes)
    assert top.x0 == 0.0
    assert side.x1 == pytest.approx(1.0)
    assert top.width == pytest.approx(side.width)
    assert side.x0 - top.x1 == pytest.approx(0.04)
    assert top.y1 == side.y1 == pytest.approx(1.0)
    assert top.y0 * page.get_figheight() == pytest.approx(side.y0 * page.get_figheight())
    assert top.y0 * page.get_figheight() == pytest.approx(0.35)  # inches for the words below
    for text, box in zip(page.texts, (top, side), strict=True):
        x, y = text.get_position()
        assert x == pytest.approx(box.x0 + box.width / 2, abs=1e-9)
        assert y * page.get_figheight() == pytest.approx(0.1)
    for area, view in zip(page.axes, ([0, 1], [0, 2]), strict=True):
        assert [text.get_text() for text in area.texts] == ["1", "2", "3"]
        for leg, text in enumerate(area.texts):
            axis = 0.35 * np.array([*LEG_AXES[leg], 0.0])
            point = axis if view == [0, 1] else np.array(configuration.points[2])[leg]
            np.testing.assert_allclose(text.xy, point[view], atol=1e-12)
            shift = np.array(text.xyann)
            if view == [0, 2]:
                assert shift[0] == 0.0
                assert shift[1] == 9.0  # points
            else:  # beside the leg
                ahead = (np.array(configuration.points[5])[leg] - axis)[:2]
                assert abs(shift @ ahead) < 1e-9
                assert shift[0] * -ahead[1] + shift[1] * ahead[0] > 0
                assert np.hypot(*shift) == pytest.approx(13.0)
        # everything is inside, with a margin
        (x0, x1), (y0, y1) = area.get_xlim(), area.get_ylim()
        for number in (2, 3, 4, 5, 7, 8, 9):
            points = np.array(configuration.points[number])[:, view]
            assert (points > [x0, y0]).all()
            assert (points < [x1, y1]).all()
        around = max(0.35, float(singular_radius(G, POSE[2])))
        assert x0 < -around
        assert x1 > around
        joints = np.concatenate([np.array(points) for points in configuration.points.values()])
        ends = [min(-around, joints[:, 0].min()), max(around, joints[:, 0].max())]
        margin = 0.04 * (ends[1] - ends[0])
        np.testing.assert_allclose([x0, x1], [ends[0] - margin, ends[1] + margin])


def test_where_the_provenance_comes_from() -> None:
    def verified(found: Any) -> str:
        table = design_section.provenance_section(REQUEST, found).blocks[0]
        return dict(cells(table))["Verified"]

    assert verified("no engine") == "no"
    assert verified(SimpleNamespace(passed=True)) == "passed"
    assert verified(SimpleNamespace(passed=False)) == "failed"
    table: Any = design_section.provenance_section(REQUEST, "no").blocks[0]
    assert dict(cells(table))["Made"].startswith("2026-01-02 03:04")
    assert (table.words, table.literal) == (2, True)


def test_the_design_file_of_a_report_has_what_the_report_is_of() -> None:
    needed = Requirements((Requirement("condition", high=8.0),), (-0.3, 0.3))
    asked = replace(REQUEST, requirements=needed)
    listing: Any = design_section.provenance_section(asked, "no").blocks[-1]
    content = read_content(listing.text, "listing.toml")
    assert (content.design, content.requirements) == (APPENDIX_4, needed)
