"""Workspace: sizes in closed form, which poses can be taken, and static torques over them."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.blocks.kinds import Block, Note, Row, Table, actuator_rows, rows
from paminsa_viz.engines.poses import WORST_CONDITION, workspace_poses
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.drive import TORQUE_UNITS
from paminsa_viz.model.grids import Grid
from paminsa_viz.model.reach import Limit, workspace_height, workspace_radius
from paminsa_viz.model.singularity import singular_radius, singular_rotation
from paminsa_viz.model.statics import static_torques
from paminsa_viz.plots.series_builders import SYMBOLS
from paminsa_viz.studies.sweeps import sweep
from paminsa_viz.units import capitalized, format_value, percent

SAMPLED = 20_000
"""Random poses behind the statistics of static torques."""

CELLS = (41, 41, 13, 17)
"""Cells along x, y, theta and z behind the shares of poses."""


def workspace_blocks(design: Design, theta: float, seed: int = 0) -> list[Block]:
    """Return sizes of a robot, which poses it can take, and how large its static torques are.

    Args:
        design: The robot.
        theta: Heading of the singular positions [rad].
        seed: Of the random poses behind the torques.
    """
    return [_sizes(design.geometry, theta), _shares(design), *_torques(design, seed)]


def _sizes(g: Geometry, theta: float) -> Table:
    bars, turn = g.crank_length + g.coupler_length, singular_rotation(g)
    sizes = {
        "Farthest position of the platform from the axis, at the best angle and height":
            format_value(workspace_radius(g), "m"),
        "Largest height of joints 5 above or below the guides, platform in the middle":
            format_value(workspace_height(g), "m"),
        "Reach of a pantograph, l_B4 + l_B8": format_value(bars, "m"),
        "Distance of joints 8 and 5 in the middle, at the height of the guides":
            format_value(g.home_span, "m"),
        "Stroke of joint 8 on its guide": format_value(g.stroke, "m"),
        "Angle at which every position is singular":
            "none" if math.isnan(turn) else "± " + format_value(turn, "rad"),
        f"Radius of singular positions at θ = {format_value(theta, 'rad')}":
            format_value(float(singular_radius(g, theta)), "m"),
    }  # fmt: skip
    return Table(
        ("Quantity", "Value"),
        rows(*sizes.items()),
        "Sizes that follow from the lengths in closed form.",
    )


def _shares(design: Design) -> Table:
    """Return the reachable share of a box around the workspace, and the limits of the rest."""
    g = design.geometry
    across, up = workspace_radius(g), workspace_height(g)
    turn = float(np.nan_to_num(singular_rotation(g), nan=math.pi))
    axes = [
        half * (2 * (np.arange(n) + 0.5) / n - 1)
        for half, n in zip((across, across, turn, up), CELLS, strict=True)
    ]
    x, y, theta, z = axes
    grid = Grid.over(np.zeros(4), theta=theta, z=z - g.platform_joint_height, y=y, x=x)
    counts = sweep(design, grid, ("reach_margin",)).counts
    shares = tuple(
        Row(
            (capitalized(limit.explanation), percent(counts[limit] / grid.size, 1)),
            "total" if limit is Limit.OK else "plain",
        )
        for limit in Limit
        if counts[limit]
    )
    box = (
        f"|x|, |y| ≤ {format_value(across, 'm', 3)}, |θ| ≤ {format_value(turn, 'rad', 3)}, "
        f"joints 5 within {format_value(up, 'm', 3)} of the guides"
    )
    caption = f"Poses of the box {box}, on a grid of {grid.size:,} poses."
    return Table(("Poses", "Share"), shares, caption)


def _torques(design: Design, seed: int) -> list[Block]:
    """Return statistics of the static torques over random poses."""
    try:
        poses = workspace_poses(design.geometry, SAMPLED, seed)
    except InvalidInput as error:
        return [Note(f"Static torques over the workspace: {error.problem}.", "warn")]
    size = np.abs(static_torques(design, poses))
    figures = [np.sqrt((size**2).mean(axis=0)), *np.percentile(size, [50, 95, 99], axis=0)]
    cells = [
        (name, *(format_value(float(figure[j]), unit) for figure in figures))
        for j, (name, unit) in enumerate(zip(SYMBOLS, TORQUE_UNITS, strict=True))
    ]
    caption = (
        f"Size of the static torques at {SAMPLED:,} random poses of the workspace with a condition "
        f"number of at most {WORST_CONDITION:g}: toward singular poses they grow without bound."
    )
    head = ("", "RMS", "Median", "95 % are below", "99 % are below")
    return [Table(head, actuator_rows(*cells), caption)]
