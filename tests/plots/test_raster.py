"""Color look-up against matplotlib's, masks, orientation, enlargement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from paminsa_viz.plots.paper_bar import matplotlib_colors

from paminsa_viz.model.reach import Limit
from paminsa_viz.palette import rgb
from paminsa_viz.plots import raster
from paminsa_viz.plots.scale import Scale, map_pixels, picture
from tests.plots.samples import scales

LINEAR = Scale(-2.0, 2.0)


@given(scales(), st.integers(0, 2**32 - 1))
def test_colors_are_those_of_matplotlib(scale: Scale, seed: int) -> None:
    span = scale.high - scale.low
    values = np.random.default_rng(seed).uniform(scale.low - span, scale.high + span, (12, 17))
    values.flat[:2] = scale.low, scale.high
    norm, table = matplotlib_colors(scale)
    theirs = table(norm(values))
    ours = map_pixels(values, None, scale)
    # Where a value falls on the edge of two colors, rounding may decide either way.
    where = scale.position(values) * 256
    sure = np.abs(where - np.round(where)) > 1e-6
    assert np.abs(ours[sure] / 255 - theirs[sure]).max() <= 0.5 / 255 + 1e-6


@given(scales(), st.integers(0, 2**32 - 1))
def test_masks_stay_masked(scale: Scale, seed: int) -> None:
    rng = np.random.default_rng(seed)
    values = rng.uniform(scale.low, scale.high, (9, 11))
    status = rng.integers(0, 7, (9, 11)).astype(np.uint8)
    values[rng.random((9, 11)) < 0.2] = np.nan
    cells = raster.codes(values, status, scale)
    singular = (status == Limit.SINGULAR) | ((status == 0) & np.isnan(values))
    masked = (status != 0) & (status != Limit.SINGULAR)
    assert (cells[masked] == raster.MASKED).all()
    assert (cells[singular] == raster.UNDEFINED).all()
    assert (cells[~masked & ~singular] <= raster.OVER).all()
    image = map_pixels(values, status, scale)
    assert ((image[..., 3] == 0) == masked).all()
    gray = map_pixels(values, status, scale, unreachable="gray")
    assert (gray[..., 3] == 255).all()


def test_values_beyond_the_range_have_their_own_colors() -> None:
    image = map_pixels(np.array([[-2.1, -2.0, 2.0, 2.1]]), None, LINEAR)[0, :, :3]
    under, over = LINEAR.beyond
    assert tuple(image[0]) == rgb(under)
    assert tuple(image[3]) == rgb(over)
    assert tuple(image[1]) not in (rgb(under), rgb(over))
    assert tuple(image[2]) not in (rgb(under), rgb(over))


@given(scales())
def test_infinite_values_are_beyond_the_range(scale: Scale) -> None:
    cells = raster.codes(np.array([[-np.inf, np.inf]]), None, scale)
    assert cells.tolist() == [[raster.UNDER, raster.OVER]]


def test_row_zero_of_an_image_is_the_smallest_y() -> None:
    values = np.broadcast_to(np.linspace(-1, 1, 27)[:, None], (27, 31))
    image = map_pixels(values, np.zeros((27, 31), np.uint8), LINEAR)
    assert image.shape == (27, 31, 4)
    assert image.dtype == np.uint8
    assert image[0, 0, 2] > image[0, 0, 0]  # negative, blue
    assert image[-1, 0, 0] > image[-1, 0, 2]  # positive, red


@given(st.integers(2, 30), st.integers(2, 30), st.integers(1, 90), st.integers(1, 90))
def test_an_enlarged_picture_shows_the_cell_under_each_pixel(
    ny: int, nx: int, height: int, width: int
) -> None:
    values = np.random.default_rng(ny * nx).uniform(-2, 2, (ny, nx))
    found = picture(values, None, LINEAR, height, width, 7)
    rows = ny - 1 - np.floor((np.arange(height) + 0.5) * ny / height).astype(int)
    columns = np.floor((np.arange(width) + 0.5) * nx / width).astype(int)
    expected = map_pixels(values, None, LINEAR)[rows][:, columns]
    assert np.array_equal(found, expected)


def test_only_masked_pixels_are_hatched() -> None:
    status = np.zeros((10, 10), dtype=np.uint8)
    status[:, 5:] = Limit.GUIDE
    found = picture(np.ones((10, 10)), status, LINEAR, 100, 100, 7)
    hatch, plain = raster.lut(LINEAR)[[raster.HATCHED, raster.MASKED]]
    left, right = found[:, :50].reshape(-1, 4), found[:, 50:].reshape(-1, 4)
    assert not (left == hatch).all(axis=1).any()
    lines = (right == hatch).all(axis=1)
    assert lines.mean() == pytest.approx(1 / 7, abs=0.02)
    assert ((right == plain).all(axis=1) | lines).all()
