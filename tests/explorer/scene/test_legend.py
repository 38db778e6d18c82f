"""The legend over the 3D view: what it says of the floor map's colors and of the arrows."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.dimensions.layout import MAST_ANGLE, layout, plinth_outline
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.maps import COARSE, MapStore
from paminsa_viz.explorer.scene.actuators import FULL_LENGTH, arrow_scales, force_arrow
from paminsa_viz.explorer.scene.legend import (
    NO_LEGEND,
    Legend,
    SceneLegend,
    arrow_rows,
    color_bar,
    with_legend,
)
from paminsa_viz.explorer.scene.mechanism import gravity_arrows, mass_centers, newtons_per_bar
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.maps import RangeMode
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.model.reach import workspace_radius
from paminsa_viz.plots.scale import color_table
from tests.support.samples import with_knee

STORE = MapStore()


def showing(*layers: str) -> State:
    """Return a state away from home with only some layers."""
    return replace(actions.move(initial_state(), x=0.06, theta=0.4), layers=frozenset(layers))


def test_color_bar_names_quantity_range_and_colors() -> None:
    view = {"range_mode": RangeMode.MANUAL, "low": -2.5, "high": 7.5}
    state = showing().updated("map_view", quantity="tau_1", **view)
    data = STORE.data(state, COARSE, ("tau_1",))
    (scale,) = STORE.scales(state, data, ("tau_1",))
    bar = color_bar(data, scale)
    assert (bar.low, bar.high, bar.name) == ("−2.5", "7.5", "τ₁  [N·m]")
    table = color_table(scale)[1:257, :3]
    assert [bar.colors[0], bar.colors[-1]] == [
        "#{:02x}{:02x}{:02x}".format(*table[i]) for i in (0, -1)
    ]
    html = Legend((), bar).html
    assert all(color in html for color in (*bar.colors, bar.under, bar.over))


def numbers(text: str) -> list[float]:
    return [float(found) for found in re.findall(r"\d+\.?\d*", text)]


def test_torque_arrows_are_explained_by_the_scale_they_are_drawn_to() -> None:
    frame = compute(showing("torques"))
    (((*colors,), text),) = arrow_rows(frame)
    assert len(colors) == 4
    assert "static" in text
    torque, force = arrow_scales(frame.shown_design)
    _, newton_meters, millimeters, newtons = numbers(text)
    np.testing.assert_allclose([newton_meters, newtons], [torque, force], rtol=5e-3)
    assert millimeters == pytest.approx(1e3 * FULL_LENGTH)
    shaft = np.unique(np.round(force_arrow(1.0)[:, 2], 9))[-2]
    assert 1e3 * shaft == pytest.approx(millimeters)


def test_weights_are_explained_by_the_scale_they_are_drawn_to() -> None:
    frame = compute(showing("gravity"))
    ((_, text),) = arrow_rows(frame)
    points = mass_centers(frame.shown_design, frame.configuration)
    arrows = gravity_arrows(points, frame.shown_design.gravity)
    heaviest = int(points.mass.argmax())
    length = -np.diff(arrows[heaviest, :, 2])[0]
    per_bar = points.mass[heaviest] * frame.shown_design.gravity / length * 0.1
    assert newtons_per_bar(points, frame.shown_design.gravity) == pytest.approx(per_bar)
    assert numbers(text)[1] == pytest.approx(per_bar, rel=5e-3)


def test_only_what_is_seen_is_explained() -> None:
    assert arrow_rows(compute(showing("mesh", "labels"))) == ()
    assert arrow_rows(compute(showing("load"))) == ()  # no load acts
    loaded = actions.vary(showing("load"), {"load.force_x": 5.0})
    assert len(arrow_rows(compute(loaded))) == 1
    still, moving = (
        showing("joint_forces"),
        showing("joint_forces").updated("playback", following=True),
    )
    assert "at rest" in arrow_rows(compute(still))[0][1]
    assert "of the motion" in arrow_rows(compute(moving))[0][1]


def test_every_place_in_the_registry_is_a_function() -> None:
    state = replace(showing(), layers=frozenset(LAYERS))
    assert len(arrow_rows(compute(state))) >= 3


class Page:
    """Counts what is sent to the page."""

    def __init__(self) -> None:
        self.sent: list[str] = []

    def call(self, function: str, html: str) -> None:
        """Remember."""
        assert function == "showLegend"
        self.sent.append(html)


def test_page_gets_the_legend_when_it_changes_and_only_then() -> None:
    page: Any = Page()
    legend = SceneLegend(page)
    for state in (showing("torques"), actions.move(showing("torques"), x=0.02), showing()):
        legend.draw(compute(state), True)
    assert len(page.sent) == 2
    assert "static torques" in page.sent[0]
    assert page.sent[1] == ""
    assert legend.shown == NO_LEGEND


@pytest.mark.parametrize("size", [(200, 300), (720, 1280), (64, 64)])
def test_exported_view_has_the_legend_in_its_corner(size: tuple[int, int]) -> None:
    picture = np.full((*size, 3), 255, dtype=np.uint8)
    assert with_legend(picture, NO_LEGEND) is picture
    state = showing("floor_map")
    data = STORE.data(state, COARSE, ("tau_1",))
    bar = color_bar(data, STORE.scales(state, data, ("tau_1",))[0])
    found = with_legend(picture, Legend(((("#0072b2",), "static"),), bar))
    assert found.shape == picture.shape
    assert (picture == 255).all()
    rows, columns = np.nonzero((found != 255).any(axis=2))
    assert rows.min() > size[0] - 90 or size[0] < 90
    assert columns.min() < 20


def test_exported_color_bar_has_a_number_at_either_end() -> None:
    white = np.full((300, 500, 3), 255, dtype=np.uint8)
    state = showing("floor_map")
    data = STORE.data(state, COARSE, ("tau_1",))
    bar = color_bar(data, STORE.scales(state, data, ("tau_1",))[0])
    # Colors that are no letters' are white, so that the last line has the two numbers alone.
    blank = bar._replace(colors=("#ffffff",) * len(bar.colors), under="#ffffff", over="#ffffff")
    columns = np.nonzero((with_legend(white, Legend((), blank))[-33:] < 200).any(axis=(0, 2)))[0]
    assert columns[0] < 20
    assert columns[-1] > 250
    assert np.diff(columns).max() > 200  # the bar between them


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("base", [0.2, 0.35, 0.6])
def test_plinth_carries_the_workspace_and_the_mast_and_little_else(
    knee: KneeBranch, base: float
) -> None:
    geometry = with_knee(replace(APPENDIX_4.geometry, base_radius=base), knee)
    outline = plinth_outline(geometry)
    radius = np.hypot(*outline.T)
    assert radius.min() > workspace_radius(geometry)
    assert np.median(radius) < max(workspace_radius(geometry), 0.15) + 0.05
    turned = outline @ [np.cos(MAST_ANGLE), np.sin(MAST_ANGLE)]
    assert turned.max() > layout(geometry).mast_radius + 0.085  # half the foot of the mast
    along = np.diff(np.unwrap(np.arctan2(outline[:, 1], outline[:, 0])))
    assert (along > 0).all()  # star-shaped, counterclockwise
