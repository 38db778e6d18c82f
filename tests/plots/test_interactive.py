"""The interactive figure of a notebook: data, colors, hover, and valid JSON."""

from __future__ import annotations

import json
import pickle
from typing import Any

import numpy as np
import plotly.io
import pytest

from paminsa_viz.plots.interactive import WITHOUT_SCRIPT, interactive_map
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.units import number
from tests.plots.samples import OWN, SCALE, made_up, real


def traces(figure: Any, kind: str) -> list[Any]:
    """Return all traces of a kind."""
    return [trace for trace in figure.data if trace.type == kind]


@pytest.mark.slow
def test_cells_show_values_in_display_units_or_why_there_is_none() -> None:
    data = made_up()
    cells = traces(interactive_map(data, SCALE), "heatmap")
    assert [trace.xaxis for trace in cells] == ["x", "x", "x2", "x2", "x3", "x3"]
    for values, shown, why in zip(data.values, cells[::2], cells[1::2], strict=True):
        assert shown.text == tuple([number(value) for value in row] for row in values)
        assert np.allclose(shown.x, data.x * 1000)
        assert np.allclose(shown.y, data.y * 1000)
        expected = np.clip(SCALE.position(values), -1, 2).astype(np.float32)
        assert np.array_equal(shown.z, expected, equal_nan=True)
        texts = np.array(why.text)
        assert (texts[data.status != 0] == "out of reach: leg 2 over-stretched").all()
        assert (texts[data.status == 0] == "").all()
        assert (np.isnan(why.z) == (data.status == 0)).all()
    lengths = made_up(panels=1, unit="m", names=("margin",))
    trace = traces(interactive_map(lengths, SCALE), "heatmap")[0]
    assert trace.text == tuple([number(1000 * value) for value in row] for row in lengths.values[0])
    assert "%{text} mm</b>" in trace.hovertemplate


@pytest.mark.slow
def test_hover_leaves_no_negative_number_to_a_format_that_writes_a_hyphen() -> None:
    figure = interactive_map(made_up(), SCALE)
    cells = traces(figure, "heatmap")
    assert not any(":" in trace.hovertemplate for trace in cells)
    assert {figure.layout.xaxis2.hoverformat, figure.layout.yaxis.hoverformat} == {".1f"}
    assert any(cell.startswith("−") for row in cells[0].text for cell in row)


@pytest.mark.slow
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


@pytest.mark.slow
def test_shared_or_own_color_axes() -> None:
    assert "coloraxis2" not in interactive_map(made_up(), SCALE).layout.to_plotly_json()
    figure = interactive_map(made_up(), OWN)
    assert {"coloraxis", "coloraxis2", "coloraxis3"} <= figure.layout.to_plotly_json().keys()
    used = [t.coloraxis for t in traces(figure, "heatmap") if t.coloraxis]
    assert used == ["coloraxis", "coloraxis2", "coloraxis3"]


@pytest.mark.slow
def test_the_marker_is_at_the_pose_in_every_panel() -> None:
    dots = [t for t in traces(interactive_map(made_up(), SCALE), "scatter") if t.mode == "markers"]
    assert {t.xaxis for t in dots} == {"x", "x2", "x3"}
    assert all((t.x[0], t.y[0]) == (50.0, -30.0) for t in dots)


@pytest.mark.slow
@pytest.mark.parametrize(
    "choice", [ScaleChoice(), ScaleChoice(kind="symlog")], ids=lambda c: c.kind
)
def test_infinite_and_missing_data_become_valid_json(choice: ScaleChoice) -> None:
    infinite, empty = made_up(panels=1).values.copy(), np.full((1, 27, 31), np.nan)
    infinite[0, 13, 15] = np.inf
    made = [made_up(panels=1, values=values) for values in (infinite, empty)]
    for data in (*made, real(21, quantities=("tau_1",))):
        text = interactive_map(data, choose_scales(data, choice)).to_json()
        json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


@pytest.mark.slow
@pytest.mark.parametrize("renderer", ["plotly_mimetype", "vscode"])
def test_a_notebook_gets_the_data_and_words_for_where_no_script_draws_them(
    renderer, monkeypatch
) -> None:
    """As IPython asks; nothing else is needed, and no network."""
    figure = interactive_map(made_up(), SCALE)
    monkeypatch.setattr(plotly.io.renderers, "default", renderer)
    with pytest.raises(NotImplementedError):  # IPython then takes the next kind of output
        figure._ipython_display_()
    found = figure._repr_mimebundle_()
    assert found.pop("application/vnd.plotly.v1+json")["data"]
    assert found == {"text/plain": WITHOUT_SCRIPT}
    assert figure._repr_html_() is None
    assert pickle.loads(pickle.dumps(figure)) == figure
