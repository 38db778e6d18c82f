"""Calibrations as tables: the lengths of the legs, and what is left of each measured pose."""

from __future__ import annotations

import numpy as np

from paminsa_viz.files.columns import POSE, TILT
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.precision.calibration import Calibration
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from paminsa_viz.precision.measurements import Measurements

FORMAT = "paminsa_viz calibration 1"
"""Name and version of the layout of the lengths."""

RESIDUALS_FORMAT = "paminsa_viz calibration residuals 1"


def lengths_table(found: Calibration, source: str) -> DataTable:
    """Return each length's deviation from its nominal value, and its standard deviation.

    A length that shows in combinations alone has none, and its deviation is one of many that
    predict the same poses.
    """
    places = [(leg, length) for leg in LEG_NAMES for length in LENGTHS]
    return DataTable(
        {
            "length": np.array([f"{leg}.{length.name}" for leg, length in places]),
            "unit": np.array([length.unit for _, length in places]),
            "deviation": deviation_array(found.design).ravel(),
            "standard_deviation": found.standard_deviations.ravel(),
            "known": np.array(["yes" if known else "no" for known in found.determined.ravel()]),
        },
        provenance(FORMAT, _facts(found, source)),
    )


def residual_table(found: Calibration, measured: Measurements, source: str) -> DataTable:
    """Return the measured poses, and by how much the lengths before and after miss them."""
    names = (*POSE, *TILT)[: measured.poses.shape[1]]
    columns = dict(zip(names, measured.poses.T, strict=True))
    for kind, values in (("before", found.residuals_before), ("after", found.residuals_after)):
        columns |= {f"{kind}_{name}": values[:, j] for j, name in enumerate(names)}
    held = np.array(["yes" if one else "no" for one in found.held])
    return DataTable(
        {**columns, "held_back": held}, provenance(RESIDUALS_FORMAT, _facts(found, source))
    )


def _facts(found: Calibration, source: str) -> dict[str, str]:
    return {
        "measured poses": source,
        "held back": str(int(found.held.sum())),
        "combinations fitted": str(len(found.combinations)),
        "noise [m]": f"{found.noise:.6g}",
    }
