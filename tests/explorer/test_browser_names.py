"""Non-public names of viser: without any one of them the page loses a feature, not its life."""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from viser import _messages

from paminsa_viz.explorer.browser import bridge as bridges
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.page import has_graphics_card
from tests.support.chromium import TIMEOUT, until

HIDDEN = """(path) => {
  // Whoever asks for the object through its global name does not find the hidden member.
  const [root, ...members] = path.split(".");
  const without = (target, [name, ...deeper]) => new Proxy(target, {
    get: (from, key) => {
      if (key !== name) { const value = from[key]; return typeof value === "function"
        && !/^(class|function [A-Z])/.test(String(value)) ? value.bind(from) : value; }
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


PACKAGE = Path(bridges.__file__).parents[2]
NOT_PUBLIC = re.compile(r"\._impl\b|_websock|viser\._|__viser|[Mm]antine|_fullLayout|js-plotly")


def test_only_two_folders_know_names_that_are_not_public() -> None:
    allowed = [PACKAGE / "explorer" / name for name in ("browser", "server")]
    found = {
        str(path.relative_to(PACKAGE))
        for path in PACKAGE.rglob("*.py")
        if not any(folder in path.parents for folder in allowed)
        and NOT_PUBLIC.search(path.read_text(encoding="utf-8"))
    }
    assert found == set()


@pytest.fixture(autouse=True)
def forget_reports() -> Iterator[None]:
    """A name is reported once in a program's life."""
    bridges._report_once.cache_clear()
    yield
    bridges._report_once.cache_clear()


@pytest.mark.browser
@pytest.mark.parametrize(
    ("name", "feature"),
    [
        ("__viserMutable", "messages"),
        ("__viserMutable.sendMessage", "messages"),
        ("__viserMutable.canvas", "graphics card"),
        ("__viserMutable.backgroundMaterial", "background"),
        ("__viserMutable.requestRender", "rendering on demand"),
        ("__viserMutable.scene.__r3f", "rendering on demand"),
        ("__viserTestpoints", None),  # the charts that it names are not open yet
    ],
)
def test_a_page_without_a_name_lives_and_reports_it(
    browser: Any, app: Any, name: str, feature: str | None, caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(bridges, "HELLO_TIMEOUT", 3.0)
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    errors: list[str] = []
    try:
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.add_init_script(f"({HIDDEN})({name!r})")
        known = set(app.sessions)
        page.goto(app.url + "?fixedDpr=1")
        number = until(lambda: set(app.sessions) - known, "a session for the tab").pop()
        session = app.sessions[number]
        assert session.built.wait(TIMEOUT)
        page.get_by_test_id("status").wait_for()
        slider = page.get_by_role("slider").first
        slider.focus()
        before = session.state.document.pose
        page.keyboard.press("ArrowRight")
        until(lambda: session.state.document.pose != before, "the slider moves the robot")
        if feature:
            until(lambda: feature in caplog.text, f"{feature} is reported missing")
        assert errors == []
    finally:
        context.close()


def _bridge(monkeypatch: pytest.MonkeyPatch, gui: Any) -> tuple[Bridge, list[tuple[str, Any]]]:
    bridge = Bridge(SimpleNamespace(gui=gui))  # type: ignore[arg-type]
    told: list[tuple[str, Any]] = []
    for kind in ("hello", "shown"):
        bridge.on(kind, lambda data, kind=kind: told.append((kind, data)))
    return bridge, told


class Gui:
    """The part of viser's GUI that a bridge uses; its inputs may lack their ``uuid``."""

    def __init__(self, **inputs: Any) -> None:
        self._inputs = inputs

    def add_text(self, *_: Any, **__: Any) -> Any:
        return SimpleNamespace(on_update=lambda _: None, value="", **self._inputs)


def test_without_a_way_to_run_scripts_the_page_is_built_at_once(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        monkeypatch.delattr(_messages, "RunJavascriptMessage")
        bridge, told = _bridge(monkeypatch, Gui(_impl=SimpleNamespace(uuid="u")))
        bridge.open()
    assert told == [("hello", None), ("shown", None)]
    assert "RunJavascriptMessage" in caplog.text
    bridge.call("showTime", "motion", 1.0)
    bridge.save("{}")


@pytest.mark.parametrize("inputs", [{}, {"_impl": SimpleNamespace()}])
def test_without_a_way_back_the_page_is_built_at_once(
    inputs: dict[str, Any], monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    gui = Gui(**inputs)
    gui._websock_interface = SimpleNamespace(queue_message=lambda _: None)  # type: ignore[attr-defined]
    with caplog.at_level(logging.WARNING):
        bridge, told = _bridge(monkeypatch, gui)
        bridge.open()
    assert told == [("hello", None), ("shown", None)]
    assert "messages from the page" in caplog.text


@pytest.mark.parametrize("names", [None, 3, "x", {"a": 1}, [], ["same"] * 100])
def test_reports_from_the_page_stay_few(names: Any, caplog: pytest.LogCaptureFixture) -> None:
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
