"""Counting: rates, and lines of the log."""

from __future__ import annotations

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.server.limits import RateLimit, RepeatFilter


@given(st.floats(1, 1000), st.floats(0, 1000), st.lists(st.floats(0, 50), max_size=60))
def test_who_waits_as_long_as_asked_never_gets_more_than_rate_and_burst(
    rate: float, burst: float, amounts: list[float]
) -> None:
    limit = RateLimit(rate, burst)
    now = taken = 0.0
    for amount in amounts:
        now += limit.take(amount, now)
        taken += amount
        assert taken <= (burst + rate * now) * (1 + 1e-9) + 1e-6


def test_a_burst_is_free_and_comes_back_by_waiting() -> None:
    limit = RateLimit(rate=2.0, burst=4.0)
    assert [limit.take(1.0, 100.0) for _ in range(5)] == [0.0, 0.0, 0.0, 0.0, 0.5]
    assert limit.delay(1.0, 100.0) == 1.0
    assert limit.delay(4.0, 1000.0) == 0.0
    assert limit.delay(5.0, 1000.0) == 0.5


def test_repeated_reports_fall_silent(caplog: pytest.LogCaptureFixture) -> None:
    logger = logging.getLogger("tests.repeated_reports")
    logger.addFilter(RepeatFilter())
    for i in range(1000):
        logger.warning("line %d", i, exc_info=ValueError("why"))
    assert "line 0" in caplog.text
    assert "left out" in caplog.text
    assert len(caplog.records) < 20
