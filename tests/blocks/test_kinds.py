"""Tables by columns and turned, numbers beside a heading, and results as plain data."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from paminsa_viz.blocks.data import plain, record
from paminsa_viz.blocks.kinds import (
    Cell,
    Figure,
    Row,
    Table,
    actuator_rows,
    aligned,
    heading,
    rows,
    series_figure,
    shown,
)
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.palette import ACTUATOR_COLORS
from paminsa_viz.plots import series_figure as plots
from paminsa_viz.trajectory import PRESET, analyze
from paminsa_viz.units import NONE, display_unit
from tests.blocks.test_units import value

TABLE = Table(
    ("a", "b", "c", "d"),
    (Row(("a0", "b0", "c0", "d0"), "marked", hint="own"), Row(("a1", "b1", "c1")), Row(("a2",))),
    "what", words=2, literal=True,
)  # fmt: skip


def test_columns_of_a_table_in_any_order() -> None:
    chosen = TABLE.columns(1, 3, 2)
    assert chosen.head == ("b", "d", "c")
    assert [row.cells for row in chosen.rows] == [("b0", "d0", "c0"), ("b1", "c1"), ()]
    assert [row.kind for row in chosen.rows] == ["marked", "plain", "plain"]
    assert [row.hint for row in chosen.rows] == ["own", "", ""]
    assert (chosen.words, chosen.caption, chosen.literal) == (1, "what", True)
    hinted = TABLE.columns(0, 1, hint=2)
    assert [row.hint for row in hinted.rows] == ["c0; own", "c1", ""]
    assert [row.cells for row in hinted.rows] == [("a0", "b0"), ("a1", "b1"), ("a2",)]
    assert hinted.words == 2
    assert [row.hint for row in TABLE.columns(0, hint=3).rows] == ["d0; own", "", ""]
    assert TABLE.columns(2).words == 0


def test_a_turned_table_has_its_rows_as_columns() -> None:
    turned = TABLE.turned(2, 1)
    assert turned.head == ("a", "a0", "a1", "a2")
    assert [row.cells for row in turned.rows] == [("c", "c0", "c1", ""), ("b", "b0", "b1", "")]
    assert (turned.words, turned.caption) == (1, "what")


def test_what_is_not_said_of_a_block_is_plain() -> None:
    table = Table(("", ""), rows(("x", "1"), ("y", "2")))
    assert (table.caption, table.words, table.literal) == ("", 1, False)
    assert table.rows == (Row(("x", "1")), Row(("y", "2")))
    (row, _) = table.rows
    assert (row.kind, row.color, row.hint, row.level) == ("plain", "", "", "")
    assert not table.marked
    for level in ("ok", "warn", "bad", "none"):
        assert Table(("",), (Row(("",)), Row(("",), level=level))).marked
    cell = Cell("text")
    assert (cell, cell.quantity, cell.hint, cell.kind) == ("text", "", "", "plain")
    assert np.isnan(cell.share)
    colored = actuator_rows(*(("x",),) * 4)
    assert [row.color for row in colored] == list(ACTUATOR_COLORS)


def test_a_figure_is_drawn_once_when_it_is_asked_for() -> None:
    drawn: list[bytes] = []

    def draw() -> bytes:
        drawn.append(b"<svg/>")
        return drawn[-1]

    figure = Figure(draw, "what it shows")
    assert not drawn
    assert base64.b64decode(figure.source.removeprefix("data:image/svg+xml;base64,")) == b"<svg/>"
    assert figure.svg == b"<svg/>"
    assert len(drawn) == 1
    assert (figure.caption, figure.half) == ("", False)


def test_a_figure_over_time_passes_on_what_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = analyze(APPENDIX_4, PRESET["arch"].build(APPENDIX_4.geometry).sample(5))
    asked: list[dict] = []
    monkeypatch.setattr(plots, "figure_bytes", lambda *a, **k: asked.append({"all": a, **k}) or b"")
    series_figure("pose", motion, "alt").draw()
    series_figure("torques", motion, "alt", reference=motion, title="t", caption=True).draw()
    one, other = asked
    common = {"format": "svg"}
    assert one == common | {"all": ("pose", motion), "reference": None, "title": None,
                            "caption": False}  # fmt: skip
    assert other == common | {"all": ("torques", motion), "reference": motion, "title": "t",
                              "caption": True}  # fmt: skip


@pytest.mark.parametrize("unit", ["m", "rad", "N", "1:%", "m:um", "1"])
def test_numbers_have_their_digits_and_the_unit_of_the_heading(unit: str) -> None:
    rng = np.random.default_rng(0)
    factor, text = display_unit(unit)
    assert heading("x", unit) == (f"x [{text}]" if text else "x")
    for digits in (3, 4):
        for size in 10.0 ** rng.uniform(-6.0, 8.0, 60):
            number = float(rng.choice([-1.0, 1.0])) * size / factor
            cell = shown(number, unit, digits)
            if digits == 3:
                assert shown(number, unit) == cell
            found, off = value(cell)
            whole = 10**digits <= size < 1e6
            assert abs(found - number * factor) <= (0.5 if whole else off * 1.001), (cell, number)
            mantissa = cell.partition("·")[0].lstrip("−").replace(".", "").lstrip("0")
            assert len(mantissa) == max(digits, len(str(round(size))) if whole else 0), cell
    assert shown(999_999 / factor, unit).endswith("999999")
    assert "·10" in shown(1.001e6 / factor, unit)


def test_aligned_numbers_have_the_decimals_of_the_largest() -> None:
    rng = np.random.default_rng(1)
    for digits in (3, 4):
        for scale in (3e-6, 1e-4, 0.03, 2.0, 5e3):
            values = scale * rng.uniform(-1.0, 1.0, 5)
            values[2] = scale * 0.95
            cells = aligned([*values, np.nan, np.inf], "m", digits)[:-1]
            assert cells[-1] == NONE
            decimals = {len(cell.partition(".")[2]) for cell in cells[:-1]}
            (count,) = decimals
            size = np.abs(values).max() * 1e3
            assert count == max(0, digits - 1 - int(np.floor(np.log10(size))))
            for cell, result in zip(cells[:-1], values, strict=True):
                shown_value = float(cell.replace("−", "-"))
                assert abs(shown_value - 1e3 * result) <= 0.5001 * 10.0**-count
    assert aligned([0.0, 0.0], "m") == ("0", "0")
    assert aligned([0.0012345], "m") == aligned([0.0012345], "m", 3) == ("1.23",)
    assert aligned([-9.4712e-9, 0.0, 2.5e-10], "m") == ("−9.47·10⁻⁶", "0", "2.5·10⁻⁷")


class Kind(Enum):
    ONE = "first"


@dataclass
class Part:
    size: float
    names: tuple[str, ...]


def test_results_are_plain_data() -> None:
    found = plain(
        {
            "kind": Kind.ONE, "array": np.array([[1.0, np.nan], [np.inf, 2.0]]),
            "count": np.int64(3), "path": Path("a") / "b", "part": Part(-np.inf, ("x", "y")),
            "nested": [(1, 2.5), None, True, "text"],
        }
    )  # fmt: skip
    assert found == {
        "kind": "first", "array": [[1.0, None], [None, 2.0]], "count": 3,
        "path": str(Path("a") / "b"), "part": {"size": None, "names": ["x", "y"]},
        "nested": [[1, 2.5], None, True, "text"],
    }  # fmt: skip
    assert type(found["count"]) is int
    assert plain(Part) is Part


def test_keys_of_data_name_an_attribute_with_its_unit() -> None:
    result = SimpleNamespace(noise=0.5, length_m=2.0, length=1.0, half_width=0.1)
    assert record(result, "noise_m", "length_m", "half_width_95", "length") == {
        "noise_m": 0.5, "length_m": 2.0, "half_width_95": 0.1, "length": 1.0,
    }  # fmt: skip
    for key in ("noise_mm", "other_m", "noise_m_s"):
        with pytest.raises(AttributeError, match=key):
            record(result, key)
