"""Fewer pictures a second where each of them is dear: in a browser without a graphics card.

viser draws the scene over and over for a quarter of a second after every change, so that whatever
follows late is seen. Without a graphics card that takes all of a machine, and the next change waits
for pictures of which nobody sees the difference. The page then draws once for a change, and again
when late followers have come, before one color instead of a gradient, which is put together with
every picture again.
"""

from __future__ import annotations

from typing import Final

from paminsa_viz.explorer.browser.backdrop import MIDDLE

LATE: Final = 250
"""When to draw again after the last change [ms]."""

SCRIPT: Final = f"""
(() => {{
  const backdrop = document.getElementById("paminsa-backdrop");
  if (backdrop) backdrop.textContent = "canvas[data-engine] {{ background: {MIDDLE}; }}";
  const viewer = window.__viserMutable;
  const root = viewer && viewer.scene && viewer.scene.__r3f && viewer.scene.__r3f.root;
  if (!root || !root.getState().invalidate) return;
  const draw = () => root.getState().invalidate();
  let timer = 0;
  viewer.requestRender = () => {{
    clearTimeout(timer);
    timer = setTimeout(draw, {LATE});
    draw();
  }};
}})();
"""
"""Takes the place of what viser's page asks for a picture with; without it the page stays as it
is, only slower."""
