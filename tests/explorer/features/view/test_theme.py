"""The theme: what it is, that its letters can be read, and that files stay light."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.commands import commands
from paminsa_viz.explorer.core import actions, tab_store
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import COARSE, MapStore
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.export import tab as export_panel
from paminsa_viz.explorer.features.view import theme
from paminsa_viz.explorer.kit.chart import themed
from paminsa_viz.explorer.kit.downloads import File
from paminsa_viz.explorer.kit.entries import Run
from paminsa_viz.explorer.kit.text import css_color
from paminsa_viz.explorer.scene.legend import NO_LEGEND
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.meshes.bodies import ground_glb
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.palette import ACTUATOR_COLORS, DARK, LIGHT, Theme, rgb
from paminsa_viz.plots.map_figure import LiveMaps
from paminsa_viz.plots.series_uplot import ChartShape, uplot_options
from tests.support.desk import desk_with

BOTH = pytest.mark.parametrize("ground", [LIGHT, DARK], ids=["light", "dark"])

STATE = initial_state()


def contrast(a: str, b: str) -> float:
    """Return the contrast of two colors after WCAG 2.2."""

    def luminance(color: str) -> float:
        levels = np.array(rgb(color)) / 255
        linear = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_the_palette_has_a_command_for_each_theme() -> None:
    found = {one.label: one for one in commands() if one.key == "appearance"}
    for name, kind in (("as the browser", "BROWSER"), ("light", "LIGHT"), ("dark", "DARK")):
        effect = found[f"Theme: {name}"].effect
        assert not isinstance(effect, Run)
        assert effect(STATE) == replace(STATE, appearance=Appearance[kind])


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)  # WCAG's own example


@BOTH
def test_letters_and_lines_stand_out_from_the_paper(ground: Theme) -> None:
    letters = ("ink", "soft_ink", "muted", "good", "warn", "bad", "reference")
    for name in letters:
        assert contrast(getattr(ground, name), ground.paper) >= 4.5, name
    for color in ACTUATOR_COLORS:
        assert contrast(ground.shown(color), ground.paper) >= 3.0, color


@pytest.mark.parametrize(
    ("appearance", "browser", "dark"),
    [(a, b, {Appearance.LIGHT: False, Appearance.DARK: True}.get(a, b))
     for a, b in product(Appearance, (False, True))],
)  # fmt: skip
def test_theme_follows_the_browser_unless_one_is_chosen(
    appearance: Appearance, browser: bool, dark: bool
) -> None:
    state = theme.as_browser(replace(STATE, appearance=appearance), browser)
    assert state.theme.dark is dark


@pytest.mark.parametrize("sent", [None, 1, "dark", [True], {}], ids=str)
def test_page_that_sends_something_else_changes_nothing(sent: Any) -> None:
    assert theme.as_browser(STATE, sent) is STATE


def test_choice_is_kept_and_the_browsers_wish_is_not() -> None:
    chosen = replace(STATE, appearance=Appearance.DARK, browser_dark=True)
    found = tab_store.restore(STATE, tab_store.dump(chosen))
    assert found.appearance is Appearance.DARK
    assert not found.browser_dark


@pytest.mark.slow
@BOTH
def test_maps_have_the_theme_around_the_cells_and_the_same_cells(ground: Theme) -> None:
    state = actions.move(STATE, theta=0.5)
    store = MapStore()
    data = store.data(state, COARSE)
    scales = store.scales(state, data)
    light, found = (LiveMaps().draw(data, scales, 500, theme=t) for t in (LIGHT, ground))
    assert tuple(found[1, 1]) == rgb(ground.paper)
    column = found.shape[1] // 6 + 20
    middle = (slice(70, 80), slice(column, column + 10))
    np.testing.assert_array_equal(found[middle], light[middle])


@pytest.mark.slow
def test_exported_maps_are_light_on_every_page() -> None:
    store, one = MapStore(), actions.move(STATE, theta=0.5)
    one = one.updated("export", single=True, width=90.0, dpi=50.0)
    auto, light, dark = (
        exports.figure(replace(one, appearance=appearance), store, "png")
        for appearance in Appearance
    )
    assert auto == light == dark


@BOTH
def test_picture_of_the_view_is_taken_of_the_light_scene(
    ground: Theme, server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Theme] = []
    taken: list[Theme] = []

    class Remembers:
        def draw(self, frame: Frame, dragging: bool) -> None:
            drawn.append(frame.state.theme)

    def view(*_: Any) -> File:
        before = len(drawn)
        for _each in range(2):  # the second one comes after the first one was drawn
            desk.dispatch(lambda s: actions.move(s, x=0.01))
        taken.append(drawn[-1])
        assert len(drawn) == before
        return File("view.png", b"")

    monkeypatch.setattr(export_panel.pictures, "view", view)
    with desk_with(server, lambda _: Remembers()) as desk:
        chosen = Appearance.DARK if ground.dark else Appearance.LIGHT
        desk.dispatch(lambda s: replace(s, appearance=chosen))
        desk.until(lambda: drawn and drawn[-1] == ground)
        export_panel.light_view(desk.session, NO_LEGEND)
        assert taken == [LIGHT]
        desk.until(lambda: drawn[-1] == ground)


def test_ground_is_darker_in_the_dark_and_as_large() -> None:
    light, dark = (ground_glb(APPENDIX_4.geometry, dark=d) for d in (False, True))
    assert light != dark
    assert len(light) == pytest.approx(len(dark), abs=64)


def test_curves_and_charts_have_the_themes_colors() -> None:
    color = ACTUATOR_COLORS[0]
    shape = ChartShape("τ", ((DARK.shown(color), "solid", 2.0, False),), 1, DARK)
    options = uplot_options(shape)
    assert all(axis["stroke"] == DARK.muted for axis in options["axes"])
    tree = {"a": [{"color": color, "grid": "#e4e8ec", "name": "M1", "x": [1.0]}]}
    text = json.dumps(themed(tree, DARK))
    assert DARK.shown(color) in text
    assert DARK.faint in text
    assert themed(tree, LIGHT) == tree
    assert css_color(color) == f"var(--pv-{color[1:].lower()}, {color})"
