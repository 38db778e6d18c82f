"""Links in a browser: the address says the design, and a link opens it or says why not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from urllib.parse import unquote

import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.core.persistence import LONGEST_CODE, open_share_code, share_code
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import APPENDIX_4, PaminsaError
from tests.support.chromium import Tab, until

pytestmark = [pytest.mark.browser, pytest.mark.slow]

OTHER = Document(
    design=replace(APPENDIX_4.vary({"links.b3": 0.777, "payload.mass": 3.0}), name="Light, 3 kg"),
    pose=(0.05, -0.03, 0.4, -0.55),
    reference=APPENDIX_4,
)


def address(tab: Tab) -> Document | None:
    """Return what the address of a page says."""
    code = tab.page.evaluate("location.hash").removeprefix("#")
    try:
        return open_share_code(code)
    except PaminsaError:
        return None


def wait_followed(tab: Tab) -> None:
    """Wait until the address says what the page shows."""
    until(lambda: address(tab) == tab.state.document, "the address follows the work")


def test_copied_link_opens_the_design_its_section_and_its_map_elsewhere(
    tab: Tab, open_tab: Callable[..., Tab]
) -> None:
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.dispatch(lambda state: replace(state, document=OTHER))
    tab.open_tab("Stiffness")
    tab.open_tab("Single map")
    tab.dispatch(partial(choose_quantity, quantity="stiffness_z"))
    shown = ["section=Strength/Stiffness", "beside=Single map", "map=stiffness_z"]

    def parts(page: Tab) -> list[str]:
        return unquote(page.page.evaluate("location.hash")).split("&")[1:]

    until(lambda: parts(tab) == shown, "the address says what is shown")
    tab.open_tab("File")
    tab.click("Copy link")
    tab.page.get_by_text("Link: it opens this design").wait_for()
    link = tab.page.evaluate("navigator.clipboard.readText()")
    assert link.startswith(f"{tab.app.url}/#{share_code(OTHER)}&")
    tab.page.evaluate("navigator.clipboard.writeText('')")
    tab.page.keyboard.press("Control+Shift+l")
    until(lambda: tab.page.evaluate("navigator.clipboard.readText()") == link, "it is copied again")
    assert link.endswith(tab.page.evaluate("location.hash")), "the address is as good a link"
    # The tab's address has a query, with which viser drops what follows the #.
    code = link.partition("#")[2]
    other = open_tab(link=code)
    until(lambda: other.state.document == OTHER, "the link is opened")
    other.wait_platform(OTHER.pose)
    section = other.page.get_by_role("tab", name="Stiffness", exact=True)
    until(lambda: section.get_attribute("aria-selected") == "true", "the section is open")
    until(lambda: other.state.map_view.quantity == "stiffness_z", "the map")
    until(lambda: parts(other) == shown, "its address says the same")
    wait_followed(other)
    other.session.undo()
    until(lambda: other.state.document.design == APPENDIX_4, "undo goes back")
    wait_followed(other)
    other.open_tab("Path")
    until(lambda: parts(other)[0] == "section=Motion/Path", "the address follows")
    other.page.evaluate("link => { location.hash = link }", code)
    until(lambda: other.state.workspace == "Strength", "a link opens in an open page too")
    until(lambda: parts(other) == shown, "its address says so")


def test_address_follows_the_work_and_a_reload_keeps_more_than_it_says(tab: Tab) -> None:
    tab.press("x  [mm]", "ArrowRight", 3)
    tab.dispatch(lambda state: actions.set_layers(state, path=False))
    tab.wait_saved()
    wait_followed(tab)
    before, layers = tab.state.document, tab.state.layers
    assert "fixedDpr=1" in tab.page.url
    tab.reload()
    until(lambda: (tab.state.document, tab.state.layers) == (before, layers), "all is back")
    assert not tab.state.offered
    wait_followed(tab)


def test_reload_that_loads_the_address_before_is_no_link(tab: Tab) -> None:
    """A browser that reloads while the page writes its address may not know of the new one."""
    wait_followed(tab)
    before = tab.page.evaluate("location.hash")
    tab.press("x  [mm]", "ArrowRight", 3)
    tab.wait_saved()
    wait_followed(tab)
    work = tab.state.document
    tab.page.evaluate("hash => history.replaceState(history.state, '', hash)", before)
    tab.reload()
    until(lambda: tab.state.document == work, "the work is back")
    assert not tab.state.offered
    wait_followed(tab)


def test_link_in_a_tab_with_other_work_offers_that(tab: Tab) -> None:
    tab.dispatch(lambda state: actions.move(state, x=0.02))
    tab.wait_saved()
    wait_followed(tab)
    work = tab.state.document
    tab.open_link(share_code(OTHER))
    until(lambda: tab.state.document == OTHER, "the link is opened")
    until(lambda: tab.state.offered, "what was kept is offered")
    tab.click("Open it")
    until(lambda: tab.state.document == work, "the work is back")
    assert tab.page.evaluate("window.Plotly === undefined"), "it is sent with the first chart"


@pytest.mark.parametrize(
    ("link", "says"),
    [
        (share_code(OTHER)[:-30], "it is damaged or incomplete"),
        ("PMZ0-eJw", "it is from another version of paminsa_viz (packing 0)"),
        ("PMZ1-" + "A" * 5 * LONGEST_CODE, f"it is too long (at most {LONGEST_CODE:,} characters)"),
        ("PMZ1-%3Cscript%3Ealert(1)%3C/script%3E", "it is damaged or incomplete"),
    ],
    ids=["truncated", "older", "long", "hostile"],
)
def test_link_that_cannot_be_opened_says_why_in_one_line(tab: Tab, link: str, says: str) -> None:
    wait_followed(tab)
    before = tab.state.document
    known = tab.page.get_by_text(f"share code: {says}").count()
    tab.page.evaluate("code => { location.hash = code }", link)
    said = tab.page.get_by_text(f"share code: {says}")
    until(lambda: said.count() > known, "it is said")
    assert "\n" not in said.last.inner_text()
    assert tab.state.document == before
    wait_followed(tab)


def test_link_set_in_the_address_of_an_open_page_is_opened(tab: Tab) -> None:
    wait_followed(tab)
    tab.page.evaluate("code => { location.hash = code }", share_code(OTHER))
    until(lambda: tab.state.document == OTHER, "the link is opened")


def test_other_words_in_the_address_are_no_link(tab: Tab) -> None:
    wait_followed(tab)
    before, said = tab.state.document, tab.page.get_by_text("share code:").all_inner_texts()
    tab.page.evaluate("location.hash = 'torques'")
    tab.page.wait_for_timeout(500)
    assert tab.state.document == before
    assert set(tab.page.get_by_text("share code:").all_inner_texts()) <= set(said)
