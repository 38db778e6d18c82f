"""Small HTML tables and notes for the panels; whoever fills them escapes what a person wrote."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from paminsa_viz.palette import INK, MUTED

FONT = f"font-size:12.5px;line-height:1.4;font-variant-numeric:tabular-nums;color:{INK}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table: the first column to the left, the numbers after it to the right."""
    lines = [_row(head, "th", f"font-weight:600;color:{MUTED};border-bottom:1px solid #d7dce1")]
    lines += [_row(cells, "td", "") for cells in rows]
    return (
        f'<table style="width:100%;border-collapse:collapse;{FONT}">' + "".join(lines) + "</table>"
    )


def _row(cells: Sequence[str], tag: str, style: str) -> str:
    parts = []
    for index, cell in enumerate(cells):
        side = "left;padding:2px 0" if index == 0 else "right;padding:2px 0 2px 8px"
        parts.append(f'<{tag} style="text-align:{side};white-space:nowrap;{style}">{cell}</{tag}>')
    return "<tr>" + "".join(parts) + "</tr>"


def dot(color: str) -> str:
    """Return a colored dot for a table."""
    return (
        f'<span style="display:inline-block;width:9px;height:9px;border-radius:5px;'
        f'background:{color};margin-right:5px"></span>'
    )


def note(text: str, name: str = "", *, muted: bool = False) -> str:
    """Return a block of text with a panel's margins; ``name`` is for tests to find it by."""
    mark = f' data-testid="{name}"' if name else ""
    color = f"color:{MUTED}" if muted else ""
    return f'<div{mark} style="padding:0 10px 8px;{FONT};{color}">{text}</div>'
