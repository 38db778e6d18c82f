"""The standing robot as one HTML page, which opens from a file without a server or a network.

viser writes the page. Its scene needs a server to belong to, so one is started while the page is
made, guarded and on this machine only.
"""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import viser
from numpy.typing import ArrayLike

from paminsa_viz.explorer.browser import asset
from paminsa_viz.explorer.browser.style import style_html
from paminsa_viz.explorer.scene.cameras import preset
from paminsa_viz.explorer.scene.robot import SHOWN_AT_START, Layer, RobotScene
from paminsa_viz.explorer.scene.view import raised
from paminsa_viz.explorer.server.listening import open_server
from paminsa_viz.explorer.server.viser_patch import quiet
from paminsa_viz.model.arrays import as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.kinematics import Configuration, inverse_kinematics
from paminsa_viz.model.reach import require_reachable

ASPECT = 1.6
"""Width over height of the window that the camera is placed for."""


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


@contextmanager
def standing_robot(
    design: Design, configuration: Configuration, *, covered: float = 0.0
) -> Iterator[tuple[viser.SceneApi, RobotScene, Callable[[], str]]]:
    """Put a robot into a scene of its own.

    Args:
        design: The robot.
        configuration: A solved configuration of shape () of it.
        covered: Lower part of the window's height that the camera is to keep free.

    Yields:
        The scene, for more to be drawn; the robot; and what writes the page of both.
    """
    with quiet():
        server = open_server(port=0)
        try:
            robot = RobotScene(server.scene, design)
            for layer in Layer:
                robot.show(layer, layer in SHOWN_AT_START or layer is Layer.FINE)
            robot.pose(configuration)
            view = preset("3D", design.geometry, configuration, ASPECT)
            view = raised(view, covered)
            camera = server.initial_camera
            camera.position, camera.look_at = np.array(view.position), np.array(view.look_at)
            camera.fov = view.fov
            yield server.scene, robot, lambda: server.get_scene_serializer().as_html()
        finally:
            server.stop()


def titled(page: str, title: str) -> str:
    """Return viser's page with a title and a backdrop of ours."""
    head, _, rest = page.partition("</head>")
    head = head.replace("<title>Viser</title>", f"<title>{html.escape(title)}</title>")
    return f"{head}{style_html()}<script>{asset('backdrop.js')}</script></head>{rest}"
