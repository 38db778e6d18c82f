"""Every row of the panel of the design, by the path of its number."""

from __future__ import annotations

from paminsa_viz.explorer.panels.design_layout import GROUPS

ROWS = {row.path: row for group in GROUPS for row in group.rows}
