"""Excitations as trajectory tables: any program that reads trajectories can run them."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.files.tables import DataTable
from paminsa_viz.files.trajectory_table import analysis_table
from paminsa_viz.identification.excitation import Excitation
from paminsa_viz.model.design import Design
from paminsa_viz.trajectory import analyze


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
