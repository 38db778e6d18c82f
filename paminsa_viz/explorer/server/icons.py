"""viser's icons, read once: viser opens its archive of six thousand anew for each button."""

from __future__ import annotations

import zipfile
from functools import cache

from viser import _gui_api, _gui_handles, _icons


@cache
def _archive() -> zipfile.ZipFile:
    return zipfile.ZipFile(_icons.ICONS_DIR / "tabler-icons.zip")


@cache
def _svg(name: str) -> str:
    return _archive().read(f"{name}.svg").decode("utf-8")


def keep_icons_open() -> None:
    """Let viser read its icons from an archive that stays open.

    A viser that reads them in another way is left as it is.
    """
    if not hasattr(_icons, "ICONS_DIR"):
        return
    for module in (_gui_api, _gui_handles):
        if "svg_from_icon" in vars(module):
            vars(module)["svg_from_icon"] = _svg
