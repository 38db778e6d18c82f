"""How the property tests draw their examples, the browser, and which tests run side by side.

``suite`` draws the same examples on every run, so that a failure can be repeated and a pass means
the same everywhere. ``pytest --hypothesis-profile explore`` draws many new ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.explorer.chromium import FLAGS, browser_path

_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large]

settings.register_profile(
    "suite",
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=15,
    suppress_health_check=_SLOW,
)
settings.register_profile(
    "explore", deadline=None, max_examples=400, print_blob=True, suppress_health_check=_SLOW
)
settings.load_profile("suite")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless browser."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = browser_path()
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=path, args=FLAGS)
        yield chromium
        chromium.close()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep the tests of a file together, and those in a browser one after the other.

    The browser comes first: it takes longest, and everything else can run beside it.
    """
    in_browser = {item: item.get_closest_marker("browser") is not None for item in items}
    items.sort(key=lambda item: not in_browser[item])
    for item in items:
        group = "browser" if in_browser[item] else str(item.path)
        item.add_marker(pytest.mark.xdist_group(group))
