"""Files of a calibration: the poses to measure, measured poses, and what they told."""

from __future__ import annotations

from paminsa_viz.explorer.core.saved_requirements import of_file
from paminsa_viz.explorer.features.calibration.actions import (
    CALIBRATE,
    PROPOSE,
    calibrated_design,
)
from paminsa_viz.explorer.kit.downloads import File, plain
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.measurements import lengths_table, measurement_table, residual_table
from paminsa_viz.files.tables import table_bytes
from paminsa_viz.model import InvalidInput
from paminsa_viz.version import MADE_BY


def poses_csv(state: State) -> File:
    """Write the poses to measure, as the table that is read with the measured ones in their place.

    Raises:
        InvalidInput: If none are proposed.
    """
    job, plan = PROPOSE.required(state, "poses", "none are proposed yet")
    table = measurement_table(plan.measurements, seed=str(job.settings.seed))
    return File("paminsa_poses-to-measure.csv", table_bytes(table, "csv"))


def measured_csv(state: State) -> File:
    """Write the measured poses that are open.

    Raises:
        InvalidInput: If there are none.
    """
    measured = state.calibration.measured
    if measured is None:
        raise InvalidInput("measured poses", "open some first")
    facts = {"source": measured.about or measured.name}
    table = measurement_table(measured.measurements, **facts)
    return File(f"paminsa_measured_{plain(measured.name)}.csv", table_bytes(table, "csv"))


def calibration_csv(state: State, kind: str) -> File:
    """Write what was found: the ``"lengths"``, or the ``"residuals"``.

    Raises:
        InvalidInput: If nothing has been calibrated.
    """
    job, found = CALIBRATE.required(state, "measured poses", "nothing has been calibrated yet")
    measured = job.measured
    table = (
        lengths_table(found, measured.name)
        if kind == "lengths"
        else residual_table(found, measured.measurements, measured.name)
    )
    return File(f"paminsa_{kind}_{plain(measured.name)}.csv", table_bytes(table, "csv"))


def design_toml(state: State) -> File:
    """Write the design with the lengths that were found, as ``paminsa-viz calibrate`` does.

    Raises:
        InvalidInput: If there are none, or they are not of the design's lengths.
    """
    design = calibrated_design(state)
    text = write_design(
        design,
        comment=f"Calibrated by {MADE_BY}.",
        requirements=of_file(state.document.requirements),
    )
    return File(f"paminsa_{plain(design.name)}.toml", text.encode())
