"""Studies: many designs, each measured over the workspace, into a table that survives a kill.

`Study` says which designs and what is measured; `run_study` streams its rows to a file and goes on
where an earlier run was stopped; `processes` and `cluster` are where the work is done.
"""

from __future__ import annotations

from paminsa_viz.studies.executors import Workers, cluster, here, processes
from paminsa_viz.studies.metrics import METRICS, Metric, Region, default_region, measure_design
from paminsa_viz.studies.running import Extremes, StudySummary, run_study
from paminsa_viz.studies.study import Study
from paminsa_viz.studies.variations import DesignAxis, DesignGrid, DesignRange, RandomDesigns

__all__ = [
    "METRICS",
    "DesignAxis",
    "DesignGrid",
    "DesignRange",
    "Extremes",
    "Metric",
    "RandomDesigns",
    "Region",
    "Study",
    "StudySummary",
    "Workers",
    "cluster",
    "default_region",
    "here",
    "measure_design",
    "processes",
    "run_study",
]
