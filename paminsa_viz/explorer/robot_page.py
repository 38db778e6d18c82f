"""The standing robot as one HTML page, which opens from a file without a server or a network.

viser writes the page. Its scene needs a server to belong to, so one is started while the page is
made, guarded and on this machine only.
"""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import viser
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.explorer.browser import asset
from paminsa_viz.explorer.browser.style import style_html
from paminsa_viz.explorer.frame import compute
from paminsa_viz.explorer.scene.actuators import ActuatorLabels
from paminsa_viz.explorer.scene.bodies import Bodies, Position, Quaternion
from paminsa_viz.explorer.scene.cameras import preset, raised
from paminsa_viz.explorer.scene.layers import SceneContext
from paminsa_viz.explorer.scene.stage import SHADOW, Stage
from paminsa_viz.explorer.server.listening import open_server
from paminsa_viz.explorer.server.viser_patch import quiet
from paminsa_viz.explorer.state import LastReachable, initial_state
from paminsa_viz.model.arrays import as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from paminsa_viz.model.reach import require_reachable

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
    place = as_vectors(pose, "pose")
    if place.shape != (4,):
        raise InvalidInput("pose", f"one pose (4,) is needed; got {place.shape}")
    require_reachable(design.geometry, place)
    configuration = inverse_kinematics(design.geometry, place)
    with standing_robot(design, configuration) as (_, _, page):
        return titled(page(), f"PAMINSA: {design.name}").encode()


Places = Callable[[Configuration], tuple[dict[str, Position], dict[str, Quaternion]]]
"""Where a configuration puts the nodes of the robot, see `Bodies.places`."""


@contextmanager
def standing_robot(
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
    standing = LastReachable(design.geometry, (x, y, theta, z))
    state = replace(initial_state(design), standing=standing, layers=_LAYERS)
    with quiet():
        server = open_server(port=0)
        try:
            context = SceneContext(server.scene)
            stage, bodies, labels = Stage(context), Bodies(context), ActuatorLabels(context)
            for view in (stage, bodies, labels):
                view.draw(compute(state), dragging=False)

            def places(other: Configuration) -> Any:
                positions, turns = bodies.places(other)
                return positions | {SHADOW: stage.shadow_place(other)}, turns

            view = raised(preset("3D", design.geometry, configuration, ASPECT), covered)
            camera = server.initial_camera
            camera.position, camera.look_at = np.array(view.position), np.array(view.look_at)
            camera.fov = view.fov
            yield server.scene, places, lambda: server.get_scene_serializer().as_html()
        finally:
            server.stop()


def titled(page: str, title: str) -> str:
    """Return viser's page with a title and a backdrop of ours."""
    head, _, rest = page.partition("</head>")
    head = head.replace("<title>Viser</title>", f"<title>{html.escape(title)}</title>")
    return f"{head}{style_html()}<script>{asset('backdrop.js')}</script></head>{rest}"
