"""The raster shown while dragging: size, places, masks, and that it shows what changed."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from paminsa_viz.plots.live import Way, live_image, marks, screen_layout

from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.plots.scale import InvalidScale, Scale, map_pixels
from tests.plots.samples import made_up, real

SCALE = Scale(-5.0, 5.0)


@pytest.mark.parametrize("width", [200, 420, 599, 600, 900, 1400])
@pytest.mark.parametrize("panels", [1, 3])
def test_size_is_as_asked(width: int, panels: int) -> None:
    data = made_up(panels=panels)
    image = live_image(data, SCALE, width)
    assert image.dtype == np.uint8
    assert image.shape == (round(screen_layout(data, SCALE, width).height), width, 3)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 2.0])
def test_cells_lie_where_the_layout_says(ratio: float) -> None:
    data = made_up(pose=(9.0, 9.0, 1.0, -0.5), margin=None, singular_radius=None)
    width = round(700 * ratio)
    image = live_image(data, SCALE, width, contours=False, pixel_ratio=ratio)
    box = screen_layout(data, SCALE, width, ratio).panels[2]
    colors = map_pixels(data.values[2], data.status, SCALE)[:, :, :3]
    inside = np.argwhere(data.status == 0)
    hits = 0
    for row, column in inside:
        x = round(box.left) + (column + 0.5) / data.x.size * round(box.width)
        y = round(box.bottom) - (row + 0.5) / data.y.size * round(box.height)
        hits += np.array_equal(image[int(y), int(x)], colors[row, column])
    assert hits > 0.85 * len(inside)  # the rest lies under the boundary


def test_masked_areas_do_not_look_like_small_values() -> None:
    data = made_up(values=np.zeros((3, 27, 31)))
    image = live_image(data, SCALE, 700, contours=False)
    box = screen_layout(data, SCALE, 700).panels[0]
    corner = image[int(box.top) + 2 : int(box.top) + 20, int(box.left) + 2 : int(box.left) + 20]
    zero = map_pixels(np.zeros((1, 1)), None, SCALE)[0, 0, :3]
    assert not (corner == zero).all(axis=2).any()
    assert len(np.unique(corner.reshape(-1, 3), axis=0)) == 2  # gray and its hatching


def test_the_mark_lies_at_the_pose_and_the_picture_does_not_change() -> None:
    data = made_up()
    there = data.with_pose((0.1, 0.1, 1.0, -0.5))
    assert np.array_equal(live_image(data, SCALE, 700), live_image(there, SCALE, 700))
    layout = screen_layout(data, SCALE, 700)
    left, right, bottom, top = data.extent
    for shown in (data, there):
        found = marks(shown, layout)
        assert len(found) == len(layout.panels)
        for (across, down), box in zip(found, layout.panels, strict=True):
            x = left + (across * layout.width - box.left) / box.width * (right - left)
            y = bottom + (box.bottom - down * layout.height) / box.height * (top - bottom)
            np.testing.assert_allclose((x, y), shown.pose[:2], atol=1e-12)
    assert marks(made_up(pose=(9.0, 9.0, 1.0, -0.5)), layout) == []


def test_contours_are_drawn_if_asked() -> None:
    data = real()
    scales = choose_scales(data)
    assert (live_image(data, scales, 600) != live_image(data, scales, 600, contours=False)).any()


def test_color_bars_are_shared_or_own() -> None:
    data = made_up()
    assert len(screen_layout(data, SCALE, 700).bars) == 1
    own = [Scale(-1.0, 1.0), Scale(-2.0, 2.0), Scale(-3.0, 3.0)]
    layout = screen_layout(data, own, 700)
    assert len(layout.bars) == 3
    image = live_image(data, own, 700)
    for bar in layout.bars:
        row = image[round(bar.top) + 5, round(bar.left) : round(bar.right)]
        assert len(np.unique(row, axis=0)) > 40


def test_the_kept_frame_follows_range_names_and_unit() -> None:
    data = made_up()
    first = live_image(data, SCALE, 500)
    assert np.array_equal(first, live_image(data, SCALE, 500))
    changed = [
        live_image(data, Scale(-5.0, 6.0), 500),
        live_image(made_up(unit="N"), SCALE, 500),
        live_image(made_up(names=("a", "b", "c")), SCALE, 500),
    ]
    assert all((picture[:18] != first[:18]).any() or (picture[-40:] != first[-40:]).any()
               for picture in changed)  # fmt: skip


def test_a_drawn_picture_does_not_change_the_next() -> None:
    data = made_up()
    first = live_image(data, SCALE, 500)
    kept = first.copy()
    first[...] = 0
    assert np.array_equal(live_image(data, SCALE, 500), kept)


def test_threads_draw_the_same_pictures() -> None:
    maps = [made_up(pose=(0.01 * i, 0.0, 1.0, -0.5)) for i in range(12)]
    scales = [Scale(-1.0 - i, 1.0 + i) for i in range(12)]
    alone = [live_image(m, s, 500) for m, s in zip(maps, scales, strict=True)]
    with ThreadPoolExecutor(6) as pool:
        together = list(pool.map(live_image, maps, scales, [500] * 12))
    assert all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))


def test_an_empty_map_says_so() -> None:
    data = made_up(values=np.full((3, 27, 31), np.nan), status=np.full((27, 31), 2, np.uint8))
    empty = live_image(data, choose_scales(data), 700)
    assert empty.shape[1] == 700
    box = screen_layout(data, SCALE, 700).panels[0]
    notice = empty[int(box.top + box.height / 5) - 6, int(box.left) + 10 : int(box.right) - 10]
    assert (notice == 255).all(axis=1).sum() > 40


def test_tiny_and_infinite_data_can_be_drawn() -> None:
    x = np.array([0.0, 0.1])
    values = np.array([[[np.inf, -np.inf], [1.0, np.nan]]])
    data = made_up(
        panels=1, x=x, y=x, values=values, status=np.zeros((2, 2), np.uint8), margin=None, leg=None
    )
    for choice in (ScaleChoice(), ScaleChoice(kind="symlog")):
        assert live_image(data, choose_scales(data, choice), 300).shape[1] == 300


@pytest.mark.parametrize("width", [0, -5, 199, 10_000])
def test_impossible_widths_are_refused(width: int) -> None:
    with pytest.raises(InvalidScale):
        live_image(made_up(), SCALE, width)


def test_the_live_picture_needs_no_plotting_library() -> None:
    code = (
        "import sys, paminsa_viz.plots.live, paminsa_viz.plots.map_data;"
        "print(sorted({'matplotlib', 'plotly'} & set(sys.modules)))"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"


def test_a_motion_is_drawn_on_every_map_and_not_beside_it() -> None:
    data = made_up(panels=3)
    right = data.extent[1]
    across = np.linspace(-0.5 * right, 3.0 * right, 200)
    way = Way((np.stack([across, 0.3 * across], axis=1),), ())
    plain, drawn = live_image(data, SCALE, 900), live_image(data, SCALE, 900, way=way)
    changed = (plain != drawn).any(axis=2)
    layout = screen_layout(data, SCALE, 900)
    for box in layout.panels:
        part = changed[int(box.top) : int(box.bottom), int(box.left) : int(box.right)]
        assert part.sum() > 0.5 * box.width
        changed[int(box.top) - 3 : int(box.bottom) + 3, int(box.left) - 3 : int(box.right) + 3] = 0
    assert not changed.any()
    bad = live_image(data, SCALE, 900, way=Way((), way.good))
    assert (bad != drawn).any()
