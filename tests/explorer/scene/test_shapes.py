"""Shapes of the scene by themselves: curves, arrows, cameras, the background."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.dimensions.layout import lift_motor_height
from paminsa_viz.explorer.browser.style import SHEET_SHARE, over_backdrop, style_html
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.scene import cameras
from paminsa_viz.explorer.scene.actuators import FACES, arc_arrow, force_arrow, torque_arrows
from paminsa_viz.explorer.scene.cameras import (
    CAMERAS,
    LEGEND_HEIGHT,
    VIEW_BAR_HEIGHT,
    in_window,
    least_aspect,
    preset,
)
from paminsa_viz.explorer.scene.curves import (
    MOST_DASHES,
    bands,
    circles,
    dashes,
    resampled,
    segments,
)
from paminsa_viz.explorer.scene.nodes import Nodes, curves, flat_curves, lines
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.palette import INK, LIGHT, rgb
from tests.support.desk import SilentPage
from tests.support.samples import resized, with_knee
from tests.support.scene import frame_at, solved


def circle(radius: float, count: int = 128) -> np.ndarray:
    """A closed circle of as many segments."""
    angle = np.linspace(0, 2 * np.pi, count + 1)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_curve_is_one_node(server: viser.ViserServer) -> None:
    nodes = server.scene._handle_from_node_name
    drawn = Nodes(server.scene)
    drawn.show([curves("/circle", [], INK)])
    assert "/circle" not in nodes
    drawn.show([curves("/circle", [circle(0.3), circle(0.1)], INK, height=-0.5)])
    node = nodes["/circle"]
    assert node.points.shape == (256, 2, 3)
    assert np.unique(node.points[..., 2]) == pytest.approx([-0.5])
    drawn.show([curves("/circle", [circle(0.3, 16)], INK)])
    assert nodes["/circle"] is node
    assert node.points.shape == (16, 2, 3)
    drawn.show([curves("/circle", [], INK)])
    assert "/circle" not in nodes


def test_gap_breaks_a_curve() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, 0.0], [2.0, 0.0], [3.0, 0.0]])
    pieces = np.array([[[0, 0, 0.5], [1, 0, 0.5]], [[2, 0, 0.5], [3, 0, 0.5]]])
    assert segments(line, 0.5) == pytest.approx(pieces)


@pytest.mark.parametrize("length", [1.0, 1e6, 1e12])
def test_a_curve_of_any_length_has_a_limited_number_of_dashes(length: float) -> None:
    cut = dashes(segments([[0.0, 0.0], [length, 0.0]]), 1e-4)
    assert len(cut) == MOST_DASHES
    assert np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum() == pytest.approx(length / 2)


def test_dashes_cover_half_of_a_curve() -> None:
    cut = dashes(segments(circle(0.3, 400)), 0.02)
    drawn = np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1).sum()
    assert drawn == pytest.approx(np.pi * 0.3, rel=0.01)
    assert np.hypot(cut[..., 0], cut[..., 1]) == pytest.approx(0.3, abs=1e-4)


def areas(corners: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed areas of triangles [m^2]."""
    a, b, c = (corners[faces[:, i]] for i in range(3))
    (x, y), (u, v) = (b - a).T, (c - a).T
    return 0.5 * (x * v - y * u)


@pytest.mark.parametrize("radius", [0.05, 0.3])
def test_a_circles_band_is_a_ring(radius: float) -> None:
    count, width = 90, 0.02
    corners, faces = bands(circles([radius], count), width)
    apothem = radius * np.cos(np.pi / count)
    # Edges are parallel to the sides, so that the band is as wide everywhere.
    sides = (np.hypot(*corners.T) * np.cos(np.pi / count)).reshape(-1, 2)
    np.testing.assert_allclose(sides[:, 0], apothem - width / 2, rtol=1e-12)
    np.testing.assert_allclose(sides[:, 1], apothem + width / 2, rtol=1e-12)
    found = areas(corners, faces)
    assert (found > 0).all() or (found < 0).all()
    ring = count * np.tan(np.pi / count) * ((apothem + width / 2) ** 2 - (apothem - width / 2) ** 2)
    assert abs(found.sum()) == pytest.approx(ring)


def test_bands_of_dashes_and_of_a_square_are_as_wide_as_asked() -> None:
    cut = dashes(segments(circle(0.3, 400)), 0.02)[..., :2]
    corners, faces = bands(cut, 0.004)
    length = np.linalg.norm(cut[:, 1] - cut[:, 0], axis=1)
    np.testing.assert_allclose(
        np.abs(areas(corners, faces)).reshape(-1, 2).sum(axis=1), 0.004 * length
    )
    square = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]])
    corners, faces = bands(square, 0.1)
    np.testing.assert_allclose(np.sort(np.unique(corners)), [-0.05, 0.05, 0.95, 1.05])
    assert np.abs(areas(corners, faces)).sum() == pytest.approx(1.1**2 - 0.9**2)
    wide, _ = bands(np.concatenate([square, square]), [0.1, 0.2])
    np.testing.assert_allclose(wide[:10], corners)
    np.testing.assert_allclose(np.unique(wide[10:]), [-0.1, 0.1, 0.9, 1.1])


def test_a_point_that_turns_back_and_one_given_twice_are_drawn() -> None:
    there_and_back = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.5, 0.0]]])
    corners, _ = bands(there_and_back, 0.2)
    assert np.isfinite(corners).all()
    assert np.abs(corners[:, 1]).max() <= 0.1 + 1e-12


@pytest.mark.parametrize("count", [2, 7, 300])
def test_a_curve_is_resampled_along_its_length(count: int) -> None:
    points = resampled(circle(0.3, 1000), count)
    np.testing.assert_allclose(points[[0, -1]], [[0.3, 0.0], [0.3, 0.0]], atol=1e-12)
    angle = 2 * np.pi * np.arange(count) / (count - 1)
    expected = 0.3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.testing.assert_allclose(points, expected, atol=1e-5)


def test_a_flat_curve_lies_at_its_height_and_keeps_its_node(server: viser.ViserServer) -> None:
    nodes, drawn = server.scene._handle_from_node_name, Nodes(server.scene)
    drawn.show([flat_curves("/flat", circles([0.3]), "#123456", 0.01, height=-0.5)])
    node = nodes["/flat"]
    assert np.unique(node.vertices[:, 2]) == pytest.approx([-0.5])
    drawn.show([flat_curves("/flat", circles([0.1]), "#123456", 0.01, height=-0.5)])
    assert nodes["/flat"] is node
    assert np.hypot(*node.vertices[:, :2].T).max() == pytest.approx(0.105, rel=0.01)


@pytest.mark.parametrize("fraction", [-1.0, -0.3, 0.0, 0.4, 1.0])
def test_arc_turns_in_the_direction_of_the_torque(fraction: float) -> None:
    corners = arc_arrow(fraction)
    assert corners.shape == arc_arrow(0.9).shape
    assert FACES.max() == len(corners) - 1
    angle = np.unwrap(np.arctan2(corners[:, 1], corners[:, 0]).reshape(-1, 12)[:, 0])
    turned = angle[-1] - angle[0]
    assert np.sign(turned) == (1 if fraction >= 0 else -1)
    assert abs(turned) < 2 * np.pi


def test_arrow_grows_with_the_force_up_to_a_limit() -> None:
    lengths = [np.ptp(force_arrow(f)[:, 2]) for f in (0.1, 0.4, 0.9, 1.0, 5.0)]
    assert lengths == sorted(lengths)
    assert lengths[-1] == lengths[-2]
    assert force_arrow(-0.5)[:, 2].min() < -0.1


def test_nodes_that_gain_parts_are_made_again(server: viser.ViserServer) -> None:
    nodes, drawn = server.scene._handle_from_node_name, Nodes(server.scene)
    points, colors = np.zeros((2, 2, 3)), np.zeros((2, 2, 3), np.uint8)
    drawn.show([lines("/parts", points, colors, 2.0)])
    before = nodes["/parts"]
    drawn.show([lines("/parts", points + 1.0, colors, 2.0)])
    assert nodes["/parts"] is before
    drawn.show([lines("/parts", points[:1], colors[:1], 2.0)])
    assert nodes["/parts"] is not before
    assert nodes["/parts"].points.shape == (1, 2, 3)


def test_torques_that_are_not_finite_are_not_drawn() -> None:
    frame = replace(frame_at(), torques=np.array([np.nan, np.inf, 1.0, 0.0]))
    assert [node.name for node in torque_arrows(frame)] == ["/efforts/m3"]


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize(
    ("window", "sheet"),
    [
        ((432.0, 720.0), False), ((512.0, 512.0), False), ((768.0, 480.0), False),
        ((390.0, 844.0), True),
    ],
    ids=str,
)  # fmt: skip
def test_every_camera_shows_all_of_the_robot_between_panel_and_legend(
    name: str, knee: KneeBranch, window: tuple[float, float], sheet: bool
) -> None:
    design = with_knee(APPENDIX_4, knee)
    configuration = solved((0.0, 0.0, 0.1, -0.45 * knee.sign), design)
    width, height = window
    view = in_window(name, design.geometry, configuration, width, height, sheet=sheet)
    position, look = np.array(view.position), np.array(view.look_at)
    back = (position - look) / np.linalg.norm(position - look)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    joints = [configuration.points[j] for j in (2, 3, 4, 5, 7, 8, 9)]
    motor = [[0.0, 0.0, lift_motor_height(design.geometry) + 0.05]]
    points = np.concatenate([*joints, motor]) - position
    depth = -points @ back
    scale = height / 2 / np.tan(view.fov / 2)
    assert (depth > 0.05).all()
    row = height / 2 - scale * (points @ np.cross(back, right)) / depth
    assert (row > VIEW_BAR_HEIGHT).all()
    assert (row < height - (SHEET_SHARE * height if sheet else LEGEND_HEIGHT)).all()
    assert (np.abs(points @ right) * scale / depth < width / 2).all()


@pytest.mark.parametrize("name", CAMERAS)
def test_a_view_that_fits_a_narrow_picture_needs_its_width(name: str) -> None:
    view = preset(name, APPENDIX_4.geometry, aspect=0.3)
    assert least_aspect(view, APPENDIX_4.geometry) == pytest.approx(0.3, rel=1e-3)


@pytest.mark.parametrize("leg", range(3))
def test_camera_faces_a_leg_square_on(leg: int) -> None:
    configuration = solved()
    view = preset(f"Leg {leg + 1}", APPENDIX_4.geometry, configuration=configuration)
    sight = np.subtract(view.look_at, view.position)
    heading = [np.cos(configuration.beta[leg]), np.sin(configuration.beta[leg]), 0.0]
    assert sight @ heading == pytest.approx(0.0, abs=1e-9)


def test_unknown_camera_is_an_error() -> None:
    with pytest.raises(KeyError):
        preset("Leg 4", APPENDIX_4.geometry)


def test_transparent_pixels_show_the_pages_gradient() -> None:
    top, bottom = LIGHT.backdrop
    picture = over_backdrop(np.zeros((101, 3, 4), dtype=np.uint8))
    assert tuple(picture[0, 0]) == rgb(top)
    assert tuple(picture[-1, 2]) == rgb(bottom)
    assert (np.diff(picture[:, 0].astype(int), axis=0) <= 0).all()
    assert all(color in style_html() for color in (top, bottom))
    pixels = np.full((3, 1, 4), 40, dtype=np.uint8)
    pixels[..., 3] = np.array([0, 255, 51])[:, None]
    clear, solid, fifth = over_backdrop(pixels)[:, 0].astype(float)
    assert tuple(clear) == rgb(top)
    assert (solid == 40).all()
    np.testing.assert_allclose(fifth, np.array(rgb(bottom)) * 0.8 + 8, atol=0.51)


def test_robot_is_fitted_to_a_new_shape_of_the_view_unless_the_camera_was_moved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[Any] = []
    looks: list[str] = []
    waiting: list[Any] = []
    camera = SimpleNamespace(
        image_width=400, image_height=400, position=(0, 0, 1), on_update=calls.append
    )
    session: Any = SimpleNamespace(
        client=SimpleNamespace(camera=camera), camera=("3D", (2.0, 0.0, 1.0)),
        submit=waiting.append, window=(800.0, 400.0),
    )  # fmt: skip
    monkeypatch.setattr(cameras, "look", lambda _, name: looks.append(name))
    cameras.follow_resizes(session)

    def update(*, meanwhile: tuple[float, float, float] | None = None, **changes: Any) -> int:
        vars(camera).update(changes)
        calls[0](None)
        if meanwhile is not None:  # the page tells of it before the session comes to it
            camera.position = meanwhile
        while waiting:
            waiting.pop(0)()
        return len(looks)

    there = (2.0, 0.0, 1.0)
    assert update() == 0  # the page has not put the camera there yet
    assert update(position=there) == 1
    assert update() == 1
    assert update(image_width=300, position=(0, 0, 1)) == 1
    assert update(position=there) == 2
    assert update(image_width=299) == 3  # the last pixels of a dock that slides in
    assert update(image_width=150, image_height=200) == 3  # viser has made the pixels fewer
    assert update(image_width=120, meanwhile=(0, 0, 1)) == 3
    assert update(position=there) == 4
    session.window = (800.0, 396.0)  # known while the page still moves the camera
    assert update(position=(0, 0, 1)) == 4
    assert update(position=there) == 5
    assert update() == 5
    assert update(image_width=110) == 6
    assert update(position=(3.0, 0.0, 1.0), image_width=100) == 6  # a person moved it


def test_robot_is_looked_at_in_the_whole_width_of_a_phone_above_the_sheet() -> None:
    page: Any = SilentPage()
    page.camera = SimpleNamespace(image_width=390, image_height=844)
    session = Session(page, initial_state())
    session.set_window(390.0, 844.0)
    cameras.look(session, "3D")
    expected = in_window("3D", APPENDIX_4.geometry, None, 390.0, 844.0, sheet=True)
    assert page.camera.position == expected.position


def test_robot_of_another_size_is_fitted_to_the_view_unless_the_camera_was_moved() -> None:
    page: Any = SilentPage()
    page.camera = SimpleNamespace(image_width=512, image_height=720)
    session = Session(page, initial_state())
    session.set_window(1280.0, 720.0)
    view = cameras.SizeView(session)
    cameras.look(session, "3D")

    def fitted(times: float, knee: KneeBranch = KneeBranch.LOWER) -> bool:
        """Open a robot so many times as large; return whether the camera is where it fits."""
        session._state = initial_state(with_knee(resized(APPENDIX_4, times), knee))
        before = page.camera.position
        view.draw(compute(session.state), True)
        assert page.camera.position == before
        view.draw(compute(session.state), False)
        return page.camera.position == cameras._in_tab(session, "3D").position

    assert fitted(3.0)
    assert fitted(0.3)
    assert not fitted(0.31)
    assert fitted(1.0)
    assert fitted(1.0, KneeBranch.UPPER)
    page.camera.position = (0.3, 0.1, 0.2)
    assert not fitted(3.0)
