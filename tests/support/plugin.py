"""How property tests draw examples, which tests run side by side, and what every room can use.

The profile ``suite`` draws the same examples on every run, so that a failure can be repeated and a
pass means the same everywhere. ``pytest --hypothesis-profile explore`` draws many new ones.
"""

from __future__ import annotations

import importlib
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

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
def mujoco() -> Any:
    """The module."""
    return importlib.import_module("mujoco")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start with the browser, which takes longest: everything else can run next to it."""
    items.sort(key=lambda item: item.get_closest_marker("browser") is None)
    for item in items:
        if item.get_closest_marker("browser"):
            item.add_marker("slow")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Share the work by files, those of the page as one: two browsers would slow each other."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            path = nodeid.split("::", 1)[0]
            return "page" if "/test_page" in path else path

    return ByFile(config, log)
