"""Which of the design's numbers are offered, under which labels, over which ranges."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.bounds import largest
from paminsa_viz.explorer.panels.design_layout import GROUPS
from paminsa_viz.explorer.panels.number_row import Row, fitted_range, round_up
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import APPENDIX_4, PARAMETER, PARAMETERS
from paminsa_viz.units import symbol_text
from tests.explorer.design_rows import ROWS


def test_every_number_of_a_design_is_offered_once() -> None:
    offered = [row.path for group in GROUPS for row in group.rows]
    assert sorted(offered) == sorted(p.path for p in PARAMETERS)


def test_labels_tell_the_numbers_apart_and_are_short_enough_for_their_column() -> None:
    labels = [row.label for row in ROWS.values()]
    assert len(set(labels)) == len(labels)
    assert max(map(len, labels)) <= 18  # 97 px hold about that many
    for parameter in PARAMETERS:
        assert ROWS[parameter.path].label.startswith(symbol_text(parameter.symbol))


@pytest.mark.parametrize("row", ROWS.values(), ids=lambda row: row.path)
def test_a_slider_reaches_appendix_4_and_only_what_is_possible(row: Row) -> None:
    unit = PARAMETER[row.path].display
    default = unit.from_si(APPENDIX_4.value(row.path))
    assert row.low <= default <= row.high
    steps = (default - row.low) / row.step if row.low == 0 else default / row.step
    assert steps == pytest.approx(round(steps), abs=1e-6)  # it can be dragged back to it
    for end in (row.low, row.high):
        value = unit.to_si(end)
        design = actions.vary(initial_state(), {row.path: value}).document.design
        assert design.value(row.path) == value


@given(path=st.sampled_from(sorted(ROWS)), fraction=st.floats(0, 1))
def test_a_range_grows_to_what_is_typed_and_leaves_room(path: str, fraction: float) -> None:
    row, most = ROWS[path], PARAMETER[path].display.from_si(largest(path))
    value = row.low + fraction * (most - row.low)
    low, high = fitted_range(row, row.low, row.high, value)
    assert low <= value <= high <= most
    assert (low, high) == (row.low, row.high) or value > row.high
    assert fitted_range(row, low, high, value) == (low, high)
    if row.high < value < most / 1.6:
        assert 1.2 < high / value < 2.1


@given(value=st.floats(1e-9, 1e9))
def test_rounding_up_gives_a_number_that_reads_well(value: float) -> None:
    up = round_up(value)
    assert value * (1 - 1e-9) <= up <= 1.51 * value
    assert len(f"{up:.10g}".split("e")[0].replace(".", "").strip("0")) <= 2
