"""The registry of figure formats: one entry is enough for files, page and command line."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from paminsa_viz.cli import main
from paminsa_viz.errors import InvalidInput
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.export.tab import export_entries
from paminsa_viz.explorer.kit.entries import ButtonGroup, given
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.plots.formats import FIGURE_FORMATS, FigureFormat, check_size, figure_format
from paminsa_viz.plots.map_figure import render_maps
from paminsa_viz.plots.scale import Scale
from tests.plots.samples import made_up


@pytest.fixture
def jpeg(monkeypatch: pytest.MonkeyPatch) -> str:
    """Register a new format and return its name."""
    monkeypatch.setitem(FIGURE_FORMATS, "jpg", FigureFormat("jpg", pixels=True))
    return "jpg"


@pytest.mark.slow
def test_a_registered_format_is_found_everywhere(jpeg: str, tmp_path: Path) -> None:
    file = exports.figure(initial_state(), MapStore(), jpeg)
    assert file.name.endswith(".jpg")
    drawn = tmp_path / "map.jpg"
    assert main(["map", "--cells", "20", "--dpi", "60", "--out", str(drawn)]) == 0
    direct = render_maps(made_up(panels=1), Scale(-5.0, 5.0), jpeg, dpi=60)
    groups = [entry for entry in export_entries(MapStore()) if isinstance(entry, ButtonGroup)]
    assert any("JPG" in given(entry.choices, initial_state()) for entry in groups)
    for content in (file.content, drawn.read_bytes(), direct):
        assert Image.open(BytesIO(content)).format == "JPEG"


def test_an_unknown_format_names_those_there_are() -> None:
    with pytest.raises(InvalidInput, match="png, svg, pdf") as caught:
        figure_format("gif")
    assert caught.value.argument == "format"


@pytest.mark.parametrize("name", FIGURE_FORMATS)
def test_pixels_are_limited_only_where_a_figure_is_made_of_them(name: str) -> None:
    if FIGURE_FORMATS[name].pixels:
        with pytest.raises(InvalidInput, match="pixels wide"):
            check_size(name, 1000.0, 2400.0)
    else:
        assert check_size(name, 1000.0, 2400.0).ending == f".{name}"
