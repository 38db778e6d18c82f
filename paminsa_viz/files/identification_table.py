"""Identification as tables: numbers with their intervals, torques over time, and excitations."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from paminsa_viz.files.columns import TIME, TORQUES
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.files.trajectory_table import analysis_table, parameter_facts, robot_facts
from paminsa_viz.trajectory import analyze

if TYPE_CHECKING:
    from paminsa_viz.identification.excitation import Excitation
    from paminsa_viz.identification.findings import Findings
    from paminsa_viz.model.design import Design

FORMAT = "paminsa_viz identification 1"
"""Name and version of the layout of the numbers."""

RESIDUALS_FORMAT = "paminsa_viz identification residuals 1"


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
        columns |= {f"{kind}_{name}": values[:, j] for j, name in enumerate(TORQUES)}
    return DataTable(columns, provenance(RESIDUALS_FORMAT, _facts(findings)))


def _facts(findings: Findings) -> dict[str, str]:
    found = findings.identification
    return {
        "log": found.log.name,
        "cut-off [Hz]": repr(found.settings.cut_off),
        **{f"note {number}": note for number, note in enumerate(found.notes, 1)},
        **robot_facts(found.design),
        **parameter_facts(found.design),
    }


def excitation_table(design: Design, excitation: Excitation, rate: float) -> DataTable:
    """Return an excitation as a trajectory table whose header states the limits that it keeps.

    Args:
        design: The robot; the table holds the torques that it takes too.
        excitation: The motion.
        rate: Samples a second [1/s].

    Raises:
        InvalidInput: If there would be too many samples.
    """
    table = analysis_table(analyze(design, excitation.plan.sample(rate)))
    settings = excitation.settings
    facts = {
        "period [s]": repr(settings.period),
        "harmonics": str(settings.harmonics),
        "seed": str(settings.seed),
        "log det of the information": f"{excitation.log_det:.2f}",
        f"log det of the best of {excitation.random}": f"{excitation.random_log_det:.2f}",
    }
    for row in excitation.limits:
        unit = f" [{row.unit}]" if row.unit else ""
        bound = "at least" if row.least else "at most"
        facts[f"{row.name}{unit}"] = f"{row.value:.6g}, {bound} {row.limit:.6g}"
    return replace(table, provenance={**table.provenance, **facts})
