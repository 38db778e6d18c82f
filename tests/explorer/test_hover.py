"""What the pointer reads off the maps."""

from __future__ import annotations

import json
from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer import actions, maps
from paminsa_viz.explorer.maps import COARSE, FULL, MapStore
from paminsa_viz.explorer.panels.hover import REASON_CELLS, HoverFigure
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import Limit
from paminsa_viz.plots.live import screen_layout


def unpacked(packed: dict[str, str]) -> np.ndarray:
    numbers = np.frombuffer(b64decode(packed["bdata"]), dtype="<f4")
    if "shape" in packed:
        numbers = numbers.reshape([int(size) for size in packed["shape"].split(",")])
    return numbers


STORE = MapStore()


@pytest.fixture(scope="module")
def figure() -> tuple[Any, Any, dict[str, Any]]:
    """Maps, their layout, and the hover figure as the page gets it."""
    state = actions.move(initial_state(), theta=0.6)
    data = STORE.data(state, FULL)
    layout = screen_layout(data, STORE.scales(state, data), 800)
    return data, layout, json.loads(HoverFigure(data, layout, "here").to_json())


class TestHover:
    def test_values_are_those_of_the_map(self, figure: Any) -> None:
        data, _, tree = figure
        for panel in range(3):
            trace = tree["data"][2 * panel + 1]
            np.testing.assert_allclose(unpacked(trace["z"]), data.values[panel], rtol=1e-6)
            np.testing.assert_allclose(unpacked(trace["x"]), 1e3 * data.x, rtol=1e-6)
            np.testing.assert_allclose(unpacked(trace["y"]), 1e3 * data.y, rtol=1e-6)
            assert "N·m" in trace["hovertemplate"]
            assert "θ" in trace["hovertemplate"]

    def test_every_masked_cell_says_why(self, figure: Any) -> None:
        data, _, tree = figure
        step = -(-FULL // REASON_CELLS)
        picked = slice(step // 2, None, step)
        status, leg = data.status[picked, picked], data.leg[picked, picked]
        words = np.array(tree["data"][0]["text"])
        assert ((words == "") == (status == 0)).all()
        stretched = (status == Limit.STRETCHED) & (leg == 1)
        assert stretched.any()
        assert set(words[stretched]) == {"out of reach: over-stretched (leg 2)"}

    def test_axes_lie_where_the_picture_has_its_panels(self, figure: Any) -> None:
        data, layout, tree = figure
        for index, box in enumerate(layout.panels):
            number = "" if index == 0 else str(index + 1)
            x, y = tree["layout"][f"xaxis{number}"], tree["layout"][f"yaxis{number}"]
            np.testing.assert_allclose(
                np.array(x["domain"]) * layout.width, [box.left, box.right], atol=1e-6
            )
            np.testing.assert_allclose(
                layout.height * (1 - np.array(y["domain"])), [box.bottom, box.top], atol=1e-6
            )
            np.testing.assert_allclose(x["range"] + y["range"], 1e3 * np.array(data.extent))

    def test_it_says_whose_clicks_come_back(self, figure: Any) -> None:
        assert figure[2]["layout"]["meta"] == "here"

    def test_values_that_explode_are_no_gaps(self) -> None:
        state = initial_state()
        data = STORE.data(state, COARSE, ("max_torque",))
        values = np.where(data.status == 0, 1e40, np.nan)[None]
        huge = maps.replace(data, values=values)
        layout = screen_layout(huge, STORE.scales(state, data, ("max_torque",)), 400)
        tree = json.loads(HoverFigure(huge, layout, "n").to_json())
        assert np.isfinite(unpacked(tree["data"][1]["z"])[data.status == 0]).all()
