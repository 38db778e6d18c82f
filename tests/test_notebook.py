"""Inline views of a notebook: robot, maps and curves."""

from __future__ import annotations

import html
import inspect
import re

import numpy as np
import pytest

from paminsa_viz.explorer.scene.html_pages import motion_html, robot_html
from paminsa_viz.model import APPENDIX_4, InvalidInput, KneeBranch, UnreachablePose, static_torques
from paminsa_viz.notebook import InlinePage, curve_view, map_view, motion_view, robot_view
from paminsa_viz.plots.series_figure import figure_bytes
from paminsa_viz.trajectory import PRESET, analyze
from tests.support.chromium import UNDRAWN

pytestmark = pytest.mark.slow


POSE = (0.05, -0.03, 0.4, -0.5)


@pytest.fixture(scope="module")
def motion():
    return PRESET["arch"].build(APPENDIX_4.geometry).sample(200)


def test_inline_page_is_a_sandboxed_frame_with_the_whole_page(tmp_path) -> None:
    page = InlinePage('<p title="a">&amp; é</p>'.encode(), height=300)
    shown = page._repr_html_()
    found = re.fullmatch(r'<iframe srcdoc="([^"]*)" sandbox="allow-scripts" .*</iframe>', shown)
    assert found
    assert html.unescape(found[1]).encode() == page.content
    assert "height: 300px" in shown
    assert "content" not in repr(page)
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_bytes() == page.content


def test_robot_view_is_the_exported_page_of_the_pose() -> None:
    page = robot_view(APPENDIX_4, POSE).content.decode()
    assert page.lstrip().lower().startswith("<!doctype html>")
    assert "<title>PAMINSA: Appendix 4</title>" in page
    assert len(robot_html(APPENDIX_4, POSE)) == pytest.approx(len(page), rel=0.01)


def test_a_frame_without_height_is_refused(motion) -> None:
    needed = "height: a whole number of pixels, at least 1, is needed, not"
    for height in (0, -5):
        with pytest.raises(InvalidInput, match=f"{needed} {height}"):
            robot_view(height=height)
        with pytest.raises(InvalidInput, match=f"{needed} {height}"):
            motion_view(motion, height=height)


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_default_pose_is_reachable(knee) -> None:
    design = APPENDIX_4.with_knee(knee)
    assert robot_view(design).content
    assert map_view(design, cells=10).data


@pytest.mark.parametrize(
    ("error", "pose"), [(UnreachablePose, (1.0, 0.0, 0.0, -0.5)), (InvalidInput, np.zeros((2, 4)))]
)
def test_an_impossible_pose_is_refused(error, pose) -> None:
    with pytest.raises(error):
        robot_view(APPENDIX_4, pose)


def test_motion_view_is_the_exported_page(motion) -> None:
    page = motion_view(motion, height=600)
    assert len(page.content) == pytest.approx(len(motion_html(APPENDIX_4, motion)), rel=0.01)
    assert b"pick-and-place arch" in page.content


def test_maps_show_the_static_torques() -> None:
    figure = map_view(APPENDIX_4, POSE, cells=40)
    heat = [trace for trace in figure.data if trace.type == "heatmap" and trace.coloraxis]
    assert len(heat) == 3
    texts = np.array(heat[1].text)
    values = np.array([float(t.replace("−", "-").replace("–", "nan")) for t in texts.flat])
    x, y = np.meshgrid(np.array(heat[1].x) / 1e3, np.array(heat[1].y) / 1e3)
    pose = np.stack([x, y, np.full_like(x, POSE[2]), np.full_like(x, POSE[3])], axis=-1)
    torque = static_torques(APPENDIX_4, pose)[..., 1].ravel()
    np.testing.assert_allclose(values, torque, rtol=1e-3)  # four digits are shown
    assert len(map_view(APPENDIX_4, POSE, quantity="condition", cells=20).data) > 0
    words = map_view(quantity="max-torque", theta=POSE[2], z=POSE[3], at=POSE[:2], cells=20)
    assert words == map_view(APPENDIX_4, POSE, quantity="max_torque", cells=20)
    for wrong, argument in (
        ({"theta": float("nan")}, "pose"), ({"at": (0.0, 0.0, 0.4)}, "at"), ({"cells": 1}, "cells"),
        ({"cells": 501}, "cells"),
        ({"cells": 20, "width": 100}, "width"), ({"at": (0.1, "0.2")}, "at"),
        ({"at": ((0.0, 0.1), (0.2, 0.3))}, "at"), ({"pose": [POSE, POSE]}, "pose"),
    ):  # fmt: skip
        with pytest.raises(InvalidInput) as refused:
            map_view(**wrong)
        assert refused.value.argument == argument
    with pytest.raises(InvalidInput, match=r"there are .*tau_1, .* more"):
        map_view(quantity="beauty")


def test_curves_are_the_figures_of_the_report(motion, tmp_path) -> None:
    analysis = analyze(APPENDIX_4, motion)
    picture = curve_view(analysis, "power", width_mm=120)
    assert picture._repr_svg_().encode() == figure_bytes(
        "power", analysis, format="svg", width_mm=120
    )
    picture.save(tmp_path / "a.svg")
    assert (tmp_path / "a.svg").read_bytes() == picture.svg


@pytest.mark.browser
def test_robot_and_motion_are_drawn_in_a_notebooks_page(browser, motion, tmp_path) -> None:
    path = tmp_path / "notebook.html"
    shown = robot_view(APPENDIX_4, POSE)._repr_html_() + motion_view(motion)._repr_html_()
    path.write_text(f'<meta charset="utf-8"><body>{shown}', encoding="utf-8")
    page = browser.new_context().new_page()
    page.add_init_script(UNDRAWN)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto(path.as_uri())
    for index in range(2):
        frame = page.frame_locator("iframe").nth(index)
        frame.locator("canvas[data-engine]").wait_for(timeout=60_000)
    page.close()
    assert wrong == []
    assert [url for url in asked if url.startswith("http")] == []


@pytest.mark.parametrize("view", [robot_view, motion_view, map_view])
def test_help_of_a_view_is_no_list_of_all_numbers_of_a_design(view) -> None:
    assert len(str(inspect.signature(view))) < 400
