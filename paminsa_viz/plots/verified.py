"""An engine's torques beside the formulae's, like the paper's Figs. 6 and 7."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.engines.mujoco_model import MujocoRobot, load_mujoco
from paminsa_viz.engines.verification import MOST_STATES, Verification
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.plots.curves import OtherTorques, curve_data
from paminsa_viz.plots.curves_data import CurveData
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis, analyze


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


def engine_torques(analysis: TrajectoryAnalysis) -> OtherTorques:
    """Return MuJoCo's torques along an analyzed trajectory, to be drawn beside its own.

    Engines here have no joint friction; the design's is added, so that the rest can be compared.
    It takes about half a millisecond a sample.

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If the trajectory has more than `MOST_STATES` samples.
    """
    t = analysis.trajectory
    if t.size > MOST_STATES:
        raise InvalidInput(
            "trajectory", f"an engine computes at most {MOST_STATES:,} samples, not {t.size:,}"
        )
    version = load_mujoco().__version__
    robot = MujocoRobot(analysis.design)
    torque = robot.inverse_dynamics(t.pose, t.velocity, t.acceleration)
    torque += analysis.breakdown.friction
    torque[~analysis.check.good] = np.nan
    return OtherTorques(f"MuJoCo {version}", torque)


def verified_curves(found: Verification) -> list[VerifiedCurves]:
    """Return the dynamic torques beside each engine's, then those of the formulae as printed."""
    compared = [(check, Misprint.NONE) for check in found.engines]
    compared.append((found.engines[0], Misprint.ALL))
    figures = []
    for check, misprints in compared:
        analysis = analyze(found.design, found.trajectory, misprints=misprints)
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
