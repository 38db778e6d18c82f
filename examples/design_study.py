"""Random robots, measured over the workspace: what makes torques small?

`paminsa-viz sweep` does the same from the command line. The table grows row by row; stop it with
Ctrl-C, run it again, and it goes on.
"""

import csv

import numpy as np

from paminsa_viz import APPENDIX_4
from paminsa_viz.studies import DesignRange, RandomDesigns, Study, default_region, run_study

PATHS = ("geometry.base_radius", "geometry.crank_length", "geometry.coupler_length", "links.b4")

designs = RandomDesigns(
    tuple(DesignRange.around(APPENDIX_4, path, 0.15) for path in PATHS), size=400, seed=1
)
study = Study(APPENDIX_4, designs, default_region(APPENDIX_4), scale_bars=True)
summary = run_study(study, "design_study.csv")
print(f"design_study.csv: {summary.rows} designs, {dict(summary.status)}")

with open("design_study.csv", encoding="utf-8") as file:
    rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
usable = [row for row in rows if row["status"] == "ok"]
peak = np.array([float(row["peak_torque_Nm"]) for row in usable])
for path, column in zip(PATHS, study.columns[1:], strict=False):
    value = np.array([float(row[column]) for row in usable])
    print(f"correlation of the peak torque with {path:24s} {np.corrcoef(value, peak)[0, 1]:+.2f}")
