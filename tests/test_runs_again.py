"""What fails in a browser or with a server runs once more; the summary names it, and all costs."""

from __future__ import annotations

import pytest

SUITE = """
    import time

    import pytest

    tried = []

    @pytest.fixture(scope="session", autouse=True)
    def browser():
        yield
        started = time.process_time()
        while time.process_time() < started + 0.6:  # its end is no test's
            pass

    @pytest.fixture
    def server():
        return None

    def first_of(name):
        tried.append(name)
        return tried.count(name) == 1

    @pytest.mark.browser
    def test_of_luck():
        assert not first_of("luck"), "the page has died"

    @pytest.mark.browser
    def test_of_no_luck():
        assert False, "always"

    def test_of_a_thread(server):
        assert not first_of("thread"), "it did not happen"

    def test_of_a_number():
        assert not first_of("number")

    def test_last():
        assert tried == ["luck", "luck", "thread", "thread", "number"]
"""


@pytest.mark.slow
def test_only_what_waits_for_others_runs_again_once_and_is_named(pytester: pytest.Pytester) -> None:
    pytester.makepyprojecttoml('[tool.pytest]\nmarkers = ["browser: b", "slow: s"]\nstrict = true')
    pytester.makepyfile(test_suite=SUITE)
    arguments = ("-p", "tests.support.plugin", "-p", "no:cacheprovider", "-n", "0")
    result = pytester.runpytest_inprocess(*arguments)
    assert result.parseoutcomes() == {"passed": 3, "failed": 2, "rerun": 3}
    begin = "passed only when run again: test_suite.py::test_of_"
    said = [line for line in result.outlines if line.startswith("passed only when run again")]
    assert said == [
        f"{begin}luck: AssertionError: the page has died",
        f"{begin}a_thread: AssertionError: it did not happen",
    ]
    assert "processor time, without that of browsers: 3 not slow 0 s, 2 slow 0 s" in result.outlines
