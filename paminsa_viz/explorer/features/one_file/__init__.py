"""The explorer in one file: a page that needs no server, with the essential part of this one.

Its numbers come from the formulas of the model, printed as JavaScript; labels, units, ranges and
hints of its inputs are those of the tables that the served page is built from.
"""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from paminsa_viz.codegen.javascript import FLOOR_MOD, JavaScript
from paminsa_viz.codegen.printer import Printer
from paminsa_viz.dimensions.layout import frame_lengths, platform_range
from paminsa_viz.explorer.browser import SOFTWARE_RENDERERS
from paminsa_viz.explorer.core import persistence
from paminsa_viz.explorer.features.one_file.motions import motions_data
from paminsa_viz.explorer.features.pose.tab import LEAST_STEPS, POSE, grain
from paminsa_viz.explorer.kit import design_numbers
from paminsa_viz.explorer.kit.entries import given
from paminsa_viz.explorer.kit.inputs import Slider
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.design_schema import DRIVE_KEYS, DRIVES, KEY_OF, SCHEMA_VERSION
from paminsa_viz.meshes.packed import pack_bodies
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    Design,
    InvalidInput,
    kinematic_formulas,
    measures,
    robot,
)
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.leg import leg_position, mechanism_of_lengths
from paminsa_viz.model.load import POINT, WRENCH, wrench_at_center
from paminsa_viz.model.lumped import MASS_PATHS, Masses, coefficients_of_masses
from paminsa_viz.model.parameters import possible_range
from paminsa_viz.model.reach import MARGINS
from paminsa_viz.old_names import KNEES
from paminsa_viz.palette import ACTUATOR_COLORS, DARK, INK, LIGHT, Theme
from paminsa_viz.plots import colors
from paminsa_viz.units import symbols_html
from paminsa_viz.version import MADE_BY

FORMULAS = (
    mechanism_of_lengths,
    coefficients_of_masses,
    leg_position,
    kinematic_formulas.leg_angles,
    kinematic_formulas.lift_position,
    kinematic_formulas.wrench_torques,
    wrench_at_center,
    robot.unit_torques,
    robot.inverse_dynamics_kernel,
    kinematic_formulas.speed_rows,
    kinematic_formulas.friction,
    measures.leg_margins,
    measures.least_margin,
    measures.dexterity,
    measures.singular_distances,
    measures.workspace_circle,
    frame_lengths,
    platform_range,
)
"""What the page computes with, and all that these call."""

SHOWN_TABS = ("Lengths", "Masses", "Load")
"""Sections of the design's numbers that change what the page shows."""

SCRIPTS = (
    "documents", "robot", "motion", "bodies", "scales", "contours", "scene", "view", "numbers",
    "pictures", "maps", "playback", "page",
)  # fmt: skip
"""What the page runs, a file each, in this order."""

ONLY_SERVED = (
    "motions of your own, balance, springs, tolerances, drives, accuracy, stiffness, clearance, "
    "identification, requirements, synthesis and all exports"
)
"""What the page does not have."""


def one_file(document: Document) -> str:
    """Return the page, opened with a document, as the text of one HTML file.

    Raises:
        InvalidInput: If the document has what the page does not know.
    """
    if any(each is not None and each.counterweights for each in designs(document)):
        raise InvalidInput(
            "page in one file", "it knows no counterweights; use the report or the served page"
        )
    parts = {
        "TITLE": "PAMINSA explorer in one file",
        "STYLE": _colors(":root", LIGHT) + _colors(":root.dark", DARK) + _text("page.css"),
        "DATA": json.dumps(_data(document), ensure_ascii=False).replace("<", "\\u003c"),
        "FORMULAS": _formulas(),
        "SCRIPTS": "\n".join(_text(f"{name}.js").rstrip() for name in SCRIPTS),
    }
    return re.sub(r"@([A-Z]+)@", lambda found: parts[found[1]], _text("page.html"))


def designs(document: Document) -> tuple[Design | None, ...]:
    """Return the designs of a document."""
    return document.design, document.reference


@cache
def _formulas() -> str:
    """Return the formulas in JavaScript."""
    printer = Printer(JavaScript())
    printer.add(*FORMULAS)
    return FLOOR_MOD + printer.text()


@cache
def _text(name: str) -> str:
    return (files(__name__) / name).read_text(encoding="utf-8")


def _colors(selector: str, theme: Theme) -> str:
    names = (
        "paper", "ink", "soft_ink", "muted", "faint", "good", "warn", "bad", "reachless", "hatch",
    )  # fmt: skip
    top, bottom = theme.backdrop
    backdrop = f"--backdrop: linear-gradient({top}, {bottom});"
    pairs = [f"--{name}: {getattr(theme, name)};" for name in names]
    pairs += [f"--m{i}: {theme.shown(color)};" for i, color in enumerate(ACTUATOR_COLORS, 1)]
    return f"{selector} {{ {' '.join([*pairs, backdrop])} }}\n"


def _data(document: Document) -> dict[str, Any]:
    """Return what the page knows of the program besides its formulas."""
    state = initial_state(document.design)
    return {
        "madeBy": MADE_BY,
        "document": persistence.dump(document),
        "version": persistence.VERSION,
        "prefix": persistence.PREFIX,
        "longestCode": persistence.LONGEST_CODE,
        "longestText": persistence.LONGEST_TEXT,
        "farthest": persistence.FARTHEST,
        "schemaVersion": SCHEMA_VERSION,
        "driveTables": [f"{DRIVES}.{actuator}" for actuator in ACTUATORS],
        "driveKeys": DRIVE_KEYS,
        "knees": {"lower": "lower", "upper": "upper", **KNEES},
        "parameters": {path: _parameter(path) for path in PARAMETER},
        "masses": dict(zip(Masses._fields, MASS_PATHS, strict=True)),
        "load": [f"load.{name}" for name in (*WRENCH, *POINT)],
        "heading": list(kinematic_formulas.HEADING),
        "grain": grain(state.document.design.geometry),
        "leastSteps": LEAST_STEPS,
        "limits": [limit.label for limit in MARGINS],
        "colors": _map_colors(),
        "ink": INK,
        "motions": motions_data(),
        "meshes": pack_bodies(document.design.geometry),
        "pose": [_slider(entry, state) for entry in POSE if isinstance(entry, Slider)],
        "groups": [
            {
                "title": group.title,
                "open": group.tab == "Masses" and group.open,
                "sliders": [
                    _slider(design_numbers.slider(item), state) | {"path": item.path}
                    for item in group.parameters
                ],
            }
            for group in design_numbers.GROUPS
            if group.tab in SHOWN_TABS
        ],
        "softwareRenderers": SOFTWARE_RENDERERS,
        "onlyServed": ONLY_SERVED,
    }


def _map_colors() -> str:
    """Return the colors of maps of torques in hexadecimal: below the range, in it, beyond it."""
    below, beyond = colors.BEYOND[colors.DIVERGING]
    inside = np.rint(255 * colors.table(colors.DIVERGING)).astype(np.uint8).tobytes().hex()
    return f"{below[1:]}{inside}{beyond[1:]}"


def _slider(entry: Slider, state: State) -> dict[str, Any]:
    low, high = entry.ends(state, given(entry.range, state))
    label = given(entry.label, state)
    return {
        "label": label, "markup": symbols_html(label), "hint": given(entry.hint, state),
        "low": low, "high": high, "step": given(entry.step, state), "factor": entry.unit.factor,
    }  # fmt: skip


def _parameter(path: str) -> dict[str, Any]:
    item = PARAMETER[path]
    least, most = item.limits or possible_range(item.unit, item.positive)
    key = KEY_OF[path]
    return {
        "value": APPENDIX_4.stored(path), "least": least, "most": most,
        "positive": item.positive, "signed": item.signed, "table": key.table, "key": key.name,
    }  # fmt: skip
