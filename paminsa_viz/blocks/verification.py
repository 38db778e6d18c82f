"""Verification: formulas against engines, the misprints, and a simulation."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import (
    Block,
    Fact,
    Figure,
    Note,
    Row,
    Table,
    actuator_rows,
)
from paminsa_viz.engines import EngineMissing
from paminsa_viz.engines.verification import Comparison, Verification
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.plots.series_builders import SYMBOLS
from paminsa_viz.plots.verified import VerificationFigure, verification_figures
from paminsa_viz.units import NONE, counted, format_value, number


def verification_blocks(found: Verification) -> list[Block]:
    """Return the verdict, the differences from each engine, a simulation, and the misprints."""
    engines = " and ".join(f"{check.engine} {check.version}" for check in found.engines)
    verdict = Note(
        f"{'Passed' if found.passed else 'Failed'}: the largest difference between the formulas "
        f"and {engines} is {number(found.worst, 2)} of the actuator’s largest torque; "
        f"{number(found.tolerance, 2)} is allowed.",
        "ok" if found.passed else "bad",
    )
    method = Note(
        "The engines get the bodies, joints and loop closures, and the joints’ positions, which "
        "the closures confirm; they know none of the formulas. "
        f"Compared are {counted(len(found.poses), 'random pose')} at rest and "
        f"{counted(found.trajectory.size, 'state')} of the trajectory, without joint friction."
    )
    blocks: list[Block] = [verdict, method]
    head = ("", "Largest torque", "Largest difference", "RMS", "Relative, largest", "Relative, RMS")
    for check in found.engines:
        rows = (*_rows("At rest", check.static), *_rows("Moving", check.dynamic))
        caption = (
            f"Formulas and {check.engine} {check.version}. Relative: over the largest torque of "
            "the same actuator."
        )
        blocks.append(Table(head, rows, caption))
    if found.missing:
        blocks += [Note(str(EngineMissing(engine))) for engine in found.missing]
    figures = [
        Figure(
            partial(_figure, figure), f"{figure.title}: torques and their difference, over time."
        )
        for figure in verification_figures(found)
    ]
    return [*blocks, figures[0], _simulation(found), _misprints(found), figures[-1]]


def verification_fact(found: Verification | None) -> Fact:
    """Return the verdict in a word; None for a verification that was not done."""
    if found is None:
        return Fact("Verification", NONE, "not done")
    word, kind = ("passed", "ok") if found.passed else ("failed", "bad")
    note = f"largest difference {number(found.worst, 2)} of the largest torque"
    return Fact("Verification", word, note, kind)


def _figure(figure: VerificationFigure) -> bytes:
    from paminsa_viz.plots.series_figure import render_series  # late: matplotlib

    return render_series(figure.data, "svg", title=figure.title, caption=False)


def _rows(where: str, comparison: Comparison) -> list[Row]:
    rows = []
    for symbol, line in zip(SYMBOLS, comparison.summary(), strict=True):
        unit = line["unit"]
        rows.append(
            (
                symbol,
                format_value(line["largest_torque"], unit),
                format_value(line["max_difference"], unit, 2),
                format_value(line["rms_difference"], unit, 2),
                number(line["max_relative"], 2),
                number(line["rms_relative"], 2),
            )
        )
    return [Row((where,), "group"), *actuator_rows(*rows)]


def _misprints(found: Verification) -> Table:
    rows = [
        Row(
            (MISPRINTS[item], *(number(value, 2) for value in comparison.relative)),
            "total" if item is Misprint.ALL else "plain",
        )
        for item, comparison in found.published.items()
    ]
    caption = (
        "The formulas as published against the engine, moving: largest difference over "
        "the largest torque. Where a misprint has an effect, it stands out by many orders of "
        "magnitude."
    )
    return Table(("Taken as published", *SYMBOLS), tuple(rows), caption)


MISPRINTS: dict[Misprint, str] = {
    Misprint.EQ13_LIFT_SPEED: "Eq. 13: Ż instead of Ż²",
    Misprint.EQ13_LEG_SPIN: "Eq. 13: θ̇² instead of θ̇ₖ²",
    Misprint.APP3_MC4: "Appendix 3, M_c4: m₇/(k²(k−1)) instead of twice that",
    Misprint.EQ14_PHI_SPEED: "Eq. 14: M_c10 φ̇² instead of M_c11 φ̇²",
    Misprint.EQ14_SINE_SIGNS: "Eq. 14: signs of sin²ψ and sin²φ",
    Misprint.ALL: "All of them",
}
"""Descriptions of the misprints."""


def _simulation(found: Verification) -> Note:
    run = _simulation_data(found)
    x, y, theta, z = (
        format_value(value, unit, 2)
        for value, unit in zip(run["drift_m_rad"], ("m", "m", "rad", "m"), strict=True)
    )
    end = "to the end" if run["complete"] else "until it had strayed: the robot is unstable"
    return Note(
        f"Forward simulation: moved by the calculated torques alone, with stiff loop closures, "
        f"{run['engine']} ran {run['until_s']:.3g} s ({end}). The platform was then off by {x} "
        f"in x, {y} in y, {theta} in θ and {z} in z; loops opened by at most "
        f"{1e6 * run['largest_gap_m']:.2g} µm."
    )


def verification_data(found: Verification) -> dict[str, Any]:
    """Return the figures, without the time series, for JSON, in SI units."""
    return {
        **record(found, "passed", "tolerance"),
        "worst_relative": found.worst,
        **robot(found.design),
        "trajectory": found.trajectory.name,
        "duration_s": found.trajectory.duration,
        "static_poses": len(found.poses),
        "dynamic_states": found.trajectory.size,
        "engines": [
            {
                **record(check, "engine", "version"),
                "passed": check.agrees(found.tolerance),
                "static": check.static.summary(),
                "dynamic": check.dynamic.summary(),
            }
            for check in found.engines
        ],
        "missing_engines": found.missing,
        "as_published": {
            misprint_name(item): compared.summary() for item, compared in found.published.items()
        },
        "simulation": _simulation_data(found),
    }


def _simulation_data(found: Verification) -> dict[str, Any]:
    """Return how far the simulated robot came, and how far it was off then."""
    stop = found.played.until - 1
    return {
        "engine": found.engines[0].engine,
        "until_s": float(found.wanted.t[stop] - found.wanted.t[0]),
        "complete": stop == found.wanted.size - 1,
        "drift_m_rad": found.played.drift[stop],
        "stray_m": float(found.played.stray[stop]),
        "largest_gap_m": float(np.nanmax(found.played.gap)),
    }


def misprint_name(misprint: Misprint) -> str:
    """Return a misprint's name as in `Misprint`, ``ALL`` for all of them."""
    return str(misprint.name if misprint.name and "|" not in misprint.name else "ALL")
