"""Stiffness: elastic data, stiffness and deflection at the pose, natural frequencies and modes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from paminsa_viz.blocks.stiffness import (
    NO_FREQUENCIES,
    NOTHING_DEFLECTED,
    compensation_text,
    deflection_table,
    directions_table,
    modes_table,
    other_tubes,
    shares_table,
    softest_text,
)
from paminsa_viz.elastostatics.beams import tube_fits
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.features.stiffness.solving import analyze_elasticity
from paminsa_viz.explorer.kit.design_numbers import is_changed, slider, what
from paminsa_viz.explorer.kit.entries import Answer, ButtonGroup, Effect, Entry, Folder, Html
from paminsa_viz.explorer.kit.inputs import Number, Slider
from paminsa_viz.explorer.kit.robot_texts import gray_if
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs, layer_switch
from paminsa_viz.explorer.kit.task import NOT_OF_PREVIEW, Follower
from paminsa_viz.explorer.kit.text import note, render
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.stiffness import (
    CASES,
    MODES,
    ElasticJob,
    ElasticResult,
    StiffnessSettings,
)
from paminsa_viz.kept import kept
from paminsa_viz.model import PARAMETER
from paminsa_viz.model.elastic import BARS, SECTION_VALUES
from paminsa_viz.units import DisplayUnit, number

LAYERS = ("mode_shape", "deflection", "compliance")
"""Layers of the scene that need a result while something is dragged."""

STIFFEST = 1e12
"""Largest stiffness that can be typed [N/m, N m/rad]."""

MATERIAL = ("young_modulus", "shear_modulus")
DRIVE = ("drive_rotary", "drive_linear")

SLIDERS: dict[str, tuple[str, float, float, float]] = {
    "young_modulus": ("E [MPa]", 1000.0, 300_000.0, 500.0),
    "shear_modulus": ("G [MPa]", 500.0, 120_000.0, 500.0),
    "drive_rotary": ("k_M [N·m/rad]", 100.0, 100_000.0, 100.0),
    "drive_linear": ("k₄ [N/mm]", 100.0, 200_000.0, 100.0),
    **{
        f"{bar}_{side}": (f"{bar.upper()} {side} ⌀ [mm]", low, 100.0, 0.1)
        for bar in BARS
        for side, low in (("outer", 1.0), ("inner", 0.0))
    },
}
"""Label, ends and step of the sliders, in the unit shown."""


def elastic_slider(name: str) -> Slider:
    """Return the slider of a number of `Elastic`; a larger number can be typed."""
    path = f"elastic.{name}"
    parameter = PARAMETER[path]
    label, low, high, step = SLIDERS[name]
    entry = replace(slider(parameter, (low, high, step)), label=label)
    bar, _, side = name.partition("_")
    if side not in ("outer", "inner"):
        return entry

    def ends(state: State) -> tuple[float, float]:
        """A tube has a wall: of a step, at least."""
        elastic, unit = state.document.design.elastic, parameter.display
        if side == "inner":
            return low, round(unit.from_si(getattr(elastic, f"{bar}_outer")) - step, 6)
        least = round(unit.from_si(getattr(elastic, f"{bar}_inner")) + step, 6)
        return max(low, least), max(high, least + step)

    return replace(entry, range=ends)


def _resets(names: tuple[str, ...], state: State) -> dict[str, Effect]:
    """Return a button that sets numbers back to their defaults, if one of them is another."""
    paths = tuple(f"elastic.{name}" for name in names)
    if not any(is_changed(state.document.design, path) for path in paths):
        return {}
    return {"Default": partial(actions.reset_values, paths=paths)}


def _folder(title: str, names: tuple[str, ...], *, opened: bool) -> Folder:
    entries: tuple[Entry, ...] = (
        *map(elastic_slider, names),
        ButtonGroup(
            f"stiffness.reset.{names[0]}",
            "Reset",
            choices=partial(_resets, names),
            hint="Sets all of this group back; the defaults are chosen, not measured",
        ),
    )
    return Folder(f"stiffness.{names[0]}", title, entries=entries, open=opened)


def _open_number(
    key: str, label: str, hint: str, path: Callable[[State], str], step: float, unit: DisplayUnit
) -> Number:
    """Return the input of a number that may be left open, which 0 does."""

    def read(state: State) -> float:
        return state.document.design.stored(path(state)) or 0.0

    def apply(state: State, value: float) -> State:
        return actions.vary(state, {path(state): value or None})

    most = min(PARAMETER[path(initial_state())].largest, STIFFEST)
    return Number(
        key, label, range=(0.0, most), step=step, unit=unit, hint=hint, read=read, apply=apply
    )


JOINTS: dict[str, str] = {
    "bearing_radial": "Bearing across", "bearing_axial": "Bearing along",
    "bearing_tilt": "Bearing tilt", "ball": "Ball joint 5", "guide": "Guide across",
    "guide_tilt": "Guide tilt",
}  # fmt: skip
"""Labels of the stiffness of the joints."""


def elastic_label(name: str) -> str:
    """Return how the label of a number of `Elastic` begins on the page."""
    return JOINTS[name] if name in JOINTS else SLIDERS[name][0]


def _joint(name: str) -> Number:
    """Return the input of the stiffness of a joint."""
    path = f"elastic.{name}"
    parameter = PARAMETER[path]
    text = f"{what(parameter)}; 0: rigid"
    return _open_number(
        f"stiffness.{name}", f"{JOINTS[name]} [{parameter.display.text}]", text, lambda _: path,
        1000.0, parameter.display,
    )  # fmt: skip


def _section(name: str, label: str, step: float) -> Number:
    """Return the input of a section value of the chosen bar."""
    display = PARAMETER[f"elastic.b4_{name}"].display
    return _open_number(
        f"stiffness.section.{name}", f"{label} [{display.text}]",
        "Of the chosen bar; 0: that of its tube",
        lambda state: f"elastic.{state.stiffness.settings.bar}_{name}", step, display,
    )  # fmt: skip


def can_wait(state: State) -> bool:
    """Whether a result may be old while something is dragged.

    It may not where a layer shows it, and while elastic data change.
    """
    outcome = state.stiffness.outcome
    if outcome is None:
        return True
    job, elastic = outcome.job, state.document.design.elastic
    changed = job.design.elastic != elastic or job.case != state.stiffness.settings.case
    return not changed and not state.layers.intersection(LAYERS)


def _job(frame: Frame) -> ElasticJob:
    state = frame.state
    return ElasticJob(frame.shown_design, state.last_reachable.pose, state.stiffness.settings.case)


ANALYSIS = Follower(
    Place(lambda state: state.stiffness.outcome), _job, analyze_elasticity, idle=can_wait
)


WAITS = "Of an earlier pose or design; it follows when the motion pauses."
"""What is said above a result while a motion is played."""


def _is_behind(frame: Frame) -> bool:
    """Whether the result is still of another pose, design or load case."""
    outcome = frame.state.stiffness.outcome
    return outcome is not None and outcome.job != _job(frame)


def result_html(frame: Frame) -> str:
    """Return stiffness, deflection and frequencies at the pose, or why there are none; in gray
    until they are those of what is shown."""
    if frame.is_preview:
        return note("stiffness-preview", NOT_OF_PREVIEW, muted=True)
    outcome = frame.state.stiffness.outcome
    if outcome is None:
        return ""
    if outcome.result is None:
        text = note("stiffness-problem", f"No stiffness at this pose: {outcome.error}.")
    else:
        text = _found_html(outcome.job, outcome.result, frame.state.stiffness.settings.mode)
    behind = _is_behind(frame)
    waits = behind and frame.state.playback.playing
    why = note("stiffness-waits", WAITS) if waits else ""
    return why + gray_if(behind, text)


@kept(2)
def _found_html(job: ElasticJob, result: ElasticResult, mode: int) -> str:
    """Return what was found, with a mode in bold; a result is shown in many pictures of a drag."""
    found = result.stiffness
    directions = directions_table(job.design, found)
    deflected = deflection_table(CASES[job.case][0], job.wrench, result.twist)
    frequencies, moved = modes_table(result.frequencies, result.alone), result.compensation
    return render(
        "stiffness/result.j2", frequencies=frequencies, missing=NO_FREQUENCIES,
        directions=replace(directions, rows=tuple(directions.rows[i] for i in (0, 1, 2, 5, 7))),
        softest=directions.rows[6],
        along=softest_text(found), deflected=deflected.turned(2).columns(0, 1, 2, 3, 6, 7),
        compensation=NOTHING_DEFLECTED if moved is None else compensation_text(moved),
        loaded=moved is not None, mode=mode,
    )  # fmt: skip


def shares_html(frame: Frame) -> str:
    """Return the share of each part in the strain energy as bars, the largest first."""
    outcome, result = frame.state.stiffness.outcome, frame.state.stiffness.result
    if frame.is_preview or outcome is None or result is None or result.shares is None:
        return ""
    case = CASES[outcome.job.case][0]
    table = shares_table({case: result.shares.share})
    return gray_if(_is_behind(frame), render("stiffness/shares.j2", table=table, case=case))


def sections_html(frame: Frame) -> str:
    """Return what tubes do not match: the design's masses, or the inertias of Appendix 4."""
    fits = tube_fits(frame.state.document.design)
    other = other_tubes(fits)
    far = {fit.bar: fit.transverse_ratio for fit in fits if fit.transverse_ratio > 1.5}
    elastic = frame.state.document.design.elastic
    given = [
        bar.upper()
        for bar in BARS
        if any(getattr(elastic, f"{bar}_{name}") is not None for name in SECTION_VALUES)
    ]
    return render("stiffness/sections.j2", other=other, far={} if other else far, given=given)


def _modes(state: State) -> dict[str, int]:
    result = state.stiffness.result
    found = () if result is None else result.frequencies
    texts = {f"{i + 1}: {number(f, 3)} Hz": i for i, f in enumerate(found)}
    return texts or {f"{i + 1}": i for i in range(MODES)}


_setting = SettingInputs("stiffness", "stiffness.settings", StiffnessSettings)

STIFFNESS = (
    Answer(
        "stiffness.answer", "Stiffness at the pose", always=True,
        entries=(
            Html("stiffness.result", content=result_html),
            Html("stiffness.shares", content=shares_html),
            Html("stiffness.sections", content=sections_html, idle=True),
        ),
    ),
    _setting("mode", options=_modes),
    layer_switch(
        "stiffness.mode_shape", "mode_shape", "Animate mode",
        "The chosen mode in the scene, enlarged and slowed down",
    ),
    _setting("case"),
    layer_switch(
        "stiffness.deflection", "deflection", "Deflection",
        "The robot under the load case, enlarged",
    ),
    layer_switch(
        "stiffness.compliance", "compliance", "Compliance",
        "Displacements by 100 N in every direction",
    ),
    _folder("Material", MATERIAL, opened=False),
    _folder("Drives, motor locked", DRIVE, opened=True),
    _folder(
        "Tubes", tuple(f"{bar}_{side}" for bar in BARS for side in ("outer", "inner")), opened=False
    ),
    Folder(
        "stiffness.joints", "Joints and guides, 0: rigid", open=False,
        entries=tuple(map(_joint, JOINTS)),
    ),
    Folder(
        "stiffness.section", "Sections that are no tubes, 0: the tube’s", open=False,
        entries=(
            _setting("bar"),
            _section("area", "Area", 1.0),
            _section("inertia_in", "I in plane", 100.0),
            _section("inertia_out", "I across", 100.0),
            _section("torsion", "Torsion J", 100.0),
        ),
    ),
    ANALYSIS.worker,
)  # fmt: skip
"""The tab's entries."""
