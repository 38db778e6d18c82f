"""Size and speed of the printed C beside the compiled Python kernel and CasADi's code, in one run.

Run: ``python -m benchmarks.code_speed`` (needs a C compiler; CasADi and Pinocchio, if installed).
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import time
import warnings
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.codegen import controller_kit
from paminsa_viz.engines.urdf import urdf_text
from paminsa_viz.model import APPENDIX_4, compiled, leg, lumped, robot

STATES = 4096

MANY, ONE = "Numba kernel, many states at once", "Numba, state by state"

FAST = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
INLINED = "clang, inlined"
BUILDS = {
    "gcc -O2": ("gcc", "-O2", "-ffp-contract=off"),
    "gcc, NumPy's bits": ("gcc", *FAST, "-ffp-contract=off"),
    "gcc, fused": ("gcc", *FAST, "-ffp-contract=fast"),
    "clang, fused": ("clang", *FAST, "-ffp-contract=fast"),
    INLINED: ("clang", *FAST, "-ffp-contract=off", "-mllvm", "-inline-threshold=10000"),
}
"""Compilers with their options; those that are not installed are left out."""

GOALS = {"ratio": 1.2, "bytes": 12_000, "seconds": 1.0}
"""Largest time over that of the Numba kernel, text at -Os, and time to print the kit [s]."""

LOOPS = """
#include "paminsa.h"
#include "design.h"

void kernel(int count, const double *row, double *out)
{
    for (int i = 0; i < count; i++, row += 13, out += 4) {
        const PaminsaActuatorForces f = paminsa_inverse_dynamics_kernel(
            &PAMINSA_DESIGN.mechanism, &PAMINSA_DESIGN.energy, 9.81, row[0], row[1], row[2], row[3],
            row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11], row[12]);
        out[0] = f.tau1; out[1] = f.tau2; out[2] = f.tau3; out[3] = f.f4;
    }
}

void columns(int count, const double *in, double *out)
{
    paminsa_inverse_dynamics_columns(&PAMINSA_DESIGN, count, in, out);
}

void whole(int count, const double *row, double *out)
{
    for (int i = 0; i < count; i++, row += 12, out += 4)
        paminsa_inverse_dynamics(&PAMINSA_DESIGN, row, row + 4, row + 8, out);
}
"""

SIZE = """
#include "paminsa.h"

PaminsaReach inverse_dynamics(const PaminsaDesign *d, const double *p, const double *v,
    const double *a, double *out)
{
    return paminsa_inverse_dynamics(d, p, v, a, out);
}
"""


def states() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return poses within reach, velocities, accelerations, (STATES, 4) each."""
    rng = np.random.default_rng(1)
    pose = rng.uniform((-0.1, -0.1, -0.6, -0.7), (0.1, 0.1, 0.6, -0.35), (STATES, 4))
    return pose, rng.normal(size=(STATES, 4)), rng.normal(size=(STATES, 4))


def pointer(array: np.ndarray) -> Any:
    """Return an array as a pointer to double."""
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def text_size(folder: Path, *flags: str) -> int:
    """Return the bytes of machine code of inverse dynamics with all that it calls."""
    (folder / "size.c").write_text(SIZE)
    command = ["cc", "-std=c99", *flags, "-c", "size.c", "-o", "size.o"]
    subprocess.run(command, cwd=folder, check=True)
    said = subprocess.run(
        ["size", "size.o"], cwd=folder, check=True, capture_output=True, text=True
    )
    return int(said.stdout.splitlines()[1].split()[0])


def loops(folder: Path, name: str, *build: str) -> Any:
    """Return the C functions, compiled."""
    name = f"{name.replace(' ', '')}.so"
    (folder / "loops.c").write_text(LOOPS)
    command = [*build, "-std=c99", "-shared", "-fPIC", "loops.c", "-o", name, "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / name))


def casadi_loop(folder: Path, e: Any, m: Any) -> Any:
    """Return CasADi's C code for the kernel in a loop, or None without CasADi."""
    try:
        import casadi
    except ImportError:
        print("CasADi is not installed; its row is left out.")
        return None
    symbols = casadi.SX.sym("q", 13)  # type: ignore[attr-defined]
    with (
        patch.object(robot, "where", casadi.if_else),
        patch.object(casadi.SX, "__and__", casadi.logic_and, create=True),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")  # of how it treats NumPy's functions
        values = robot.inverse_dynamics_kernel(m, e, 9.81, *casadi.vertsplit(symbols))
    function = casadi.Function("dynamics", [symbols], [casadi.vertcat(*values[:4])])
    generator = casadi.CodeGenerator("casadi_code.c")
    generator.add(function)
    generator.generate(f"{folder}/")
    (folder / "casadi_loop.c").write_text(
        '#include "casadi_code.c"\n'
        "void kernel(int count, const double *row, double *out) {\n"
        "    for (int i = 0; i < count; i++, row += 13, out += 4) {\n"
        "        const double *a[1]; double *r[1]; a[0] = row; r[0] = out;\n"
        "        dynamics(a, r, 0, 0, 0); } }\n"
    )
    command = ["cc", "-O2", "-shared", "-fPIC", "casadi_loop.c", "-o", "casadi.so", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "casadi.so"))


def pinocchio_tree() -> Any:
    """Return a call of Pinocchio's RNEA for the tree of links without its loops, or None."""
    try:
        pinocchio: Any = import_module("pinocchio")
    except ImportError:
        print("Pinocchio is not installed; its row is left out.")
        return None
    model = pinocchio.buildModelFromXML(urdf_text(APPENDIX_4))
    data, rng = model.createData(), np.random.default_rng(2)
    q, v, a = pinocchio.neutral(model), rng.normal(size=model.nv), rng.normal(size=model.nv)

    def run() -> None:
        for _ in range(STATES):
            pinocchio.rnea(model, data, q, v, a)

    return run


def one_by_one(e: Any, m: Any) -> Any:
    """Return the formula compiled by Numba for one state after the other."""
    digest = compiled.register(robot.inverse_dynamics_kernel)
    kernel = robot.inverse_dynamics_kernel

    @compiled.kernel(error_model="numpy", fastmath={"contract"})
    def run(m, e, rows, out):  # type: ignore[no-untyped-def]
        _ = digest
        for i in range(len(rows)):
            r = rows[i]
            values = kernel(
                m, e, 9.81, r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10],
                r[11], r[12],
            )  # fmt: skip
            out[i, 0], out[i, 1] = values[0], values[1]
            out[i, 2], out[i, 3] = values[2], values[3]

    return run


def print_goals(timed: dict[str, float], generated: float, small: int) -> None:
    """Print what was aimed at: the fastest build of either way against the same way of Numba's."""
    found = []
    for what, words, reference in (("many", "in columns", MANY), ("one by one", "given", ONE)):
        times = {name: t for name, t in timed.items() if name.startswith("C,") and words in name}
        name = min(times, key=lambda key: times[key])
        goal = f"inverse dynamics, {what}, over Numba's"
        found.append((goal, times[name] / timed[reference], GOALS["ratio"], name))
    found.append(("text at -Os [bytes]", small, GOALS["bytes"], "inverse dynamics, all it calls"))
    found.append(("kit printed [s of processor time]", generated, GOALS["seconds"], "all files"))
    rows = [
        [goal, number(value), number(most), "met" if value <= most else "NOT MET", what]
        for goal, value, most, what in found
    ]
    table(["goal", "measured", "at most", "", "of"], rows)


def main() -> None:
    """Print the tables."""
    start = time.process_time()
    kit = controller_kit(APPENDIX_4)
    generated = time.process_time() - start
    m, e = leg.mechanism(APPENDIX_4.geometry), lumped.term_factors(APPENDIX_4)
    pose, velocity, acceleration = states()
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    out, narrow = np.empty((STATES, 8)), np.empty((STATES, 4))
    compiled.inverse_dynamics_kernel(m, e, 9.81, pose, c, s, velocity, acceleration, out)
    given = np.column_stack([pose[:, :2], c, s, pose[:, 3], velocity, acceleration])
    plain = np.column_stack([pose, velocity, acceleration])
    calls = {
        "kernel": ("cos and sin given", given),
        "whole": ("whole call", plain),
        "columns": ("in columns", np.ascontiguousarray(given.T)),
    }
    with TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in kit.items():
            (folder / file).write_text(text)
        small = text_size(folder, "-Os", "-ffp-contract=off")
        timed = {
            MANY: best(
                lambda: compiled.inverse_dynamics_kernel(
                    m, e, 9.81, pose, c, s, velocity, acceleration, out
                )
            )
        }
        run = one_by_one(e, m)
        timed[ONE] = best(lambda: run(m, e, given, narrow))
        for build, command in BUILDS.items():
            if shutil.which(command[0]) is None:
                continue
            library = loops(folder, build, *command)
            for function, (words, rows) in calls.items():
                if build == INLINED and function != "columns":
                    continue  # it would take several rows at once
                call = getattr(library, function)
                timed[f"C, {words}, {build}"] = best(
                    lambda f=call, r=rows: f(STATES, pointer(r), pointer(narrow))
                )
        assert np.allclose(narrow.reshape(4, -1).T, out[:, :4], equal_nan=True)
        other = casadi_loop(folder, e, m)
        if other is not None:
            timed["CasADi's C, -O2"] = best(
                lambda: other.kernel(STATES, pointer(given), pointer(narrow))
            )
    tree = pinocchio_tree()
    if tree is not None:
        timed["Pinocchio's RNEA called from Python, tree without loops"] = best(tree)
    heading("Inverse dynamics in C")
    rows = [
        [what, number(1e9 * t / STATES), number(t / timed[MANY]), number(t / timed[ONE])]
        for what, t in timed.items()
    ]
    table(["what", "ns a state", "of many at once", "of one by one"], rows)
    print_goals(timed, generated, small)


if __name__ == "__main__":
    main()
