"""Color tables: lightness runs as promised, also for color-blind eyes."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.palette import ACTUATOR_COLORS, COORDINATE_COLORS, DARK, LIGHT, Theme, rgb
from paminsa_viz.plots import colors

EYES = {
    "usual": np.eye(3),
    # Machado, Oliveira, Fernandes (2009), severity 1, on linear RGB.
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
               [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
               [-0.011820, 0.042940, 0.968881]],
}  # fmt: skip


def seen(table: np.ndarray, eye: str) -> np.ndarray:
    """Return OKLab of a table as an eye sees it."""
    linear = np.where(table <= 0.04045, table / 12.92, ((table + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ np.transpose(EYES[eye]), 0, 1)
    back = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return colors.oklab(back)


def shown(colors_of: tuple[str, ...], theme: Theme) -> np.ndarray:
    """Return colors of the data (n, 3) as they are drawn on a theme's ground, 0 to 1."""
    return np.array([rgb(theme.shown(color)) for color in colors_of]) / 255


def contrast(color: np.ndarray, ground: np.ndarray) -> float:
    """Return the contrast of two colors as WCAG 2 defines it."""
    linear = [
        np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) for c in (color, ground)
    ]
    low, high = sorted(float(c @ [0.2126, 0.7152, 0.0722]) for c in linear)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=["light", "dark"])
def test_coordinates_are_told_apart_and_taken_for_no_actuator(theme: Theme) -> None:
    ground, own = shown((theme.paper,), theme)[0], shown(COORDINATE_COLORS, theme)
    assert min(contrast(color, ground) for color in own) > 4.5
    for eye in EYES:
        x, y, _, z = seen(own, eye)
        assert min(np.linalg.norm(one - other) for one, other in ((x, y), (y, z), (z, x))) > 0.12
    actuators = seen(shown(ACTUATOR_COLORS, theme), "usual")
    apart = np.linalg.norm(seen(own, "usual")[:, None] - actuators, axis=-1)
    assert apart.min() > 0.08


@pytest.mark.parametrize("eye", EYES)
def test_diverging_arms_darken_outwards_and_differ(eye: str) -> None:
    lab = seen(colors.table(colors.DIVERGING), eye)
    light = lab[:, 0]
    assert (np.diff(light[:128]) > -2e-3).all()
    assert (np.diff(light[128:]) < 2e-3).all()
    assert light[127:129].min() > 0.94
    for step in (30, 60, 127):  # the same distance from zero on both sides
        assert np.linalg.norm(lab[127 - step] - lab[128 + step]) > 0.05


@pytest.mark.parametrize("eye", EYES)
def test_sequential_table_lightens_all_the_way(eye: str) -> None:
    light = seen(colors.table(colors.SEQUENTIAL), eye)[:, 0]
    assert (np.diff(light) > -2e-3).all()
    assert light[-1] - light[0] > 0.5


def test_diverging_table_is_perceptually_uniform_and_inside_srgb() -> None:
    table = colors.table(colors.DIVERGING)
    assert 0 < table.min() <= table.max() < 1  # nothing was cut off
    lab = colors.oklab(table)
    for arm in (lab[:128], lab[128:]):
        steps = np.diff(arm[:, 0])
        assert np.allclose(steps, steps.mean(), rtol=1e-6)
        change = np.linalg.norm(np.diff(arm, axis=0), axis=1)
        assert change.max() < 1.2 * change.min()


@pytest.mark.parametrize("name", colors.BEYOND)
def test_a_table_is_complete_and_colors_beyond_it_are_new(name: str) -> None:
    table = colors.table(name)
    assert table.shape == (256, 3)
    assert 0 <= table.min() <= table.max() <= 1
    assert not table.flags.writeable
    lab = colors.oklab(table)
    for color, end in zip(colors.BEYOND[name], (lab[0], lab[-1]), strict=True):
        beyond = colors.oklab(np.array(rgb(color)) / 255)
        assert np.linalg.norm(beyond - end) > 0.04
        assert np.linalg.norm(beyond - lab, axis=1).min() > 0.03


def test_an_unknown_table_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        colors.table("jet")
