"""Studies: many designs, each measured over the workspace, and on a motion if one is given.

`Study` defines the designs and what is measured; `run_study` streams its rows to a resumable table,
and resumes where an earlier run was stopped; `processes` and `cluster` are where
the work is done.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.studies.executors import Workers, cluster, here, processes
    from paminsa_viz.studies.metrics import (
        METRICS,
        MOTION_METRICS,
        Metric,
        measure_design,
        measure_motion,
    )
    from paminsa_viz.studies.region import Region, default_region
    from paminsa_viz.studies.running import Extremes, StudySummary, run_study
    from paminsa_viz.studies.study import Study
    from paminsa_viz.studies.sweeps import SweepSummary, sweep, sweep_blocks
    from paminsa_viz.studies.variations import DesignAxis, DesignGrid, DesignRange, RandomDesigns

__all__ = [
    "METRICS",
    "MOTION_METRICS",
    "DesignAxis",
    "DesignGrid",
    "DesignRange",
    "Extremes",
    "Metric",
    "RandomDesigns",
    "Region",
    "Study",
    "StudySummary",
    "SweepSummary",
    "Workers",
    "cluster",
    "default_region",
    "here",
    "measure_design",
    "measure_motion",
    "processes",
    "run_study",
    "sweep",
    "sweep_blocks",
]

__getattr__ = late_names(__name__)
