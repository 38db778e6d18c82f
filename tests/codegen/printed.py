"""Runs printed formulas on tables of numbers: the same columns for NumPy, C and JavaScript."""

from __future__ import annotations

import inspect
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from typing import Any

import numpy as np
import pytest

import paminsa_viz
from paminsa_viz.codegen.c99 import C99
from paminsa_viz.codegen.javascript import FLOOR_MOD, JavaScript
from paminsa_viz.codegen.kit import FORMULAS, MOD
from paminsa_viz.codegen.printer import Printer
from paminsa_viz.codegen.source import Record
from paminsa_viz.model.backend import Formula
from paminsa_viz.model.leg import LegPosition, Mechanism, mechanism_of_lengths
from paminsa_viz.model.lumped import EnergyTerms

STRICT = ["-std=c99", "-ffp-contract=off", "-Wall", "-Wextra", "-pedantic", "-Werror"]

RECORDS = {"m": Mechanism, "e": EnergyTerms, "g": LegPosition}
"""Records among the arguments of formulas, by the names of the arguments."""


def compilers(names: Sequence[str] = ("gcc", "clang")) -> list[Any]:
    """Return compilers as parameters; those that are not here are skipped."""
    return [
        pytest.param(
            name, marks=pytest.mark.skipif(shutil.which(name) is None, reason=f"no {name} here")
        )
        for name in names
    ]


def registered() -> Iterator[Callable[..., Any]]:
    """Yield the function of every `Formula` of the package."""
    rooms = ("model", "quantities", "actuation", "balancing", "precision", "synthesis", "clearance")
    seen = set()
    for room in rooms:
        package = import_module(f"{paminsa_viz.__name__}.{room}")
        for info in walk_packages(package.__path__, f"{package.__name__}."):
            for value in vars(import_module(info.name)).values():
                if isinstance(value, Formula) and value.function not in seen:
                    seen.add(value.function)
                    yield value.function


def columns(count: int, seed: int = 7) -> dict[str, Any]:
    """Return random designs and states, each number an array (count,), by argument name."""
    rng = np.random.default_rng(seed)
    k = rng.uniform(1.6, 5.0, count)
    base = 0.35 * rng.uniform(0.5, 2.0, count)
    bars = k / (k - 1) * base * rng.uniform(1.2, 2.4, count)
    share = rng.uniform(0.35, 0.5, count)
    lengths = {
        "k": k, "base_radius": base, "platform_radius": base * rng.uniform(0.15, 1.2, count),
        "joint_height": rng.uniform(0, 0.06, count), "shaft": rng.uniform(0.2, 0.8, count),
        "crank": share * bars, "coupler": (1 - share) * bars,
        "stroke": base / (k - 1) * rng.uniform(1, 2, count),
        "clearance": rng.choice([0.0, 0.01], count), "root": rng.choice([-1.0, 1.0], count),
    }  # fmt: skip
    theta = rng.uniform(-1.0, 1.0, count)
    beta = rng.uniform(-np.pi, np.pi, (3, count))
    found: dict[str, Any] = {
        **lengths,
        "m": mechanism_of_lengths(**lengths),
        "e": EnergyTerms(*rng.uniform(-1, 5, (21, count))),
        "g": LegPosition(*rng.normal(size=(21, count))),
        "gravity": rng.uniform(0, 20, count),
        "x": base * rng.uniform(-0.4, 0.4, count), "y": base * rng.uniform(-0.4, 0.4, count),
        "c": np.cos(theta), "s": np.sin(theta), "z": -bars * rng.uniform(0.2, 0.9, count),
        "branch": rng.choice([-1.0, 1.0], count), "lift": rng.uniform(-1, 1, count),
        "heading": rng.uniform(0, 5, count), "transition_speed": rng.uniform(1e-3, 1, count),
        "turn": rng.uniform(0, np.pi, count), "turns": rng.choice([0.0, 1.0], count),
    }  # fmt: skip
    for index, row in enumerate(beta, 1):
        found[f"c{index}"], found[f"s{index}"] = np.cos(row), np.sin(row)
    upper = rng.normal(size=(10, count))
    upper[[0, 4, 7, 9]] += 8
    for index, row in enumerate(upper):
        found[f"a{index}"] = row
    for name in (
        *("vx", "vy", "vt", "vz", "ax", "ay", "at", "az", "viscous", "coulomb", "speed"),
        *("fx", "fy", "fz", "mx", "my", "mz", "px", "py", "pz", "ft"),
    ):
        found[name] = rng.normal(size=count)
    return found


def table(given: dict[str, Any]) -> np.ndarray:
    """Return the columns side by side, records spread out, (count, numbers)."""
    parts: list[Any] = []
    for value in given.values():
        parts += list(value) if isinstance(value, tuple) else [value]
    return np.stack(parts, axis=-1)


def places(given: dict[str, Any]) -> dict[str, int]:
    """Return where each argument starts in a row of `table`."""
    found, at = {}, 0
    for name, value in given.items():
        found[name] = at
        at += len(value) if isinstance(value, tuple) else 1
    return found


@np.errstate(all="ignore")
def on_numpy(formulas: list[Callable[..., Any]], given: dict[str, Any]) -> np.ndarray:
    """Return the results of formulas side by side, (count, numbers)."""
    parts: list[Any] = []
    for formula in formulas:
        value = formula(*(given[name] for name in inspect.signature(formula).parameters))
        parts += list(value) if isinstance(value, tuple) else [value]
    return np.stack(np.broadcast_arrays(*parts, given["x"])[:-1], axis=-1)


def size(printer: Printer, formula: Callable[..., Any]) -> int:
    """Return how many numbers a formula returns."""
    kind = printer.results[formula.__name__]
    return kind.size if isinstance(kind, Record) else 1


def c_program(formulas: list[Callable[..., Any]], given: dict[str, Any]) -> tuple[str, int]:
    """Return a C program that maps rows of a table to results, and their number in a row."""
    language = C99()
    printer = Printer(language)
    printer.add(*formulas)
    at, width = places(given), table(given).shape[1]
    lines, total = [], 0
    for formula in formulas:
        passed = []
        for name in inspect.signature(formula).parameters:
            if name in RECORDS:
                kind = language.type_name(printer.record(RECORDS[name]))
                passed.append(f"(const {kind} *)(row + {at[name]})")
            else:
                passed.append(f"row[{at[name]}]")
        name = formula.__name__
        kind = language.type_name(printer.results[name])
        lines.append(
            f"{{ const {kind} r = {language.function_name(name)}({', '.join(passed)});"
            f" memcpy(out + {total}, &r, sizeof r); }}"
        )
        total += size(printer, formula)
    body = "\n        ".join(lines)
    return (
        f"""#include <math.h>
#include <stdio.h>
#include <string.h>
{MOD}
{printer.text()}
int main(void)
{{
    static double row[{width}], out[{total}];
    while (fread(row, sizeof row, 1, stdin) == 1) {{
        {body}
        fwrite(out, sizeof out, 1, stdout);
    }}
    return 0;
}}
""",
        total,
    )


def js_program(formulas: list[Callable[..., Any]], given: dict[str, Any]) -> tuple[str, int]:
    """Return the same in JavaScript for Node."""
    language = JavaScript()
    printer = Printer(language)
    printer.add(*formulas)
    at, width = places(given), table(given).shape[1]
    lines, total = [], 0
    for formula in formulas:
        passed = []
        for name in inspect.signature(formula).parameters:
            if name in RECORDS:
                fields = enumerate(RECORDS[name]._fields)
                inside = ", ".join(f"{key}: d[o + {at[name] + i}]" for i, key in fields)
                passed.append(f"{{ {inside} }}")
            else:
                passed.append(f"d[o + {at[name]}]")
        lines.append(f"put({language.function_name(formula.__name__)}({', '.join(passed)}));")
        total += size(printer, formula)
    body = "\n    ".join(lines)
    return (
        f"""'use strict';
{FLOOR_MOD}
{printer.text()}
const fs = require('fs');
const bytes = fs.readFileSync(process.argv[2]);
const d = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.length / 8);
const rows = d.length / {width};
const out = new Float64Array(rows * {total});
let at = 0;
function put(value) {{
    if (typeof value === 'number') out[at++] = value;
    else for (const part of Object.values(value)) out[at++] = part;
}}
for (let o = 0; o < d.length; o += {width}) {{
    {body}
}}
fs.writeFileSync(process.argv[3], out);
""",
        total,
    )


SANITIZERS = ("-O0", "-g", "-fsanitize=undefined,address", "-fno-sanitize-recover=all")


def sanitizes(compiler: str, folder: Path) -> bool:
    """Whether a compiler comes with the libraries of its sanitizers."""
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    built = [compiler, *SANITIZERS, "empty.c", "-o", "empty"]
    return subprocess.run(built, cwd=folder, capture_output=True).returncode == 0


def run_c(folder: Path, program: str, compiler: str, rows: np.ndarray, *flags: str) -> bytes:
    """Compile a program and return its output for rows of numbers."""
    # A header, as clang's warnings of unused functions are for files of their own.
    (folder / "program.h").write_text(program)
    (folder / "program.c").write_text('#include "program.h"\n')
    built = [compiler, *STRICT, *(flags or ("-O1",)), "program.c", "-o", "program", "-lm"]
    done = subprocess.run(built, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:2000]
    ran = subprocess.run(["./program"], cwd=folder, input=rows.tobytes(), capture_output=True)
    assert ran.returncode == 0, ran.stderr[:2000]
    assert not ran.stderr, ran.stderr[:2000]
    return ran.stdout


_ANGULAR = ("leg_angles", "friction", "dexterity", "singular_distances")

EXACT = [f for f in FORMULAS if f.__name__ not in _ANGULAR]
"""Formulas of nothing but the operations that IEEE 754 rounds exactly."""

ROUNDED = [f for f in FORMULAS if f not in EXACT]
"""Formulas with angles and tanh, which libraries round in their own ways."""
