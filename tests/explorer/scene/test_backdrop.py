"""The gradient behind the 3D view, on the page and behind pictures of it."""

from __future__ import annotations

import numpy as np

from paminsa_viz.explorer.browser.style import BOTTOM, TOP, over_backdrop, style_html
from paminsa_viz.palette import rgb


def test_a_clear_picture_shows_the_gradient_of_the_page() -> None:
    picture = over_backdrop(np.zeros((101, 3, 4), dtype=np.uint8))
    assert tuple(picture[0, 0]) == rgb(TOP)
    assert tuple(picture[-1, 2]) == rgb(BOTTOM)
    assert (np.diff(picture[:, 0].astype(int), axis=0) <= 0).all()
    assert all(color in style_html() for color in (TOP, BOTTOM))


def test_what_is_drawn_covers_it_as_far_as_it_is_not_clear() -> None:
    pixels = np.full((3, 1, 4), 40, dtype=np.uint8)
    pixels[..., 3] = np.array([0, 255, 51])[:, None]
    clear, solid, fifth = over_backdrop(pixels)[:, 0].astype(float)
    assert tuple(clear) == rgb(TOP)
    assert (solid == 40).all()
    np.testing.assert_allclose(fifth, np.array(rgb(BOTTOM)) * 0.8 + 8, atol=0.51)
