"""The guided tour: shown to newcomers once, beside what it explains, and driven by keys alone."""

from __future__ import annotations

from typing import Any

import pytest

from paminsa_viz.explorer.browser.tour import STEPS
from tests.support.chromium import until

pytestmark = pytest.mark.browser


@pytest.fixture(params=[(1280, 720), (1400, 900)], ids=lambda size: str(size[0]))
def newcomer(browser: Any, app: Any, request: pytest.FixtureRequest) -> Any:
    """The page of a newcomer; not one for reproducible pictures, where no tour starts."""
    width, height = request.param
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.set_default_timeout(60_000)
    page.goto(app.url)
    page.get_by_test_id("tour").wait_for()
    yield page
    context.close()


def box(page: Any, selector: str) -> dict[str, float]:
    return page.locator(selector).bounding_box()


def test_tour_is_beside_what_it_explains_and_ends_for_good(newcomer: Any) -> None:
    page, titles = newcomer, []
    tour = page.get_by_test_id("tour")
    size = page.viewport_size
    for number in range(len(STEPS)):
        titles.append(tour.locator("b").inner_text())
        assert f"{number + 1} of {len(STEPS)}" in tour.inner_text()
        page.wait_for_timeout(400)
        card, ring = box(page, ".pv-tour"), box(page, ".pv-tour-ring")
        apart = (
            card["x"] + card["width"] <= ring["x"]
            or ring["x"] + ring["width"] <= card["x"]
            or card["y"] + card["height"] <= ring["y"]
            or ring["y"] + ring["height"] <= card["y"]
        )
        assert apart, titles[-1]
        assert card["x"] >= 0
        assert card["y"] >= 0
        assert card["x"] + card["width"] <= size["width"]
        assert card["y"] + card["height"] <= size["height"]
        page.keyboard.press("Enter")
    assert titles == [step["title"] for step in STEPS]
    until(lambda: tour.count() == 0, "the tour is over")
    page.reload()
    page.get_by_test_id("status").wait_for()
    page.get_by_role("tab", name="File", exact=True).click()
    again = page.get_by_role("button", name="Take the guided tour")
    again.wait_for()
    page.wait_for_timeout(500)
    assert tour.count() == 0
    again.press("Enter")
    tour.wait_for()
    page.keyboard.press("ArrowRight")
    until(lambda: tour.locator("b").inner_text() == STEPS[1]["title"], "the second step")
    page.keyboard.press("ArrowLeft")
    until(lambda: tour.locator("b").inner_text() == STEPS[0]["title"], "the first step")
    page.keyboard.press("Escape")
    until(lambda: tour.count() == 0, "the tour is over")
