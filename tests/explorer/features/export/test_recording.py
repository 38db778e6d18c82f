"""A motion as an animated picture: which instants, at which poses, canceled, refused."""

from __future__ import annotations

import io
import threading
import time
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.export.pictures import VIEW_SIDES
from paminsa_viz.explorer.features.export.recording import (
    LARGEST,
    LONGEST,
    MOST_FRAMES,
    RATE,
    Recorder,
    instants,
    size_of,
)
from paminsa_viz.explorer.features.export.tab import export_entries
from paminsa_viz.explorer.features.maps.floor import FloorMap
from paminsa_viz.explorer.kit.downloads import session_export
from paminsa_viz.explorer.kit.entries import ButtonGroup, given
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import InvalidInput
from paminsa_viz.palette import DARK, LIGHT, Theme
from paminsa_viz.plots import animations
from paminsa_viz.plots.animations import ANIMATION_FORMATS
from tests.support.chromium import TIMEOUT, until
from tests.support.desk import SilentPage, stop


class Page(SilentPage):
    """A tab that renders a picture whose brightness is the platform's x."""

    def __init__(self) -> None:
        super().__init__()
        self.camera = SimpleNamespace(
            image_width=100, image_height=80, wxyz=(1, 0, 0, 0), position=(0, 0, 2), fov=0.5
        )
        self.places: list[Any] = []
        self.x = 0.0
        self.poses: list[Any] = []
        self.widths: list[int] = []
        self.theme = LIGHT
        self.themes: list[Theme] = []
        self.drawn: list[Any] = []
        self.drawn_at_last_picture = 0
        self.renders = threading.Semaphore(0)
        self.slow = 0.0

    def get_render(self, height: int, width: int, position: Any = None, **_: Any) -> np.ndarray:
        time.sleep(self.slow)
        self.places.append(position)
        self.renders.release()
        self.drawn_at_last_picture = len(self.drawn)
        self.poses.append(self.x)
        self.widths.append(width)
        self.themes.append(self.theme)
        value = int(np.clip(128 + 1000 * self.x, 0, 255))
        picture = np.full((height, width, 4), value, dtype=np.uint8)
        picture[..., 3] = 255
        return picture


@pytest.fixture
def session() -> Any:
    page = Page()
    made: Any = Session(page, motions.choose_preset(initial_state(), "circle"))  # type: ignore[arg-type]

    def draw(frame: Any, dragging: bool) -> None:
        page.x = float(frame.configuration.pose[0])
        page.theme = frame.state.theme
        page.drawn.append(frame.shown_design)

    made.immediate.append(SimpleNamespace(draw=draw))
    made.start()
    yield made
    stop(made)


def frames_of(content: bytes) -> list[Image.Image]:
    image = Image.open(io.BytesIO(content))
    found = []
    for index in range(image.n_frames):  # type: ignore[attr-defined]
        image.seek(index)
        found.append(image.convert("RGB").copy())
    return found


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_every_instant_is_rendered_at_its_pose(session: Any, kind: str) -> None:
    before = session.state
    file = Recorder().record(session, kind)
    trajectory = motions.planned(before).trajectory
    assert trajectory is not None
    times = instants(trajectory.duration)
    assert times.size == round(3.0 * RATE) + 1
    poses = session.client.poses[1:]  # the first picture is taken twice
    np.testing.assert_allclose(poses, trajectory.at(times).pose[:, 0], atol=1e-12)
    assert file.name.endswith(f".{kind}")
    assert Image.open(io.BytesIO(file.content)).format == kind.upper()
    # Neighbors that look the same are one frame, shown longer.
    shown = [frame.getpixel((5, 5))[0] for frame in frames_of(file.content)]
    assert 20 < len(shown) <= times.size
    assert max(shown) - min(shown) > 150
    end = time.monotonic() + 10
    while session.state.recording.running:
        assert time.monotonic() < end
    assert session.state.document == before.document


class NewMaps(FloorMap):
    """A floor with another map in each picture."""

    def __init__(self) -> None:
        pass

    def draw(self, frame: Any, dragging: bool) -> None:
        """Draw nothing."""

    def draw_at_once(self, frame: Any) -> bool:
        """Say so."""
        return True


def test_a_new_map_on_the_floor_is_decoded_before_a_picture_is_taken(session: Any) -> None:
    session.dispatch("motion", lambda s: motions.change(s, timing=Timing.GIVEN, duration=0.1))
    session.ground.append(NewMaps())
    until(lambda: session.state.document.motion.duration == 0.1, "a short motion")
    Recorder().record(session, "gif")
    assert session.client.widths == [VIEW_SIDES[0], size_of((100, 80))[0]] * instants(0.1).size


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_recording_can_be_canceled(session: Any, kind: str) -> None:
    session.client.slow = 0.05
    recorder = Recorder()

    def cancel() -> None:
        for _ in range(3):
            assert session.client.renders.acquire(timeout=TIMEOUT)
        recorder.cancel(session)

    canceling = threading.Thread(target=cancel)
    canceling.start()
    export: Any = session_export("the motion", partial(recorder.record, kind=kind))
    export.call(session)
    canceling.join()
    assert 0 < len(session.client.poses) < 30
    assert session.client.notices == session.client.removed == [("Exporting the motion …", "")]
    again = Recorder()
    session.client.slow = 0.0
    assert again.record(session, kind).content


def test_all_pictures_are_taken_from_one_place(session: Any) -> None:
    """A person turns the view, or it follows the window that is resized."""
    page = session.client
    session.dispatch("motion", lambda s: motions.change(s, timing=Timing.GIVEN, duration=0.2))
    until(lambda: session.state.document.motion.duration == 0.2, "a short motion")

    def move(frame: Any, dragging: bool) -> None:
        if page.places:  # not yet by a frame that is drawn before the recording begins
            page.camera.position = (0, 0, 3 + len(page.places))

    session.immediate.append(SimpleNamespace(draw=move))
    Recorder().record(session, "gif")
    assert page.camera.position != (0, 0, 2)
    assert page.places[1:] == [(0, 0, 2)] * instants(0.2).size  # the first waits for new bodies


@pytest.mark.slow
def test_a_design_that_is_changed_meanwhile_is_drawn_afterwards(session: Any) -> None:
    page, before = session.client, session.state.document.design
    page.slow = 0.02

    def change() -> None:
        for mass in (1.0, 2.0):
            assert page.renders.acquire(timeout=TIMEOUT)
            session.dispatch("mass", lambda s, m=mass: actions.vary(s, {"payload.mass": m}))

    changing = threading.Thread(target=change)
    changing.start()
    file = Recorder().record(session, "gif")
    changing.join()
    assert "appendix-4" in file.name
    assert set(page.drawn[: page.drawn_at_last_picture]) == {before}
    until(lambda: page.drawn[-1].payload.mass == 2.0, "the page shows the design")


@pytest.mark.slow
def test_pictures_are_light_on_a_dark_page_and_the_page_is_dark_again(session: Any) -> None:
    session.dispatch("view", lambda state: replace(state, appearance=Appearance.DARK))
    until(lambda: session.client.theme is DARK, "the page is dark")
    Recorder().record(session, "gif")
    assert set(session.client.themes) == {LIGHT}
    until(lambda: session.client.theme is DARK, "the page is dark again")


def test_what_cannot_be_recorded_is_refused(session: Any) -> None:
    def refused(state: State, match: str) -> None:
        session._state = state
        with pytest.raises(InvalidInput, match=match):
            Recorder().record(session, "gif")

    start = initial_state()
    refused(motions.choose_kind(start, Kind.WAYPOINTS), "two or more")
    refused(motions.change(start, timing=Timing.GIVEN, duration=LONGEST + 1), "at most")
    line = motions.choose_kind(start, Kind.LINE)
    refused(motions.change(line, start=(0, 0, 0, -0.5), goal=(0.6, 0, 0, -0.5)), "fails")


def test_pictures_are_few_and_small_enough() -> None:
    assert instants(0.01).size == 2
    assert instants(100.0).size == MOST_FRAMES
    np.testing.assert_allclose(instants(1.0)[[0, -1]], [0.0, 1.0])
    assert size_of((412.0, 705.0)) == (412, 704)
    assert max(size_of((4000.0, 1000.0))) == LARGEST
    pictures = iter([np.full((64, 64, 3), value, np.uint8) for value in (0, 99, 200)])
    image = Image.open(io.BytesIO(ANIMATION_FORMATS["gif"].encode(pictures, 0.1, 3)))
    assert image.info["duration"] == 100
    assert image.info["loop"] == 0


@pytest.mark.parametrize(("kind", "unit"), [("gif", 10), ("webp", 1)])
def test_durations_of_pictures_add_up(kind: str, unit: int) -> None:
    pictures = [np.full((64, 64, 3), 5 * value, np.uint8) for value in range(46)]
    image: Any = Image.open(io.BytesIO(ANIMATION_FORMATS[kind].encode(iter(pictures), 1 / 15, 46)))
    durations = []
    for index in range(image.n_frames):
        image.seek(index)
        image.load()
        durations.append(image.info["duration"])
    assert len(durations) == len(pictures)
    assert abs(sum(durations) - 46e3 / 15) <= unit / 2
    assert all(abs(duration - 1e3 / 15) < unit for duration in durations)


@pytest.mark.slow
def test_video_has_every_picture_in_true_time(session: Any) -> None:
    av = pytest.importorskip("av")
    file = Recorder().record(session, "mp4")
    trajectory = motions.planned(session.state).trajectory
    assert trajectory is not None
    times = instants(trajectory.duration)
    assert file.name.endswith(".mp4")
    with av.open(io.BytesIO(file.content)) as container:
        video = container.streams.video[0]
        assert (video.codec_context.name, video.pix_fmt) == ("h264", "yuv420p")
        frames = list(container.decode(video))
        seconds = float(video.duration * video.time_base)
    assert len(frames) == times.size
    assert seconds == pytest.approx(trajectory.duration + times[1], abs=1e-3)
    brightness = [frame.to_ndarray(format="rgb24")[5, 5, 0] for frame in frames]
    expected = np.clip(128 + 1000 * trajectory.at(times).pose[:, 0], 0, 255)
    np.testing.assert_allclose(brightness, expected, atol=4)


def test_video_cuts_odd_sides() -> None:
    av = pytest.importorskip("av")
    pictures = iter(np.zeros((3, 65, 101, 3), np.uint8))
    with av.open(io.BytesIO(ANIMATION_FORMATS["mp4"].encode(pictures, 1 / 15, 3))) as container:
        first = next(container.decode(video=0))
    assert (first.width, first.height) == (100, 64)


def test_format_that_is_not_installed_is_disabled_with_the_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(animations, "find_spec", lambda name: None)
    entries = {entry.key: entry for entry in export_entries(MapStore())}
    group, button = entries["export.record"], entries["export.mp4"]
    assert isinstance(group, ButtonGroup)
    assert list(given(group.choices, initial_state())) == ["GIF", "WebP"]
    assert button.disabled is not None
    assert button.disabled(initial_state())
    assert "av" in str(button.label)
    assert "paminsa-viz[video]" in str(button.hint)
