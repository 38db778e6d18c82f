"""Maps over x and y at the pose's angle and height: static torques, force of M4, condition."""

from __future__ import annotations

from paminsa_viz.plots.map_data import FULL, MapData, map_data, workspace_field
from paminsa_viz.plots.map_figure import render
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales
from paminsa_viz.quantities import TORQUES
from paminsa_viz.report.blocks import Block, Figure, Note, Section
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.units import format_value

DPI = 150.0
"""Resolution of the colored cells inside the figures."""


def maps_section(request: ReportRequest) -> Section:
    """Return the section."""
    geometry = request.design.geometry
    _, _, theta, z = request.pose
    field = workspace_field(geometry, theta, z, FULL)

    def maps(*quantities: str) -> MapData:
        return map_data(field, request.design, request.pose, quantities)

    blocks: list[Block] = [
        Note(
            f"All maps are at θ = {format_value(theta, 'rad')} and z = {format_value(z, 'm')}. The "
            "torques of M1 to M3 are one number, M_p2, times a map that the lengths alone decide."
        ),
        _figure(maps(*TORQUES), 170.0, half=False),
        _figure(maps("f_4"), 85.0, half=True),
        _figure(maps("condition"), 85.0, half=True),
    ]
    return Section("maps", "Torque maps", tuple(blocks))


def _figure(data: MapData, width: float, *, half: bool) -> Figure:
    kind = "linear" if data.signed or data.unit == "N" else "symlog"
    scales = choose_scales(data, ScaleChoice(shared=True, kind=kind))
    svg = render(data, scales, "svg", width_mm=width, dpi=DPI, caption=not half)
    return Figure(svg, f"Map over x and y: {data.title}.", half=half)
