"""The robot, or a motion that is played, as one HTML page that opens from a file.

viser writes the page of the robot at a pose. Its scene needs a server to belong to, so one is
started while the page is made, guarded and on this machine only. The motion is played by a small
script of ours (``browser/player.js``), which moves the nodes: viser's own player makes the whole
scene again whenever the motion starts again, and freezes meanwhile.
"""

from __future__ import annotations

import base64
import html
import json
import math
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import viser
from numpy.typing import ArrayLike

from paminsa_viz import palette
from paminsa_viz.explorer.browser import asset
from paminsa_viz.explorer.browser.style import style_html
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.scene.actuators import actuator_labels
from paminsa_viz.explorer.scene.bodies import Bodies, Position, Quaternion
from paminsa_viz.explorer.scene.cameras import CameraView, least_aspect, preset, raised
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.nodes import LayerView, Nodes, curves
from paminsa_viz.explorer.scene.stage import SHADOW, Stage
from paminsa_viz.explorer.server.listening import open_server
from paminsa_viz.explorer.server.viser_patch import quiet
from paminsa_viz.explorer.state.document import LastReachable
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.arrays import Array, as_pose
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from paminsa_viz.model.reach import require_reachable
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis, analyze
from paminsa_viz.trajectory.check import ImpossibleTrajectory
from paminsa_viz.trajectory.planners import PLACE
from paminsa_viz.trajectory.sampled import Trajectory
from paminsa_viz.units import as_sentence
from paminsa_viz.version import MADE_BY

FRAME_RATE = 30.0
"""Places of the robot a second [1/s]; between them the page interpolates."""

MOST_FRAMES = 3000
"""Longer motions have fewer places a second; each is some 400 bytes."""

PAUSE = 0.6
"""How long the end is shown before a motion that ends elsewhere starts again [s]."""

_CLOSED = 1e-6
"""Difference of two poses that are the same [m, rad]."""

_ROUNDING = 1e-9
"""Change of a place that is none [m, 1]."""

_PATH_POINTS = 600
"""Points of the path that is drawn."""

_COVERED = 0.2
"""Share of the window's height that the controls cover."""

Frames = list[tuple[dict[str, Position], dict[str, Quaternion]]]
"""Positions and quaternions by scene node, of each instant."""

ASPECT = 1.6
"""Width over height of the window that the camera is placed for."""

_LAYERS = frozenset({"mesh", "fine", "labels"})


def robot_html(design: Design, pose: ArrayLike) -> bytes:
    """Return a page with the robot in a pose, to be turned and zoomed with the mouse.

    Args:
        design: The robot.
        pose: (4,) [m, m, rad, m].

    Returns:
        HTML, UTF-8.

    Raises:
        InvalidInput: If it is not one pose.
        UnreachablePose: If the robot cannot take it.
        CannotListen: If no port is left for the server.
    """
    place = as_pose(pose)
    require_reachable(design.geometry, place)
    configuration = inverse_kinematics(design.geometry, place)
    with robot_scene(design, configuration) as (_, _, page):
        return titled(page(), f"PAMINSA: {design.name}").encode()


Places = Callable[[Configuration], tuple[dict[str, Position], dict[str, Quaternion]]]
"""Where a configuration puts the nodes of the robot, see `Bodies.places`."""


@contextmanager
def robot_scene(
    design: Design, configuration: Configuration, *, covered: float = 0.0
) -> Iterator[tuple[viser.SceneApi, Places, Callable[[], str]]]:
    """Put a robot into a scene of its own.

    Args:
        design: The robot.
        configuration: A solved configuration of shape () of it.
        covered: Lower part of the window's height that the camera is to keep free.

    Yields:
        The scene, for more to be drawn; where other configurations put the robot's nodes; and what
        writes the page.
    """
    x, y, theta, z = map(float, configuration.pose)
    last_reachable = LastReachable(design.geometry, (x, y, theta, z))
    state = replace(initial_state(design), last_reachable=last_reachable, layers=_LAYERS)
    with quiet():
        server = open_server(port=0)
        try:
            context = SceneContext(server.scene)
            stage, bodies = Stage(context), Bodies(context)
            labels = LayerView(LAYERS["labels"], actuator_labels, context)
            for view in (stage, bodies, labels):
                view.draw(compute(state), dragging=False)

            def places(other: Configuration) -> Any:
                positions, turns = bodies.places(other)
                return positions | {SHADOW: stage.shadow_place(other)}, turns

            view = raised(preset("3D", design.geometry, configuration, ASPECT), covered)
            camera = server.initial_camera
            camera.position, camera.look_at = np.array(view.position), np.array(view.look_at)
            camera.fov = view.fov
            script = _narrow(view, design)
            yield (
                server.scene, places,
                lambda: _with_head(server.get_scene_serializer().as_html(), script),
            )  # fmt: skip
        finally:
            server.stop()


def _narrow(view: CameraView, design: Design) -> str:
    """Return the script that shows the whole robot in a narrow window as well."""
    aspect = least_aspect(view, design.geometry)
    script = asset("narrow.js", HALF=repr(math.tan(view.fov / 2)), ASPECT=repr(aspect))
    return f"<script>{script}</script>"


def _with_head(page: str, more: str) -> str:
    """Return a page with more at the end of its head."""
    head, end, rest = page.partition("</head>")
    return f"{head}{more}{end}{rest}"


def titled(page: str, title: str) -> str:
    """Return viser's page with a title and a backdrop of ours."""
    page = page.replace("<title>Viser</title>", f"<title>{html.escape(title)}</title>", 1)
    return _with_head(page, f"{style_html()}<script>{asset('backdrop.js')}</script>")


def motion_html(design: Design, trajectory: Trajectory) -> bytes:
    """Return a page that plays a motion in real time, over and over, with the robot and its path.

    A motion that the robot cannot run is played up to where it first fails; the rest of its path
    is red, and the page says why.

    Args:
        design: The robot.
        trajectory: The motion.

    Returns:
        HTML, UTF-8.

    Raises:
        ImpossibleTrajectory: If the motion fails at its very start: there is nothing to play.
        CannotListen: If no port is left for the server.
    """
    analysis = analyze(design, trajectory)
    first = analysis.check.first
    if first is not None and analysis.check.until < 2:
        raise ImpossibleTrajectory(first)
    until = analysis.check.until
    times = frame_times(float(trajectory.t[0]), float(trajectory.t[until - 1]))
    scene, frames = _record(analysis, times)
    return _page(scene, analysis, times, frames).encode()


def frame_times(begin: float, end: float) -> Array:
    """Return the instants of the robot's places in equal steps, both ends among them (n,) [s]."""
    steps = min(max(math.ceil((end - begin) * FRAME_RATE - 1e-9), 1), MOST_FRAMES - 1)
    return np.linspace(begin, end, steps + 1)


def _record(analysis: TrajectoryAnalysis, times: Array) -> tuple[str, Frames]:
    """Return viser's page of the robot at its first place, and its nodes' places at all times."""
    geometry, trajectory = analysis.design.geometry, analysis.trajectory
    poses = trajectory.at(times).pose
    configurations = [inverse_kinematics(geometry, pose) for pose in poses]
    with robot_scene(analysis.design, configurations[0], covered=_COVERED) as (
        scene,
        places,
        page,
    ):
        _draw_path(scene, trajectory, float(times[-1]))
        return page(), [places(configuration) for configuration in configurations]


def _draw_path(scene: viser.SceneApi, trajectory: Trajectory, end: float) -> None:
    """Draw the path of the platform: what is run, and red what is not."""
    begin, last = float(trajectory.t[0]), float(trajectory.t[-1])
    for name, color, start, stop in (
        ("run", palette.INK, begin, end),
        ("beyond", palette.BAD, end, last),
    ):
        if stop > start:
            path = trajectory.at(np.linspace(start, stop, _PATH_POINTS)).pose[:, PLACE]
            Nodes(scene).show([curves(f"/path/{name}", [path], color, 3.0)])


def _page(scene: str, analysis: TrajectoryAnalysis, times: Array, frames: Frames) -> str:
    """Return viser's page with our title, notes, controls and places."""
    title = f"PAMINSA: {analysis.trajectory.name}"
    data = json.dumps(_data(analysis, times, frames))
    player = asset(
        "player.html",
        SCRIPT=asset("player.js"),
        TITLE=html.escape(title),
        WORDS="".join(f"<p>{html.escape(line)}</p>" for line in _notes(analysis)),
        DATA=data.replace("<", "\\u003c"),  # a name may hold </script>
    )
    page = titled(scene, title)
    end = page.rindex("</body>")
    return page[:end] + player + page[end:]


def _notes(analysis: TrajectoryAnalysis) -> list[str]:
    """Return what the page says of the motion, a line each."""
    trajectory, failure = analysis.trajectory, analysis.failure
    notes = [
        f"Design “{analysis.design.name}”, {analysis.solved.geometry.knee.label}; "
        f"{trajectory.duration:.4g} s. {MADE_BY}.",
        *trajectory.notes,
    ]
    if left_out := equal_legs_note(analysis.design.deviations):
        notes.append(as_sentence(left_out))
    if failure is not None:
        played = "" if analysis.check.possible else " It is played up to there."
        notes.insert(0, f"The motion fails {failure.explanation}.{played}")
    return notes


def _data(analysis: TrajectoryAnalysis, times: Array, frames: Frames) -> dict[str, Any]:
    """Return what the player needs: which nodes move how, float32 in base64, frame by frame."""
    positions, turns = (
        _changing({name: np.array([frame[kind][name] for frame in frames]) for name in first})
        for kind, first in enumerate(frames[0])
    )
    until = analysis.check.until
    t = analysis.trajectory.t[:until]
    torque = np.stack([np.interp(times, t, column[:until]) for column in analysis.torque.T], axis=1)
    pose = analysis.trajectory.pose
    closed = until == len(pose) and np.abs(pose[0] - pose[-1]).max() < _CLOSED
    return {
        "duration": float(times[-1] - times[0]),
        "pause": 0.0 if closed else PAUSE,
        "frames": times.size,
        "moved": list(positions),
        "turned": list(turns),
        "positions": _packed(positions.values()),
        "turns": _packed(turns.values()),
        "torques": _packed([torque]),
        "colors": palette.ACTUATOR_COLORS,
    }


def _changing(places: dict[str, Array]) -> dict[str, Array]:
    """Return the places (n, k) that are not the same all the time, but for rounding."""
    return {name: rows for name, rows in places.items() if np.ptp(rows, axis=0).max() > _ROUNDING}


def _packed(arrays: Collection[Array]) -> str:
    """Return arrays (n, k) side by side, frame by frame, as little-endian float32 in base64."""
    rows = np.concatenate(list(arrays), axis=1)
    return base64.b64encode(rows.astype("<f4").tobytes()).decode()
