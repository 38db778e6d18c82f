"""Every slider of the design panel, by the path of its number."""

from __future__ import annotations

from paminsa_viz.explorer.panels.design_panel import GROUPS, slider

ROWS = {p.path: slider(p) for group in GROUPS for p in group.parameters}
