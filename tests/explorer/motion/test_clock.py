"""Playing on a real session, with a page that only listens."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.motion.description import Timing
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import initial_state
from tests.support.raw_page import TIMEOUT, eventually


class Watch:
    """Remembers which instants were drawn."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.poses: list[Any] = []

    def draw(self, frame: Frame, moving: bool) -> None:
        del moving
        self.times.append(frame.state.playback.time)
        self.poses.append(frame.configuration.pose)


@pytest.fixture
def played() -> Iterator[tuple[Session, Watch]]:
    """A session with a motion of 0.3 s, before it is played."""
    camera = SimpleNamespace(image_width=1400, image_height=900)
    page: Any = SimpleNamespace(atomic=contextlib.nullcontext, flush=lambda: None, camera=camera)
    state = motions.change(initial_state(), timing=Timing.GIVEN, duration=0.3)
    session, watch = Session(cast(Any, page), state), Watch()
    session.immediate.append(watch)
    session.start()
    yield session, watch
    session.close()
    session._thread.join(TIMEOUT)


def test_a_motion_is_played_to_its_end_and_is_no_step(played: tuple[Session, Watch]) -> None:
    session, watch = played
    session.dispatch("play", motions.play, step=False)
    eventually(lambda: watch.times and watch.times[-1] == 0.3)
    eventually(lambda: not session.state.playback.playing)
    assert watch.times == sorted(watch.times)
    assert any(0.0 < time < 0.3 for time in watch.times)
    motion = motions.planned(session.state).trajectory
    assert motion is not None
    for time, pose in list(zip(watch.times, watch.poses, strict=True))[-3:]:
        np.testing.assert_allclose(pose, motion.at(time).pose, atol=1e-12)
    assert not session.can_undo


def test_a_motion_repeats_until_it_is_paused(played: tuple[Session, Watch]) -> None:
    session, watch = played
    session.dispatch("loop", lambda s: motions.play(s.updated("playback", loop=True)), step=False)
    eventually(lambda: (np.diff(watch.times) < 0).sum() >= 2)
    session.dispatch("pause", motions.pause, step=False)
    eventually(lambda: not session.state.playback.playing)
    stopped = session.state.playback.time
    assert 0 <= stopped < 0.3
    session.dispatch("play", motions.play, step=False)
    eventually(lambda: session.state.playback.time != stopped)
