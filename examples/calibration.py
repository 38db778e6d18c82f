"""Calibrate a robot whose legs differ: simulate its measurement, then find its lengths.

Writes ``measured.csv`` for ``paminsa-viz calibrate measured.csv --validate 0.25``.
"""

from __future__ import annotations

from pathlib import Path

from paminsa_viz.files import measurement_table, table_bytes
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.precision import calibrate, plan_calibration, simulated_measurements

# The nominal robot's actuators for 60 poses; where a robot with lengths up to 0.5 mm off, and
# angles up to 0.5 mrad, really is then, measured within 10 µm.
asked = plan_calibration(APPENDIX_4, 60).measurements
measured = simulated_measurements(APPENDIX_4, asked, size=5e-4, noise=1e-5, seed=5)
Path("measured.csv").write_bytes(table_bytes(measurement_table(measured), "csv"))

found = calibrate(APPENDIX_4, measured, validate=0.25)
print(f"{found.rank} combinations show with equal legs, {len(found.combinations)} are known")
for name, before, after in (
    ("fitted", found.before, found.after),
    ("held back", found.before_held, found.after_held),
):
    for axis, index in (("x", 0), ("z", 3)):
        print(
            f"{name:>9}, RMS of {axis}: {1e6 * before.rms[index]:6.1f} µm before, "
            f"{1e6 * after.rms[index]:4.1f} µm after"
        )
