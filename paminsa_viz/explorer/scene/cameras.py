"""Camera presets: the whole robot, from above, from the front, one leg."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from paminsa_viz.dimensions.body_scale import times_body_scale
from paminsa_viz.dimensions.layout import layout, lift_motor_height, plinth_outline
from paminsa_viz.explorer.browser.style import SHEET_SHARE, has_sheet, view_width
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.state.view import Camera
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Geometry
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration, inverse_kinematics

FIELD_OF_VIEW: Final = float(np.radians(32.0))
"""Vertical field of view of every preset [rad]: a long lens keeps vertical lines vertical."""

FILL: Final = 0.94
"""How much of the picture's height or width a preset fills."""

LEGEND_HEIGHT: Final = 56.0
"""Height of the picture that is left to the legend [px]."""

VIEW_BAR_HEIGHT: Final = 44.0
"""Height of the picture that is left to the panel *View*, folded [px]."""

CAMERAS: Final = ("3D", "Top", "Front", "Leg 1", "Leg 2", "Leg 3")
"""Names of the presets."""


@dataclass(frozen=True)
class CameraView:
    """A camera: its position and what it looks at [m], and its field of view [rad]."""

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    fov: float = FIELD_OF_VIEW
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)


def preset(
    name: str, geometry: Geometry, configuration: Configuration | None = None, aspect: float = 1.5
) -> CameraView:
    """Return a preset that fits the picture.

    Args:
        name: One of `CAMERAS`. "Leg k" faces the leg's plane as the paper's Fig. 2 does, from the
            side where the mast is not in front of it.
        geometry: Lengths of the robot.
        configuration: With it, "Leg k" faces the plane as it is now; without, as at home.
        aspect: Width of the picture divided by its height.

    Raises:
        KeyError: If there is no such preset.
    """
    if name not in CAMERAS:
        raise KeyError(name)
    if name.startswith("Leg"):
        leg = int(name[-1]) - 1
        heading = (
            AXIS_ANGLES[leg] + np.pi if configuration is None else float(configuration.beta[leg])
        )
        side = -90.0 if leg == 0 else 90.0
        return _fitted(np.degrees(heading) + side, 5.0, _outline(geometry), aspect)
    azimuth, elevation = {"3D": (-52.0, 15.0), "Front": (-90.0, 4.0), "Top": (-90.0, 89.95)}[name]
    return _fitted(azimuth, elevation, _outline(geometry), aspect)


@times_body_scale
def _outline(geometry: Geometry) -> Array:
    """Return points around the whole machine, (n, 3) [m]."""
    place = layout(geometry)
    angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = geometry.base_radius + max(geometry.guide_link_length, geometry.crank_length)
    rings = [
        (reach + 0.02, 0.0),
        (reach + 0.02, -geometry.knee.sign * geometry.crank_length),
        (0.04, lift_motor_height(geometry) + 0.06),
    ]
    around = [np.column_stack([r * ring, np.full(24, z)]) for r, z in rings]
    foot = plinth_outline(geometry)
    return np.vstack([*around, np.column_stack([foot, np.full(len(foot), place.ground - 0.02)])])


def _fitted(azimuth: float, elevation: float, points: Array, aspect: float) -> CameraView:
    """Return the view from a direction [deg] that just holds all points.

    The camera is moved across until the margins on opposite sides are equal.
    """
    a, e = np.radians([azimuth, elevation])
    back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    up = np.cross(back, right)
    tangent = np.tan(FIELD_OF_VIEW / 2) * FILL
    look = points.mean(axis=0)
    distance = 1.0
    for _ in range(12):
        local = (points - look) @ np.stack([right, up, back], axis=1)
        needed = np.maximum(np.abs(local[:, 0]) / aspect, np.abs(local[:, 1])) / tangent
        distance = float((needed + local[:, 2]).max())
        seen = local[:, :2] / (distance - local[:, 2])[:, None]
        middle = (seen.max(axis=0) + seen.min(axis=0)) / 2 * distance
        look = look + middle[0] * right + middle[1] * up
    return CameraView(_triple(look + distance * back), _triple(look))


def _triple(point: Array) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return (x, y, z)


def raised(view: CameraView, below: float, above: float = 0.0) -> CameraView:
    """Return a view that shows the same in the free part of the picture.

    Args:
        view: A camera for the whole picture.
        below, above: Share of the picture's height that is covered from below, and from above.
    """
    position, target = np.array(view.position), np.array(view.look_at)
    back = position - target
    distance = float(np.linalg.norm(back)) / (1 - below - above)
    back /= np.linalg.norm(back)
    right = np.cross(view.up, back)
    upward = np.cross(back, right / np.linalg.norm(right))
    shift = (below - above) * distance * np.tan(view.fov / 2) * upward
    look_at = target - shift
    moved = look_at + distance * back
    return replace(view, position=_triple(moved), look_at=_triple(look_at))


def least_aspect(view: CameraView, geometry: Geometry) -> float:
    """Return the width over the height of the narrowest picture that holds the whole machine."""
    position = np.array(view.position)
    back = position - np.array(view.look_at)
    right = np.cross(view.up, back)
    points = _outline(geometry) - position
    across = np.abs(points @ right) / np.linalg.norm(right)
    ahead = -points @ back / np.linalg.norm(back)
    return float((across / ahead).max() / (np.tan(view.fov / 2) * FILL))


def in_window(
    name: str,
    geometry: Geometry,
    configuration: Configuration | None,
    width: float,
    height: float,
    *,
    sheet: bool = False,
) -> CameraView:
    """Return a preset that fits between the panel *View* and the legend.

    Args:
        name, geometry, configuration: As `preset` takes them.
        width, height: Size of the picture [px]; 0 is not known.
        sheet: Whether a sheet of controls covers the legend, and more.
    """
    if not height:
        return preset(name, geometry, configuration, 1.0)
    below, above = (min(part / height, 0.25) for part in (LEGEND_HEIGHT, VIEW_BAR_HEIGHT))
    below = SHEET_SHARE if sheet else below
    aspect = width / height / (1 - below - above)
    return raised(preset(name, geometry, configuration, aspect), below, above)


def look(session: Session, name: str) -> None:
    """Move a tab's camera to a preset that fits the free part of its window.

    Args:
        session: The tab; "Leg k" faces the leg at the robot's pose.
        name: One of `CAMERAS`.
    """
    client = session.client
    view = _in_tab(session, name)
    camera = client.camera
    with client.atomic():
        camera.up_direction = view.up
        camera.position = view.position
        camera.look_at = view.look_at
        camera.fov = view.fov
    client.flush()
    session.camera = (name, view.position)


def _in_tab(session: Session, name: str) -> CameraView:
    """Return a preset that fits the free part of a tab's window, see `look`."""
    camera, last_reachable = session.client.camera, session.state.last_reachable
    configuration = inverse_kinematics(last_reachable.geometry, last_reachable.pose)
    width = camera.image_width / session.pixel_ratio
    height = camera.image_height / session.pixel_ratio
    if np.allclose((width, height), session.window, atol=1):  # the panels take theirs in a moment
        width = view_width(width, height)
    return in_window(
        name, last_reachable.geometry, configuration, width, height,
        sheet=has_sheet(session.window[0]),
    )  # fmt: skip


def at_preset(session: Session) -> bool:
    """Whether the camera is where it was sent to last, and no person has moved it since."""
    name, position = session.camera
    return bool(name) and np.allclose(session.client.camera.position, position, atol=1e-3)


def camera_of(session: Session) -> Camera | None:
    """Return where a person has put the camera; None while it is where a preset put it."""
    camera = session.client.camera
    if at_preset(session):
        return None
    return Camera(_triple(np.array(camera.position)), _triple(np.array(camera.look_at)))


def place(session: Session) -> None:
    """Put the camera where the state has it: where a person left it, or back to its preset."""
    wanted, camera = session.state.camera, session.client.camera
    if wanted is None:
        if not at_preset(session):
            look(session, session.camera[0] or CAMERAS[0])
        return
    if not np.isfinite([*wanted.position, *wanted.look_at]).all():
        return
    with session.client.atomic():
        camera.up_direction = CameraView.up
        camera.position, camera.look_at = wanted.position, wanted.look_at
        camera.fov = FIELD_OF_VIEW
    session.client.flush()


KEEPING = 1.0
"""How long after the camera was moved its place is kept at the latest [s]."""


def keep_camera(session: Session) -> None:
    """Keep in the state where a person puts the camera, for its workspace and for a reload."""
    waiting = threading.Event()

    def keep() -> None:
        waiting.clear()
        now = camera_of(session)
        if not session.closed and now != session.state.camera:
            session.dispatch(
                "camera", lambda state: replace(state, camera=now), step=False, overtakes=True
            )

    def check(_: object) -> None:
        if waiting.is_set() or not session.camera[0]:
            return
        waiting.set()
        timer = threading.Timer(KEEPING, keep)
        timer.daemon = True
        timer.start()

    session.client.camera.on_update(check)


def fit(session: Session) -> None:
    """Look as the preset chosen last does, for a window that is known only now."""
    if at_preset(session):
        look(session, session.camera[0])


NEARER, FARTHER, ASIDE = 0.75, 1.15, 0.1
"""How much nearer, farther and aside, in parts of its distance, a preset would look at a robot of
other lengths before it does so: by less, a slider is seen to change the robot, not the picture."""


class SizeView:
    """Fits the robot to the view again once its lengths have changed by much, as a file does,
    unless a person moved the camera.

    Args:
        session: The tab.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._geometry = session.state.last_reachable.geometry

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Follow the lengths when nothing is dragged."""
        session, geometry = self._session, frame.state.last_reachable.geometry
        if dragging or geometry == self._geometry:
            return
        self._geometry = geometry
        if at_preset(session) and self._is_due(session):
            look(session, session.camera[0])

    @staticmethod
    def _is_due(session: Session) -> bool:
        camera, wanted = session.client.camera, _in_tab(session, session.camera[0])
        position, target = np.array(camera.position), np.array(camera.look_at)
        now = float(np.linalg.norm(position - target))
        distance = float(np.linalg.norm(np.subtract(wanted.position, wanted.look_at))) / now
        aside = float(np.linalg.norm(wanted.look_at - target)) / now
        return not NEARER <= distance <= FARTHER or aside > ASIDE


RESIZED = 0.01
"""Change of the picture's shape from which on the robot is fitted again at another height: viser
makes the pixels fewer where pictures take long, and rounding them is no new shape."""


def follow_resizes(session: Session) -> None:
    """Fit the robot to the view again when its shape changes, unless a person moved the camera.

    At the same height every pixel counts: how wide the view was on the way to its width, which is
    a matter of time, is not seen in the end.
    """
    camera = session.client.camera
    fitted, window = (0, 1), session.window

    def is_due() -> bool:
        if session.window != window:  # which may be known later than the view that came of it
            return True
        width, height = camera.image_width, max(camera.image_height, 1)
        if height == fitted[1]:
            return width != fitted[0]
        shape = width / height
        return abs(shape - fitted[0] / fitted[1]) > RESIZED * shape

    def check(_: object) -> None:
        # A new shape may be known before the page has put the camera where it was sent to.
        if at_preset(session) and is_due():
            session.submit(follow)

    def follow() -> None:
        nonlocal fitted, window
        if at_preset(session) and is_due():
            window = session.window
            fitted = (camera.image_width, max(camera.image_height, 1))
            look(session, session.camera[0])

    camera.on_update(check)
