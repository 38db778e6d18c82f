"""The guided tour: shown to newcomers once, beside what it explains, and driven by keys alone."""

from __future__ import annotations

from typing import Any

import pytest

from paminsa_viz.explorer.browser.tour import STEPS
from tests.support.chromium import UNDRAWN, until

pytestmark = pytest.mark.browser


@pytest.fixture
def newcomer(browser: Any, app: Any) -> Any:
    """The page of a newcomer; not one for reproducible pictures, where no tour starts."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.add_init_script(UNDRAWN)
    page.set_default_timeout(60_000)
    page.goto(f"{app.url}/#")  # as of a link without its code: it is an address too
    page.get_by_test_id("tour").wait_for()
    yield page
    context.close()


def walk(page: Any) -> None:
    """Go through the tour by keys; every step is beside what it explains, and on the page."""
    titles, size = [], page.viewport_size
    tour = page.get_by_test_id("tour")
    for number in range(len(STEPS)):
        titles.append(tour.locator("b").inner_text())
        assert f"{number + 1} of {len(STEPS)}" in tour.inner_text()
        page.wait_for_timeout(400)
        card, ring = (page.locator(each).bounding_box() for each in (".pv-tour", ".pv-tour-ring"))
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


OPACITIES = """() => {
  const covers = [...document.querySelectorAll(".pv-tour, .pv-tour-ring")];
  const seen = () => covers.map((cover) => getComputedStyle(cover).opacity).join();
  window.__seen = [seen()];
  const note = () => seen() === window.__seen.at(-1) || window.__seen.push(seen());
  const observer = new MutationObserver(note);
  for (const cover of covers) observer.observe(cover, {attributeFilter: ["class"]});
}"""
"""Notes the opacities of card and ring whenever they change."""


def hide_while_dragged(page: Any) -> None:
    """Drag by keys and by the pointer: card and ring leave the view to the robot until it rests."""
    page.evaluate(OPACITIES)

    def seen() -> Any:
        return page.evaluate("window.__seen")

    shown, hidden = "1,1", "0,0"
    slider = page.get_by_role("slider").first
    slider.press("Tab")
    slider.press("ArrowRight")
    until(lambda: len(seen()) == 3, "hidden and shown again, while a slider moves")
    view = page.locator("canvas[data-engine]").bounding_box()
    x, middle = view["x"] + 40, view["y"] + view["height"] / 2
    page.mouse.move(x, middle)
    page.mouse.move(x + 10, middle)
    page.wait_for_timeout(100)
    assert len(seen()) == 3, "nothing is dragged"
    page.mouse.down()
    page.mouse.move(x + 20, middle)
    page.mouse.up()
    until(lambda: len(seen()) == 5, "hidden and shown again, while the view turns")
    assert seen() == [shown, hidden, shown, hidden, shown]
    page.get_by_test_id("tour").get_by_role("button", name="Next").focus()


def test_tour_is_beside_what_it_explains_and_ends_for_good(newcomer: Any) -> None:
    page, tour = newcomer, newcomer.get_by_test_id("tour")
    hide_while_dragged(page)
    walk(page)
    page.set_viewport_size({"width": 1400, "height": 900})
    page.reload()
    page.get_by_test_id("status").wait_for()
    page.get_by_text("File", exact=True).first.click()
    again = page.get_by_role("button", name="Take the guided tour")
    again.wait_for()
    page.wait_for_timeout(500)
    assert tour.count() == 0
    again.press("Enter")
    tour.wait_for()
    walk(page)
    again.press("Enter")
    tour.wait_for()
    page.keyboard.press("ArrowRight")
    until(lambda: tour.locator("b").inner_text() == STEPS[1]["title"], "the second step")
    page.keyboard.press("ArrowLeft")
    until(lambda: tour.locator("b").inner_text() == STEPS[0]["title"], "the first step")
    page.keyboard.press("Escape")
    until(lambda: tour.count() == 0, "the tour is over")
