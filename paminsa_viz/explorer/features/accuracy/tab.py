"""Accuracy: errors that the drives leave at the pose, on maps and in the scene."""

from __future__ import annotations

from functools import partial

from paminsa_viz.blocks.accuracy import drive_errors_table, drives_note, no_bound
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.maps import choose_quantity
from paminsa_viz.explorer.features.accuracy.layers import shown_errors
from paminsa_viz.explorer.features.accuracy.manufacture import MANUFACTURE, error_slider
from paminsa_viz.explorer.features.accuracy.worst import WORST_ERRORS
from paminsa_viz.explorer.kit.entries import (
    Answer,
    ButtonGroup,
    Effect,
    Folder,
    Html,
    Tabs,
    Then,
)
from paminsa_viz.explorer.kit.inputs import Number, Slider
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs, layer_switch
from paminsa_viz.explorer.kit.text import blocks_html
from paminsa_viz.explorer.state.accuracy import BITS, EncoderSettings, bits_of, count_of
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import DriveAccuracy

MAPS = {
    "position": "error_horizontal",
    "θ": "error_theta",
    "linear, position": "linear_error_horizontal",
}
"""What the buttons show on the single map."""


def pose_html(frame: Frame) -> str:
    """Return the errors at the pose: worst, linear and RMS, or why there is no bound."""
    found = shown_errors(frame)
    return blocks_html(
        "accuracy-pose", *no_bound(found), drive_errors_table(found), drives_note(found.accuracy),
        bold=[1],
    )  # fmt: skip


def _choices(state: State) -> dict[str, Effect]:
    design = state.document.design
    found: dict[str, Effect] = {}
    if design.accuracy != DriveAccuracy():
        found["Default"] = partial(actions.change_design, accuracy=DriveAccuracy())
    measured = design.accuracy.with_encoders(design.drives)
    if measured != design.accuracy:
        found["Drives’ encoders"] = partial(actions.change_design, accuracy=measured)
    return found


def _bits(state: State) -> float:
    """Return the bits a turn of the encoders of M1 to M3, see `EncoderSettings`."""
    return bits_of(state.document.design.accuracy.resolution_rotary, state.encoder.settings.gear)


def _set_bits(state: State, bits: float) -> State:
    count = count_of(bits, state.encoder.settings.gear)
    return actions.vary(state, {"accuracy.resolution_rotary": count})


def _set_gear(state: State, gear: float) -> State:
    """Put another gear behind the encoders: a count moves the actuator less."""
    bits = _bits(state)
    return _set_bits(state.updated("encoder.settings", gear=gear), bits)


_setting = SettingInputs("encoder", "encoder.settings", EncoderSettings, _set_gear)


def _slider(name: str, label: str, high: float, step: float) -> Slider:
    return error_slider(f"accuracy.{name}", label, high, step, ", at the actuator")


DRIVES_ACCURACY = (
    Answer(
        "accuracy.answer", "Errors by the drives", always=True,
        entries=(Html("accuracy.pose", content=pose_html),),
    ),
    layer_switch(
        "accuracy.layer", "drive_errors", "Show in scene",
        "Where the platform’s center may be, to a stated scale", undo=False,
    ),
    ButtonGroup(
        "accuracy.map", "Single map",
        choices={
            label: Then(partial(choose_quantity, quantity=key), opens="Single map")
            for label, key in MAPS.items()
        },
        hint="What the single map and the floor show; the family “accuracy” has more",
    ),
    *WORST_ERRORS,
    Folder(
        "accuracy.drives", "Errors of the drives",
        entries=(
            Number(
                "encoder.bits", "Encoder M1–M3 [bit]", range=BITS, step=1.0,
                read=_bits, apply=_set_bits,
                hint="Bits a turn of the encoders, at the motor where there is a gear: sets the "
                "count below",
            ),
            _setting("gear"),
            _slider("resolution_rotary", "Count M1–M3", 0.1, 0.001),
            _slider("resolution_linear", "Count M4", 100.0, 0.5),
            _slider("backlash_rotary", "Backlash M1–M3", 0.1, 0.001),
            _slider("backlash_linear", "Backlash M4", 100.0, 0.5),
            _slider("control_rotary", "Control M1–M3", 0.1, 0.001),
            _slider("control_linear", "Control M4", 100.0, 0.5),
            ButtonGroup(
                "accuracy.reset", "Set to", choices=_choices,
                hint="All errors of this folder as for a new design, or the counts of the encoders "
                "of the design’s drives",
            ),
        ),
    ),
)  # fmt: skip

ACCURACY = (Tabs("accuracy.tabs", tabs={"Drives": DRIVES_ACCURACY, "Manufacture": MANUFACTURE}),)
