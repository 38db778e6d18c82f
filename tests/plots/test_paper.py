"""Printed figures: exact size, not blank, embedded fonts, equal bytes, any thread, any name."""

from __future__ import annotations

import re
import warnings
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from paminsa_viz.model import APPENDIX_4, Quantity
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.plots.caption import caption
from paminsa_viz.plots.maps import difference
from paminsa_viz.plots.paper import render
from paminsa_viz.plots.ranges import choose_scales, per_panel
from paminsa_viz.plots.scale import Scale, ScaleChoice
from tests.plots.samples import SOURCE, made_up, real

SCALE = Scale(-5.0, 5.0)


def opened(png: bytes) -> Image.Image:
    """Return a PNG as RGB."""
    return Image.open(BytesIO(png)).convert("RGB")


@pytest.mark.parametrize(
    ("width", "dpi"), [(85.0, 300.0), (120.0, 200.0), (130.0, 300.0), (123.4, 97.0)]
)
def test_a_png_is_exactly_as_wide_as_asked_and_knows_its_size(width: float, dpi: float) -> None:
    png = render(made_up(), SCALE, "png", width_mm=width, dpi=dpi)
    image = Image.open(BytesIO(png))
    assert image.width == round(width / 25.4 * dpi)
    assert image.info["dpi"][0] == pytest.approx(dpi, abs=0.02)
    assert image.info["Software"] == "paminsa_viz 0.0.1"
    assert "Sample" in image.info["Description"]


def test_a_png_shows_the_map_in_its_colors() -> None:
    image = np.asarray(opened(render(made_up(), SCALE, dpi=150)))
    colors = {tuple(c) for c in np.unique(image.reshape(-1, 3), axis=0)}
    assert len(colors) > 300
    shown = (np.array([SCALE.table[0], SCALE.table[255]]) * 255 + 0.5).astype(int)
    assert all(tuple(c) in colors for c in shown)
    assert (image == 255).all(axis=2).mean() < 0.7


def test_nothing_is_cut_off_at_the_edges() -> None:
    for data in (made_up(), real(quantities=(Quantity.MAX_TORQUE,))):
        for width in (85.0, 170.0):
            for dpi in (72.0, 200.0):
                png = render(data, choose_scales(data), width_mm=width, dpi=dpi)
                image = np.asarray(opened(png))
                frame = [image[0], image[-1], image[:, 0], image[:, -1]]
                assert all((side == 255).all() for side in frame)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_equal_input_gives_equal_bytes(kind: str) -> None:
    data = made_up()
    assert render(data, SCALE, kind, dpi=80) == render(data, SCALE, kind, dpi=80)


def test_an_svg_can_be_read_and_has_its_size() -> None:
    tree = ElementTree.fromstring(render(made_up(), SCALE, "svg", width_mm=170.0))
    assert tree.tag == "{http://www.w3.org/2000/svg}svg"
    width = tree.attrib["width"]
    assert width.endswith("pt")
    assert float(width[:-2]) == pytest.approx(170 / 25.4 * 72, abs=0.3)
    assert tree.findall(".//{http://www.w3.org/2000/svg}image")
    paths = tree.findall(".//{http://www.w3.org/2000/svg}path")
    assert len(paths) > 100
    assert not tree.findall(".//{http://www.w3.org/2000/svg}text")  # letters are outlines


def test_a_pdf_embeds_its_fonts() -> None:
    pdf = render(made_up(), SCALE, "pdf")
    assert pdf.startswith(b"%PDF-")
    assert pdf.rstrip().endswith(b"%%EOF")
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
    assert b"CreationDate" not in pdf
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    assert sum(len(zlib.decompress(s)) for s in streams if s[:1] == b"\x78") > 10_000
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", pdf)
    assert box is not None
    assert float(box[1]) == pytest.approx(170 / 25.4 * 72, abs=0.3)


def test_threads_may_ask_at_once() -> None:
    jobs = [(Scale(-1.0 - i, 1.0 + i), ("png", "svg", "pdf")[i % 3]) for i in range(6)]
    data = made_up()

    def draw(job: tuple[Scale, Any]) -> bytes:
        return render(data, job[0], job[1], width_mm=85.0, dpi=60)

    alone = [draw(job) for job in jobs]
    with ThreadPoolExecutor(6) as pool:
        assert list(pool.map(draw, jobs)) == alone


def test_a_person_s_settings_are_neither_used_nor_changed() -> None:
    plain = render(made_up(), SCALE, dpi=60)
    with mpl.rc_context({"font.size": 30, "axes.facecolor": "red", "text.usetex": True}):
        before = dict(mpl.rcParams)
        assert render(made_up(), SCALE, dpi=60) == plain
        assert dict(mpl.rcParams) == before


def test_no_figure_is_left_open() -> None:
    import matplotlib.pyplot as plt

    render(made_up(), SCALE, dpi=60)
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    "name",
    ["$x_{", "a $\\nonsense{$ c", "日本\U0001f600", "line\nbreak\ttab", "<b>&amp;", "x" * 5000, ""],
)
def test_any_name_of_a_design_can_be_printed(name: str) -> None:
    data = made_up(provenance=replace(SOURCE, design=name), title=f"Map of {name[:200]}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        image = opened(render(data, SCALE, width_mm=85.0, dpi=60))
        ElementTree.fromstring(render(data, SCALE, "svg", width_mm=85.0))
    assert image.width == round(85 / 25.4 * 60)


@pytest.mark.parametrize(
    "quantity", [q for q in Quantity if q not in (Quantity.TAU_1, Quantity.TAU_2)]
)
@pytest.mark.parametrize("kind", ["linear", "symlog"])
def test_every_quantity_can_be_printed(quantity: Quantity, kind: Any) -> None:
    data = real(31, quantities=(quantity,))
    scales = choose_scales(data, ScaleChoice(kind=kind))
    assert opened(render(data, scales, width_mm=85.0, dpi=60)).width == 201


def test_differences_empty_maps_and_own_scales_can_be_printed() -> None:
    other = APPENDIX_4.vary({"links.b8": 1.2})
    changed = difference(real(31, design=other), real(31))
    empty = made_up(values=np.full((3, 27, 31), np.nan), status=np.full((27, 31), 2, np.uint8),
                    margin=np.full((27, 31), -0.1))  # fmt: skip
    own = [Scale(-1.0, 1.0), Scale(-2.0, 2.0), Scale(-3.0, 3.0)]
    for data, scales in ((changed, choose_scales(changed)), (empty, SCALE), (made_up(), own)):
        assert opened(render(data, scales, dpi=50)).width == 335


def test_title_and_caption_can_be_left_out() -> None:
    full, bare = (
        opened(render(made_up(), SCALE, dpi=60, **options)).height
        for options in ({}, {"title": "", "caption": False})
    )
    assert full > bare + 20


def test_the_caption_tells_where_the_figure_comes_from() -> None:
    data = real(31)
    text = caption(data, choose_scales(data)).replace("\u00a0", " ")
    for part in (
        "“Appendix 4”",
        "lower knee",
        "θ = 60°",
        "z = −500 mm",
        "x = 50 mm",
        "y = −30 mm",
        "Contours every 5 N·m",
        "radius = 312.2 mm",
        "paminsa_viz ",
    ):
        assert part in text
    outside = data.with_pose((0.9, 0.0, np.pi / 3, -0.5))
    assert "outside the map" in caption(outside, choose_scales(data))
    stretched = data.with_pose((0.39, 0.39, np.pi / 3, -0.5))
    assert "over-stretched" in caption(stretched, choose_scales(data))


def test_the_caption_names_both_designs_of_a_difference() -> None:
    other = replace(APPENDIX_4.vary({"links.b8": 1.2}), name="Heavier")
    data = difference(real(31, design=other), real(31))
    text = caption(data, per_panel(data, SCALE))
    assert "“Heavier”" in text
    assert "minus design “Appendix 4”" in text


@pytest.mark.parametrize(
    "options",
    [
        {"kind": "gif"},
        {"width_mm": 10.0},
        {"width_mm": float("nan")},
        {"width_mm": 60.0},  # too narrow for three panels
        {"width_mm": 5000.0},
        {"dpi": 5.0},
        {"dpi": float("nan")},
        {"width_mm": 900.0, "dpi": 1200.0},
    ],
)
def test_impossible_figures_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput):
        render(made_up(), SCALE, **options)
