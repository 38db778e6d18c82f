"""Writes the pages that follow from the source: ``python docs/generate.py``.

``design-file.md`` from the design's own list of values, ``command-line.md`` from the commands'
flags, ``python-api.md`` from the public names and what they say of themselves, ``explorer.html`` as
``paminsa-viz page`` writes it. A test compares them with what is in the folder.
"""

from __future__ import annotations

import ast
import html
import importlib
import inspect
import math
import re
import types
import typing
from collections.abc import Iterator
from dataclasses import MISSING, fields
from itertools import pairwise
from pathlib import Path
from typing import Any

import tyro

from paminsa_viz import cli
from paminsa_viz.cli import flags, motion_flags
from paminsa_viz.cli.help import KINDS, flag_texts
from paminsa_viz.files.design_schema import (
    CHOICE_MEANINGS,
    CHOICES,
    DRIVE_KEYS,
    SCHEMA_VERSION,
    TABLES,
    DesignKey,
    choice,
)
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model import drive as drive_model
from paminsa_viz.model.accuracy import LEG_NAMES, LegDeviations
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.units import unit_text
from paminsa_viz.version import COMMAND
from paminsa_viz.webpage import design_page

FOLDER = Path(__file__).parent

NOTE = "<!-- Written by docs/generate.py; change what it is made from instead. -->\n"

PAPER_TABLES = ("geometry", "joints", "links", "inertias", "platform")
"""Tables of a design file whose values are in the paper."""

API = {
    "paminsa_viz": "What most scripts need, by its shortest name.",
    "paminsa_viz.model": "Mechanics: design, kinematics, singularities, statics, dynamics, grids.",
    "paminsa_viz.trajectory": "Motions: planned, timed, checked, analyzed, simulated.",
    "paminsa_viz.actuation": "What the actuators hold and reach within their limits.",
    "paminsa_viz.elastostatics": "Joint forces, bar loads, stiffness, natural frequencies.",
    "paminsa_viz.clearance": "Least distances of the robot's bodies as they are drawn.",
    "paminsa_viz.precision": "Errors of the pose by drives and by manufacture; calibration.",
    "paminsa_viz.identification": "Masses, balance and friction of a built robot from its log.",
    "paminsa_viz.balancing": "Optimal redistribution of masses, and what goes with it.",
    "paminsa_viz.quantities": "What can be mapped, swept and required: one registry.",
    "paminsa_viz.studies": "Many designs, each measured over the workspace.",
    "paminsa_viz.synthesis": "From requirements to a robot: lengths, masses, springs.",
    "paminsa_viz.files": "Designs, logs, measurements, motions and tables as files.",
    "paminsa_viz.engines": "The same robot in physics engines written by others.",
    "paminsa_viz.plots": "Maps and curves as figures.",
    "paminsa_viz.notebook": "Robot, maps and motions inline in a notebook.",
    "paminsa_viz.blocks": "The words of results: tables and sentences of report and commands.",
    "paminsa_viz.report": "The design report, one HTML file.",
    "paminsa_viz.dimensions": "What the bodies measure and where they are.",
    "paminsa_viz.meshes": "The robot's shape, for 3D models.",
    "paminsa_viz.codegen": "The robot as C code for a controller.",
    "paminsa_viz.progress": "How long work says how far it is, and is ended.",
    "paminsa_viz.cli": "The command line, called from Python.",
    "paminsa_viz.explorer": "What the data of a feature of the page is made of.",
}


# ---------------------------------------------------------------------------- the design file


def design_file() -> str:
    """Return the reference of the design file."""
    parts = [
        "# Design file",
        NOTE,
        "A robot as text (TOML), in SI units, each key ending in its unit. "
        f"`{COMMAND} design default --out robot.toml` writes one to start from, "
        f"`{COMMAND} design check robot.toml` says whether it can be used and, if not, which line "
        "and key stand in the way.",
        "A value that is left out is Appendix 4's, or the default of this program for what the "
        "paper does not have. An unknown table or key is refused, so that a typing error does not "
        "pass as the default; so is a number that no machine can have.",
        "## At the top",
        _table(
            ("key", "meaning"),
            [
                ("`schema_version`", f"layout of the file, {SCHEMA_VERSION}; needed"),
                ("`name`", "one line of text; `Appendix 4` belongs to its numbers alone"),
                (
                    "`value_count`",
                    "number of values in the file, so that one that was cut short is noticed; "
                    "may be left out",
                ),
                *((f"`{key.name}`", _meaning(key)) for key in TABLES[""].values()),
            ],
        ),
    ]
    for table, keys in TABLES.items():
        if table and table not in LEG_NAMES[1:]:
            legs = table == LEG_NAMES[0]  # all three have the same keys
            group = LegDeviations if legs else type(getattr(APPENDIX_4, table))
            choices = [_choice_row(*place) for place in CHOICES if place[0] == table]
            parts += [
                f"## [{table}] to [{LEG_NAMES[-1]}]" if legs else f"## [{table}]",
                _paragraphs(inspect.getdoc(group) or ""),
                _table(
                    ("key", "symbol", "meaning", _default_head(table), "allowed"),
                    [*(_key_row(key) for key in keys.values()), *choices],
                ),
            ]
    ends = ", ".join(f"{bar.upper()} ({a}, {b})" for bar, (a, b) in BAR_ENDS.items())
    parts += [
        "## [[counterweights]]",
        "Point masses on the bars of every leg, none in Appendix 4; the table is repeated for "
        f"each. `bar` and `joint` say where it is measured from: {ends}. `beyond_m` is the "
        "distance from that joint, away from the bar's other end, negative on the bar itself; "
        "`mass_kg` is that on each leg.",
        '```toml\n[[counterweights]]\nbar = "b3"\njoint = 7\nbeyond_m = 0.2\nmass_kg = 1.1\n```',
        "## [drives.M1] to [drives.M4]",
        _paragraphs(inspect.getdoc(drive_model) or ""),
        "None in Appendix 4. Each key may be left out; a limit that is left out is none. See "
        "[Drives](drives.md).",
        _table(
            ("key", "symbol", "meaning"),
            [
                (f"`{DRIVE_KEYS[i.name]}`", f"`{i.metadata['symbol']}`", i.metadata["label"])
                for i in fields(Drive)
                if i.metadata
            ],
        ),
        "`name` is a text, `transmission` for M4 is `screw` or `belt` in quotes, `brake` true or "
        "false, and `envelope` lists corners of the largest torque [N·m] over the speed [rad/s].",
        '```toml\n[drives.M1]\nname = "servo 100 W, gear 100:1"\nrotor_inertia_kg_m2 = 4e-6\n'
        "gear_ratio = 100.0\nefficiency = 0.8\nrated_torque_Nm = 0.32\npeak_torque_Nm = 0.95\n"
        "envelope = [[0, 0.95], [314, 0.95], [628, 0.4]]\n```",
        "## [[requirements]]",
        "What the robot is needed for, none in Appendix 4: a bound on a quantity, the table "
        "repeated for each. `quantity` is its name as `paminsa-viz requirements quantities` lists "
        "it; `min` and `max` end in its SI unit, such as `max_Nm`, and one of them is needed. "
        "`theta_min_rad`, "
        "`theta_max_rad` and `z_min_m`, `z_max_m` are headings and heights over which it holds; "
        "left out, all those that are required. See [Requirements](requirements.md).",
        "## [workspace]",
        "The headings that count, `theta_min_rad` and `theta_max_rad` (0 if left out), and a "
        "workspace of the platform's center that has to fit, if there is one: `shape` is "
        '`"cylinder"` with `diameter_m` and `height_m`, or `"box"` with `size_x_m`, `size_y_m`, '
        "`size_z_m`. `center_x_m`, `center_y_m` and `center_z_m` say where its center is; a "
        "coordinate that is left out is free to be found.",
        "```toml\n[workspace]\ntheta_min_rad = -0.5236\ntheta_max_rad = 0.5236\n"
        'shape = "cylinder"\ndiameter_m = 0.3\nheight_m = 0.4\ncenter_x_m = 0.0\n'
        'center_y_m = 0.0\n\n[[requirements]]\nquantity = "condition"\nmax = 10.0\n\n'
        '[[requirements]]\nquantity = "max_torque"\nmax_Nm = 15.0\n```',
        "## The whole of it",
        f"```toml\n{write_design(APPENDIX_4).strip()}\n```",
    ]
    return _page(parts)


def _choice_row(table: str, name: str) -> tuple[str, ...]:
    symbol = {"knee": "sign of F's root"}.get(name, "")
    default = f'`"{choice(APPENDIX_4, table, name).value}"`'
    allowed = " or ".join(f'`"{word.value}"`' for word in CHOICES[table, name])
    return f"`{name}`", symbol, CHOICE_MEANINGS[name], default, allowed


def _meaning(key: DesignKey) -> str:
    p = key.parameter
    return f"{p.label} `{p.symbol}` [{unit_text(p.unit)}], {p.default:g}"


def _default_head(table: str) -> str:
    """Return whose values those of a table are where they are left out."""
    return "Appendix 4" if table in PAPER_TABLES else "default"


def _key_row(key: DesignKey) -> tuple[str, ...]:
    p = key.parameter
    default = "as l_B10" if p.path == "geometry.guide_stroke" else f"{p.default:g}"
    if math.isinf(p.default):  # no file may have it: such a value is left out
        default = "rigid"
    allowed = "any number" if p.signed else "above 0" if p.positive else "0 or more"
    if p.path == "geometry.magnification":
        allowed = "above 1"
    return f"`{key.name}`", f"`{p.symbol}`", p.label, default, allowed


# --------------------------------------------------------------------------- the command line


def command_line() -> str:
    """Return the reference of the command line."""
    parts = [
        "# Command line",
        NOTE,
        inspect.cleandoc(cli.__doc__ or "").split("\n\n")[-1],
        _table(
            ("command", "what it does"),
            [(f"[`{name}`](#{name})", text) for name, text in cli.COMMANDS.items()],
        ),
    ]
    parts += [
        "## Flags of several commands",
        "A command that has such flags says which; what follows is said here once.",
    ]
    for shared in SHARED_FLAGS:
        own = [row for owner, row in _flags(shared) if owner is shared]
        parts += [f"### {_title(shared)}", _table(FLAG_HEAD, own)]
    for name in cli.COMMANDS:
        module = cli.command_module(name)
        text = module.DESCRIPTION.split("\n\nCommands:")[0]  # the list stands above
        parts += [f"## {name}", f"```text\n{text.strip()}\n```"]
        for word, kind in _kinds(module.FLAGS).items():
            parts += [f"### {name} {word}", f"{inspect.getdoc(kind)}"] if word else []
            rows = list(_flags(kind))
            shared = [one for one in SHARED_FLAGS if any(owner is one for owner, _ in rows)]
            links = [f"[{_title(one)}](#{_title(one).lower().replace(' ', '-')})" for one in shared]
            parts += [f"Flags of several commands: {', '.join(links)}."] if links else []
            own = [row for owner, row in rows if owner not in SHARED_FLAGS]
            parts += [_table(FLAG_HEAD, own)] if own else []
    return _page(parts)


FLAG_HEAD = ("flag", "default", "")

SHARED_FLAGS = tuple(
    kind
    for module in (flags, motion_flags)
    for kind in vars(module).values()
    if inspect.isclass(kind) and kind.__module__ == module.__name__
)
"""Groups of flags that several commands have, see `paminsa_viz.cli.flags` and `.motion_flags`."""


def _title(kind: type) -> str:
    """Return what a group of flags is called."""
    return (inspect.getdoc(kind) or "").rstrip(".")


def _kinds(given: Any) -> dict[str, type]:
    """Return a command's flags by subcommand, under an empty name where there are none."""
    if inspect.isclass(given):
        return {"": given}
    return {mark.name: kind for kind, mark in map(typing.get_args, typing.get_args(given))}


def _flags(kind: type) -> Iterator[tuple[type, tuple[str, str, str]]]:
    """Yield the rows of a table of flags: how it is written, its default, what it does.

    Each is with the class that decides it, the last one that says it.
    """
    said, hints = flag_texts(kind), typing.get_type_hints(kind, include_extras=True)
    for item in fields(kind):
        hint = hints[item.name]
        marks = typing.get_args(hint)[1:] if hasattr(hint, "__metadata__") else ()
        named = [mark.metavar for mark in marks if getattr(mark, "metavar", None)]
        flag = "--" + item.name.replace("_", "-")
        if tyro.conf.Positional in marks:
            shown = named[0]
        elif hint is bool:
            shown = f"{flag}, --no-{flag[2:]}" if item.default is True else flag
        else:
            shown = f"{flag} {named[0] if named else _values(hint)}"
        owner = next(one for one in kind.__mro__ if item.name in inspect.get_annotations(one))
        yield owner, (f"`{shown}`", _default(item.default), said[item.name])


def _values(hint: Any) -> str:
    """Return what a flag takes, where its metavar does not say so."""
    options = [arg for arg in typing.get_args(hint) if arg is not type(None)]
    if typing.get_origin(hint) is typing.Literal:
        return "|".join(map(str, options))
    if options:
        return _values(options[0])
    return KINDS[hint]


def _default(value: Any) -> str:
    if value is MISSING:
        return "needed"
    if value is True:
        return "on"
    if value is None or value is False or value == ():
        return ""
    return f"`{' '.join(map(str, value)) if isinstance(value, tuple) else value}`"


# ----------------------------------------------------------------------------- the Python API


def python_api() -> str:
    """Return the list of public names."""
    parts = [
        "# Python API",
        NOTE,
        "Everything is batch-first: poses (..., 4) = (x, y, theta, z) [m, m, rad, m] in, results "
        "(..., n) out, in SI units. Everything is typed; `help(name)` says shapes, units, frames "
        "and what is raised. So do the pages of the subpackages on the documentation's site, which "
        "its search finds by name.",
    ]
    for name, what in API.items():
        module = importlib.import_module(name)
        rows = [(f"`{public}`", _summary(module, public)) for public in module.__all__]
        parts += [f"## {name}", what, _table(("name", ""), rows)]
    return _page(parts)


def _summary(module: types.ModuleType, name: str) -> str:
    """Return the first sentence that a public name says of itself."""
    value = getattr(module, name)
    described = inspect.isclass(value) or inspect.isroutine(inspect.unwrap(value))
    text = (inspect.getdoc(value) or "") if described else _constant(module, name)
    return _paragraphs(" ".join(text.split("\n\n")[0].split()).rstrip("."))


def _constant(module: types.ModuleType, name: str) -> str:
    """Return the text below a constant, in the module that a package has it from."""
    body = ast.parse(inspect.getsource(module)).body
    late = [item for block in body if isinstance(block, ast.If) for item in block.body]
    for item, after in pairwise([*body, *late, ast.Pass()]):
        names = {a.name for a in item.names} if isinstance(item, ast.ImportFrom) else set()
        if isinstance(item, ast.ImportFrom) and names & {name, "*"}:
            return _constant(importlib.import_module(item.module or ""), name)
        targets = item.targets if isinstance(item, ast.Assign) else []
        targets = [item.target] if isinstance(item, ast.AnnAssign) else targets
        named = name in {target.id for target in targets if isinstance(target, ast.Name)}
        if named and isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            return str(after.value.value)
    raise AssertionError(f"{name} in {module.__name__} says nothing of itself")


# --------------------------------------------------------------------------------- Markdown


_UNIT = re.compile(r"\b(?:kg m(?:\^2)?|N m(?: s)?|m|rad)(?:/(?:rad|s)(?:\^\d)?)?\b")


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, row)) + " |" for row in lines)


def _cell(text: str) -> str:
    """Return a cell whose bars do not end it; GitHub and MkDocs agree on HTML alone."""

    def code(found: re.Match[str]) -> str:
        return f"<code>{html.escape(found[1])}</code>" if "|" in found[1] else found[0]

    return re.sub(r"`([^`]+)`", code, text).replace("|", "&#124;")


def _paragraphs(text: str) -> str:
    """Return a docstring as Markdown, without its sections: double backticks become single ones.

    Units are in plain text in the source, whose C code has to be ASCII.
    """
    text = re.split(r"\n\n(?:Attributes|Raises):", text)[0].replace("``", "`")
    return _UNIT.sub(lambda found: unit_text(found[0]), text)


def _page(parts: list[str]) -> str:
    return "\n\n".join(part.strip() for part in parts if part) + "\n"


PAGES = {
    "design-file.md": design_file,
    "command-line.md": command_line,
    "python-api.md": python_api,
    "explorer.html": lambda: design_page(APPENDIX_4),
}
"""Pages by file name, with what makes them."""

if __name__ == "__main__":
    for file, make in PAGES.items():
        (FOLDER / file).write_text(make(), encoding="utf-8")
        print(f"docs/{file}: written")
