"""Figures of maps: what they look like, that each panel shows its own data, and their files."""

from __future__ import annotations

import os
import re
import warnings
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.testing.compare import compare_images
from PIL import Image

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.plots import map_panel
from paminsa_viz.plots.caption import caption
from paminsa_viz.plots.contours import NO_LINE
from paminsa_viz.plots.formats import FIGURE_FORMATS
from paminsa_viz.plots.map_data import MapData, difference
from paminsa_viz.plots.map_figure import PAGE_EM, LiveMaps, render
from paminsa_viz.plots.map_layout import MapLayout, map_layout
from paminsa_viz.plots.map_panel import FloorPath
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales, per_panel
from paminsa_viz.plots.scale import Scale, map_pixels
from paminsa_viz.quantities import QUANTITIES, TORQUES
from tests.plots.samples import SOURCE, made_up, real

pytestmark = pytest.mark.slow


SCALE = Scale(-5.0, 5.0)
SCALES = (SCALE,) * 3
OWN = (Scale(-1.0, 1.0), Scale(-2.0, 2.0), Scale(-3.0, 3.0))
OWN_REAL = (Scale(-20.0, 20.0), Scale(-10.0, 20.0), Scale(-10.0, 100.0, "symlog", 0.1))
EMPTY = made_up(
    values=np.full((3, 27, 31), np.nan),
    status=np.full((27, 31), 2, np.uint8),
    margin=np.full((27, 31), -0.1),
)
BASELINES = Path(__file__).parent / "baselines"
"""Figures that a person has looked at; PAMINSA_VIZ_NEW_BASELINES=1 writes them again."""

HEAVIER = APPENDIX_4.vary({"links.b8": 1.2})
FIGURES: dict[str, Any] = {
    "torques": lambda: printed(real(121), width_mm=170.0),
    "own_ranges": lambda: render(real(121), OWN_REAL, dpi=80, width_mm=130.0),
    "narrow": lambda: printed(real(121), width_mm=85.0),
    "condition_log": lambda: printed(
        real(121, quantities=("condition",)), ScaleChoice(kind="symlog"), width_mm=85.0
    ),
    "difference": lambda: printed(
        difference(real(121, theta=0.7, design=HEAVIER), real(121, theta=0.7)), width_mm=170.0
    ),
    "live": lambda: png(live(real(72), choose_scales(real(72)), 620, path=PATH)),
}
SWEEP = np.stack([np.linspace(-0.6, 0.6, 200), np.linspace(-0.1, 0.1, 200)], axis=1)
PATH = FloorPath(SWEEP[:150], SWEEP[149:])


def printed(data: MapData, choice: ScaleChoice | None = None, **options: Any) -> bytes:
    return render(data, choose_scales(data, choice), dpi=80, **options)


def live(data: MapData, scales: Any, width: int, ratio: float = 1.0, **options: Any) -> np.ndarray:
    return LiveMaps().draw(data, scales, width, ratio, **options)


def png(pixels: np.ndarray) -> bytes:
    stream = BytesIO()
    Image.fromarray(pixels).save(stream, format="png")
    return stream.getvalue()


def opened(content: bytes) -> Image.Image:
    """Return a PNG as RGB."""
    return Image.open(BytesIO(content)).convert("RGB")


def layout_of(data: MapData, scales: Any = SCALES, width: int = 700) -> MapLayout:
    return map_layout(data, scales, width, PAGE_EM)


def crop(pixels: np.ndarray, place: Any, scale: float = 1.0) -> np.ndarray:
    """Return the pixels inside a panel, without its frame."""
    left, right, top, bottom = (
        round(scale * edge) for edge in (place.left, place.right, place.top, place.bottom)
    )
    return pixels[top + 2 : bottom - 2, left + 2 : right - 2]


@pytest.mark.parametrize("name", FIGURES)
def test_figures_look_as_they_did(name: str, tmp_path: Path) -> None:
    expected, actual = BASELINES / f"{name}.png", tmp_path / f"{name}.png"
    content = FIGURES[name]()
    if os.environ.get("PAMINSA_VIZ_NEW_BASELINES"):
        BASELINES.mkdir(exist_ok=True)
        expected.write_bytes(content)
    actual.write_bytes(content)
    problem = compare_images(str(expected), str(actual), tol=4.0)
    assert problem is None, problem


class TestLive:
    @pytest.mark.parametrize(("width", "ratio"), [(300, 1.0), (599, 1.0), (901, 1.5), (700, 2.0)])
    @pytest.mark.parametrize("panels", [1, 3])
    def test_size_is_as_asked(self, width: int, ratio: float, panels: int) -> None:
        data = made_up(panels=panels)
        image = live(data, SCALES[:panels], width, ratio)
        height = layout_of(data, SCALES[:panels], width).height
        assert image.dtype == np.uint8
        assert image.shape == (round(height * ratio), round(width * ratio), 3)

    def test_cells_lie_where_the_layout_says(self) -> None:
        data = made_up(margin=None, singular_radius=None)
        bare = (replace(SCALE, contours=0),) * 3
        image, place = live(data, bare, 700), layout_of(data).panels[2]
        colors = map_pixels(data.values[2], data.status, SCALE)[:, :, :3]
        inside = np.argwhere(data.status == 0)
        hits = 0
        for row, column in inside:
            x = place.left + (column + 0.5) / data.x.size * place.width
            y = place.bottom - (row + 0.5) / data.y.size * place.height
            hits += np.array_equal(image[int(y), int(x)], colors[row, column])
        assert hits > 0.85 * len(inside)  # the rest lies under the boundary

    @pytest.mark.parametrize("panel", range(3))
    def test_each_panel_shows_its_own_values_and_contours(self, panel: int) -> None:
        data = made_up(nx=61, ny=61)
        same = made_up(nx=61, ny=61, values=np.repeat(data.values[panel : panel + 1], 3, axis=0))
        place = layout_of(data).panels[panel]
        mixed, alike = (crop(live(each, SCALES, 700), place) for each in (data, same))
        assert np.array_equal(mixed, alike)
        other = crop(live(data, SCALES, 700), layout_of(data).panels[panel - 1])
        shape = tuple(min(a, b) for a, b in zip(mixed.shape, other.shape, strict=True))[:2]
        assert (mixed[: shape[0], : shape[1]] != other[: shape[0], : shape[1]]).any()

    def test_the_pose_moves_and_the_picture_does_not_change(self) -> None:
        data = made_up()
        there = data.with_pose((0.1, 0.1, 1.0, -0.5))
        assert np.array_equal(live(data, SCALES, 700), live(there, SCALES, 700))
        layout = layout_of(data)
        left, right, bottom, top = data.extent
        for shown in (data, there):
            found = layout.positions(shown)
            assert len(found) == 3
            for (across, down), place in zip(found, layout.panels, strict=True):
                x = left + (across * layout.width - place.left) / place.width * (right - left)
                y = bottom + (place.bottom - down * layout.height) / place.height * (top - bottom)
                np.testing.assert_allclose((x, y), shown.pose[:2], atol=1e-12)
        assert layout.positions(made_up(pose=(9.0, 9.0, 1.0, -0.5))) == []

    def test_what_is_kept_follows_data_scales_and_size(self) -> None:
        maps = LiveMaps()
        requests = [
            (made_up(), SCALES, 500),
            (made_up(), OWN, 500),
            (made_up(), (Scale(-5.0, 6.0),) * 3, 500),
            (made_up(unit="N"), SCALES, 500),
            (made_up(names=("a", "b", "c")), SCALES, 500),
            (real(31), SCALES, 500),
            (made_up(), SCALES, 620),
            (EMPTY, SCALES, 500),
            (made_up(), SCALES, 500),
        ]
        pictures = [maps.draw(*request) for request in requests]
        alone = [LiveMaps().draw(*request) for request in requests]
        assert all(np.array_equal(a, b) for a, b in zip(pictures, alone, strict=True))
        assert len({picture.tobytes() for picture in pictures}) == len(requests) - 1
        assert not np.shares_memory(pictures[0], maps.draw(*requests[0]))

    def test_threads_draw_the_same_pictures(self) -> None:
        maps = LiveMaps()
        jobs = [(made_up(), (Scale(-1.0 - i, 1.0 + i),) * 3) for i in range(8)]
        alone = [live(data, scales, 500) for data, scales in jobs]
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(lambda job: maps.draw(*job, 500), jobs))
        assert all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))

    def test_a_motion_is_drawn_inside_every_map(self) -> None:
        data = made_up()
        plain, drawn = live(data, SCALES, 900), live(data, SCALES, 900, path=PATH)
        changed = (plain != drawn).any(axis=2)
        for place in layout_of(data, width=900).panels:
            inside = np.s_[
                int(place.top) : int(place.bottom) + 1, int(place.left) : int(place.right) + 1
            ]
            assert changed[inside].sum() > 0.5 * place.width
            changed[inside] = False
        assert not changed.any()
        failing = live(data, SCALES, 900, path=FloorPath(NO_LINE, SWEEP))
        assert (failing != drawn).any()

    def test_tiny_and_infinite_data_can_be_drawn(self) -> None:
        x = np.array([0.0, 0.1])
        values = np.array([[[np.inf, -np.inf], [1.0, np.nan]]])
        data = made_up(
            panels=1, x=x, y=x, values=values, status=np.zeros((2, 2), np.uint8), margin=None,
            leg=None,
        )  # fmt: skip
        for choice in (ScaleChoice(), ScaleChoice(kind="symlog")):
            assert live(data, choose_scales(data, choice), 300).shape[1] == 300

    @pytest.mark.parametrize("width", [0, -5, 199])
    def test_impossible_widths_are_refused(self, width: int) -> None:
        with pytest.raises(InvalidInput, match="width"):
            live(made_up(), SCALES, width)


class TestLayout:
    @pytest.mark.parametrize("width", [300, 420, 620, 1400])
    @pytest.mark.parametrize("scales", [SCALES, OWN])
    def test_panels_and_bars_do_not_overlap_and_stay_inside(self, width: int, scales: Any) -> None:
        layout = layout_of(made_up(), scales, width)
        assert len(layout.bars) == (1 if scales is SCALES else 3)
        for place in layout.panels + layout.bars:
            assert place.left >= 0 <= place.top
            assert place.right <= layout.width
            assert place.bottom <= layout.height
        for a, b in zip(layout.panels, layout.panels[1:], strict=False):
            assert a.right < b.left
        for bar in layout.bars:
            assert bar.left > layout.panels[-1].right or bar.top > layout.panels[0].bottom

    def test_x_and_y_have_one_scale(self) -> None:
        data = made_up()
        left, right, bottom, top = data.extent
        for place in layout_of(data).panels:
            aspect = place.height / place.width
            assert aspect == pytest.approx((top - bottom) / (right - left))


class TestPrint:
    @pytest.mark.parametrize(("width", "dpi"), [(85.0, 300.0), (120.0, 200.0), (123.4, 97.0)])
    def test_a_png_is_exactly_as_wide_as_asked_and_knows_its_size(
        self, width: float, dpi: float
    ) -> None:
        image = Image.open(BytesIO(render(made_up(), SCALE, "png", width_mm=width, dpi=dpi)))
        assert image.width == round(width / 25.4 * dpi)
        assert image.info["dpi"][0] == pytest.approx(dpi, abs=0.02)
        assert image.info["Software"] == "paminsa_viz 0.0.1"
        assert "Sample" in image.info["Description"]

    @pytest.mark.parametrize("panel", range(3))
    def test_each_panel_shows_its_own_contours(
        self, panel: int, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        data = made_up(nx=61, ny=61)
        same = made_up(nx=61, ny=61, values=np.repeat(data.values[panel : panel + 1], 3, axis=0))
        # Without colors, so that what is compared are lines.
        monkeypatch.setattr(map_panel, "map_pixels", lambda *_: np.zeros((61, 61, 4), np.uint8))
        dpi, width = 144.0, 170.0
        place = map_layout(data, SCALES, width / 25.4 * 72, 8.0, head=1.5 * 8.0).panels[panel]
        mixed, alike = (
            crop(np.asarray(opened(render(each, SCALE, dpi=dpi, width_mm=width))), place, 2.0)
            for each in (data, same)
        )
        assert np.array_equal(mixed, alike)
        bare = np.asarray(opened(render(data, replace(SCALE, contours=0), dpi=dpi)))
        assert (crop(bare, place, 2.0) != mixed).any()

    @pytest.mark.parametrize("width", [85.0, 170.0])
    @pytest.mark.parametrize("quantities", [("max_torque",), TORQUES])
    def test_nothing_is_cut_off_at_the_edges(self, width: float, quantities: Any) -> None:
        data = real(31, quantities=quantities)
        image = np.asarray(opened(render(data, choose_scales(data), width_mm=width, dpi=100)))
        frame = [image[0], image[-1], image[:, 0], image[:, -1]]
        assert all((side == 255).all() for side in frame)

    def test_title_and_caption_can_be_left_out(self) -> None:
        full, bare = (
            opened(render(made_up(), SCALE, dpi=60, **options)).height
            for options in ({}, {"title": "", "caption": False})
        )
        assert full > bare + 20

    @pytest.mark.parametrize("format", FIGURE_FORMATS)
    def test_equal_input_gives_equal_bytes_in_any_thread(self, format: str) -> None:
        jobs = [(Scale(-1.0 - i, 1.0 + i), format) for i in range(3)]

        def draw(job: tuple[Scale, str]) -> bytes:
            return render(made_up(), *job, width_mm=85.0, dpi=60)

        alone = [draw(job) for job in jobs]
        with ThreadPoolExecutor(3) as pool:
            assert list(pool.map(draw, jobs)) == alone

    def test_an_svg_can_be_read_and_has_its_size(self) -> None:
        tree = ElementTree.fromstring(render(made_up(), SCALE, "svg", width_mm=170.0))
        assert tree.tag == "{http://www.w3.org/2000/svg}svg"
        width = tree.attrib["width"]
        assert width.endswith("pt")
        assert float(width[:-2]) == pytest.approx(170 / 25.4 * 72, abs=0.3)
        assert tree.findall(".//{http://www.w3.org/2000/svg}image")
        assert len(tree.findall(".//{http://www.w3.org/2000/svg}path")) > 100
        assert not tree.findall(".//{http://www.w3.org/2000/svg}text")  # letters are outlines

    def test_a_pdf_embeds_its_fonts(self) -> None:
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

    def test_a_person_s_settings_are_neither_used_nor_changed(self) -> None:
        plain = render(made_up(), SCALE, dpi=60)
        with mpl.rc_context({"font.size": 30, "axes.facecolor": "red", "text.usetex": True}):
            before = dict(mpl.rcParams)
            assert render(made_up(), SCALE, dpi=60) == plain
            assert dict(mpl.rcParams) == before

    @pytest.mark.parametrize(
        "name",
        [
            "$x_{",
            "a $\\nonsense{$ c",
            "日本\U0001f600",
            "line\nbreak\ttab",
            "<b>&amp;",
            "x" * 5000,
            "",
        ],
    )
    def test_any_name_of_a_design_can_be_printed(self, name: str) -> None:
        data = made_up(provenance=replace(SOURCE, design=name), title=f"Map of {name[:200]}")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            image = opened(render(data, SCALE, width_mm=85.0, dpi=60))
            ElementTree.fromstring(render(data, SCALE, "svg", width_mm=85.0))
        assert image.width == round(85 / 25.4 * 60)

    @pytest.mark.parametrize("quantity", QUANTITIES)
    @pytest.mark.parametrize("kind", ["linear", "symlog"])
    def test_every_quantity_can_be_printed(self, quantity: str, kind: Any) -> None:
        data = real(31, quantities=(quantity,))
        scales = choose_scales(data, ScaleChoice(kind=kind))
        assert opened(render(data, scales, width_mm=85.0, dpi=60)).width == 201

    @pytest.mark.parametrize(
        "options",
        [
            {"format": "gif"},
            {"width_mm": 10.0},
            {"width_mm": float("nan")},
            {"width_mm": 60.0},  # too narrow for three panels
            {"width_mm": 5000.0},
            {"dpi": 5.0},
            {"dpi": float("nan")},
            {"width_mm": 900.0, "dpi": 1200.0},
        ],
    )
    def test_impossible_figures_are_refused(self, options: dict[str, Any]) -> None:
        with pytest.raises(InvalidInput):
            render(made_up(), SCALE, **options)

    def test_empty_maps_can_be_printed(self) -> None:
        assert opened(render(EMPTY, SCALE, dpi=50)).width == 335


class TestCaption:
    def test_it_says_where_the_figure_comes_from(self) -> None:
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

    def test_it_names_both_designs_of_a_difference(self) -> None:
        other = replace(HEAVIER, name="Heavier")
        data = difference(real(31, design=other), real(31))
        text = caption(data, per_panel(data, SCALE))
        assert "“Heavier”" in text
        assert "minus design “Appendix 4”" in text
