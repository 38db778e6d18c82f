"""What fails in a browser runs once more, and the summary names it and what tests have cost."""

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

    def first_of(name):
        tried.append(name)
        return tried.count(name) == 1

    @pytest.mark.browser
    def test_of_luck():
        assert not first_of("luck"), "the page has died"

    @pytest.mark.browser
    def test_of_no_luck():
        assert False, "always"

    def test_of_a_number():
        assert not first_of("number")

    def test_last():
        assert tried == ["luck", "luck", "number"]
"""


@pytest.mark.slow
def test_only_a_browsers_test_runs_again_once_and_is_named(pytester: pytest.Pytester) -> None:
    pytester.makepyprojecttoml('[tool.pytest]\nmarkers = ["browser: b", "slow: s"]\nstrict = true')
    pytester.makepyfile(test_suite=SUITE)
    arguments = ("-p", "tests.support.plugin", "-p", "no:cacheprovider", "-n", "0")
    result = pytester.runpytest_inprocess(*arguments)
    assert result.parseoutcomes() == {"passed": 2, "failed": 2, "rerun": 2}
    said = [line for line in result.outlines if line.startswith("passed only when run again")]
    assert said == [
        "passed only when run again: test_suite.py::test_of_luck: AssertionError: the page has died"
    ]
    assert "processor time, without that of browsers: 2 not slow 0 s, 2 slow 0 s" in result.outlines
