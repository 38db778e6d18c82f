"""The design report: one HTML file with everything that a design review needs.

`request.ReportRequest` holds robot, pose and motion, `page.report_html` writes the report. Each
section holds the blocks of a subject (`paminsa_viz.blocks`): tables, figures, notes. One template
sets them, and commands print the same blocks as text (`cli.output`). The file needs no network and
no script; a browser's print dialog makes a PDF of it. Nothing is imported here, since figures are
slow to import.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.report.page import report_html
    from paminsa_viz.report.request import ReportRequest

__all__ = [
    "ReportRequest",
    "report_html",
]

__getattr__ = late_names(__name__)
