"""Non-public names of viser: without one of them the page loses a feature and goes on."""

from __future__ import annotations

import asyncio
import logging
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from viser import _messages

from paminsa_viz.explorer.browser import bridge as bridges
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.page import has_graphics_card
from tests.support.chromium import Tab, until

HIDDEN = """(path) => {
  // Whoever asks for the object through its global name does not find the hidden members.
  const [root, ...members] = path.split(".");
  const without = (target, [names, ...deeper]) => new Proxy(target, {
    get: (from, key) => {
      if (!names.split("|").includes(key)) {
        const value = from[key];
        return typeof value === "function" && !/^(class|function [A-Z])/.test(String(value))
          ? value.bind(from) : value;
      }
      return deeper.length && from[key] ? without(from[key], deeper) : undefined;
    },
    set: (from, key, value) => { from[key] = value; return true; },
  });
  let real;
  Object.defineProperty(window, root, {
    configurable: true,
    get: () => real && (members.length ? without(real, members) : undefined),
    set: (value) => { real = value; },
  });
}"""


WITHOUT_LINKS = """{
  const write = history.replaceState.bind(history);
  history.replaceState = (state, title, url) => write(state, title, String(url).split("#")[0]);
}"""
"""Takes what follows the # from the address whenever that is written."""


def hidden(name: str) -> str:
    """Return a script that hides a name, ``|`` between several members of the same object."""
    return f"({HIDDEN})({name!r})"


PACKAGE = Path(bridges.__file__).parents[2]
NOT_PUBLIC = re.compile(r"\._impl\b|_websock|viser\._|__viser|[Mm]antine|_fullLayout|js-plotly")


def test_scripts_are_told_the_places_of_the_scene() -> None:
    """They stand once, where the scene is built; a path of a page's address ends with a name."""
    scripts = (PACKAGE / "explorer" / "browser").glob("*.js")
    found = {
        path.name: re.findall(r"[\"'`](/[a-z_]+/[a-z_/]*)[\"'`]", path.read_text())
        for path in scripts
    }
    assert {name: paths for name, paths in found.items() if paths} == {}


@pytest.mark.slow
def test_only_browser_and_server_know_names_that_are_not_public() -> None:
    # the model has no page, and another library's `_impl`
    allowed = [PACKAGE / name for name in ("explorer/browser", "explorer/server", "model")]
    found = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        if not any(folder in path.parents for folder in allowed)
        and NOT_PUBLIC.search(path.read_text(encoding="utf-8"))
    }
    assert found == set()


def test_style_sheets_have_the_forms_that_safari_knows() -> None:
    """It takes `text-decoration` for a line alone, and `user-select` with its prefix."""
    for sheet in (PACKAGE / "explorer" / "browser").glob("*.css"):
        text = sheet.read_text(encoding="utf-8")
        assert set(re.findall(r"text-decoration: ([^;]*)", text)) <= {"underline"}, sheet.name
        selects = re.findall(r"(?<!-)user-select: [^;]*;", text)
        assert re.findall(r"-webkit-(user-select: [^;]*;)", text) == selects, sheet.name


def test_style_sheets_have_no_selector_that_looks_down() -> None:
    # With `:has()` every frame of a drag costs a fifth more; marks.js is there for it.
    sheets = (PACKAGE / "explorer" / "browser").glob("*.css")
    assert [
        path.name
        for path in sheets
        if ":has(" in re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
    ] == []


WITHOUT = {
    "page": [hidden("__viserMutable")],
    "messages": [hidden("__viserMutable.sendMessage")],
    # None of the first three is needed to come to another; the charts that the last but one
    # names are not open yet.
    "canvas, rendering, links": [
        hidden("__viserMutable.canvas|backgroundMaterial|requestRender"),
        hidden("__viserTestpoints"),
        hidden("paminsaReconnect"),
        WITHOUT_LINKS,
    ],
    "scene": [hidden("__viserMutable.scene.__r3f")],
}


class LackingPage:
    """A page that lacks names, others at each load; to load it again costs half of a new one.

    Args:
        browser: Where.
        app: The explorer.
    """

    def __init__(self, browser: Any, app: Any) -> None:
        self._context = browser.new_context(viewport={"width": 1280, "height": 720})
        self._app = app
        self._tab: Tab | None = None

    def load(self, lacking: str) -> Tab:
        """Load it without what one of `WITHOUT` hides."""
        if self._tab is None:
            page = self._context.new_page()
            for key, scripts in WITHOUT.items():
                wanted = f"(sessionStorage.lacking ?? {lacking!r}) === {key!r}"
                page.add_init_script(f"if ({wanted}) {{ {';'.join(scripts)} }}")
            self._tab = Tab(page, self._app)
        else:
            self._tab.page.evaluate("key => { sessionStorage.lacking = key; }", lacking)
            self._tab.reload()
        return self._tab

    def close(self) -> None:
        """Close it; nothing may have gone wrong."""
        self._context.close()
        assert self._tab is None or self._tab.errors == []


@pytest.fixture(scope="module")
def lacking_page(browser: Any, app: Any) -> Iterator[LackingPage]:
    page = LackingPage(browser, app)
    yield page
    page.close()


@pytest.fixture(autouse=True)
def forget_reports() -> Iterator[None]:
    """A name is reported once in a program's life."""
    bridges._report_once.cache_clear()
    yield
    bridges._report_once.cache_clear()


@pytest.mark.browser
@pytest.mark.parametrize(
    ("lacking", "features"),
    [
        ("page", ["messages"]),
        ("messages", ["messages"]),
        (
            "canvas, rendering, links",
            [
                "graphics card",
                "background",
                "rendering on demand",
                "links in the address",
                "connecting again",
            ],
        ),
        ("scene", ["rendering on demand"]),
    ],
    ids=list(WITHOUT),
)
def test_page_without_a_name_works_and_reports_it(
    lacking_page: LackingPage, lacking: str, features: list[str],
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    if "messages" in features:  # none comes, however long the page is waited for
        monkeypatch.setattr(bridges, "HELLO_TIMEOUT", 1.0)
    monkeypatch.setattr(bridges, "MISSING_AFTER", 1.0)
    tab = lacking_page.load(lacking)
    tab.page.get_by_role("slider").first.focus()
    before = tab.state.document.pose
    tab.page.keyboard.press("ArrowRight")
    until(lambda: tab.state.document.pose != before, "the slider moves the robot")
    for feature in features:
        until(lambda: feature in caplog.text, f"{feature} is reported missing")  # noqa: B023
    assert tab.errors == []


def opened_bridge(gui: Any) -> tuple[Bridge, list[tuple[str, Any]]]:
    """Return an open bridge to a GUI, and the messages that it has delivered."""
    client: Any = SimpleNamespace(gui=gui)
    bridge, received = Bridge(client), []
    for kind in ("hello", "shown"):
        bridge.on(kind, lambda data, kind=kind: received.append((kind, data)))
    bridge.open()
    return bridge, received


def fake_gui(**inputs: Any) -> Any:
    """Return the part of viser's GUI that a bridge uses; its inputs may lack their ``uuid``."""
    box = SimpleNamespace(on_update=lambda _: None, value="", **inputs)
    channel = SimpleNamespace(queue_message=lambda _: None)
    return SimpleNamespace(add_text=lambda *_, **__: box, _websock_interface=channel)


@pytest.mark.parametrize(
    ("inputs", "scripts", "missing"),
    [
        ({"_impl": SimpleNamespace(uuid="u")}, False, "RunJavascriptMessage"),
        ({}, True, "messages from the page"),
        ({"_impl": SimpleNamespace()}, True, "messages from the page"),
    ],
    ids=["no scripts", "no input", "no uuid"],
)
def test_page_that_cannot_answer_is_built_at_once(
    inputs: dict[str, Any], scripts: bool, missing: str, monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    if not scripts:
        monkeypatch.delattr(_messages, "RunJavascriptMessage")
    with caplog.at_level(logging.WARNING):
        bridge, received = opened_bridge(fake_gui(**inputs))
    assert received == [("hello", None), ("shown", None)]
    assert missing in caplog.text
    bridge.call("showTime", "motion", 1.0)
    bridge.save("{}")


def test_a_message_that_cannot_be_taken_stops_no_other(caplog: pytest.LogCaptureFixture) -> None:
    gui, taken = fake_gui(_impl=SimpleNamespace(uuid="u")), []
    bridge = Bridge(SimpleNamespace(gui=gui))  # type: ignore[arg-type]
    bridge.on("tabs", lambda _: [][0])
    bridge.on("tabs", taken.append)
    bridge.on("click", taken.append)
    bridge._inbox.value = '[[1, "tabs", "a"], [2, "click", "b"]]'
    with ThreadPoolExecutor(1) as thread:  # a browser's tests leave a loop running in this one
        thread.submit(asyncio.run, bridge._receive(SimpleNamespace(client=object()))).result()
    assert taken == ["a", "b"]
    assert "could not be taken: tabs" in caplog.text


@pytest.mark.parametrize(
    "names", [None, 3, "x", {"a": 1}, [], ["same"] * 100], ids=lambda n: str(n)[:9]
)
def test_page_cannot_flood_the_log_with_reports(
    names: Any, caplog: pytest.LogCaptureFixture
) -> None:
    report: Callable[[Any], None] = bridges._report_missing
    for _ in range(3):
        report(names)
    assert len(caplog.records) == (1 if isinstance(names, list) and names else 0)


@pytest.mark.parametrize(
    ("renderer", "card"),
    [
        ("ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 Direct3D11 vs_5_0 ps_5_0, D3D11)", True),
        ("Apple M2", True),
        ("ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)", False),
        ("llvmpipe (LLVM 15.0.7, 256 bits)", False),
        ("", False),
        (None, False),
    ],
)
def test_software_renderers_are_not_graphics_cards(renderer: object, card: bool) -> None:
    assert has_graphics_card(renderer) is card
