"""Live maps: their layout, and images that follow data, scales and size."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.plots import map_figure
from paminsa_viz.plots.contours import NO_LINE, FloorPath
from paminsa_viz.plots.map_figure import LiveMaps
from paminsa_viz.plots.map_layout import PAGE_EM, MapLayout, map_layout
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale, map_pixels
from tests.plots.samples import (
    OWN,
    PATH,
    SCALE,
    SCALES,
    SWEEP,
    crop,
    live,
    made_up,
    panel_and_same,
)

pytestmark = pytest.mark.slow


def layout_of(data: MapData, scales: Any = SCALES, width: int = 700) -> MapLayout:
    return map_layout(data, scales, width, PAGE_EM)


@pytest.mark.parametrize(("width", "ratio"), [(599, 1.0), (301, 1.5)])
@pytest.mark.parametrize("panels", [1, 3])
def test_a_live_picture_has_the_size_of_its_layout(width: int, ratio: float, panels: int) -> None:
    data = made_up(panels=panels)
    image = live(data, SCALES[:panels], width, ratio)
    height = layout_of(data, SCALES[:panels], width).height
    assert image.dtype == np.uint8
    assert image.shape == (round(height * ratio), round(width * ratio), 3)


def test_live_cells_lie_where_the_layout_says() -> None:
    data = made_up(margin=None, singular_radius=None)
    bare = (replace(SCALE, contours=0),) * 3
    image, place = live(data, bare, 700), layout_of(data).panels[2]
    colors = map_pixels(data.values[2], data.status, SCALE)[:, :, :3]
    inside = np.argwhere(data.status == 0)
    x = place.left + (inside[:, 1] + 0.5) / data.x.size * place.width
    y = place.bottom - (inside[:, 0] + 0.5) / data.y.size * place.height
    hits = (image[y.astype(int), x.astype(int)] == colors[tuple(inside.T)]).all(axis=1)
    assert hits.mean() > 0.85  # the rest lies under the boundary


def test_each_live_panel_shows_its_own_values_and_contours() -> None:
    data = panel_and_same(0)[0]
    image, places = live(data, SCALES[:2], 500), layout_of(data, SCALES[:2], 500).panels
    for panel, place in enumerate(places):
        same = live(panel_and_same(panel)[1], SCALES[:2], 500)
        mixed, alike, other = crop(image, place), crop(same, place), crop(image, places[panel - 1])
        assert np.array_equal(mixed, alike)
        rows, columns = np.minimum(mixed.shape, other.shape)[:2]
        assert (mixed[:rows, :columns] != other[:rows, :columns]).any()


def test_the_pose_moves_over_a_picture_that_does_not_change() -> None:
    data = made_up()
    there = data.with_pose((0.1, 0.1, 1.0, -0.5))
    assert np.array_equal(live(data, SCALES, 700), live(there, SCALES, 700))
    layout = layout_of(data)
    left, right, bottom, top = data.extent
    for shown in (data, there):
        for (across, down), place in zip(layout.positions(shown), layout.panels, strict=True):
            x = left + (across * layout.width - place.left) / place.width * (right - left)
            y = bottom + (place.bottom - down * layout.height) / place.height * (top - bottom)
            np.testing.assert_allclose((x, y), shown.pose[:2], atol=1e-12)
    assert layout.positions(made_up(pose=(9.0, 9.0, 1.0, -0.5))) == []


def test_kept_backgrounds_follow_data_scales_and_size_in_any_thread(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(map_figure, "_KEPT_SCALES", 1)  # fewer than the scales below
    maps, one = LiveMaps(), made_up(panels=1)
    requests: list[Any] = [
        (made_up(panels=2), SCALES[:2], 300),
        (made_up(panels=2), OWN[:2], 300),
        (replace(one, values=np.full_like(one.values, np.nan)), (SCALE,), 200),
        (one, (SCALE,), 200),
        (one, (SCALE,), 220),
        (replace(one, unit="N"), (SCALE,), 200),
        (replace(one, names=("a",)), (SCALE,), 200),
        *((one, (Scale(-1.5 - i, 1.5 + i),), 200) for i in range(2)),
    ]
    alone = [LiveMaps().draw(*request) for request in requests]
    kept = [maps.draw(*request) for request in requests]
    again = [maps.draw(*request) for request in requests[-2:]]  # to one that is no longer kept
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda request: maps.draw(*request), requests[-5:]))
    for found, wanted in ((kept, alone), (again, alone[-2:]), (together, alone[-5:])):
        assert all(np.array_equal(a, b) for a, b in zip(found, wanted, strict=True))
    assert len({picture.tobytes() for picture in alone}) == len(requests)
    assert not np.shares_memory(kept[0], maps.draw(*requests[0]))


@pytest.mark.parametrize("panels", [1, 3])
def test_of_a_scale_only_its_color_bars_are_kept(panels: int) -> None:
    maps, data = LiveMaps(), made_up(panels=panels)
    for i in range(4):
        scales = [Scale(-1.5 - i - panel / 9, 1.5 + i) for panel in range(panels)]
        picture = maps.draw(data, scales, 600)
    (figure,) = maps._figures.values()
    kept = [sum(piece.nbytes for _, piece in bars) for bars in figure._bars.values()]
    assert len(kept) == 4
    assert 0 < max(kept) < picture.nbytes / 3


def test_a_motion_is_drawn_inside_every_map() -> None:
    data = made_up()
    plain, drawn = live(data, SCALES, 900), live(data, SCALES, 900, path=PATH)
    changed = (plain != drawn).any(axis=2)
    for place in layout_of(data, width=900).panels:
        rows = slice(int(place.top), int(place.bottom) + 1)
        inside = changed[rows, int(place.left) : int(place.right) + 1]
        assert inside.sum() > 0.5 * place.width
        inside[:] = False
    assert not changed.any()
    assert (live(data, SCALES, 900, path=FloorPath(NO_LINE, SWEEP)) != drawn).any()


@pytest.mark.parametrize("width", [300, 420, 620, 1400])
@pytest.mark.parametrize("scales", [SCALES, OWN], ids=["shared", "own"])
def test_panels_and_bars_do_not_overlap_and_stay_inside(width: int, scales: Any) -> None:
    data = made_up()
    layout = layout_of(data, scales, width)
    left, right, bottom, top = data.extent
    assert len(layout.bars) == (1 if scales is SCALES else 3)
    for place in layout.panels + layout.bars:
        assert place.left >= 0 <= place.top
        assert place.right <= layout.width
        assert place.bottom <= layout.height
    for a, b in zip(layout.panels, layout.panels[1:], strict=False):
        assert a.right < b.left
        assert a.height / a.width == pytest.approx((top - bottom) / (right - left))
    for bar in layout.bars:
        assert bar.left > layout.panels[-1].right or bar.top > layout.panels[0].bottom


@pytest.mark.parametrize("width", [0, -5, 199])
def test_impossible_live_widths_are_refused(width: int) -> None:
    with pytest.raises(InvalidInput, match="width"):
        live(made_up(), SCALES, width)
