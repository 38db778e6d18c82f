"""Figures of maps: baselines, captions and files."""

from __future__ import annotations

import os
import re
import warnings
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.testing.compare import compare_images
from PIL import Image

from paminsa_viz import __version__
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.published_table import PublishedMap
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.load import NO_LOAD, LoadFrame
from paminsa_viz.plots import map_figure, map_panel
from paminsa_viz.plots.caption import caption, robot, summary
from paminsa_viz.plots.formats import FIGURE_FORMATS, drawing
from paminsa_viz.plots.map_figure import render_maps
from paminsa_viz.plots.map_layout import map_layout
from paminsa_viz.plots.map_values import MapData, difference
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales, per_panel
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import QUANTITIES, TORQUES
from paminsa_viz.units import display_unit, symbols_math
from tests.plots.samples import (
    EMPTY,
    PATH,
    SAMPLE,
    SCALE,
    SCALES,
    crop,
    live,
    made_up,
    panel_and_same,
    pixels,
    real,
)

pytestmark = pytest.mark.slow

OWN_REAL = (Scale(-20.0, 20.0), Scale(-10.0, 20.0), Scale(-10.0, 100.0, "symlog", 0.1))
SVG = "{http://www.w3.org/2000/svg}"
BASELINES = Path(__file__).parent / "baselines"
"""Figures that a person has looked at; PAMINSA_VIZ_NEW_BASELINES=1 writes them again."""

HEAVIER = APPENDIX_4.vary({"links.b8": 1.2})
LOG = ScaleChoice(kind="symlog")
FIGURES: dict[str, Any] = {
    "torques": lambda: printed(real(121)),
    "own_ranges": lambda: render_maps(real(121), OWN_REAL, dpi=80, width_mm=130.0),
    "narrow": lambda: printed(real(121), width_mm=85.0),
    "condition_log": lambda: printed(real(121, quantities=("condition",)), LOG, width_mm=85.0),
    "difference": lambda: printed(
        difference(real(121, theta=0.7, design=HEAVIER), real(121, theta=0.7))
    ),
    "live": lambda: png(live(real(72), choose_scales(real(72)), 620, path=PATH)),
}


def printed(data: MapData, choice: ScaleChoice | None = None, **options: Any) -> bytes:
    return render_maps(data, choose_scales(data, choice), dpi=80, **options)


def png(pixels: np.ndarray) -> bytes:
    stream = BytesIO()
    Image.fromarray(pixels).save(stream, format="png")
    return stream.getvalue()


@pytest.mark.parametrize("name", FIGURES)
def test_figures_match_their_baselines(name: str, tmp_path: Path) -> None:
    expected, actual = BASELINES / f"{name}.png", tmp_path / f"{name}.png"
    actual.write_bytes(FIGURES[name]())
    if os.environ.get("PAMINSA_VIZ_NEW_BASELINES"):
        expected.write_bytes(actual.read_bytes())
    problem = compare_images(str(expected), str(actual), tol=4.0)
    assert problem is None, problem


def test_each_printed_panel_shows_its_own_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    # Without colors, so that what is compared are lines.
    monkeypatch.setattr(map_panel, "map_pixels", lambda *_: np.zeros((61, 61, 4), np.uint8))
    data = panel_and_same(0)[0]
    places = map_layout(data, SCALES[:2], 170.0 / 25.4 * 72, 8.0, head=1.5 * 8.0).panels
    whole, bare = (
        pixels(render_maps(data, scale, dpi=72.0)) for scale in (SCALE, replace(SCALE, contours=0))
    )
    for panel, place in enumerate(places):
        same = pixels(render_maps(panel_and_same(panel)[1], SCALE, dpi=72.0))
        mixed, alike, plain = (crop(image, place) for image in (whole, same, bare))
        assert np.array_equal(mixed, alike)
        assert (plain != mixed).any()


@pytest.mark.parametrize("choice", [ScaleChoice(), LOG], ids=["linear", "symlog"])
def test_tiny_infinite_and_empty_data_can_be_drawn(choice: ScaleChoice) -> None:
    tiny = made_up(
        panels=1, x=[0.0, 0.1], y=[0.0, 0.1], values=[[[np.inf, -np.inf], [1.0, np.nan]]],
        status=np.zeros((2, 2), np.uint8), margin=None, leg=None,
    )  # fmt: skip
    assert live(tiny, choose_scales(tiny, choice), 300).shape[1] == 300
    assert pixels(render_maps(EMPTY, choose_scales(EMPTY, choice), dpi=50)).shape[1] == 335


@pytest.mark.parametrize(("width", "dpi"), [(85.0, 300.0), (123.4, 97.0)])
def test_a_png_is_exactly_as_wide_as_asked_and_knows_its_size(width: float, dpi: float) -> None:
    image = Image.open(BytesIO(render_maps(made_up(panels=1), SCALE, width_mm=width, dpi=dpi)))
    assert image.width == round(width / 25.4 * dpi)
    assert image.info["dpi"][0] == pytest.approx(dpi, abs=0.02)
    assert image.info["Software"] == f"paminsa_viz {__version__}"
    assert "Sample" in image.info["Description"]


@pytest.mark.parametrize(
    ("width", "quantities", "times"),
    [
        (85.0, ("max_torque",), 1),
        (170.0, ("max_torque",), 40),
        (85.0, TORQUES, 40),
        (170.0, TORQUES, 1),
    ],
    ids=["one, narrow", "one, wide and huge", "three, narrow and huge", "three, wide"],
)
def test_nothing_is_cut_off_at_the_edges(width: float, quantities: Any, times: int) -> None:
    data = real(31, quantities=quantities)
    data = replace(data, x=times * data.x, y=times * data.y)
    for image in (
        pixels(render_maps(data, choose_scales(data), width_mm=width, dpi=100)),
        live(data, choose_scales(data), round(4 * width), columns=2),
    ):
        assert all((side == 255).all() for side in (image[0], image[-1], image[:, 0], image[:, -1]))


@cache
def column(format: str, **options: Any) -> bytes:
    """What several tests look at."""
    return drawn(format, **options)


def drawn(format: str, end: float = 5.0, **options: Any) -> bytes:
    """Return a map as wide as a column of print."""
    return render_maps(
        made_up(panels=1), Scale(-end, end), format, width_mm=85.0, dpi=60, **options
    )


def test_title_and_caption_can_be_left_out() -> None:
    left_out: list[dict[str, Any]] = [{}, {"title": ""}, {"title": "", "caption": False}]
    heights = [len(pixels(column("png", **options))) for options in left_out]
    assert (np.diff(heights) < -5).all()


@pytest.mark.parametrize("format", FIGURE_FORMATS)
def test_equal_input_gives_equal_bytes_in_any_thread(format: str) -> None:
    with ThreadPoolExecutor(2) as pool:
        other, same = (pool.submit(drawn, *given) for given in (("png", 2.0), (format,)))
    assert same.result() == column(format) != other.result()


def test_an_svg_can_be_read_and_has_its_size() -> None:
    tree = ElementTree.fromstring(column("svg"))
    assert tree.tag == f"{SVG}svg"
    assert float(tree.attrib["width"].removesuffix("pt")) == pytest.approx(85 / 25.4 * 72, abs=0.3)
    counts = [len(tree.findall(f".//{SVG}{tag}")) for tag in ("image", "path", "text")]
    assert counts[0] > 0
    assert counts[1] > 80
    assert counts[2] == 0  # letters are outlines


def test_a_pdf_embeds_its_fonts() -> None:
    pdf = column("pdf")
    assert pdf.startswith(b"%PDF-")
    assert pdf.rstrip().endswith(b"%%EOF")
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
    assert b"CreationDate" not in pdf
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    assert sum(len(zlib.decompress(s)) for s in streams if s[:1] == b"\x78") > 10_000
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf)
    assert box is not None
    assert float(box[1]) == pytest.approx(85 / 25.4 * 72, abs=0.3)


def test_matplotlib_settings_of_the_user_are_neither_used_nor_changed() -> None:
    plain = column("png")
    with mpl.rc_context({"font.size": 30, "axes.facecolor": "red", "text.usetex": True}):
        before = dict(mpl.rcParams)
        assert drawn("png") == plain
        assert dict(mpl.rcParams) == before


@pytest.mark.parametrize(
    "name",
    ["a $\\n{$ c", "日本\U0001f600 line\nbreak\ttab <b>&amp;", "x" * 5000, ""],
    ids=["TeX", "not plain", "long", "empty"],
)
def test_any_name_of_a_design_can_be_printed(name: str) -> None:
    data = made_up(panels=1, design=replace(SAMPLE, name=name), title=f"Map of {name[:200]}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        image = pixels(render_maps(data, SCALE, width_mm=85.0, dpi=60))
        ElementTree.fromstring(render_maps(data, SCALE, "svg", width_mm=85.0))
    assert image.shape[1] == round(85 / 25.4 * 60)


def test_symbol_of_a_panel_has_its_index_below() -> None:
    """Whatever else a symbol has that looks like math."""
    svg = render_maps(made_up(panels=2, names=("K_x", "$\\n{$")), SCALE, "svg")
    assert rb"K$_\mathregular{x}$" in svg


def test_the_font_has_every_symbol_and_unit() -> None:
    """What is missing in it is warned of."""
    with drawing():
        page = Figure()
        for quantity in QUANTITIES.values():
            page.text(0, 0, symbols_math(quantity.symbol), parse_math=True, weight="bold")
            page.text(0, 0, display_unit(quantity.unit).text)
        FigureCanvasAgg(page).draw()


@pytest.mark.parametrize(
    "quantity",
    ["tau_1", "condition", "error_theta", "stiffness_x", "deviation_x", "clearance_counterweights"],
    ids=["signed", "pure", "angle", "large", "zero", "nothing"],
)
def test_quantities_of_every_kind_can_be_printed(quantity: str) -> None:
    data = real(21, quantities=(quantity,))
    image = pixels(render_maps(data, choose_scales(data), width_mm=85.0, dpi=60))
    assert image.shape[1] == round(85 / 25.4 * 60)


@pytest.mark.parametrize(
    ("argument", "options"),
    [
        ("format", {"format": "gif"}),
        ("width_mm", {"width_mm": 10.0}),
        ("width_mm", {"width_mm": float("nan")}),
        ("width", {"width_mm": 60.0}),  # too narrow for three panels
        ("width_mm", {"width_mm": 5000.0}),
        ("dpi", {"dpi": 5.0}),
        ("dpi", {"dpi": float("nan")}),
        ("dpi", {"width_mm": 900.0, "dpi": 1200.0}),
    ],
)
def test_impossible_figures_are_refused(argument: str, options: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput) as caught:
        render_maps(made_up(), SCALE, **options)
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    ("place", "parts"),
    [
        (
            (0.05, -0.03),
            ("“Appendix 4”", "lower knee", "θ = 60°", "z = −500 mm", "x = 50 mm", "y = −30 mm",
             "Contours every 5 N·m", "radius = 312.2 mm", f"paminsa_viz {__version__}"),
        ),
        ((0.9, 0.0), ("outside the map",)),
        ((0.39, 0.39), ("over-stretched",)),
    ],
    ids=["reached", "outside", "stretched"],
)  # fmt: skip
def test_a_caption_names_design_pose_and_lines(
    place: tuple[float, float], parts: tuple[str, ...]
) -> None:
    data = real(31).with_pose((*place, np.pi / 3, -0.5))
    text = caption(data, choose_scales(data)).replace("\u00a0", " ")
    assert [part for part in parts if part not in text] == []


def test_a_caption_names_all_of_the_load_that_numbers_depend_on() -> None:
    """Where the force acts and whether it turns change torques as the force itself does."""
    beside = APPENDIX_4.vary({"load.force_x": 21.0, "load.moment_x": 1.5, "load.point_y": -0.05})
    turning = replace(beside, load=replace(beside.load, frame=LoadFrame.PLATFORM))
    centered = APPENDIX_4.vary({"load.moment_z": 2.0, "load.point_y": -0.05})
    tails = [robot(one).replace("\u00a0", " ").partition("F_x")[2] for one in (beside, turning)]
    assert tails[0] == " = 21 N, M_x = 1.5 N·m, r_y = −50 mm"
    assert tails[1] == f"{tails[0]}, load turning with the platform"
    assert "r_y" not in robot(centered)  # no force acts there
    no_load = replace(NO_LOAD, frame=LoadFrame.PLATFORM)
    assert robot(replace(APPENDIX_4, load=no_load)) == robot(APPENDIX_4)


def test_a_caption_says_what_circles_are_where_there_are_any(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Published torques are drawn on maps of torques alone."""
    table = PublishedMap("of the paper", np.zeros((1, 2)), np.zeros((1, 4)))
    below: list[str] = []

    def noted(*arguments: Any) -> str:
        below.append(caption(*arguments))
        return ""

    monkeypatch.setattr(map_figure, "caption_text", noted)
    torque, other = (real(11, quantities=(name,)) for name in ("tau_1", "condition"))
    for data, published in ((torque, table), (torque, None), (other, table)):
        render_maps(data, choose_scales(data), width_mm=85.0, dpi=40, published=published)
    assert ["Circles: torques of “of the paper”" in text for text in below] == [True, False, False]


def test_color_bars_are_pointed_where_values_lie_beyond() -> None:
    inside = made_up(panels=1, values=np.full((1, 27, 31), 0.5))
    place = map_layout(inside, (SCALE,), 170.0 / 25.4 * 72, 8.0, head=1.5 * 8.0).bars[0]
    tips = [round(place.bottom) - 4, round(place.top) + 4]
    beside = []
    for value, pointed in ((0.5, (False, False)), (-9.0, (True, False)), (9.0, (False, True))):
        data = replace(inside, values=np.full((1, 27, 31), value))
        image = pixels(render_maps(data, SCALE, dpi=72.0))
        middle = image[tips, round((place.left + place.right) / 2)]
        assert tuple((middle < 255).any(axis=1)) == pointed
        assert ("Pointed ends" in caption(data, (SCALE,))) == any(pointed)
        beside.append(image[: round(place.bottom), round(place.right) + 1 :])
    assert np.array_equal(beside[0], beside[1])  # numbers and unit keep their places
    assert np.array_equal(beside[0], beside[2])


def test_a_caption_names_both_designs_of_a_difference() -> None:
    data = difference(real(31, design=replace(HEAVIER, name="Heavier")), real(31))
    text = caption(data, per_panel(data, SCALE))
    for each in (text, summary(data)):  # below the figure, and in the file's metadata
        assert "“Heavier”" in each
        assert "minus design “Appendix 4”" in each


@pytest.mark.parametrize("value", [0.0, np.nan], ids=["constant", "nothing"])
def test_a_caption_names_contours_only_where_there_are_any(value: float) -> None:
    """Torques of a balanced robot are zero everywhere."""
    data = made_up()
    flat = replace(data, values=np.where(np.isfinite(data.values), value, np.nan))
    said = ["Contours every" in caption(each, choose_scales(each)) for each in (data, flat)]
    assert said == [True, False]
