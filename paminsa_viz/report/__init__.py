"""The design report: one HTML file with everything that a design review needs.

`ReportRequest` holds robot, pose and motion, `report_html` writes the report. Each section
is a module that turns results into blocks (`blocks`): tables, figures, notes. One template sets
them. The file needs no network and no script; a browser's print dialog makes a PDF of it.
"""

from __future__ import annotations

from paminsa_viz.report.page import report_html
from paminsa_viz.report.request import ReportRequest

__all__ = ["ReportRequest", "report_html"]
