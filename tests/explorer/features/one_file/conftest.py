"""The page in one file, which its tests share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from paminsa_viz.explorer.core.persistence import share_code
from paminsa_viz.webpage import code_page
from tests.explorer.features.one_file.opened import START, Opened


@pytest.fixture(scope="package")
def opened(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    path = tmp_path_factory.mktemp("page") / "explorer.html"
    path.write_text(code_page(share_code(START)), encoding="utf-8")
    page = Opened(browser, path)
    yield page
    page.context.close()
    own = (page.address, "about:blank", "data:", "blob:")
    assert all(url.startswith(own) for url in page.requests)
    assert page.errors == []
