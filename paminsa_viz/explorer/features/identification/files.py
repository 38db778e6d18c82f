"""Files of what an identification found."""

from __future__ import annotations

from paminsa_viz.explorer.features.identification.actions import excitation, findings
from paminsa_viz.explorer.kit.downloads import File, plain
from paminsa_viz.explorer.state.identification import EXPORT_RATE
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.identification_table import estimate_table, excitation_table, residual_table
from paminsa_viz.files.tables import table_bytes


def identification_table(state: State, kind: str) -> File:
    """Write what a log told: the ``"parameters"`` with their intervals, or the ``"residuals"``.

    Raises:
        InvalidInput: If nothing has been identified.
    """
    found = findings(state)
    table = estimate_table(found) if kind == "parameters" else residual_table(found)
    name = f"paminsa_{kind}_{plain(found.identification.log.name)}.csv"
    return File(name, table_bytes(table, "csv"))


def excitation_csv(state: State) -> File:
    """Write the motion that was found as a trajectory.

    Raises:
        InvalidInput: If there is none.
    """
    job, found = excitation(state)
    table = excitation_table(job.design, found, EXPORT_RATE)
    return File("paminsa_excitation.csv", table_bytes(table, "csv"))
