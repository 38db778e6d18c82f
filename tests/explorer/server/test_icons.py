"""viser's icons out of an archive that stays open."""

from __future__ import annotations

import pytest
import viser
from viser import _gui_api, _icons

from paminsa_viz.explorer.server import icons


def test_icons_are_those_of_viser(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_gui_api, "svg_from_icon", _icons.svg_from_icon)
    icons.keep_icons_open()
    for name in (viser.Icon.ARROW_BACK_UP, viser.Icon.HOME):
        assert _gui_api.svg_from_icon(name) == _icons.svg_from_icon(name)
        assert _gui_api.svg_from_icon is not _icons.svg_from_icon


def test_a_viser_that_reads_them_in_another_way_is_left_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(_gui_api, "svg_from_icon", _icons.svg_from_icon)
    monkeypatch.delattr(_icons, "ICONS_DIR")
    icons.keep_icons_open()
    assert _gui_api.svg_from_icon is _icons.svg_from_icon
