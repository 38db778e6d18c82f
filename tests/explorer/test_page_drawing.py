"""What the page draws when, and what it sends of a drag."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from paminsa_viz.explorer.browser import asset
from paminsa_viz.palette import DARK, LIGHT, rgb
from tests.support.chromium import TIMEOUT, Tab, until

if TYPE_CHECKING:
    from tests.support.page import Browser

pytestmark = pytest.mark.browser

PIXELS = "() => window.__viserMutable.canvas.width / window.__viserMutable.canvas.clientWidth"
COLORS = """async (change) => {
  if (change) window.__viserMutable.requestRender();
  for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
  const gl = window.__viserMutable.canvas.getContext("webgl2");
  const colors = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(
    0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, colors,
  );
  return new Set(new Uint32Array(colors.buffer)).size;
}"""
"""How many colors the view has, or its next picture after a change: more where edges are smooth."""

SCHEME = "data-mantine-color-scheme"

CORNER = """async ([draw, wider]) => {
  if (draw) {
    window.__viserMutable.requestRender();
    for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
  }
  const { gl: renderer } = window.__viserMutable.scene.__r3f.root.getState();
  const gl = renderer.getContext();
  const { clientWidth: width, clientHeight: height } = gl.canvas;
  if (wider) renderer.setSize(width + wider, height, false);
  const pixel = new Uint8Array(4);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  if (wider) renderer.setSize(width, height, false);
  return [...pixel];
}"""
"""A pixel of the view where the scene is clear; in a canvas of another size, if wanted."""

CAMERA = "() => window.__viserMutable.camera.matrixWorld.elements.join()"
PICTURE = "() => document.querySelector('[data-paminsa-picture]')?.getAttribute('src')"

TOGETHER = """() => {
  const thumbs = [...document.querySelectorAll('[role=slider]')].slice(0, 4);
  for (const thumb of thumbs)
    for (const key of ["ArrowRight", "ArrowRight", "ArrowRight"])
      thumb.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true}));
  return thumbs.map((thumb) => Number(thumb.getAttribute("aria-valuenow")));
}"""


MADE_AGAIN = """() => {
  const place = document.querySelector("[data-paminsa-picture]").parentElement;
  place.outerHTML = place.outerHTML.replace(/ src="[^"]*"/, "");
}"""
"""As viser makes a text anew, in a panel that is unfolded."""


def test_values_of_several_inputs_set_at_once_all_arrive(tab: Tab) -> None:
    before = tab.state.document.pose
    tab.page.evaluate(TOGETHER)
    until(
        lambda: all(a != b for a, b in zip(before, tab.state.document.pose, strict=True)),
        "x, y, theta and z have moved",
    )
    names = ("x  [mm]", "y  [mm]", "θ  [°]", "z  [mm]")
    shown = tab.page.evaluate(
        "() => [...document.querySelectorAll('[role=slider]')].slice(0, 4)"
        ".map((thumb) => Number(thumb.getAttribute('aria-valuenow')))"
    )
    assert [tab.handle(name).value for name in names] == pytest.approx(shown)


def test_arrow_keys_of_a_slider_leave_the_camera_alone(tab: Tab) -> None:
    tab.page.get_by_role("slider").first.focus()
    camera = tab.page.evaluate(CAMERA)
    before = tab.state.document.pose
    tab.page.keyboard.down("ArrowRight")
    until(lambda: tab.state.document.pose != before, "the slider moves the robot")
    tab.wait_platform()
    tab.page.keyboard.up("ArrowRight")
    assert tab.page.evaluate(CAMERA) == camera


def test_maps_come_back_with_a_panel_that_was_folded(tab: Tab) -> None:
    picture = until(lambda: tab.page.evaluate(PICTURE), "the maps are drawn")
    assert picture.startswith("data:image/")
    tab.page.evaluate(MADE_AGAIN)
    assert tab.page.evaluate(PICTURE) == picture


def colors(tab: Tab, *, moving: bool) -> int:
    """Return how many colors the view has while it moves or at rest."""
    if not moving:
        tab.wait_frames(600)
    return tab.page.evaluate(COLORS, moving)


def test_edges_in_the_view_and_its_pictures_are_smooth_at_rest_without_a_graphics_card(
    drawn: Tab,
) -> None:
    until(
        lambda: colors(drawn, moving=False) > 1.2 * colors(drawn, moving=True),
        "edges have colors between at rest only",  # not while shaders are compiled
    )
    rest = colors(drawn, moving=False)
    camera, canvas = drawn.session.client.camera, "window.__viserMutable.canvas"
    picture = drawn.session.client.get_render(
        *drawn.page.evaluate(f"[{canvas}.height, {canvas}.width]"),
        wxyz=camera.wxyz,
        position=camera.position,
        fov=camera.fov,
        transport_format="png",
        timeout=TIMEOUT,
    )
    assert len(np.unique(picture.reshape(-1, picture.shape[-1]), axis=0)) > 0.9 * rest
    assert colors(drawn, moving=False) == rest


def test_backdrop_is_the_themes_in_the_view_and_the_light_gradient_in_a_picture(tab: Tab) -> None:
    for name, theme in (("dark", DARK), ("light", LIGHT), ("dark", DARK)):
        tab.page.evaluate(f"() => document.documentElement.setAttribute('{SCHEME}', '{name}')")
        ends = np.array([rgb(color) for color in theme.backdrop])
        middle = [*ends.mean(axis=0), 255]
        until(
            lambda middle=middle: np.allclose(
                tab.page.evaluate(CORNER, [False, 0]), middle, atol=1
            ),
            "the view is drawn with the theme's backdrop",
        )
        assert tab.page.evaluate(CORNER, [True, 0]) == pytest.approx(middle, abs=1)
        assert tab.page.evaluate(CORNER, [False, 7]) == pytest.approx(middle, abs=1)
    camera = tab.session.client.camera
    picture = tab.session.client.get_render(
        101, 80, wxyz=camera.wxyz, position=camera.position, fov=camera.fov,
        transport_format="png", timeout=TIMEOUT,
    )  # fmt: skip
    light = [rgb(color) for color in LIGHT.backdrop]
    np.testing.assert_allclose(picture[[0, -1], 0, :3], light, atol=1)
    np.testing.assert_allclose(picture[50, 0, :3], np.mean(light, axis=0), atol=1)
    assert tab.page.evaluate(CORNER, [True, 0]) == pytest.approx(middle, abs=1)
    tab.page.evaluate(f"() => document.documentElement.setAttribute('{SCHEME}', 'light')")


def test_number_of_pixels_in_the_address_stays(tab: Tab) -> None:
    tab.page.evaluate("() => window.__viserMutable.requestRender()")
    tab.wait_frames(600)
    assert tab.page.evaluate(PIXELS) == pytest.approx(1, abs=0.01)


FIREFOX = """() => {
  const [RENDERER, getExtension] = [7937, () => null];
  const gl = { RENDERER, getExtension, getParameter: (name) => name === RENDERER && "llvmpipe" };
  HTMLCanvasElement.prototype.getContext = () => gl;
  window.paminsaContext = { whenFound: () => {} };
}"""
"""A browser that names what draws by its ordinary parameter, and has no extension for that."""


def test_a_program_that_draws_is_known_without_an_extension(browser: Browser) -> None:
    page = browser.new_context().new_page()
    page.evaluate(FIREFOX)
    page.evaluate(f"() => {{ {asset('drawing.js', PROGRAMS='llvmpipe', BACKDROPS='{}')} }}")
    assert page.evaluate("window.paminsaDrawing.named()") == "llvmpipe"
    page.close()
