"""Texts of the page: templates filled in as HTML.

A template lies beside the feature that it belongs to and is named with its folder, such as
``springs/result.j2``; those of several features lie here.
"""

from __future__ import annotations

from collections.abc import Collection
from importlib.resources import files
from typing import Any

from markupsafe import Markup

from paminsa_viz import units
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.templates import html_environment

_PAGE = files("paminsa_viz.explorer")

_ENVIRONMENT = html_environment([_PAGE / "kit", _PAGE / "features", _PAGE])


def css_color(color: str) -> Markup:
    """Return a data color ``#rrggbb`` as CSS that follows the theme; see `browser.style`."""
    return Markup(f"var(--pv-{color.lstrip('#').lower()}, {Markup.escape(color)})")


_ENVIRONMENT.filters |= {
    "counted": units.counted,
    "css_color": css_color,
    "fixed": units.fixed,
    "number": units.number,
    "percent_change": units.percent_change,
    "symbol": lambda text: Markup(units.symbol_html(text)),
    "symbols": lambda text: Markup(units.symbols_html(text)),
    "unit": units.unit_text,
}


def render(template: str, **context: Any) -> str:
    """Return a template filled in, as HTML; all but `Markup` is escaped."""
    return _ENVIRONMENT.get_template(template).render(context)


def note(testid: str, text: str, *, muted: bool = False) -> str:
    """Return a text as HTML, in gray if it is muted."""
    return render("note.j2", testid=testid, text=text, muted=muted)


def status(testid: str, level: str, title: str, *lines: str) -> str:
    """Return a box with a title and lines below it; its color is that of the level.

    Args:
        testid: Name for tests.
        level: ``ok``, ``warn``, ``bad`` or ``plain``.
        title: The first line.
        lines: Others, which get a capital letter; empty ones are left out.
    """
    said = map(units.capitalized, filter(None, lines))
    return render("status.j2", testid=testid, level=level, title=title, lines=said)


def blocks_html(
    testid: str, *blocks: Table | Note, look: str = "", bold: Collection[int] = (),
    chosen: int = -1, stale: str = "",
) -> str:  # fmt: skip
    """Return tables and sentences of `paminsa_viz.blocks` as HTML.

    Args:
        testid: Name for tests.
        blocks: From top to bottom.
        look: Class of the tables besides that of all.
        bold: Columns of the first table that are bold.
        chosen: A row of the first table that is selected.
        stale: What has changed since, above them; empty for nothing.
    """
    return render(
        "blocks.j2", testid=testid, blocks=blocks, look=look, bold=bold, chosen=chosen, stale=stale
    )
