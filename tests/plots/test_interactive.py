"""The interactive figure of a notebook: data, colors, hover, and valid JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from paminsa_viz.plots.interactive import interactive_map
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import made_up, real

SCALE = Scale(-5.0, 5.0)


def traces(figure: Any, kind: str) -> list[Any]:
    """Return all traces of a kind."""
    return [trace for trace in figure.data if trace.type == kind]


def test_values_and_places_are_the_map_s() -> None:
    data = made_up()
    shown = [t for t in traces(interactive_map(data, SCALE), "heatmap") if t.customdata is not None]
    assert [trace.xaxis for trace in shown] == ["x", "x2", "x3"]
    for values, trace in zip(data.values, shown, strict=True):
        assert np.array_equal(trace.customdata, values.astype(np.float32), equal_nan=True)
        assert np.allclose(trace.x, data.x * 1000)
        assert np.allclose(trace.y, data.y * 1000)
        expected = np.clip(SCALE.position(values), -1, 2).astype(np.float32)
        assert np.array_equal(trace.z, expected, equal_nan=True)


def test_lengths_are_shown_in_mm() -> None:
    data = made_up(panels=1, unit="m", names=("margin",))
    trace = traces(interactive_map(data, SCALE), "heatmap")[0]
    expected = (data.values[0] * 1000).astype(np.float32)
    assert np.array_equal(trace.customdata, expected, equal_nan=True)
    assert "mm</b>" in trace.hovertemplate


def test_masked_cells_say_why() -> None:
    data = made_up()
    found = [t for t in traces(interactive_map(data, SCALE), "heatmap") if t.text is not None]
    assert len(found) == 3
    for trace in found:
        texts = np.array(trace.text)
        assert (texts[data.status != 0] == "out of reach: leg 2 over-stretched").all()
        assert (texts[data.status == 0] == "").all()
        assert (np.isnan(trace.z) == (data.status == 0)).all()


def test_the_color_scale_is_the_table_with_blocks_for_what_is_beyond() -> None:
    axis = interactive_map(made_up(), SCALE).layout.coloraxis
    stops = axis.colorscale
    assert (stops[0][1], stops[-1][1]) == SCALE.beyond
    where = [stop[0] for stop in stops]
    assert where == sorted(where)
    assert (where[0], where[-1]) == (0.0, 1.0)
    for position, color in ((0.0, SCALE.table[0]), (1.0, SCALE.table[-1])):
        share = (position - axis.cmin) / (axis.cmax - axis.cmin)
        nearest = [stop for stop in stops[2:-2] if abs(stop[0] - share) < 1e-9]
        expected = "rgb({},{},{})".format(*(255 * color).round().astype(int))
        assert nearest[0][1].replace(" ", "") == expected


def test_shared_or_own_color_axes() -> None:
    assert "coloraxis2" not in interactive_map(made_up(), SCALE).layout.to_plotly_json()
    own = [Scale(-1.0, 1.0), Scale(-2.0, 2.0), Scale(-3.0, 3.0)]
    figure = interactive_map(made_up(), own)
    assert {"coloraxis", "coloraxis2", "coloraxis3"} <= figure.layout.to_plotly_json().keys()
    used = [t.coloraxis for t in traces(figure, "heatmap") if t.customdata is not None]
    assert used == ["coloraxis", "coloraxis2", "coloraxis3"]


def test_the_marker_is_at_the_pose_in_every_panel() -> None:
    dots = [t for t in traces(interactive_map(made_up(), SCALE), "scatter") if t.mode == "markers"]
    assert {t.xaxis for t in dots} == {"x", "x2", "x3"}
    assert all((t.x[0], t.y[0]) == (50.0, -30.0) for t in dots)


def test_odd_data_become_valid_json() -> None:
    values = made_up().values.copy()
    values[0, 13, 15] = np.inf
    empty = made_up(values=np.full((3, 27, 31), np.nan), status=np.full((27, 31), 2, np.uint8))
    for data in (made_up(values=values), empty, real(21)):
        for choice in (ScaleChoice(), ScaleChoice(kind="symlog")):
            text = interactive_map(data, choose_scales(data, choice)).to_json()
            json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
