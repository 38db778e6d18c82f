"""The page of a played motion: what it holds, and that a browser plays it from a file, offline."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer.html_pages import MOST_FRAMES, PAUSE, frame_times, motion_html
from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.model import APPENDIX_4, InvalidInput, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.trajectory import (
    PRESET,
    ImpossibleTrajectory,
    analyze,
    home,
    point_to_point,
)
from tests.support.chromium import TIMEOUT, until
from tests.support.samples import with_knee

NAME = "<b>& </script> “näme”"


def planned(key: str, knee: KneeBranch = KneeBranch.LOWER):
    return PRESET[key].build(with_knee(APPENDIX_4.geometry, knee))


def beyond():
    start = home(APPENDIX_4.geometry)
    return point_to_point(start, np.add(start, (0.45, 0.05, 0.3, 0.02)), 1.0).sample(200)


def held(page: bytes) -> dict:
    found = re.search(
        r'<script id="motion-data" type="application/json">(.*?)</script>', page.decode()
    )
    assert found
    return json.loads(found[1])


def numbers(data: dict, key: str) -> np.ndarray:
    rows = np.frombuffer(base64.b64decode(data[key]), "<f4")
    return rows.reshape(data["frames"], -1)


def node(data: dict, key: str, name: str, width: int) -> np.ndarray:
    place = data[{"positions": "moved", "turns": "turned"}[key]].index(name)
    return numbers(data, key)[:, width * place : width * (place + 1)]


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_the_page_holds_the_motion(knee: KneeBranch) -> None:
    trajectory = planned("paper-like", knee).sample(200)
    data = held(motion_html(with_knee(APPENDIX_4, knee), trajectory))
    times = frame_times(0.0, trajectory.duration)
    assert data["frames"] == times.size == 39
    assert (data["duration"], data["pause"]) == (trajectory.duration, PAUSE)

    pose = trajectory.at(times).pose
    platform = node(data, "positions", node_name("platform"), 3)
    np.testing.assert_allclose(platform, pose[:, [0, 1, 3]], atol=1e-7)
    turn = node(data, "turns", node_name("platform"), 4)
    np.testing.assert_allclose(2 * np.arctan2(turn[:, 3], turn[:, 0]), pose[:, 2], atol=1e-6)
    configuration = inverse_kinematics(with_knee(APPENDIX_4.geometry, knee), pose)
    carriage = node(data, "positions", node_name("carriage"), 3)
    np.testing.assert_allclose(carriage[:, 2], configuration.actuators[:, 3], atol=1e-7)

    analysis = analyze(with_knee(APPENDIX_4, knee), trajectory)
    torque = numbers(data, "torques")
    np.testing.assert_allclose(torque[[0, -1]], analysis.torque[[0, -1]], rtol=1e-6)


def test_only_what_moves_is_held() -> None:
    lift = point_to_point(
        home(APPENDIX_4.geometry), np.add(home(APPENDIX_4.geometry), (0, 0, 0, 0.05))
    )
    data = held(motion_html(APPENDIX_4, lift.sample(100)))
    assert not {node_name(f"leg{k}") for k in (1, 2, 3)} & set(data["turned"])
    assert node_name("leg1/slider") not in data["moved"]
    assert node_name("leg1/b8") in data["turned"]


def test_a_closed_motion_starts_again_at_once() -> None:
    circle = planned("circle").sample(100)
    assert held(motion_html(APPENDIX_4, circle))["pause"] == 0.0


def test_a_failing_motion_is_played_up_to_there() -> None:
    trajectory = beyond()
    page = motion_html(APPENDIX_4, trajectory)
    first = analyze(APPENDIX_4, trajectory).check.first
    assert first is not None
    assert 0 < first.t - held(page)["duration"] < 0.006
    assert np.isfinite(numbers(held(page), "torques")).all()
    assert f"The motion fails {first.explanation}." in page.decode()


def test_names_are_words_and_nothing_else() -> None:
    trajectory = replace(planned("line").sample(50), name=NAME)
    page = motion_html(replace(APPENDIX_4, name=NAME), trajectory).decode()
    assert NAME not in page
    assert "<title>PAMINSA: &lt;b&gt;&amp; &lt;/script&gt; “näme”</title>" in page


def test_nothing_is_announced(capfd: pytest.CaptureFixture) -> None:
    motion_html(APPENDIX_4, planned("line").sample(20))
    assert capfd.readouterr() == ("", "")


def test_frames_are_bounded() -> None:
    assert frame_times(0.0, 1.0, 30.0).size == 31
    assert frame_times(0.0, 1e4).size == MOST_FRAMES
    assert frame_times(0.0, 1e-3).size == 2


@pytest.mark.parametrize("rate", [0.0, -1.0, 61.0, np.nan])
def test_impossible_rates_are_refused(rate: float) -> None:
    with pytest.raises(InvalidInput, match="frame_rate"):
        motion_html(APPENDIX_4, planned("line").sample(20), frame_rate=rate)


def test_a_motion_that_fails_at_once_is_refused() -> None:
    start = np.add(home(APPENDIX_4.geometry), (0.9, 0.0, 0.0, 0.0))
    with pytest.raises(ImpossibleTrajectory, match="leg 1"):
        motion_html(APPENDIX_4, point_to_point(start, start + 0.1).sample(20))


@pytest.mark.browser
def test_a_browser_plays_it_from_a_file_offline(browser, tmp_path) -> None:
    trajectory = planned("circle").sample(500)
    file = tmp_path / "motion.html"
    file.write_bytes(motion_html(APPENDIX_4, trajectory))
    context = browser.new_context(viewport={"width": 480, "height": 360}, offline=True)
    page = context.new_page()
    page.set_default_timeout(1000 * TIMEOUT)
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    page.on("requestfailed", lambda request: complaints.append(request.url))
    page.goto(file.as_uri() + "?fixedDpr=1")

    def place() -> list[float] | None:
        return page.evaluate(
            "name => { const n = window.__viserMutable?.nodeRefFromName[name];"
            " return n ? n.position.toArray().concat(n.quaternion.toArray()) : null; }",
            node_name("platform"),
        )

    def clock() -> float:
        return float((page.locator("#motion-clock").inner_text() or "0").split(" ")[0])

    def shown(t: float) -> bool:
        x, y, _, z = trajectory.at([t]).pose[0]
        got = place()
        return got is not None and bool(np.allclose(got[:3], [x, y, z], atol=1e-3))

    start = until(place, "the platform")
    until(lambda: np.linalg.norm(np.subtract(place()[:3], start[:3])) > 0.05, "it moves by itself")
    # Past the end it starts again.
    until(lambda: clock() > 2.0, "most of the motion")
    until(lambda: clock() < 1.0, "a second time")
    # The pose shown is that of the chosen instant.
    for t in (0.4, 1.5, 2.9):
        page.locator("#motion-time").evaluate(
            "(slider, t) => { slider.value = t; slider.dispatchEvent(new Event('input')); }", t
        )
        until(lambda t=t: shown(t), f"the pose at {t} s; it is {place()}")
        assert clock() == t
    page.keyboard.press("Space")
    until(lambda: clock() > 2.9 or clock() < 2.0, "it plays on")
    context.close()
    assert complaints == []
