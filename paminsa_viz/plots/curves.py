"""Figures over time: what a trajectory asks of the robot, how it moves, how well it is followed.

`curve_data` makes the data that the page and files share, `figure_bytes` a file. None of them is a
curve of the paper: the motion of its Figs. 6-11 is not in its text.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

from paminsa_viz.plots.curves_data import CurveData
from paminsa_viz.plots.curves_model import build
from paminsa_viz.plots.curves_sources import OtherTorques, Sources
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.simulation import Simulation

CurveKind = Literal["torques", "breakdown", "pose", "power", "energy", "tracking", "comparison"]
KINDS: tuple[CurveKind, ...] = get_args(CurveKind)
"""Kinds of figures, in the order in which a page offers them."""

__all__ = ["KINDS", "CurveData", "CurveKind", "OtherTorques", "curve_data", "figure_bytes"]


def curve_data(
    kind: CurveKind,
    analysis: TrajectoryAnalysis,
    *,
    reference: TrajectoryAnalysis | None = None,
    printed: TrajectoryAnalysis | None = None,
    simulation: Simulation | None = None,
    engine: OtherTorques | None = None,
    notes: Sequence[str] = (),
) -> CurveData:
    """Return what a figure over time shows.

    Args:
        kind: One of `KINDS`. ``"tracking"`` needs a simulation, ``"comparison"`` a second source
            of torques: an engine, else printed formulae, else a reference.
        analysis: The design on the trajectory.
        reference: Another design on the same trajectory, drawn dashed in gray.
        printed: The design by the formulae as printed, drawn dotted.
        simulation: The robot driven along the trajectory.
        engine: Torques from a physics engine at the trajectory's samples.
        notes: Further sentences for the caption.

    Raises:
        InvalidInput: If the kind is unknown, what it needs is missing, or the sources are not of
            the same trajectory.
    """
    return build(kind, Sources(analysis, reference, printed, simulation, engine), notes)


def figure_bytes(
    kind: CurveKind,
    analysis: TrajectoryAnalysis,
    *,
    reference: TrajectoryAnalysis | None = None,
    printed: TrajectoryAnalysis | None = None,
    simulation: Simulation | None = None,
    engine: OtherTorques | None = None,
    notes: Sequence[str] = (),
    format: str = "png",
    width_mm: float = 170.0,
    dpi: float = 300.0,
    title: str | None = None,
    caption: bool = True,
) -> bytes:
    """Draw a figure over time for print; see `curve_data` and `curves_paper.render_curves`.

    Raises:
        InvalidInput: As they do.
    """
    # Late: matplotlib takes a second to load, and a page that only plots does not need it.
    from paminsa_viz.plots.curves_paper import render_curves

    data = curve_data(
        kind, analysis, reference=reference, printed=printed, simulation=simulation, engine=engine,
        notes=notes,
    )  # fmt: skip
    return render_curves(data, format, width_mm=width_mm, dpi=dpi, title=title, caption=caption)
