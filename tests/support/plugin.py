"""How property tests draw examples, which tests run side by side, what they cost, and what every
subpackage's tests can use.

The profile ``suite`` draws the same examples on every run, so that a failure can be repeated and a
pass means the same everywhere. ``pytest --hypothesis-profile explore`` draws many new ones.
"""

from __future__ import annotations

import gc
import importlib
import os
from collections.abc import Generator, Iterator
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.support import page

# before numpy is imported: threads of small linear algebra wait for each other, and for those of
# the tests on the other cores
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large]

settings.register_profile(
    "suite",
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=10,
    suppress_health_check=_SLOW,
)
settings.register_profile(
    "explore", deadline=None, max_examples=400, print_blob=True, suppress_health_check=_SLOW
)
settings.load_profile("suite")


@pytest.fixture(scope="session")
def mujoco() -> Any:
    """The module."""
    return importlib.import_module("mujoco")


@pytest.fixture(scope="session")
def parsers_made_once() -> Iterator[None]:
    """Have tyro make the parser of a command once: that takes most of the time of a refusal.

    Where a version of tyro has moved what makes them, they are made anew.
    """
    made: dict[Any, Any] = {}

    def make_once(kind: Any, **options: Any) -> Any:
        if options.get("intern_prefix") != "" or options.get("parent_classes"):
            return make(kind, **options)  # a part of one
        key = kind, repr(options)
        if key not in made:
            made[key] = make(kind, **options)
        return made[key]

    with pytest.MonkeyPatch.context() as patch:
        with suppress(ImportError, AttributeError):
            parsers = importlib.import_module("tyro._parsers").ParserSpecification
            make = parsers.from_callable_or_type
            patch.setattr(parsers, "from_callable_or_type", staticmethod(make_once))
        yield


@pytest.fixture
def report_of_the_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out of reports what takes long and does not depend on the motion."""
    from paminsa_viz.blocks import requirements
    from paminsa_viz.report import page
    from paminsa_viz.report.request import Section

    monkeypatch.setattr(requirements, "TIME_LIMIT", 0.2)

    for key in ("workspace", "maps", "forces", "stiffness", "accuracy"):
        monkeypatch.setattr(page, f"{key}_section", lambda _, key=key: Section(key, key, ()))


@pytest.fixture(scope="module")
def built_in_few_rounds() -> Iterator[None]:
    """Look in few rounds at whether robots can be built, where how exactly is not the point."""
    from paminsa_viz.synthesis.search import extremes
    from paminsa_viz.synthesis.search.buildability import buildability

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(extremes, "ROUNDS", 4)
        yield
    kept: Any = buildability
    kept.__wrapped__.cache_clear()  # other modules ask for all rounds


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make reports with empty pictures, where what is drawn is not the point."""
    from paminsa_viz.blocks.kinds import Figure

    monkeypatch.setattr(Figure, "svg", b"")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Run long tests first, those in a browser before all: at the end no worker waits for one.

    A test in a browser or with a server, which wait for other processes and threads, runs once more
    if it fails, but in a debugger; the summary names it.
    """
    for item in items:
        in_browser = item.get_closest_marker("browser") is not None
        if in_browser:
            item.add_marker("slow")
        if (in_browser or "server" in item.fixturenames) and not config.getoption("usepdb"):
            item.add_marker(pytest.mark.flaky(reruns=1))
    long_files = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(
        key=lambda item: (
            not _in_browser(item.nodeid),
            not _compiles(item.nodeid),
            item.path not in long_files,
        )
    )


_STARTED = pytest.StashKey[tuple[float, int]]()
_LAST_ENDED = pytest.StashKey[float]()
_COST = "processor_s"
_PAGES = "pages"


def _processor_time() -> float:
    """Time of this process and of those that it has waited for [s]; a browser is none of them."""
    return sum(os.times()[:4])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Note when a try of a test begins."""
    item.user_properties[:] = [one for one in item.user_properties if one[0] not in (_COST, _PAGES)]
    item.stash[_STARTED] = _processor_time(), page.opened


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """Leave out of the last test's price what ends after it with all tests: the browser."""
    if nextitem is None:
        item.stash[_LAST_ENDED] = _processor_time()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> None:
    """Note what a test has cost, in the report of its end, which comes from every worker."""
    if call.when == "teardown":
        started, pages = item.stash[_STARTED]
        ended = item.stash.get(_LAST_ENDED, _processor_time())
        item.user_properties.append((_COST, ended - started))
        item.user_properties.append((_PAGES, page.opened - pages))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Print the list price, of each kind of tests, and what passed only when run again, and why."""
    cost: dict[str, dict[str, float]] = {"not slow": {}, "slow": {}}
    pages = 0
    for report in terminalreporter.getreports(""):
        noted = dict(report.user_properties)
        if _COST in noted:
            tests = cost["slow" if "slow" in report.keywords else "not slow"]
            tests[report.nodeid] = tests.get(report.nodeid, 0) + noted[_COST]
            pages += noted[_PAGES]
    said = [f"{len(each)} {kind} {sum(each.values()):.0f} s" for kind, each in cost.items()]
    terminalreporter.write_line(f"processor time, without that of browsers: {', '.join(said)}")
    terminalreporter.write_line(f"pages opened in a browser: {pages}")
    lost = {one.nodeid for kind in ("failed", "error") for one in terminalreporter.getreports(kind)}
    for first in terminalreporter.getreports("rerun"):
        if first.nodeid not in lost:
            crash = getattr(first.longrepr, "reprcrash", None)
            reason = crash.message if crash else str(first.longrepr)
            terminalreporter.write_line(
                f"passed only when run again: {first.nodeid}: {reason.splitlines()[0]}", yellow=True
            )


_BROWSER_FILES = ("/test_page", "/test_browser_names", "/test_html_pages", "/test_one_file")


def _in_browser(nodeid: str) -> bool:
    """Whether a test is in a file that is about a page in a browser."""
    return any(name in nodeid for name in _BROWSER_FILES)


_COMPILING = (
    "tests/blocks/test_subjects.py",
    "tests/blocks/test_units.py",
    "tests/clearance/test_clearance.py",
)
"""Files that would be the first to simulate or to measure distances, each on a worker of its own:
what is compiled for that takes 25 s and lies on disk afterwards. They run one after the other,
before others need it."""


def _compiles(nodeid: str) -> bool:
    return nodeid.startswith(_COMPILING)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Generator[None, Any, Any]:
    """Spare the garbage collector what is imported and collected: it stays until the end."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Share the work by files, those of a browser as one, which shares a browser and a page.

    Those that compile what others load are one as well.
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            path = nodeid.split("::", 1)[0]
            if _in_browser(path):
                return "browser"
            return "compiling" if _compiles(path) else path

    return ByFile(config, log)
