"""Round numbers: they are round, they fit, and they are written as people write them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.plots import ticks

spans = st.floats(1e-12, 1e12)


def significant(value: float) -> str:
    """Return the digits of a number without its power of ten."""
    return f"{value:.10e}".split("e")[0].rstrip("0").rstrip(".")


@given(spans, st.integers(1, 30))
def test_a_step_is_round_and_makes_no_more_parts_than_asked(span: float, count: int) -> None:
    step = ticks.nice_step(span, count)
    assert significant(step) in {"1", "2", "2.5", "5"}
    assert span / step <= count * (1 + 1e-6)
    assert span / step >= count / 2.6


@given(spans)
def test_a_limit_is_round_and_holds_the_value(value: float) -> None:
    limit = ticks.nice_limit(value)
    assert value * (1 - 1e-6) <= limit <= 1.51 * value
    assert len(significant(limit)) <= 3


@given(spans)
def test_the_nearest_limit_is_not_far(value: float) -> None:
    assert value / 1.3 < ticks.nice_limit(value, nearest=True) < 1.3 * value


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3))
def test_multiples_are_all_inside_and_none_is_missing(low: float, step: float) -> None:
    high = low + 7.3 * step
    found = ticks.multiples(low, high, step)
    assert len(found) in (7, 8)
    assert low - 1e-6 * step <= found[0] < low + step
    assert high - step < found[-1] <= high + 1e-6 * step


@pytest.mark.parametrize(
    ("low", "high", "count", "step"),
    [(-20, 20, 8, 5), (-30, 30, 6, 10), (0, 25, 8, 5), (0, 0.225, 4, None), (-25, 25, 2, 25)],
)
def test_dividing_steps(low: float, high: float, count: int, step: float | None) -> None:
    assert ticks.dividing_step(low, high, count) == step
