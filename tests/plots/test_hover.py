"""Hover texts and axes over the maps."""

from __future__ import annotations

import json
from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.hover import REASON_CELLS, HoverFigure, emptiness, reasons
from paminsa_viz.plots.map_layout import map_layout
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.ranges import choose_scales
from tests.plots.samples import made_up, real

WIDTH = 800


def unpacked(packed: dict[str, str]) -> np.ndarray:
    numbers = np.frombuffer(b64decode(packed["bdata"]), dtype="<f4")
    if "shape" in packed:
        numbers = numbers.reshape([int(size) for size in packed["shape"].split(",")])
    return numbers


def tree_of(data: MapData) -> dict[str, Any]:
    """Return the figure as the page gets it."""
    layout = map_layout(data, choose_scales(data), WIDTH, 11)
    return json.loads(HoverFigure(data, layout, "here").to_json())


@pytest.fixture(scope="module")
def data() -> MapData:
    return real(200, theta=0.6)


@pytest.fixture(scope="module")
def tree(data: MapData) -> dict[str, Any]:
    return tree_of(data)


def test_values_are_those_of_the_map(data: MapData, tree: dict[str, Any]) -> None:
    assert tree["layout"]["meta"] == "here"  # comes back with clicks
    for panel, trace in enumerate(tree["data"][1::2]):
        np.testing.assert_allclose(unpacked(trace["z"]), data.values[panel], rtol=1e-6)
        for axis in ("x", "y"):
            np.testing.assert_allclose(unpacked(trace[axis]), 1e3 * getattr(data, axis), rtol=1e-6)
        assert f"{data.names[panel]} = %{{z:.4~g}} N·m" in trace["hovertemplate"]
        assert "θ" in trace["hovertemplate"]


def test_every_masked_cell_says_why(data: MapData, tree: dict[str, Any]) -> None:
    step = -(-200 // REASON_CELLS)
    picked = slice(step // 2, None, step)
    assert data.leg is not None
    status, leg = data.status[picked, picked], data.leg[picked, picked]
    words = np.array(tree["data"][0]["text"])
    assert ((words == "") == (status == 0)).all()
    stretched = (status == Limit.STRETCHED) & (leg == 1)
    assert stretched.any()
    assert set(words[stretched]) == {"out of reach: leg 2 over-stretched"}


def test_axes_lie_where_the_picture_has_its_panels(data: MapData, tree: dict[str, Any]) -> None:
    layout = map_layout(data, choose_scales(data), WIDTH, 11)
    for number, panel in zip(("", "2", "3"), layout.panels, strict=True):
        x, y = tree["layout"][f"xaxis{number}"], tree["layout"][f"yaxis{number}"]
        across, up = np.array(x["domain"]) * layout.width, np.array(y["domain"])
        np.testing.assert_allclose(across, [panel.left, panel.right], atol=1e-6)
        np.testing.assert_allclose(layout.height * (1 - up), [panel.bottom, panel.top], atol=1e-6)
        np.testing.assert_allclose(x["range"] + y["range"], 1e3 * np.array(data.extent))


def test_huge_values_are_no_gaps() -> None:
    huge = made_up(values=np.full((3, 27, 31), 1e40))
    shown = unpacked(tree_of(huge)["data"][1]["z"])
    assert np.isfinite(shown[huge.status == 0]).all()


def test_every_limit_has_a_reason() -> None:
    assert len({limit.reason(1) for limit in Limit}) == len(Limit)
    data = made_up(leg=None)
    assert set(reasons(data, 0)[data.status != 0]) == {"out of reach: a leg over-stretched"}


@pytest.mark.parametrize(
    ("code", "text"),
    [
        (Limit.OK, "no value here"),
        (Limit.STRETCHED, "nothing reachable here"),
        (Limit.SINGULAR, "singular everywhere"),
    ],
)
def test_an_empty_map_says_why(code: Limit, text: str) -> None:
    nothing, status = np.full((3, 27, 31), np.nan), np.full((27, 31), code, np.uint8)
    assert emptiness(made_up(values=nothing, status=status), 0) == text
    assert emptiness(made_up(), 0) == ""
