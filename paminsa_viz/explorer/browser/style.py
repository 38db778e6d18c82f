"""The page's style sheet."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from paminsa_viz.palette import ACTUATOR_COLORS, BAD, INK, MUTED, OK, REFERENCE, WARN

_COLORS = {
    "ink": INK,
    "muted": MUTED,
    "reference": REFERENCE,
    "good": OK,
    "warning": WARN,
    "wrong": BAD,
} | {f"color-m{number}": color for number, color in enumerate(ACTUATOR_COLORS, start=1)}


@cache
def style_html() -> str:
    """Return page.css with the palette's colors, as an HTML element."""
    colors = "".join(f"--pv-{name}:{color};" for name, color in _COLORS.items())
    text = files("paminsa_viz.explorer.browser").joinpath("page.css").read_text(encoding="utf-8")
    return f"<style>:root{{{colors}}}\n{text}</style>"
