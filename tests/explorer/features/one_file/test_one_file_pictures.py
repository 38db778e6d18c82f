"""The page in one file: what it draws, in any window, on paper and into files."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from paminsa_viz.explorer.core.persistence import share_code
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import APPENDIX_4, static_torques
from paminsa_viz.palette import LIGHT, rgb
from paminsa_viz.plots import colors
from paminsa_viz.units import TIE
from paminsa_viz.webpage import code_page
from tests.explorer.features.one_file.opened import OTHER, START, Opened
from tests.explorer.test_page_sections import CHECK, RULES
from tests.support.chromium import until, watch_errors
from tests.support.samples import enlarged

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_all_pictures_fit_any_window_and_paper_has_all_controls(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    before = page.viewport_size
    fits = "document.querySelector('#hover').getBoundingClientRect().bottom <= innerHeight"
    for width, height in ((1920, 1080), (1366, 650), (1000, 1200), (1280, 600)):
        page.set_viewport_size({"width": width, "height": height})
        until(lambda: page.evaluate(fits), f"maps are seen, {width} x {height}")
        stage = page.locator("#stage").bounding_box()
        assert stage["height"] > 0.35 * height
    page.set_viewport_size({"width": 844, "height": 390})
    chooser = page.locator("#kind").bounding_box()
    middle = chooser["y"] + chooser["height"] / 2
    label = page.locator("label[for=kind]").bounding_box()
    assert label["y"] < middle < label["y"] + label["height"]
    counted = "Number(document.documentElement.dataset.drawn)"
    assert page.evaluate(f"""() => {{
      const before = {counted};
      window.dispatchEvent(new Event("beforeprint"));
      return {counted} - before;
    }}"""), "Firefox prints of the robot what is drawn in the same task"
    page.emulate_media(media="print")
    cut = "(({clientHeight, scrollHeight}) => scrollHeight - clientHeight)"
    assert page.locator("#controls").evaluate(cut) <= 1
    page.emulate_media(media="screen")
    page.set_viewport_size(before)


COLORED = """async (canvas) => {
  await new Promise(requestAnimationFrame);
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [90, 60];
  const draw = picture.getContext("2d");
  // A drawing buffer holds its picture until it is shown.
  document.querySelector("#floor").dispatchEvent(new Event("change"));
  await new Promise((done) => requestAnimationFrame(() => {
    draw.drawImage(canvas, 0, 0, 90, 60);
    done();
  }));
  const parts = draw.getImageData(0, 0, 90, 60).data;
  return parts.filter((part, index) => index % 4 === 3 && part > 0).length / 5400;
}"""


def test_robot_is_drawn_and_moves_with_its_handle(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    page.evaluate("window.drawn = true")
    page.get_by_label("Floor map").select_option("1")
    canvas = page.locator("#robot")
    assert 0.05 < canvas.evaluate(COLORED) < 0.9
    assert "x 80.0 mm, y 50.0 mm" in (canvas.get_attribute("aria-label") or "")
    box = canvas.bounding_box()

    def drag(keys: str, dx: float, dy: float) -> None:
        u, v = page.evaluate("window.paminsaPage.view.handlePlace()")
        x, y = box["x"] + u * box["width"], box["y"] + v * box["height"]
        if keys:
            page.keyboard.down(keys)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + dx, y + dy, steps=3)
        page.mouse.up()
        if keys:
            page.keyboard.up(keys)

    def look(name: str) -> None:
        before = canvas.evaluate(COLORED)
        page.get_by_role("button", name=name).click()
        until(lambda: canvas.evaluate(COLORED) != before, "the view has changed")

    look("Top")
    drag("", 20, 0)
    moved = opened.wait(lambda found: found.pose[0] > START.pose[0] + 0.01)
    assert moved.pose[1:] == pytest.approx(START.pose[1:], abs=1e-3)
    page.get_by_role("button", name="Undo").click()  # a drag is one step
    opened.wait(lambda found: found == START)
    look("Front")
    drag("Shift", 0, -15)
    moved = opened.wait(lambda found: found.pose[3] > START.pose[3] + 0.01)
    assert moved.pose[:3] == START.pose[:3]
    page.get_by_role("button", name="Undo").click()
    opened.wait(lambda found: found == START)


def test_a_robot_of_millimeters_is_stepped_and_seen_as_closely_as_a_large_one(
    browser: Any, tmp_path: Path
) -> None:
    small = enlarged(APPENDIX_4, 0.01)
    path = tmp_path / "small.html"
    document = Document(design=small, pose=(0.0008, 0.0005, np.pi / 3, -0.0055))
    path.write_text(code_page(share_code(document)), encoding="utf-8")
    opened = Opened(browser, path)
    page = opened.page
    try:
        inertia = page.locator("[id='platform.inertia']")
        page.get_by_text("Inertias of platform and payload").click()
        inertia.press("ArrowUp")
        opened.wait(lambda found: 1 < found.design.platform.inertia / small.platform.inertia < 1.01)
        page.evaluate("window.drawn = true")
        canvas, place = page.locator("#robot"), "window.paminsaPage.view.handlePlace()"
        canvas.press("Home")
        u, v = until(
            lambda: (p := page.evaluate(place)) and np.isfinite(p).all() and p, "it is drawn"
        )
        canvas.press("+")
        nearer = until(lambda: (p := page.evaluate(place)) != [u, v] and p, "the view has changed")
        assert np.hypot(nearer[0] - 0.5, nearer[1] - 0.5) > np.hypot(u - 0.5, v - 0.5)
        assert "at x 0.800 mm, y 0.500 mm" in (canvas.get_attribute("aria-label") or "")
        page.get_by_role("button", name="Balance by m₇").click()  # but for rounding
        caption = page.locator("#caption")
        until(lambda: f"−5.500{TIE}mm: 0 everywhere" in caption.inner_text(), "nothing is drawn")
        label = page.locator("#map").get_attribute("aria-label") or ""
        assert "colors from −1·10⁻⁸ to 1·10⁻⁸ N·m" in label, "it is one of the last digit"
        assert opened.errors == []
    finally:
        opened.context.close()


def test_maps_show_the_difference_from_the_pinned_design(opened: Opened) -> None:
    opened.open(share_code(OTHER))
    page = opened.page
    page.get_by_label("Maps", exact=True).select_option("difference")
    page.locator("#map").focus()
    page.keyboard.press("ArrowRight")
    text = until(lambda: (t := page.locator("#hover").inner_text()) and "Δτ₁" in t and t, "is said")
    x, y = (float(n.replace("−", "-")) / 1e3 for n in re.findall(r"[xy] = ([−\d.]+) mm", text))
    pose = (x, y, *OTHER.pose[2:])
    wanted = static_torques(OTHER.design, pose) - static_torques(APPENDIX_4, pose)
    shown = [float(n.replace("−", "-")) for n in re.findall(r"Δτ. = ([−\d.]+)", text)]
    assert shown == pytest.approx(wanted[:3], abs=2e-3)
    title = f"Static torques, difference from “Appendix 4”, at θ{TIE}={TIE}22.92°"
    assert title in page.locator("#caption").inner_text()


def test_keys_and_fingers_read_a_map_and_go_there(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    canvas, says = page.locator("#map"), page.locator("#hover")
    hint = says.inner_text()
    canvas.focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowDown"):
        page.keyboard.press(key)
    torques = static_torques(APPENDIX_4, (0.1, 0.04, *START.pose[2:]))
    texts = [f"τ{'₁₂₃'[i]} = {torques[i]:.3f}".replace("-", "−") for i in range(3)]
    assert says.inner_text() == f"x = 100.0 mm, y = 40.0 mm: {', '.join(texts)} N·m"
    assert opened.document() == START, "it is only read"
    page.keyboard.press("Enter")
    opened.wait(lambda found: found.pose == (0.1, 0.04, *START.pose[2:]))
    page.keyboard.press("Escape")
    assert says.inner_text() == hint

    touch = """(canvas, [kind, x, y]) => canvas.dispatchEvent(new PointerEvent(kind, {
      pointerType: "touch", pointerId: 9, clientX: x, clientY: y, bubbles: true}))"""
    before = opened.document()
    window = page.viewport_size
    page.set_viewport_size({"width": 390, "height": 844})
    until(lambda: " 374px" in (canvas.get_attribute("style") or ""), "it is drawn as narrow")
    canvas.focus()
    tops = []
    for key in ("Escape", "ArrowUp"):
        page.keyboard.press(key)
        tops.append(page.locator("#controls").bounding_box()["y"])
    assert tops[0] == tops[1], "what is below a map stays where it is, whatever is said of the map"
    box = canvas.bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.3 * box["height"]
    for kind, down in (("pointerdown", 0), ("pointermove", 20), ("pointercancel", 20)):
        canvas.evaluate(touch, [kind, x, y + down])  # the browser scrolls the page
    page.evaluate("() => new Promise(requestAnimationFrame)")
    assert "x 100.0 mm, y 40.0 mm" in (page.locator("#robot").get_attribute("aria-label") or "")
    for kind in ("pointerdown", "pointerup"):
        canvas.evaluate(touch, [kind, x, y])
    moved = opened.wait(lambda found: found != before)
    assert f"x = {1e3 * moved.pose[0]:.1f} mm".replace("-", "−") in says.inner_text()
    page.set_viewport_size(window)


def test_paper_is_light_and_its_pictures_sharp(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    page.get_by_role("button", name="Light / dark").click()
    page.get_by_label("Preset").select_option(index=1)
    seen = page.locator("#chart").evaluate("({width, height}) => [width, height]")
    found = page.evaluate("""() => {
      const sizes = () => ["map", "chart"].flatMap((id) => [find(id).width, find(id).height]);
      const state = () => [document.documentElement.className, ...sizes()];
      const box = JSON.stringify(find("robot").getBoundingClientRect());
      window.dispatchEvent(new Event("beforeprint"));
      const paper = [...state(), JSON.stringify(find("robot").getBoundingClientRect()) === box];
      window.dispatchEvent(new Event("afterprint"));
      return [paper, state()];
    }""")
    theme, width, _, *chart, is_as_large = found[0]
    assert (theme, width, *chart) == ("", 2100, 2100, 525)
    assert is_as_large, "WebGL prints nothing once its canvas has another size"
    assert (found[1][0], *found[1][3:]) == ("dark", *seen)
    page.emulate_media(media="print")
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    box = page.locator("#chart").bounding_box()
    assert box["width"] == pytest.approx(4 * box["height"], rel=0.01), "letters keep their shape"
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    page.emulate_media(media="screen")
    page.get_by_label("Preset").select_option(index=0)
    page.get_by_role("button", name="Light / dark").click()


AT_ONCE = """() => {
  HTMLCanvasElement.prototype.toBlob = function (done) {
    const letters = atob(this.toDataURL().split(",")[1]);
    done(new Blob([Uint8Array.from(letters, (one) => one.charCodeAt())], {type: "image/png"}));
  };
}"""
"""A browser on a busy machine writes a picture of a canvas when it has nothing else to do, or after
some seconds."""


def test_saved_maps_are_light_and_say_what_they_are_of(opened: Opened) -> None:
    opened.open(share_code(OTHER))
    page = opened.page
    written = """(() => {
      const write = CanvasRenderingContext2D.prototype.fillText;
      window.written = [];
      CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
        window.written.push(text);
        write.call(this, text, ...rest);
      };
    })()"""
    page.evaluate(written)
    page.evaluate(AT_ONCE)
    saved = []
    for _ in range(2):
        with page.expect_download() as waiting:
            page.get_by_role("button", name="Maps as PNG").click()
        saved.append(Path(waiting.value.path()).read_bytes())
        page.get_by_role("button", name="Light / dark").click()
    assert saved[0] == saved[1]
    colored = np.asarray(Image.open(io.BytesIO(saved[0])).convert("RGB"))
    assert tuple(colored[1, 1]) == rgb(LIGHT.paper)
    assert (colored == rgb(LIGHT.reachless)).all(axis=2).mean() > 0.1
    text = "\n".join(page.evaluate("window.written")).replace(TIE, " ")
    for part in (
        "“Light, 3 kg”",
        "lower knee",
        "θ = 22.92°",
        "z = −550.0 mm",
        "x = 50.0 mm",
        "x [mm]",
        "y [mm]",
        "[N·m]",
    ):
        assert part in text


def test_without_webgl_a_line_says_so(opened: Opened) -> None:
    page = opened.context.new_page()
    errors = watch_errors(page)
    page.add_init_script("""HTMLCanvasElement.prototype.getContext = ((made) =>
      function (kind, ...rest) {
        return kind === "webgl2" ? null : made.call(this, kind, ...rest);
      })(HTMLCanvasElement.prototype.getContext)""")
    page.goto(opened.address)
    line = page.get_by_text("The robot is not drawn: this browser has no WebGL2")
    until(line.is_visible, "it is said")
    assert not page.locator("#robot").is_visible()
    assert "N·m" in page.get_by_test_id("actuators").inner_text()
    page.close()
    assert errors == []


PICTURE = """([values, limit]) => {
  const {data} = pictureOf(values, Math.sqrt(values.length), limit);
  return values.map((_, index) => [...data.slice(4 * index, 4 * index + 4)]);
}"""
"""Colors of a map's cells; its first row is the lowest of the picture."""


def test_maps_have_the_colors_of_the_served_page(opened: Opened) -> None:
    inside, (below, beyond) = colors.table(colors.DIVERGING), colors.BEYOND[colors.DIVERGING]
    values = [-30.0, -19.99, -0.01, 0.01, 19.99, 30.0, 10.05, float("nan"), 20.01]
    cells = opened.page.evaluate(PICTURE, [values, 20.0])
    found = dict(zip([*values[6:], *values[3:6], *values[:3]], cells, strict=True))
    for value, color in (
        (-30.0, below), (30.0, beyond), (20.01, beyond),
        (-19.99, inside[0]), (-0.01, inside[127]), (0.01, inside[128]), (19.99, inside[255]),
        (10.05, inside[192]),
    ):  # fmt: skip
        given = rgb(color) if isinstance(color, str) else np.rint(255 * color)
        np.testing.assert_array_equal(found[value], [*given, 255], str(value))
    assert cells[1][3] == 0, "a cell that cannot be reached is clear"


CIRCLE = """(ground) => {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 200;
  const draw = canvas.getContext("2d");
  const shown = { extent: 1, singular: 0.8, pose: [0, 0], pointed: null };
  const colors = { reachless: ground, hatch: ground };
  const map = { cells: canvasOf(new ImageData(2, 2)), lines: [] };
  drawMap(draw, { em: 14, side: 200 }, { left: 0, top: 0 }, map, shown, colors);
  const found = [];
  for (let angle = 0; angle < 6.2; angle += 0.01) {
    const place = [100 + 80 * Math.cos(angle), 100 + 80 * Math.sin(angle)].map(Math.floor);
    found.push(draw.getImageData(...place, 1, 1).data[0]);
  }
  return [Math.min(...found), Math.max(...found)];
}"""
"""Darkest and brightest red of the singular circle on a color."""


def test_singular_circle_is_seen_on_dark_and_light_ground(opened: Opened) -> None:
    for ground in ("#2b2f36", "#ffffff"):
        dark, bright = opened.page.evaluate(CIRCLE, ground)
        assert dark < 60
        assert bright > 200


def test_contrast_names_and_roles(opened: Opened) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    opened.open(share_code(OTHER))
    page = opened.page
    page.evaluate("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    page.evaluate(axe.axe_script)
    for rules in (RULES, ["color-contrast"]):  # names and roles are those of both themes
        found = page.evaluate(CHECK, rules)["violations"]
        assert [(each["id"], each["nodes"][0]["html"]) for each in found] == []
        page.get_by_role("button", name="Light / dark").click()


def test_maps_follow_a_drag_of_theta(opened: Opened) -> None:
    opened.open(share_code(START))
    slider = opened.page.get_by_label("θ  [°], slider")
    before = opened.page.locator("#caption").inner_text()
    drawn, cells = slider.evaluate("""async (slider) => {
      const drawn = () => Number(document.documentElement.dataset.drawn);
      const first = drawn();
      const cells = [];
      const put = CanvasRenderingContext2D.prototype.putImageData;
      CanvasRenderingContext2D.prototype.putImageData = function (picture, ...rest) {
        window.cells = picture.width;
        put.call(this, picture, ...rest);
      };
      for (let step = 0; step < 40; step++) {
        slider.value = 10 + step;
        slider.dispatchEvent(new Event("input"));
        await new Promise(requestAnimationFrame);
        if (drawn() > first) cells.push(window.cells);
      }
      slider.dispatchEvent(new Event("change"));
      return [drawn() - first, cells];
    }""")
    assert drawn > 4  # of 40 steps, each with a frame of the browser: none waits for the end
    until(lambda: opened.page.evaluate("window.cells") > max(cells), "maps are finer at rest")
    assert opened.page.locator("#caption").inner_text() != before
    opened.wait(lambda found: abs(found.pose[2] - np.radians(49.0)) < 1e-9)
    opened.page.get_by_role("button", name="Undo").click()
    opened.wait(lambda found: found == START)
