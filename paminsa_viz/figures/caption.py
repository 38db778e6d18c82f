"""What stands under a printed figure: what it shows, of which robot, where, and made by what."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.figures import axes, ticks
from paminsa_viz.figures.maps import MapData
from paminsa_viz.figures.scale import Scale

LONGEST_NAME = 60
"""Characters of a design's name that a caption repeats."""


def caption(data: MapData, scales: tuple[Scale, ...]) -> str:
    """Return the caption of a figure as one paragraph."""
    source = data.provenance
    numbers = "".join(f", {s} = {ticks.number(v)} {u}".rstrip() for s, v, u in source.numbers)
    robot = f"PAMINSA, design {shown(source.design)}, {source.assembly} assembly{numbers}"
    if source.reference:
        robot += f", minus design {shown(source.reference)}"
    x, y, z = (ticks.number(float(v) * axes.MM) for v in data.pose[[0, 1, 3]])
    theta = ticks.number(math.degrees(data.theta))
    parts = [
        f"{robot}; θ = {theta}°, z = {z} mm.",
        f"Ring: pose x = {x} mm, y = {y} mm{_values_here(data)}.",
        _contours(data, scales),
        "Thick line: boundary of the workspace; hatched: not reachable.",
    ]
    if data.singular_radius:
        radius = ticks.number(data.singular_radius * axes.MM)
        parts.append(f"Dashed: singular positions, radius {radius} mm.")
    parts.append(f"paminsa_viz {source.version}.")
    return " ".join(part for part in parts if part)


def summary(data: MapData) -> str:
    """Return one line about a map for a file's metadata."""
    source = data.provenance
    x, y, theta, z = data.pose
    return (
        f"{data.title or 'Map'} of PAMINSA, design {shown(source.design)}, {source.assembly} "
        f"assembly, pose x = {x:.6g} m, y = {y:.6g} m, theta = {theta:.6g} rad, z = {z:.6g} m"
    )


def shown(name: str) -> str:
    """Return a name that a person gave, on one line and not too long, in quotation marks."""
    plain = " ".join("".join(c if c.isprintable() else " " for c in name).split())
    if len(plain) > LONGEST_NAME:
        plain = plain[: LONGEST_NAME - 1] + "…"
    return f"“{plain}”"


def _contours(data: MapData, scales: tuple[Scale, ...]) -> str:
    if len(set(scales)) > 1 or scales[0].kind != "linear" or len(scales[0].levels) < 2:
        return ""
    factor, unit = data.display
    step = (scales[0].levels[1] - scales[0].levels[0]) * factor
    return f"Contours every {ticks.number(step)} {unit}".rstrip() + "."


def _values_here(data: MapData) -> str:
    """Return the values of the cell under the pose, if there are any."""
    left, right, bottom, top = data.extent
    x, y = float(data.pose[0]), float(data.pose[1])
    if not (left <= x < right and bottom <= y < top):
        return " (outside the map)"
    column = int((x - left) / (right - left) * data.x.size)
    row = int((y - bottom) / (top - bottom) * data.y.size)
    values = data.values[:, row, column]
    if np.isnan(values).any():
        return f" ({axes.reasons(data)[row, column]})"
    return ""
