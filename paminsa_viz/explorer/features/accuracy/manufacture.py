"""Errors by manufacture: tolerances, which length counts most, random robots, unequal legs."""

from __future__ import annotations

from functools import partial

from paminsa_viz.blocks.accuracy import own_legs, shares_table, tolerance_blocks
from paminsa_viz.blocks.kinds import Table
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.features.accuracy.monte_carlo import MONTE_CARLO, setting, shown_lengths
from paminsa_viz.explorer.kit.design_numbers import set_value, what
from paminsa_viz.explorer.kit.entries import Answer, ButtonGroup, Effect, Folder, Html
from paminsa_viz.explorer.kit.inputs import Number, Slider
from paminsa_viz.explorer.kit.text import blocks_html, render
from paminsa_viz.explorer.state.monte_carlo import NAMES
from paminsa_viz.explorer.state.state import State
from paminsa_viz.kept import kept
from paminsa_viz.model import PARAMETER, Design
from paminsa_viz.model.accuracy import LEG_NAMES, NO_DEVIATIONS, NO_TOLERANCES, Tolerances
from paminsa_viz.model.arrays import Pose
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import ToleranceErrors, tolerance_errors
from paminsa_viz.units import display_unit


@kept(4)
def errors_at(design: Design, pose: Pose) -> ToleranceErrors:
    """Return the errors of a design with nothing but lengths and tolerances at a pose."""
    return tolerance_errors(design, pose)


def tolerances_html(frame: Frame) -> str:
    """Return the errors by tolerances and clearances at the pose."""
    blocks = tolerance_blocks(errors_at(*shown_lengths(frame)))
    narrow = (one.columns(0, 1, 2, 3) if isinstance(one, Table) else one for one in blocks)
    return blocks_html("manufacture-errors", *narrow, bold=[1])


def shares_html(frame: Frame) -> str:
    """Return the share of each length in the variance of a coordinate, as bars."""
    index = frame.state.monte_carlo.settings.coordinate
    table = shares_table(errors_at(*shown_lengths(frame)), index)
    return render("accuracy/shares.j2", name=NAMES[index], table=table)


def legs_html(frame: Frame) -> str:
    """Return where the design's own legs put the platform, if they are not alike."""
    return blocks_html("manufacture-legs", own_legs(*shown_lengths(frame)))


def _tolerance_choices(state: State) -> dict[str, Effect]:
    now = state.document.design.tolerances
    all_of = {"Default": Tolerances(), "None": NO_TOLERANCES}
    return {
        name: partial(actions.change_design, tolerances=value)
        for name, value in all_of.items()
        if value != now
    }


def _leg_choices(state: State) -> dict[str, Effect]:
    if state.document.design.deviations == NO_DEVIATIONS:
        return {}
    legs = dict(zip(LEG_NAMES, NO_DEVIATIONS, strict=True))
    return {"All legs alike": partial(actions.change_design, **legs)}


def _deviation(state: State) -> tuple[str, float]:
    """Return the path of the deviation that is shown, and millimeters or degrees of its unit."""
    shown = state.monte_carlo.settings
    length = LENGTHS[shown.length]
    return f"{LEG_NAMES[shown.leg]}.{length.name}", display_unit(length.unit).factor


def _deviation_label(state: State) -> str:
    return f"Off by [{display_unit(LENGTHS[state.monte_carlo.settings.length].unit).text}]"


def _read_deviation(state: State) -> float:
    path, factor = _deviation(state)
    return round(state.document.design.value(path) * factor, 9)


def _set_deviation(state: State, value: float) -> State:
    path, factor = _deviation(state)
    return actions.vary(state, {path: round(value / factor, 12)})


def grown(ends: tuple[float, float], value: float) -> tuple[float, float]:
    """Return the ends of a slider, grown to hold a value."""
    return min(ends[0], value), max(ends[1], value)


_LABELS = {
    "bar": "Bars", "shaft": "Shaft B2", "joint_height": "Joint 5 up", "guide_height": "Guide up",
    "axis_radius": "Leg axes R_b", "axis_angle": "Leg axes at", "joint_radius": "Joints 5 R_pl",
    "joint_angle": "Joints 5 at", "actuator_zero": "Zeros M", "pin_clearance": "Pin play",
    "guide_clearance": "Guide play",
}  # fmt: skip


def error_slider(path: str, label: str, high: float, step: float, hint: str = "") -> Slider:
    """Return the slider of an error of the design, in micrometers or degrees."""
    parameter = PARAMETER[path]
    unit = display_unit("m:um" if parameter.unit == "m" else "rad")
    return Slider(
        path, f"{label} [{unit.text}]", range=(0.0, high), step=step, unit=unit, fit=grown,
        hint=f"{what(parameter)}{hint}",
        read=lambda state: state.document.design.value(path),
        apply=partial(set_value, path=path, name=label, unit=unit),
    )  # fmt: skip


def _slider(name: str) -> Slider:
    path = f"tolerances.{name}"
    high, step = (500.0, 1.0) if PARAMETER[path].unit == "m" else (0.2, 0.001)
    return error_slider(path, _LABELS[name], high, step)


MANUFACTURE = (
    Answer(
        "manufacture.answer", "Errors by manufacture", always=True,
        entries=(
            Html("manufacture.errors", content=tolerances_html, idle=True),
            setting("coordinate"),
            Html("manufacture.shares", content=shares_html, idle=True),
            Html("manufacture.own", content=legs_html, idle=True),
        ),
    ),
    Folder(
        "manufacture.tolerances", "Tolerances, ±", open=False,
        entries=(
            *(_slider(name) for name in _LABELS),
            ButtonGroup(
                "manufacture.reset", "Set to", choices=_tolerance_choices,
                hint="All tolerances and clearances as for a new design, or zero",
            ),
        ),
    ),
    Folder(
        "manufacture.random", "Random robots (Monte Carlo)", entries=MONTE_CARLO,
    ),
    Folder(
        "manufacture.legs", "Deviations of each leg", open=False,
        entries=(
            setting("leg"),
            setting("length"),
            Number(
                "manufacture.deviation", _deviation_label, range=(-100.0, 100.0), step=0.01,
                hint="Actual minus nominal",
                read=_read_deviation, apply=_set_deviation,
            ),
            ButtonGroup(
                "manufacture.alike", "Set to", choices=_leg_choices,
                hint="Takes all deviations away, such as a calibration has found",
            ),
        ),
    ),
)  # fmt: skip
