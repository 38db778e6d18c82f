"""The text below a figure: what it shows, which robot, where, and the version of this package."""

from __future__ import annotations

import math

from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.load import POINT, WRENCH
from paminsa_viz.model.statics import shown_imbalance
from paminsa_viz.plots.contours import contour_lines
from paminsa_viz.plots.hover import cell_at, reasons
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import MM, TIE, display_unit, number
from paminsa_viz.version import MADE_BY

LONGEST_NAME = 60
"""Characters of a design's name that a caption repeats."""


def caption(data: MapData, scales: tuple[Scale, ...], circles: str = "") -> str:
    """Return the caption of a figure as one paragraph.

    Args:
        data: The maps.
        scales: Color scales, one a panel.
        circles: Name of a table whose values are drawn as circles; empty for none.
    """
    x, y, z = (float(v) * MM for v in data.pose[[0, 1, 3]])
    theta = equals("θ", math.degrees(data.theta), "") + "°"
    parts = [
        f"{robot(data.design, data.reference)}; {theta}, {equals('z', z, 'mm')}.",
        f"Ring: pose {equals('x', x, 'mm')}, {equals('y', y, 'mm')}{_trouble(data)}.",
        contours_text(data, scales),
        "Thick line: boundary of the workspace; hatched: not reachable.",
    ]
    if circles:
        parts.append(f"Circles: torques of {shown(circles)}, in their own colors.")
    if data.singular_radius:
        radius = equals("radius", data.singular_radius * MM, "mm")
        parts.append(f"Dashed: singular positions, {radius}.")
    if data.outside is not None and (present := data.outside.present()):
        names = ", ".join(reason for reason, _ in present)
        parts.append(f"Colored hatching: requirements broken ({names}).")
    if data.missing_word:
        parts.append(f"Dark gray: {data.missing_word}.")
    if any(any(s.exceeded(panel)) for panel, s in zip(data.values, scales, strict=True)):
        parts.append("Pointed ends of the color bar: beyond its range.")
    parts.append(f"{MADE_BY}.")
    return " ".join(part for part in parts if part)


def key_numbers(design: Design) -> list[tuple[str, float, str]]:
    """Return the numbers of a design that captions and tables name: symbol, value, unit (SI)."""
    numbers = [("Mₚ₂", shown_imbalance(design), "N")]
    numbers += [("payload", design.payload.mass, "kg")] if design.payload.mass else []
    names = WRENCH if not any(design.load.wrench[:3]) else (*WRENCH, *POINT)
    for path in (f"load.{name}" for name in names):
        if value := design.value(path):
            numbers.append((PARAMETER[path].symbol, value, PARAMETER[path].unit))
    return numbers


def robot(design: Design, reference: Design | None = None) -> str:
    """Return the robot that numbers belong to, as the start of a sentence."""
    numbers = ""
    for symbol, value, unit in key_numbers(design):
        display = display_unit(unit)
        numbers += f", {equals(symbol, display.from_si(value), display.text)}"
    turning = ", load turning with the platform" if design.load.acts and design.load.turns else ""
    words = f"PAMINSA, design {shown(design.name)}, {design.geometry.knee.label}{numbers}"
    return words + turning + _minus(reference)


def _minus(reference: Design | None) -> str:
    """Return what a difference is to, as the end of a robot's name; "" for no difference."""
    return f", minus design {shown(reference.name)}" if reference else ""


def summary(data: MapData) -> str:
    """Return one line about a map for a file's metadata."""
    x, y, theta, z = data.pose
    return (
        f"{data.title or 'Map'} of PAMINSA, design {shown(data.design.name)}, "
        f"{data.design.geometry.knee.label}{_minus(data.reference)}, "
        f"pose x = {x:.6g} m, y = {y:.6g} m, theta = {theta:.6g} rad, z = {z:.6g} m"
    )


def shown(name: str) -> str:
    """Return a user's name for something, shortened to one line, in quotation marks."""
    plain = " ".join("".join(c if c.isprintable() else " " for c in name).split())
    if len(plain) > LONGEST_NAME:
        plain = plain[: LONGEST_NAME - 1] + "…"
    return f"“{plain}”"


def contours_text(data: MapData, scales: tuple[Scale, ...]) -> str:
    """Return how far contours are apart, "" where none is drawn, or not evenly or equally."""
    if len(set(scales)) > 1 or scales[0].kind != "linear" or len(scales[0].levels) < 2:
        return ""
    if not any(contour_lines(data, panel, scale) for panel, scale in enumerate(scales)):
        return ""
    step = data.display.format(scales[0].levels[1] - scales[0].levels[0])
    return f"Contours every {step.replace(' ', TIE)}."


def equals(symbol: str, value: float, unit: str) -> str:
    """Return ``symbol = value unit`` that no line break tears apart."""
    return TIE.join([symbol, "=", number(value), *([unit] if unit else [])])


def _trouble(data: MapData) -> str:
    """Return why the cell under the pose has no value, if it has none."""
    cell = cell_at(data, float(data.pose[0]), float(data.pose[1]))
    if cell is None:
        return " (outside the map)"
    found = [str(reasons(data, panel)[cell]) for panel in range(data.panels)]
    return next((f" ({text})" for text in found if text), "")
