"""Random use of all inputs of several pages reports no error; see `tests.support.monkey`."""

from __future__ import annotations

import logging
import threading

import pytest

from tests.support.monkey import Reports, run


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Queued a:UserWarning")  # viser's, of what nobody receives
def test_random_use_reports_no_error() -> None:
    monkey, reports = run(seed=4, seconds=20.0, pages=2, most=150)
    assert reports.found == []
    assert len(monkey.sent) >= 4


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_errors_are_heard_from_logs_and_threads() -> None:
    def fail() -> None:
        raise RuntimeError("broken")

    reports = Reports()
    with reports.listening():
        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
        logging.getLogger("any").warning("no error")
        try:
            fail()
        except RuntimeError:
            logging.getLogger("any").exception("said")
    assert ["broken" in text and "Traceback" in text for text in reports.found] == [True, True]
