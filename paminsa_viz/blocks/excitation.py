"""Excitation: what a motion is worth for identification, and the limits that it keeps."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Cell, Note, Row, Table
from paminsa_viz.identification.excitation import Excitation, KeptLimit
from paminsa_viz.model.design import Design
from paminsa_viz.units import NONE, counted, fixed, format_value, number, percent


def excitation_blocks(found: Excitation) -> list[Block]:
    """Return how the motion was found, its information, and its limits."""
    settings, evaluations = found.settings, counted(found.evaluations, "evaluation")
    return [
        Note(
            f"{counted(settings.periods, 'period')} of {number(settings.period)} s, "
            f"{counted(settings.harmonics, 'harmonic')}; {evaluations} in "
            f"{number(found.seconds, 3)} s."
        ),
        Note(information_text(found)),
        limits_table(found),
    ]


def information_text(found: Excitation) -> str:
    """Return the information of a motion beside that of the best random one."""
    return (
        f"log det of the information of {counted(found.parameters, 'parameter')} "
        f"{fixed(found.log_det, 1)}, of the best of {found.random} random motions "
        f"{fixed(found.random_log_det, 1)}: intervals narrower "
        f"by a factor of {number(found.narrowing, 3)} on average."
    )


def limits_table(found: Excitation) -> Table:
    """Return what the motion takes of each limit, and when."""
    rows = tuple(Row(_cells(row), "plain" if row.kept else "marked") for row in found.limits)
    head = ("Limit of", "Largest", "Limit", "At", "Used")
    return Table(head, rows, "Limits that the motion keeps, within a period.", literal=True)


def _cells(row: KeptLimit) -> tuple[str, ...]:
    sign = "≥" if row.least else "≤"
    limit = f"{sign} {format_value(row.limit, row.unit, 3)}"
    over, under = (row.limit, row.value) if row.least else (row.value, row.limit)
    share = NONE if not under or not math.isfinite(under) else percent(over / under)
    value = format_value(row.value, row.unit, 3)
    used = Cell(share, kind="plain" if row.kept else "bad")
    return row.name, value, limit, f"{number(row.t, 3)} s", used


def excitation_data(design: Design, found: Excitation) -> dict[str, Any]:
    """Return how the motion was found and its limits, for JSON, in SI units."""
    return {
        **robot(design),
        **record(found.settings, "period_s", "harmonics"),
        "duration_s": found.plan.duration,
        "log_det_random": found.random_log_det,
        **record(found, "parameters", "log_det", "random", "evaluations", "seconds"),
        "limits": [
            record(row, "name", "value", "limit", "unit", "t_s", "least", "kept")
            for row in found.limits
        ],
    }
