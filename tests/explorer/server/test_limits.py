"""Counting: buckets and reports."""

from __future__ import annotations

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.server.buckets import Bucket
from paminsa_viz.explorer.server.reports import Reports


@given(st.floats(1, 1000), st.floats(0, 1000), st.lists(st.floats(0, 50), max_size=60))
def test_who_waits_as_told_never_gets_more_than_rate_and_burst(
    rate: float, burst: float, takes: list[float]
) -> None:
    bucket = Bucket(rate, burst, 0.0)
    now = taken = 0.0
    for tokens in takes:
        now += bucket.take(tokens, now)
        taken += tokens
        assert taken <= (burst + rate * now) * (1 + 1e-9) + 1e-6


def test_repeated_reports_fall_silent(caplog: pytest.LogCaptureFixture) -> None:
    report = Reports()
    with caplog.at_level(logging.WARNING):
        for i in range(1000):
            report(f"line {i}", ValueError("why"))
    assert "line 0" in caplog.text
    assert "left out" in caplog.text
    assert len(caplog.records) < 20
