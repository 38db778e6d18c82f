"""Hatching of the cells that are outside a volume, live and in print."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.plots import outside as hatching
from paminsa_viz.plots.caption import caption
from paminsa_viz.plots.map_figure import render_maps
from paminsa_viz.plots.map_layout import PAGE_EM, map_layout
from paminsa_viz.plots.outside import Outside
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import SCALES, live, made_up

RED, BLUE = "#cc0000", "#0000cc"


def halves(code: int = 1) -> Outside:
    """Return a map's right half outside for one reason, and a corner of it for another."""
    cells = np.zeros((27, 31), np.uint8)
    cells[:, 16:] = code
    cells[20:, 24:] = 2
    return Outside(cells, ("", "κ", "τ₁"), ("", RED, BLUE))


def inked(image: np.ndarray, color: str) -> np.ndarray:
    """Return which pixels have a color."""
    wanted = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    return (image[..., :3] == wanted).all(axis=-1)


@pytest.mark.slow
def test_cells_outside_are_hatched_in_the_color_of_their_reason_and_no_others() -> None:
    data = made_up(panels=1, margin=None, singular_radius=None)
    bare: tuple[Scale, ...] = (replace(SCALES[0], contours=0),)
    plain = live(data, bare, 600)
    image = live(replace(data, outside=halves()), bare, 600)
    place = map_layout(data, bare, 600, PAGE_EM).panels[0]
    middle = round(place.left + 16 / 31 * place.width)
    top = round(place.bottom - 20 / 27 * place.height)
    red, blue = inked(image, RED), inked(image, BLUE)
    inside = slice(round(place.left), middle - 1)
    assert not red[:, inside].any()
    assert (image[:, inside] == plain[:, inside]).all()
    right = red[top + 3 : round(place.bottom) - 2, middle + 2 : round(place.right) - 2]
    assert 0.05 < right.mean() < 0.4
    assert blue.any()
    assert not blue[top + 2 :].any()
    # The cells still show through: nothing but the lines has changed, and where others cross them.
    changed = (image != plain).any(axis=-1)
    assert (changed & ~(red | blue)).mean() < 0.002


@pytest.mark.slow
def test_reasons_differ_by_the_direction_of_their_lines() -> None:
    data = made_up(panels=1, margin=None, singular_radius=None)
    cells = np.ones((27, 31), np.uint8)
    drawn = []
    for code in range(1, 1 + len(hatching.STROKES)):
        texts = ("", *"abcd")
        one = Outside(np.full_like(cells, code), texts, ("", *(RED,) * 4))
        drawn.append(inked(live(replace(data, outside=one), SCALES[:1], 300), RED))
    for i, first in enumerate(drawn):
        for second in drawn[i + 1 :]:
            assert (first != second).mean() > 0.01


@pytest.mark.slow
def test_print_has_the_hatching_and_names_the_reasons() -> None:
    data = made_up(panels=1)
    shown = replace(data, outside=halves())
    svg = render_maps(shown, SCALES[:1], "svg", width_mm=85.0).decode()
    assert RED in svg
    assert BLUE in svg
    assert RED not in render_maps(data, SCALES[:1], "svg", width_mm=85.0).decode()
    assert "requirements broken (κ, τ₁)" in caption(shown, SCALES[:1])
    none = replace(data, outside=replace(halves(), code=np.zeros((27, 31), np.uint8)))
    assert caption(none, SCALES[:1]) == caption(data, SCALES[:1])
