"""The interactive figure: data, colors, places, hover, and that a browser can show it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import plotly
import pytest
from paminsa_viz.plots.live import live_image, screen_layout
from paminsa_viz.plots.raster import lut
from paminsa_viz.plots.screen import CONFIG, aspect, screen_figure
from PIL import Image

from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import made_up, real

SCALE = Scale(-5.0, 5.0)


def traces(figure: Any, kind: str) -> list[Any]:
    """Return all traces of a kind."""
    return [trace for trace in figure.data if trace.type == kind]


def test_values_and_places_are_the_map_s() -> None:
    data = made_up()
    figure = screen_figure(data, SCALE)
    shown = [trace for trace in traces(figure, "heatmap") if trace.customdata is not None]
    assert len(shown) == 3
    for values, trace in zip(data.values, shown, strict=True):
        assert np.array_equal(trace.customdata, values.astype(np.float32), equal_nan=True)
        assert np.allclose(trace.x, data.x * 1000)
        assert np.allclose(trace.y, data.y * 1000)
        expected = np.clip(SCALE.position(values), -1, 2).astype(np.float32)
        assert np.array_equal(trace.z, expected, equal_nan=True)


def test_lengths_are_shown_in_mm() -> None:
    data = made_up(panels=1, unit="m", names=("margin",))
    trace = traces(screen_figure(data, SCALE), "heatmap")[0]
    assert np.array_equal(trace.customdata, (data.values[0] * 1000).astype(np.float32),
                          equal_nan=True)  # fmt: skip
    assert "mm" in trace.hovertemplate


def test_masked_cells_say_why() -> None:
    data = made_up()
    reasons = [
        trace for trace in traces(screen_figure(data, SCALE), "heatmap") if trace.text is not None
    ]
    assert len(reasons) == 3
    for trace in reasons:
        words = np.array(trace.text)
        assert (words[data.status != 0] == "leg 2 over-stretched").all()
        assert (words[data.status == 0] == "").all()
        assert (np.isnan(trace.z) == (data.status == 0)).all()


def test_the_color_scale_is_the_table_with_blocks_for_what_is_beyond() -> None:
    axis = screen_figure(made_up(), SCALE).layout.coloraxis
    stops = axis.colorscale
    assert axis.autocolorscale is False
    assert (stops[0][1], stops[-1][1]) == SCALE.beyond
    where = [stop[0] for stop in stops]
    assert where == sorted(where)
    assert (where[0], where[-1]) == (0.0, 1.0)
    for position, code in ((0.0, 1), (1.0, 256)):
        share = (position - axis.cmin) / (axis.cmax - axis.cmin)
        nearest = [s for s in stops[2:-2] if abs(s[0] - share) < 1e-9]
        assert nearest[0][1].replace(" ", "") == "rgb({},{},{})".format(*lut(SCALE)[code, :3])


def test_shared_or_own_color_axes() -> None:
    data = made_up()
    assert screen_figure(data, SCALE).layout.to_plotly_json().keys() & {"coloraxis2"} == set()
    own = choose_scales(
        made_up(values=data.values * np.array([1, 9, 99])[:, None, None]), ScaleChoice(shared=False)
    )
    layout = screen_figure(data, own).layout.to_plotly_json()
    assert {"coloraxis", "coloraxis2", "coloraxis3"} <= layout.keys()


def test_the_marker_is_at_the_pose_in_every_panel() -> None:
    dots = [t for t in traces(screen_figure(made_up(), SCALE), "scatter") if t.mode == "markers"]
    assert {t.xaxis for t in dots} == {"x", "x2", "x3"}
    assert all((t.x[0], t.y[0]) == (50.0, -30.0) for t in dots)


@pytest.mark.parametrize("width", [420, 900])
def test_panels_have_equal_scales_and_lie_where_the_raster_draws_them(width: int) -> None:
    data = made_up()
    figure = screen_figure(data, SCALE, width)
    assert (figure.layout.width, figure.layout.height) == live_image(data, SCALE, width).shape[
        1::-1
    ]
    assert aspect(figure) == figure.layout.height / width
    layout = screen_layout(data, SCALE, width)
    for number, box in zip(("", "2", "3"), layout.panels, strict=True):
        x, y = figure.layout[f"xaxis{number}"], figure.layout[f"yaxis{number}"]
        assert np.allclose(np.array(x.domain) * layout.width, [box.left, box.right])
        wide = (x.domain[1] - x.domain[0]) * layout.width / (x.range[1] - x.range[0])
        high = (y.domain[1] - y.domain[0]) * layout.height / (y.range[1] - y.range[0])
        assert wide == pytest.approx(high, rel=1e-9)


def test_odd_data_become_valid_json() -> None:
    values = made_up().values.copy()
    values[0, 13, 15] = np.inf
    empty = made_up(values=np.full((3, 27, 31), np.nan), status=np.full((27, 31), 2, np.uint8))
    for data in (made_up(values=values), empty, real(21)):
        for choice in (ScaleChoice(), ScaleChoice(kind="symlog")):
            text = screen_figure(data, choose_scales(data, choice)).to_json()
            json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


@pytest.fixture(scope="module")
def shots() -> Iterator[Any]:
    """Opens figures in a headless browser, in a thread of its own."""
    playwright = pytest.importorskip("playwright.sync_api")
    from tests.explorer.chromium import FLAGS, browser_path

    path = browser_path()
    script = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"

    def shoot(
        figure: Any, points: list[tuple[float, float]]
    ) -> tuple[Image.Image, list[str], list[str]]:
        complaints: list[str] = []
        hovers: list[str] = []
        with playwright.sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=path, args=FLAGS)
            size = {"width": figure.layout.width, "height": figure.layout.height}
            page = browser.new_page(viewport=size)
            page.on("console", lambda message: complaints.append(message.text))
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.set_content("<body style='margin:0'><div id=g></div>")
            page.add_script_tag(path=str(script))
            page.evaluate(
                "([f, c]) => Plotly.newPlot('g', f.data, f.layout, c)",
                [json.loads(figure.to_json()), CONFIG],
            )
            picture = Image.open(BytesIO(page.screenshot())).convert("RGB")
            for x, y in points:
                page.mouse.move(x, y)
                hovers.append(page.wait_for_selector(".hovertext").text_content())
                page.mouse.move(0, 0)
                page.wait_for_selector(".hovertext", state="detached")
            browser.close()
        return picture, hovers, complaints

    with ThreadPoolExecutor(1) as pool:
        yield lambda figure, points: pool.submit(shoot, figure, points).result()


@pytest.mark.browser
@pytest.mark.parametrize("width", [420, 900])
def test_a_browser_draws_what_the_raster_draws(shots: Any, width: int) -> None:
    data = real(61)
    scales = choose_scales(data)
    box = screen_layout(data, scales, width).panels[1]
    middle = (box.left + box.width / 2, box.top + box.height / 2)
    corner = (box.left + 4, box.bottom - 4)
    picture, hovers, complaints = shots(screen_figure(data, scales, width), [middle, corner])
    assert complaints == []
    value = data.values[1, 30, 30]
    assert "τ₂ = " in hovers[0]
    assert float(hovers[0].split("=")[1].split()[0]) == pytest.approx(value, rel=0.4)
    assert "no value: leg" in hovers[1]
    theirs = np.asarray(picture).astype(float)
    ours = live_image(data, scales, width).astype(float)
    assert theirs.shape == ours.shape
    for panel in screen_layout(data, scales, width).panels:
        part = np.s_[int(panel.top) : int(panel.bottom), int(panel.left) : int(panel.right)]
        off = np.abs(theirs[part] - ours[part]).max(axis=2)
        assert np.median(off) < 12
        assert (off > 90).mean() < 0.12
