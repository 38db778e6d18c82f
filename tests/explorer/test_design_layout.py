"""Which of the design's numbers are offered, under which labels, over which ranges."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.panels.design_layout import GROUPS, base_range, fitted_range, round_up
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import PARAMETER, PARAMETERS, Parameter
from paminsa_viz.units import symbol_text
from tests.explorer.design_rows import ROWS


def test_every_number_of_a_design_is_offered_once() -> None:
    offered = [p.path for group in GROUPS for p in group.parameters]
    assert sorted(offered) == sorted(p.path for p in PARAMETERS)


def test_labels_tell_the_numbers_apart_and_are_short_enough_for_their_column() -> None:
    labels = [row.label for row in ROWS.values()]
    assert len(set(labels)) == len(labels)
    assert max(map(len, labels)) <= 18  # 97 px hold about that many
    for parameter in PARAMETERS:
        assert ROWS[parameter.path].label.startswith(symbol_text(parameter.symbol))


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda p: p.path)
def test_slider_reaches_appendix_4_and_only_possible_values(parameter: Parameter) -> None:
    path, shown = parameter.path, parameter.display
    low, high, step = base_range(parameter)
    default = shown.from_si(parameter.default)
    assert low <= default <= high
    steps = (default - low) / step if low <= 0 else default / step
    assert steps == pytest.approx(round(steps), abs=1e-6)  # it can be dragged back to it
    for end in (low, high):
        state = ROWS[path].apply(initial_state(), ROWS[path].parse(initial_state(), end))
        assert shown.from_si(state.document.design.value(path)) == end


@given(path=st.sampled_from(sorted(ROWS)), fraction=st.floats(0, 1))
def test_range_grows_to_a_typed_value_and_leaves_room(path: str, fraction: float) -> None:
    low, high, _ = base_range(PARAMETER[path])
    most = PARAMETER[path].display.from_si(PARAMETER[path].largest)
    value = low + fraction * (most - low)
    grown = fitted_range(path, (low, high), value)
    assert grown[0] <= value <= grown[1] <= most
    if low < 0:
        assert fitted_range(path, (low, high), 5 * low)[0] == 5 * low
    assert grown == (low, high) or value > high
    assert fitted_range(path, grown, value) == grown
    if high < value < most / 1.6:
        assert 1.2 < grown[1] / value < 2.3


@given(value=st.floats(1e-9, 1e9))
def test_rounding_up_gives_a_number_that_reads_well(value: float) -> None:
    up = round_up(value)
    assert value * (1 - 1e-9) <= up <= 1.51 * value
    assert len(f"{up:.10g}".split("e")[0].replace(".", "").strip("0")) <= 2
