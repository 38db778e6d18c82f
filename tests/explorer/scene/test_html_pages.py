"""The page of a played motion: its data, and that a browser plays it from a file, offline."""

from __future__ import annotations

import base64
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.explorer.scene.cameras import FIELD_OF_VIEW
from paminsa_viz.explorer.scene.html_pages import MOST_FRAMES, PAUSE, frame_times, motion_html
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.trajectory import (
    PRESET,
    ImpossibleTrajectory,
    Trajectory,
    analyze,
    point_to_point,
    preset_center,
)
from tests.support.chromium import NODE_PLACE, TIMEOUT, UNDRAWN, until, watch_errors

ANGLE = "() => window.__viserMutable.camera.fov"
"""Vertical angle of view [deg]."""

FARTHEST = """() => {
  const { camera, nodeRefFromName } = window.__viserMutable;
  const legs = Object.entries(nodeRefFromName).filter(([name]) => name.includes("/leg"));
  return Math.max(...legs.map(([, node]) =>
    Math.abs(node.getWorldPosition(node.position.clone()).project(camera).x)));
}"""
"""How far to a side a part of a leg is in the picture: 1 at its edge."""

NAME = "<b>& </script> “näme”"
HOME = preset_center(APPENDIX_4.geometry)


def planned(key: str, samples: int, design: Any = APPENDIX_4) -> Trajectory:
    return PRESET[key].build(design.geometry).sample(samples)


def moved(*step: float) -> Trajectory:
    """Return a motion from home by a step."""
    return point_to_point(HOME, np.add(HOME, step), 1.0).sample(200)


class Data:
    """What a page holds of its motion."""

    def __init__(self, page: bytes) -> None:
        pattern = r'<script id="motion-data" type="application/json">(.*?)</script>'
        found = re.search(pattern, page.decode())
        assert found
        self.fields = json.loads(found[1])

    def numbers(self, key: str) -> np.ndarray:
        rows = np.frombuffer(base64.b64decode(self.fields[key]), "<f4")
        return rows.reshape(self.fields["frames"], -1)

    def position(self, body: str) -> np.ndarray:
        place = 3 * self.fields["moved"].index(node_name(body))
        return self.numbers("positions")[:, place : place + 3]

    def angle(self, body: str) -> np.ndarray:
        place = 4 * self.fields["turned"].index(node_name(body))
        turns = self.numbers("turns")
        return 2 * np.arctan2(turns[:, place + 3], turns[:, place])


@pytest.mark.slow
@pytest.mark.parametrize("knee", KneeBranch)
def test_page_holds_places_and_torques_of_the_model(knee: KneeBranch) -> None:
    design = APPENDIX_4.with_knee(knee)
    trajectory = planned("paper-like", 200, design)
    data = Data(motion_html(design, trajectory))
    times = frame_times(0.0, trajectory.duration)
    assert data.fields["frames"] == times.size == 39
    assert (data.fields["duration"], data.fields["pause"]) == (trajectory.duration, PAUSE)
    pose = trajectory.at(times).pose
    np.testing.assert_allclose(data.position("platform"), pose[:, [0, 1, 3]], atol=1e-7)
    np.testing.assert_allclose(data.angle("platform"), pose[:, 2], atol=1e-6)
    lift = inverse_kinematics(design.geometry, pose).actuators[:, 3]
    np.testing.assert_allclose(data.position("carriage")[:, 2], lift, atol=1e-7)
    torque = analyze(design, trajectory).torque
    np.testing.assert_allclose(data.numbers("torques")[[0, -1]], torque[[0, -1]], rtol=1e-6)


@pytest.mark.slow
def test_page_holds_only_what_moves() -> None:
    fields = Data(motion_html(APPENDIX_4, moved(0, 0, 0, 0.05))).fields
    assert not {node_name(f"leg{k}") for k in (1, 2, 3)} & set(fields["turned"])
    assert node_name("leg1/slider") not in fields["moved"]
    assert node_name("leg1/b8") in fields["turned"]


@pytest.mark.slow
def test_closed_motion_starts_again_at_once() -> None:
    assert Data(motion_html(APPENDIX_4, planned("circle", 100))).fields["pause"] == 0.0


@pytest.mark.slow
def test_failing_motion_is_played_up_to_its_failure() -> None:
    trajectory = moved(0.45, 0.05, 0.3, 0.02)
    page = motion_html(APPENDIX_4, trajectory)
    first = analyze(APPENDIX_4, trajectory).check.first
    assert first is not None
    assert 0 < first.t - Data(page).fields["duration"] < 0.006
    assert np.isfinite(Data(page).numbers("torques")).all()
    assert f"The motion fails {first.explanation}." in page.decode()
    start = np.add(HOME, (0.9, 0.0, 0.0, 0.0))
    nowhere = point_to_point(start, start + 0.1).sample(20)
    with pytest.raises(ImpossibleTrajectory, match="leg 1"):
        motion_html(APPENDIX_4, nowhere)


@pytest.mark.slow
def test_page_says_that_legs_are_taken_as_equal() -> None:
    trajectory, note = moved(0, 0, 0, 0.05), "<p>Legs are equal, the design’s deviations of"
    assert note not in motion_html(APPENDIX_4, trajectory).decode()
    assert note in motion_html(APPENDIX_4.vary({"leg2.bar_94": 1e-4}), trajectory).decode()


@pytest.mark.slow
def test_names_are_escaped_and_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    trajectory = replace(planned("line", 50), name=NAME)
    page = motion_html(replace(APPENDIX_4, name=NAME), trajectory).decode()
    assert NAME not in page
    assert "<title>PAMINSA: &lt;b&gt;&amp; &lt;/script&gt; “näme”</title>" in page
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(("duration", "frames"), [(1.0, 31), (1e4, MOST_FRAMES), (1e-3, 2)])
def test_number_of_frames_is_bounded(duration: float, frames: int) -> None:
    assert frame_times(0.0, duration).size == frames


NOTICES_END = """document.querySelector(".mantine-Notifications-root[data-position=top-left]")
  .getBoundingClientRect().bottom"""
CONTROLS_BEGIN = "document.getElementById('motion').getBoundingClientRect().top"


@pytest.mark.browser
def test_browser_plays_it_from_a_file_offline(browser: Any, tmp_path: Path) -> None:
    trajectory = planned("circle", 500)
    file = tmp_path / "motion.html"
    file.write_bytes(motion_html(APPENDIX_4, trajectory))
    context = browser.new_context(viewport={"width": 480, "height": 360}, offline=True)
    page = context.new_page()
    page.add_init_script(UNDRAWN)
    page.set_default_timeout(1000 * TIMEOUT)
    errors = watch_errors(page)
    page.on("requestfailed", lambda request: errors.append(request.url))
    page.goto(file.as_uri() + "?fixedDpr=1")

    def position() -> Any:
        found = page.evaluate(NODE_PLACE, node_name("platform"))
        return None if found is None else found[:3]

    def clock() -> float:
        return float((page.locator("#motion-clock").inner_text() or "0").split(" ")[0])

    start = np.array(until(position, "the platform"))
    until(lambda: np.linalg.norm(position() - start) > 0.05, "it moves by itself")
    # Past the end it starts again.
    until(lambda: clock() > 2.0, "most of the motion")
    until(lambda: clock() < 1.0, "a second time")
    # The pose shown is that of the chosen instant.
    for t in (0.4, 1.5, 2.9):
        page.locator("#motion-time").evaluate(
            "(slider, t) => { slider.value = t; slider.dispatchEvent(new Event('input')); }", t
        )
        wanted = trajectory.at([t]).pose[0][[0, 1, 3]]
        until(lambda w=wanted: np.allclose(position(), w, atol=1e-3), f"the pose at {t} s")
        assert clock() == t
    page.keyboard.press("Space")
    until(lambda: clock() > 2.9 or clock() < 2.0, "it plays on")
    # All legs are in the picture in a narrow window as well, and a wide one is as planned again.
    for width, height, least in ((180, 390, 33.0), (480, 360, 31.9)):
        page.set_viewport_size({"width": width, "height": height})
        until(lambda low=least: low < page.evaluate(ANGLE) < low + 60.0, "the angle of view")
        until(lambda: 0.2 < page.evaluate(FARTHEST) < 0.97, "whole legs")
    assert page.evaluate(NOTICES_END) < page.evaluate(CONTROLS_BEGIN)
    planned_angle = pytest.approx(math.degrees(FIELD_OF_VIEW))
    until(lambda: page.evaluate(ANGLE) == planned_angle, "the planned angle of view")
    context.close()
    assert errors == []
