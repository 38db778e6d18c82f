"""The robot, its maps and its motions as things that a notebook shows inline.

The last line of a cell is shown::

    from paminsa_viz.notebook import curve_view, map_view, motion_view, robot_view

    robot_view(APPENDIX_4, (0.05, -0.03, 0.4, -0.6))

Robot and motion are pages of their own in a frame: the notebook keeps them, and they can be turned
and played without a kernel and without a network. Maps and curves are the app's and the report's.

The explorer itself opens in a tab of its own: it lets no other page, such as a notebook with
``IFrame``, show it in a frame, since clicks could be caught there.
"""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked, require_at_least, require_count
from paminsa_viz.errors import InvalidInput, name_hint
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.model.arrays import Array, as_numbers, as_pose
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.reach import home_pose
from paminsa_viz.trajectory import Trajectory, TrajectoryAnalysis

if TYPE_CHECKING:
    import plotly.graph_objects as go

    from paminsa_viz.plots.series import FigureKind

__all__ = ["InlinePage", "InlinePicture", "curve_view", "map_view", "motion_view", "robot_view"]

MOST_CELLS = 500
"""Most cells along a side of a map that shows each cell's value: more are not told apart in it."""


@dataclass(frozen=True)
class InlinePage:
    """A page of its own, shown in a frame.

    Attributes:
        content: The page, HTML in UTF-8.
        height: Of the frame [pixels]; it is as wide as the notebook.

    Raises:
        InvalidInput: If the height is less than 1.
    """

    content: bytes = field(repr=False)
    height: int = 480

    def __post_init__(self) -> None:
        require_at_least(self.height, "height", 1, "a whole number of pixels, at least 1,")

    def _repr_html_(self) -> str:
        # No access to the notebook it is in: the page runs its own scripts and nothing else.
        return (
            f'<iframe srcdoc="{html.escape(self.content.decode())}" sandbox="allow-scripts" '
            f'style="width: 100%; height: {self.height:d}px; border: 0"></iframe>'
        )

    def save(self, path: str | Path) -> None:
        """Write the page to a file, which any browser opens.

        Raises:
            FileError: If it cannot be written.
        """
        write_bytes(path, self.content)


@dataclass(frozen=True)
class InlinePicture:
    """A drawing.

    Attributes:
        svg: The drawing, SVG in UTF-8.
    """

    svg: bytes = field(repr=False)

    def _repr_svg_(self) -> str:
        return self.svg.decode()

    def save(self, path: str | Path) -> None:
        """Write the drawing to a file.

        Raises:
            FileError: If it cannot be written.
        """
        write_bytes(path, self.svg)


@kinds_checked
def robot_view(
    design: Design | None = None,
    pose: ArrayLike | None = None,
    *,
    height: int = 480,
) -> InlinePage:
    """Return the robot in 3D, to be turned and zoomed.

    Args:
        design: The robot; that of Appendix 4 if left out.
        pose: (4,) [m, m, rad, m]; in the middle of the workspace if left out.
        height: Of the frame [pixels], at least 1.

    Raises:
        InvalidInput: If the height is less.
        UnreachablePose: If the robot cannot take the pose.
    """
    from paminsa_viz.explorer.scene.html_pages import robot_html  # late: the page's libraries

    robot = design or APPENDIX_4
    return InlinePage(robot_html(robot, _pose(robot, pose)), height)


@kinds_checked
def motion_view(
    trajectory: Trajectory,
    design: Design | None = None,
    *,
    height: int = 560,
) -> InlinePage:
    """Return the moving robot in 3D, with a time line and its torques.

    Args:
        trajectory: The motion; one that fails is played up to there.
        design: The robot; that of Appendix 4 if left out.
        height: Of the frame [pixels], at least 1.

    Raises:
        InvalidInput: If the height is less.
        ImpossibleTrajectory: If the motion fails at its very start.
    """
    from paminsa_viz.explorer.scene.html_pages import motion_html  # late: the page's libraries

    return InlinePage(motion_html(design or APPENDIX_4, trajectory), height)


@kinds_checked
def map_view(
    design: Design | None = None,
    pose: ArrayLike | None = None,
    *,
    quantity: str = "torques",
    theta: float | None = None,
    z: float | None = None,
    at: tuple[float, float] | None = None,
    cells: int = 100,
    width: int = 900,
) -> go.Figure:
    """Return maps over x and y as a plotly figure, which shows values under the mouse.

    Plotly's script draws it; where there is none, as in a notebook exported to HTML, its
    ``write_html(path)`` keeps it, or `paminsa_viz.plots.render_maps` a picture.

    Args:
        design: The robot; that of Appendix 4 if left out.
        pose: (4,) [m, m, rad, m]; the maps are at its theta and z, and a ring marks its x and y.
            In the middle of the workspace, at theta = 0, if left out; Fig. 3 is at pi/3.
        quantity: ``"torques"`` for those of M1, M2 and M3, or a key of
            `paminsa_viz.quantities.QUANTITIES`; with hyphens too, as on the command line.
        theta, z, at: Angle [rad], height [m] and position (x, y) [m] in place of the pose's.
        cells: Cells along each side, 2 to `MOST_CELLS`; ``paminsa-viz map`` draws finer ones.
        width: Of the figure [pixels], at least 200.

    Raises:
        InvalidInput: If there is no such quantity, or a number is not possible.
    """
    from paminsa_viz.plots.interactive import interactive_map
    from paminsa_viz.plots.map_values import map_data, workspace_field
    from paminsa_viz.plots.ranges import choose_scales
    from paminsa_viz.quantities import selections

    quantity = quantity.replace("-", "_")
    if quantity not in selections():
        raise InvalidInput("quantity", name_hint(quantity, selections()))
    require_count(cells, "cells", MOST_CELLS, 2)
    if at is not None and as_numbers(at, "at").shape != (2,):
        raise InvalidInput("at", f"two numbers (x, y) are needed, not {at}")
    robot = design or APPENDIX_4
    place = _pose(robot, pose).copy()
    for where, given in ((slice(0, 2), at), (2, theta), (3, z)):
        if given is not None:
            place[where] = given
    if not np.isfinite(place).all():
        raise InvalidInput("pose", "finite numbers are needed")
    field = workspace_field(robot.geometry, float(place[2]), float(place[3]), cells)
    data = map_data(field, robot, place, selections()[quantity])
    return interactive_map(data, choose_scales(data), width)


@kinds_checked
def curve_view(
    analysis: TrajectoryAnalysis, kind: FigureKind = "torques", **more: Any
) -> InlinePicture:
    """Return curves over time as a drawing.

    Args:
        analysis: A design on a trajectory.
        kind: What is drawn, see `paminsa_viz.plots.FIGURES`.
        more: Further arguments of `paminsa_viz.plots.figure_bytes`, such as ``reference``; the
            format is SVG.

    Raises:
        InvalidInput: If the kind is unknown, or what it needs is missing.
    """
    from paminsa_viz.plots.series_figure import figure_bytes

    return InlinePicture(figure_bytes(kind, analysis, format="svg", **more))


def _pose(design: Design, pose: ArrayLike | None) -> Array:
    """Return the given pose, or the one in the middle of the workspace."""
    return np.array(home_pose(design.geometry)) if pose is None else as_pose(pose)
