"""Geometry and workspace: sizes in closed form, which poses can be taken, a sketch; and maps."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MatplotlibFigure

from paminsa_viz.blocks.balance import RULE
from paminsa_viz.blocks.kinds import Block, Figure, Note
from paminsa_viz.blocks.workspace import workspace_blocks
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.kinematics import AXIS_ANGLES, Configuration, inverse_kinematics
from paminsa_viz.model.parameters import LEG_JOINTS
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.palette import INK, LEG_COLORS, LIFT_COLOR, MUTED, PLATFORM
from paminsa_viz.plots.formats import Credits, drawing, figure_file
from paminsa_viz.plots.map_figure import render_maps
from paminsa_viz.plots.map_values import (
    FULL,
    MapData,
    difference,
    half_width,
    map_data,
    workspace_field,
)
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.quantities import TORQUES
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.units import format_value

DPI = 150.0
"""Resolution of the colored cells inside the maps."""


def workspace_section(request: ReportRequest) -> Section:
    """Return the section."""
    design = request.design
    configuration = inverse_kinematics(design.geometry, request.pose)
    blocks: list[Block] = [
        Figure(
            partial(sketch, configuration),
            "The robot’s joints and bars in the pose of the report, from above and from the side.",
            "The robot in the pose of the report, to scale. From above: thin circle through the "
            "leg axes; dashed circle of positions that are singular at this angle. From the side: "
            "dotted line at the height of the guides.",
        ),
        *workspace_blocks(design, request.pose[2], request.seed),
    ]
    return Section("workspace", "Geometry and workspace", tuple(blocks))


def maps_section(request: ReportRequest) -> Section:
    """Return the section."""
    geometry = request.design.geometry
    _, _, theta, z = request.pose
    field = workspace_field(geometry, theta, z, FULL)

    def maps(*quantities: str) -> MapData:
        return map_data(field, request.design, request.pose, quantities)

    torques = maps(*TORQUES)
    blocks: list[Block] = [
        Note(f"θ = {format_value(theta, 'rad')}, z = {format_value(z, 'm')}. {RULE}"),
        _map_figure(torques, 170.0, half=False),
        _map_figure(maps("f_4"), 85.0, half=True),
        _map_figure(maps("condition"), 85.0, half=True),
    ]
    if (other := request.reference) is not None:
        same_cells = workspace_field(other.geometry, theta, z, FULL, half_width(geometry))
        held = map_data(same_cells, other, request.pose)
        blocks.append(_map_figure(difference(torques, held), 170.0, half=False))
    return Section("maps", "Torque maps", tuple(blocks))


def _map_figure(data: MapData, width: float, *, half: bool) -> Figure:
    kind = "linear" if data.signed or data.unit == "N" else "symlog"
    scales = choose_scales(data, ScaleChoice(shared=True, kind=kind))
    draw = partial(render_maps, data, scales, "svg", width_mm=width, dpi=DPI, caption=not half)
    return Figure(draw, f"Map over x and y: {data.title}.", half=half)


WIDTH = 9.0
"""Width of the drawing [inches]."""

DRAWN_BARS = ((9, 5), (8, 9), (4, 7), (7, 8))
"""Joints at the ends of the bars B4, B8, B3 and B7."""


def sketch(configuration: Configuration) -> bytes:
    """Return both views of a configuration of shape () as SVG."""
    with drawing():
        title = "PAMINSA from above and from the side"
        return figure_file(draw_sketch(configuration), "svg", 72.0, Credits(title, title))


def draw_sketch(configuration: Configuration) -> MatplotlibFigure:
    """Return both views of a configuration of shape (), to one scale, inside `formats.drawing`."""
    g = configuration.geometry
    joints = {number: np.asarray(configuration.points[number]) for number in LEG_JOINTS}
    feet = g.base_radius * np.array([[np.cos(a), np.sin(a), 0.0] for a in AXIS_ANGLES])
    plate = joints[5] - [0.0, 0.0, g.platform_joint_height]
    singular = float(singular_radius(g, configuration.pose[2]))
    around = max(g.base_radius, singular)
    everything = np.concatenate([*joints.values(), feet, plate, [[around] * 2 + [0.0]]])
    everything = np.concatenate([everything, [[-around] * 2 + [0.0]]])
    margin = 0.04 * np.ptp(everything[:, 0])
    low, high = everything.min(axis=0) - margin, everything.max(axis=0) + margin
    size = high - low
    words, half = 0.35, 0.48  # room below for words [inches], width of a view as a share
    height = half * WIDTH * max(size[1:]) / size[0] + words
    page = MatplotlibFigure(figsize=(WIDTH, height))
    for up, start, text in ((1, 0.0, "from above: x right, y up"),
                            (2, 1 - half, "from the side: x right, z up")):  # fmt: skip
        area = page.add_axes((start, words / height, half, 1 - words / height))
        area.set(xlim=(low[0], high[0]), ylim=(low[up], high[up]), aspect="equal")
        area.set_axis_off()
        page.text(start + half / 2, 0.1 / height, text, ha="center", color=INK, size=10)
        if up == 1:
            area.plot(0, 0, "+", color=MUTED, ms=8)
            for radius, color, dash in ((g.base_radius, MUTED, "-"), (singular, INK, "--")):
                turn = np.linspace(0, 2 * np.pi, 181)
                area.plot(radius * np.cos(turn), radius * np.sin(turn), dash, color=color, lw=0.8)
        else:
            area.axhline(0, color=MUTED, lw=0.8, ls=":")
            hub = [0.0, 0.0, float(configuration.actuators[3])]
            for arm in joints[2]:
                _line(area, np.array([hub, arm]), up, LIFT_COLOR, 2.2)
            for one, other in zip(plate, joints[5], strict=True):
                _line(area, np.array([one, other]), up, INK, 1.3)
        area.fill(plate[:, 0], plate[:, up], fc=PLATFORM, ec=INK, lw=1.3, alpha=0.8)
        for leg, color in enumerate(LEG_COLORS):
            points = {number: point[leg] for number, point in joints.items()}
            _draw_leg(area, points, feet[leg], up, color)
            place, shift = points[2], np.array([0.0, 9.0])  # points
            if up == 1:
                ahead = points[5] - feet[leg]
                aside = np.array([-ahead[1], ahead[0]]) / max(float(np.hypot(*ahead[:2])), 1e-9)
                place, shift = feet[leg], 13 * aside
            area.annotate(
                str(leg + 1), place[[0, up]], tuple(shift), textcoords="offset points",
                ha="center", va="center", color=color, size=10,
            )  # fmt: skip
    return page


def _draw_leg(area: Axes, points: dict[int, Array], foot: Array, up: int, color: str) -> None:
    _line(area, np.array([foot, points[8]]), up, color, 1.1, "--")
    _line(area, np.array([points[3], points[2]]), up, LIFT_COLOR, 2.2)
    for first, second in DRAWN_BARS:
        _line(area, np.array([points[first], points[second]]), up, color, 2.2)
    rings = np.array([points[number] for number in (3, 4, 5, 7, 8, 9)])
    for at, size in ((foot[None], 9), (rings, 4.5)):
        area.plot(at[:, 0], at[:, up], "o", ms=size, mfc="white", mec=color, mew=1.0)


def _line(area: Axes, ends: Array, up: int, color: str, width: float, dash: str = "-") -> None:
    area.plot(ends[:, 0], ends[:, up], dash, color=color, lw=width, solid_capstyle="round")
