"""An engine's torques compared with the formulas', like the paper's Figs. 6 and 7."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.engines.closed_loop import ClosedLoopRobot
from paminsa_viz.engines.mujoco_model import MujocoRobot, load_mujoco
from paminsa_viz.engines.pinocchio_model import PinocchioRobot, load_pinocchio
from paminsa_viz.engines.verification import MOST_STATES, Verification
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.plots.series import EngineTorques, SeriesData, SeriesSources
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis, analyze

_ENGINES: dict[str, tuple[Callable[[], Any], type[ClosedLoopRobot]]] = {
    "MuJoCo": (load_mujoco, MujocoRobot),
    "Pinocchio": (load_pinocchio, PinocchioRobot),
}


class VerificationFigure(NamedTuple):
    """A figure of a verification.

    Attributes:
        stem: Name for a file, without ending.
        title: Heading.
        data: What `series_figure.render_series` draws.
    """

    stem: str
    title: str
    data: SeriesData


def engine_torques(
    analysis: TrajectoryAnalysis, engine: str = "MuJoCo", *, most: int | None = MOST_STATES
) -> EngineTorques:
    """Return an engine's torques along an analyzed trajectory, to be drawn next to its own.

    Engines here have no joint friction; the design's is added, so that the rest can be compared.
    It takes about half a millisecond a sample.

    Args:
        analysis: The design on the trajectory.
        engine: ``"MuJoCo"`` or ``"Pinocchio"``, in any case.
        most: Most samples; None for any number.

    Raises:
        EngineMissing: If the engine is not installed.
        InvalidDesign: If a bar's inertias belong to no rigid body.
        InvalidInput: If there is no such engine, or the trajectory has more samples.
    """
    t = analysis.trajectory
    if most is not None and t.size > most:
        raise InvalidInput(
            "trajectory", f"an engine computes at most {most:,} samples, not {t.size:,}"
        )
    found = next((name for name in _ENGINES if name.lower() == engine.lower()), None)
    if found is None:
        raise InvalidInput("engine", f"one of {', '.join(_ENGINES)} is needed, not {engine!r}")
    load, robot = _ENGINES[found]
    version = load().__version__
    torque = robot(analysis.design).inverse_dynamics(
        t.pose, t.velocity, t.acceleration, load=t.load
    )
    torque += analysis.breakdown.friction
    torque[~analysis.check.ok] = np.nan
    return EngineTorques(f"{found} {version}", torque)


def verification_figures(found: Verification) -> list[VerificationFigure]:
    """Compare the dynamic torques with each engine's, then those of the formulas as published."""
    compared = [(check, Misprint.NONE) for check in found.engines]
    compared.append((found.engines[0], Misprint.ALL))
    figures = []
    for check, misprints in compared:
        analysis = analyze(found.design, found.trajectory, misprints=misprints)
        other = EngineTorques(f"{check.engine} {check.version}", check.dynamic.reference)
        stem, title = "formulas", "Formulas"
        if misprints is not Misprint.NONE:
            stem, title = "formulas_as_published", "Formulas as published"
        figures.append(
            VerificationFigure(
                f"{stem}_{check.engine.lower()}",
                f"{title} and {check.engine}",
                build_series("comparison", SeriesSources(analysis, engine=other)),
            )
        )
    return figures
