"""The pose: its status and numbers, a slider for each coordinate, the knee, undo and redo."""

from __future__ import annotations

from functools import partial
from math import ceil, floor
from typing import Any

import numpy as np

from paminsa_viz.dimensions.layout import layout
from paminsa_viz.explorer.core import actions, clearance
from paminsa_viz.explorer.core.frame import Frame, Health
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.kit.design_numbers import of_size, shrunk
from paminsa_viz.explorer.kit.entries import Button, Html, Run
from paminsa_viz.explorer.kit.inputs import Dropdown, Number, Slider, attribute
from paminsa_viz.explorer.kit.robot_texts import decimals, line_texts, millimeter_decimals, of_pose
from paminsa_viz.explorer.kit.text import render
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import Geometry, KneeBranch
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.reach import MARGINS, home_pose, workspace_radius
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.units import capitalized, display_unit, fixed

LEVELS = {
    Health.OK: "ok",
    Health.BEYOND: "warn",
    Health.NEAR: "warn",
    Health.UNREACHABLE: "bad",
}


def _status(frame: Frame) -> tuple[str, str, list[str]]:
    """Return the level of the status, its title, and the lines that explain it."""
    lines = [frame.explanation]
    if frame.health is not Health.UNREACHABLE:
        lines += [f"the {locus.label} lies between this pose and home" for locus in frame.barriers]
    level, title = LEVELS[frame.health], frame.health.value.capitalize()
    if frame.health is not Health.UNREACHABLE:
        distance, why = clearance.reason(frame.state)
        if why:
            lines = [why, *lines] if frame.health is not Health.OK else [why]
            level, words = clearance.headline(distance)
            title = f"{title}, {words}"
    return level, title, lines


def status_html(frame: Frame) -> str:
    """Return all that explains the status, in lines; nothing if all is well."""
    level, _, (reason, *others) = _status(frame)
    if level == "ok":
        return ""
    return render(
        "status.j2", testid="status-lines", level=level, title=capitalized(reason),
        lines=map(capitalized, others),
    )  # fmt: skip


def status_line_html(frame: Frame) -> str:
    """Return the status in one line, whose end may be cut off, and a button that undoes."""
    level, title, lines = _status(frame)
    if frame.health is Health.OK and level == "ok":
        margin = 1e3 * frame.configuration.reach.margins.min()
        places = millimeter_decimals(frame.configuration.geometry) - 1
        lines = [f"margin {fixed(float(margin), places)} mm to the nearest limit"]
    back = bool(frame.state.steps.back)
    return render("pose/status_line.j2", level=level, title=title, lines=lines, back=back)


def _at_rest(name: str, frame: Frame, **values: Any) -> str:
    """Return a template of this section with what it writes of a robot at rest."""
    return render(
        f"pose/{name}.j2", frame=frame, torques=frame.torques,
        decimals=decimals(frame.shown_design),
        places=millimeter_decimals(frame.configuration.geometry), **values,
    )  # fmt: skip


def load_html(frame: Frame) -> str:
    """Return the static torques in one line."""
    return render("pose/load.j2", texts=line_texts(frame.shown_design, frame.torques))


def actuators_html(frame: Frame) -> str:
    """Return positions and static torques of the four actuators."""
    text = _at_rest(
        "actuators", frame, pinned=frame.state.document.reference is not None,
        reference=frame.reference_torques, degrees=np.degrees,
    )  # fmt: skip
    return of_pose(frame, text)


def torques_html(frame: Frame) -> str:
    """Return the static torques in two lines, with the change from the reference."""
    return _at_rest(
        "torques", frame, reference=frame.reference_torques,
    )  # fmt: skip


AMPLE, SMALL, TINY = 0.2, 0.05, 0.01
"""Margins to a limit, at Appendix 4's lengths [m]: of a full bar, and below which a bar is amber or
red."""


def _margin_level(margin: float, size: float) -> str:
    margin /= size
    return "bad" if margin < TINY else "warn" if margin < SMALL else "ok"


def quality_html(frame: Frame) -> str:
    """Return static imbalance, condition, distances to singularities and the legs' margins."""
    size = length_ratio(frame.configuration.geometry)
    text = _at_rest(
        "quality", frame, singularity=frame.singularity, degrees=np.degrees,
        margins=frame.configuration.reach.margins, finite=np.isfinite,
        limits={limit.label: index for index, limit in enumerate(MARGINS)},
        level=partial(_margin_level, size=size),
        share=lambda margin: f"{min(max(margin / (AMPLE * size), 0.0), 1.0):.3f}",
    )  # fmt: skip
    return of_pose(frame, text)


def summary_html(frame: Frame) -> str:
    """Return condition, least margin and static imbalance in a line."""
    return _at_rest(
        "summary", frame, margin=frame.configuration.reach.margins.min(),
    )  # fmt: skip


def pose_line_html(frame: Frame) -> str:
    """Return the pose that numbers belong to, in mm and degrees."""
    x, y, theta, z = frame.state.last_reachable.pose
    # Of a design that reaches nothing the pose that is asked for is shown, out of reach as it is.
    reached = bool(frame.configuration.reach.ok.all())
    return render(
        "pose/line.j2", stale=frame.health is Health.UNREACHABLE, reached=reached,
        other=frame.state.last_reachable.geometry != frame.state.document.design.geometry,
        places=millimeter_decimals(frame.configuration.geometry),
        values=[(1e3 * x, "mm"), (1e3 * y, "mm"), (float(np.degrees(theta)), "°"),
                (1e3 * z, "mm")],
    )  # fmt: skip


GRAIN = 10
"""Ends of ranges are multiples of this [mm or degrees]."""

LEAST_STEPS = 5
"""Least half width of the ranges of x and y over `GRAIN`."""

Range = tuple[float, float]


@kept(64)
def pose_limits(geometry: Geometry) -> tuple[Range, Range, Range, Range]:
    """Return (lowest, highest) of the sliders for x, y, theta, z, in mm and degrees."""
    step = grain(geometry)
    radius = float(max(ceil(1e3 * workspace_radius(geometry) / step), LEAST_STEPS) * step)
    return (-radius, radius), (-radius, radius), (-180.0, 180.0), heights(geometry)


def heights(geometry: Geometry) -> Range:
    """Return the platform heights that the slider offers, which are clear of the frame [mm].

    Home is always among them. The frame is drawn for machines like the paper's; to others it may
    leave less room, or none.
    """
    place, step = layout(geometry), grain(geometry)
    low = ceil(1e3 * place.platform_low / step) * step
    high = floor(1e3 * place.platform_high / step) * step
    return holding((low, max(high, low + step)), 1e3 * home_pose(geometry)[3], step)


def grain(geometry: Geometry) -> float:
    """Return what the ends of x, y and z are multiples of [mm], finer for a small robot."""
    return shrunk(GRAIN, "m", geometry)


def holding(ends: Range, value: float, step: float = GRAIN) -> Range:
    """Return a range, grown to a multiple of a step if it has to be to hold a value."""
    low, high = ends
    return (
        float(low if low <= value else floor(value / step) * step),
        float(high if high >= value else ceil(value / step) * step),
    )


def _slider(index: int, label: str, unit: str, step: float, hint: str) -> Slider:
    coordinate = COORDINATES[index]

    def limits(state: State) -> Range:
        geometry = state.document.design.geometry
        if not workspace_radius(geometry):  # it reaches nothing: there are no ends to slide to
            geometry = state.last_reachable.geometry
        return pose_limits(geometry)[index]

    return Slider(
        f"pose.{coordinate}", label, unit=display_unit(unit), step=of_size(step, unit), hint=hint,
        range=limits, fit=holding,
        read=lambda state: state.document.pose[index],
        apply=lambda state, value: actions.move(state, **{coordinate: value}),
    )  # fmt: skip


POSE = (
    _slider(0, "x  [mm]", "m", 1.0, "Platform position along x"),
    _slider(1, "y  [mm]", "m", 1.0, "Platform position along y"),
    _slider(2, "θ  [°]", "rad", 0.5, "Rotation of the platform about the vertical"),
    _slider(
        3, "z  [mm]", "m", 1.0,
        "Height of the platform; 0 is the plane of the guides. The slider keeps the robot clear "
        "of its frame as it is drawn; any other height can be typed.",
    ),
    Dropdown(
        "pose.knee", "Knee branch",
        options={
            "lower knee (as published)": KneeBranch.LOWER,
            "upper knee (mirrored)": KneeBranch.UPPER,
        },
        hint="Which root of Appendix 1 the knee 9 takes; switching mirrors the height",
        read=lambda state: state.document.design.geometry.knee, apply=actions.set_knee,
    ),
    Html("pose.steps.mark", content='<span class="pv-button-row"></span>'),
    Button("pose.home", "Home", effect=actions.go_home, color="gray",
           hint="The middle of the workspace (key: H)"),
    Button("pose.undo", "Undo", effect=Run(Session.undo, at_once=True), color="gray",
           hint="The last change of design, pose, motion or requirements (Ctrl+Z)",
           disabled=lambda state: not state.steps.back),
    Button("pose.redo", "Redo", effect=Run(Session.redo, at_once=True), color="gray",
           hint="What was undone last (Ctrl+Shift+Z, Ctrl+Y)",
           disabled=lambda state: not state.steps.forward),
    Html("readout.status", content=status_html),
    Html("readout.actuators", content=actuators_html),
    Html("readout.quality", content=quality_html),
    Number(
        "pose.condition_limit", "Largest condition number", range=(1.5, 1e6), step=1.0,
        hint="Poses with a larger condition number, and those within 10 mm (at Appendix 4’s "
        "lengths, else in proportion) of a stretched or folded pantograph or of a leg axis, are "
        "too close to a singularity: torques grow without bound. The status warns of them, and "
        "statistics and the balance leave them out.",
        **attribute("condition_limit"),
    ),
)  # fmt: skip
