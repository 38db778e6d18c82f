"""What logs say as tables: the numbers with their intervals, and torques over time."""

from __future__ import annotations

import numpy as np

from paminsa_viz.files.columns import TIME
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.identification.findings import Findings

FORMAT = "paminsa_viz identification 1"
"""Name and version of the layout of the numbers."""

RESIDUALS_FORMAT = "paminsa_viz identification residuals 1"

_ACTUATORS = ("tau1_Nm", "tau2_Nm", "tau3_Nm", "f4_N")


def estimate_table(findings: Findings) -> DataTable:
    """Return the estimates with their 95 % intervals; an infinite half width is left empty."""
    estimates = findings.identification.estimates
    half = np.array([item.half_width for item in estimates])
    return DataTable(
        {
            "symbol": np.array([item.symbol for item in estimates]),
            "unit": np.array([item.parameter.unit for item in estimates]),
            "value": np.array([item.value for item in estimates]),
            "half_width_95": np.where(np.isfinite(half), half, np.nan),
            "design": np.array([item.parameter.design for item in estimates]),
            "known": np.array(["yes" if item.known else "no" for item in estimates]),
        },
        provenance(FORMAT, _facts(findings)),
    )


def residual_table(findings: Findings) -> DataTable:
    """Return measured and predicted torques, filtered, over time."""
    found = findings.identification
    columns = {TIME: found.signals.t}
    for kind, values in (("measured", found.measured), ("predicted", found.predicted)):
        columns |= {f"{kind}_{name}": values[:, j] for j, name in enumerate(_ACTUATORS)}
    return DataTable(columns, provenance(RESIDUALS_FORMAT, _facts(findings)))


def _facts(findings: Findings) -> dict[str, str]:
    found = findings.identification
    return {
        "log": found.log.name,
        "design": found.design.name,
        "cut-off [Hz]": repr(found.settings.cut_off),
        **{f"note {number}": note for number, note in enumerate(found.notes, 1)},
    }
