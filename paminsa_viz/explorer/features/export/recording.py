"""A motion as an animated picture or a video, as the page draws it; see `plots.animations`.

The page renders frame after frame while the session's worker holds the robot at each instant. In
between the worker does what it always does, so that the page stays alive and can cancel.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.export.exports import motion_name
from paminsa_viz.explorer.features.export.pictures import VIEW_TIMEOUT, Viewpoint, picture
from paminsa_viz.explorer.features.maps.floor import FloorMap
from paminsa_viz.explorer.kit.downloads import File
from paminsa_viz.explorer.scene.legend import NO_LEGEND, Legend
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import InvalidInput, PaminsaError
from paminsa_viz.plots.animations import ANIMATION_FORMATS
from paminsa_viz.progress import Canceled

RATE = 15.0
"""Pictures a second of the motion, as long as there are not too many."""

MOST_FRAMES = 180
"""Pictures of one file; a longer motion has fewer a second, in true time."""

LONGEST = 120.0
"""Longest motion that is recorded [s]."""

LARGEST = 720
"""Longest side of an animated picture [pixels]."""


def instants(duration: float) -> NDArray[np.float64]:
    """Return the instants of the pictures of a motion in equal steps, both ends among them [s].

    Raises:
        InvalidInput: If it is too long.
    """
    if duration > LONGEST:
        raise InvalidInput("motion", f"at most {LONGEST:g} s can be recorded, not {duration:.4g}")
    count = min(max(math.ceil(duration * RATE) + 1, 2), MOST_FRAMES)
    return np.linspace(0.0, duration, count)


def size_of(view: tuple[float, float]) -> tuple[int, int]:
    """Return width and height of the pictures for a view of some size [pixels]."""
    width, height = view
    share = min(1.0, LARGEST / max(width, height, 1.0))
    # even sides: many players need them
    return max(int(share * width) // 2 * 2, 64), max(int(share * height) // 2 * 2, 64)


class Recorder:
    """Records the motion of a session; one at a time.

    Args:
        legend: Returns the legend of a frame that has been drawn.
    """

    def __init__(self, legend: Callable[[Frame], Legend] = lambda frame: NO_LEGEND) -> None:
        self._legend = legend
        self._cancel = threading.Event()

    def cancel(self, session: Session) -> None:
        """Let the recording that runs end."""
        del session
        self._cancel.set()

    def record(self, session: Session, kind: str) -> File:
        """Return the motion as a light page draws it; called on a thread of its own.

        Args:
            session: The session of the page.
            kind: One of `ANIMATION_FORMATS`.

        Raises:
            PaminsaError: If there is no motion, it fails, it is too long, or the page does not
                answer.
            Canceled: If it was canceled, or the page has gone.
        """
        state = replace(session.state, appearance=Appearance.LIGHT)
        store = MotionStore()
        found = store.all(state)
        if found is None:
            raise motions.no_motion(state)
        first = found.analysis.check.first
        if first is not None:
            raise InvalidInput("motion", f"it fails {first.explanation}")
        times = instants(found.analysis.trajectory.duration)

        def frame_at(time: float) -> Frame:
            return compute(motions.scrub(state, time), store)

        self._cancel.clear()
        try:
            start = partial(_recording, kind)
            session.dispatch("recording", start, step=False)
            frames = self._frames(session, frame_at, times)
            with session.holding_scene():
                step = float(times[1] - times[0])
                content = ANIMATION_FORMATS[kind].encode(frames, step, times.size)
        finally:
            session.dispatch("recording", partial(_recording, None), step=False)
        return File(motion_name(state, found, "", kind), content)

    def _frames(
        self,
        session: Session,
        frame_at: Callable[[float], Frame],
        times: NDArray[np.float64],
    ) -> Iterator[NDArray[np.uint8]]:
        camera = session.client.camera
        size = size_of((camera.image_width, camera.image_height))
        viewpoint = Viewpoint.now(session.client)  # a resized window or a person may change it
        told = -1.0
        for index, time in enumerate(times):
            done = index / len(times)
            if done - told >= 0.05:  # now and then: the page is drawn for it
                told = done
                action = partial(State.updated, part="recording", done=done)
                session.dispatch("recording.done", action, step=False, overtakes=True)
            make = partial(frame_at, float(time))
            draw = partial(self._render, session, make, size, viewpoint, first=index == 0)
            yield self._on_worker(session, draw)

    def _on_worker(self, session: Session, make: Callable[[], Any]) -> Any:
        """Return what a function returns on the session's worker."""
        done, result = threading.Event(), []

        def job() -> None:
            try:
                result.append(make())
            except Exception as error:
                result.append(error)
            finally:
                done.set()

        session.submit(job)
        for _ in range(int(10 * 2 * VIEW_TIMEOUT)):
            if self._cancel.is_set() or session.closed:
                raise Canceled
            if done.wait(0.1):
                break
        if not result:
            raise PaminsaError("the page did not draw the motion in time")
        if isinstance(result[0], Exception):
            raise result[0]
        return result[0]

    def _render(
        self,
        session: Session,
        make: Callable[[], Frame],
        size: tuple[int, int],
        viewpoint: Viewpoint,
        *,
        first: bool,
    ) -> NDArray[np.uint8]:
        """Draw a frame and have the page render it."""
        frame, is_late = make(), first  # bodies that the first one has made anew
        with session.client.atomic():
            for view in session.immediate:
                view.draw(frame, True)
            for view in session.ground:
                if isinstance(view, FloorMap):
                    is_late |= view.draw_at_once(frame)
        session.client.flush()
        if is_late:  # the browser has decoded it by the time that the page has answered once
            picture(session.client, (0, 0))
        return picture(session.client, size, self._legend(frame), viewpoint)


def _recording(kind: str | None, state: State) -> State:
    """Return the state with a recording that has begun, or None for none."""
    own = state.recording
    return state.updated("", recording=own.ended() if kind is None else own.started(kind))
