"""Figures of a verification, like the paper's Figs. 6 and 7: formulae, engine, and difference."""

from __future__ import annotations

from typing import NamedTuple

from paminsa_viz.engines.verification import Verification
from paminsa_viz.figures.curves import OtherTorques, curve_data
from paminsa_viz.figures.curves_data import CurveData
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.model.trajectory.analysis import analyse


class VerifiedCurves(NamedTuple):
    """A figure of a verification.

    Attributes:
        stem: Name for a file, without ending.
        title: Heading.
        data: What `curves_paper.render_curves` draws.
    """

    stem: str
    title: str
    data: CurveData


def verified_curves(found: Verification) -> list[VerifiedCurves]:
    """Return the dynamic torques beside each engine's, then those of the formulae as printed."""
    compared = [(check, Misprint.NONE) for check in found.engines]
    compared.append((found.engines[0], Misprint.ALL))
    figures = []
    for check, misprints in compared:
        analysis = analyse(found.design, found.trajectory, found.assembly, misprints=misprints)
        other = OtherTorques(f"{check.engine} {check.version}", check.dynamic.reference)
        kind = "formulae" if misprints is Misprint.NONE else "formulae as printed"
        figures.append(
            VerifiedCurves(
                f"{kind.replace(' ', '_')}_{check.engine.lower()}",
                f"{kind.capitalize()} and {check.engine}",
                curve_data("comparison", analysis, engine=other),
            )
        )
    return figures
