"""Speed of the model beside Pinocchio and MuJoCo models of the same robot, in one run.

Run: ``python -m benchmarks.model_speed`` (needs the extra ``verify`` for the engines).
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.model import (
    APPENDIX_4,
    Grid,
    backend,
    compiled,
    inverse_dynamics,
    leg,
    lumped_coefficients,
    regressor_torques,
    robot,
    rotary_torques,
    solve_field,
    static_torques,
    torque_regressor,
    xy_grid,
)
from paminsa_viz.model.lumped import Misprint, term_factors
from paminsa_viz.studies.sweeps import sweep

DESIGN = APPENDIX_4
GEOMETRY = DESIGN.geometry
ENGINE_STATES = 300
"""States given to an engine; its cost a state does not depend on their number."""

SIDES = (200, 500, 1000, 2000)
"""Cells along the sides of the maps that threads share."""

LARGEST = 7
"""Exponent of the largest sweep's poses."""


def random_states(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return poses within reach, velocities, accelerations, (count, 4) each."""
    rng = np.random.default_rng(1)
    pose = rng.uniform((-0.1, -0.1, -0.6, -0.7), (0.1, 0.1, 0.6, -0.35), (count, 4))
    return pose, rng.normal(size=(count, 4)), rng.normal(size=(count, 4))


def fig3_grid(count: int = 200) -> Grid:
    """Return the grid of Fig. 3, theta = pi/3, at a height of our choice."""
    axis = np.linspace(-0.2, 0.2, count)
    return xy_grid(axis, axis, np.pi / 3, -0.5)


def engines() -> dict[str, object]:
    """Return the engines' models that are installed."""
    found: dict[str, object] = {}
    try:
        from paminsa_viz.engines.pinocchio_model import PinocchioRobot

        found["Pinocchio, from Python"] = PinocchioRobot(DESIGN)
    except ImportError:
        print("Pinocchio is not installed; its rows are left out.")
    try:
        from paminsa_viz.engines.mujoco_model import MujocoRobot

        found["MuJoCo, from Python"] = MujocoRobot(DESIGN)
    except ImportError:
        print("MuJoCo is not installed; its rows are left out.")
    return found


def _rows(timed: list[tuple[str, float]], reference: float) -> list[list[str]]:
    return [[name, number(1e9 * t), number(t / reference)] for name, t in timed]


def static_map() -> None:
    """Time the static torques of M1..M3 on a 200 x 200 map."""
    grid = fig3_grid()
    poses = grid.poses().reshape(-1, 4)
    m = leg.mechanism(GEOMETRY)
    outer = np.zeros((200, 5))
    outer[:, 1] = grid.axes[0][1]
    outer[:, 2], outer[:, 3], outer[:, 4] = -0.5, np.cos(np.pi / 3), np.sin(np.pi / 3)
    inner = np.zeros((3, 200))
    inner[0] = grid.axes[1][1]
    out = np.empty((200, 3, 200))
    kernel = compiled.over_poses(robot.unit_torques, 3)[0]

    def on_numpy() -> None:
        with backend.use_numpy():
            rotary_torques(DESIGN, grid, threads=1)

    size = grid.size
    timed: list[tuple[str, float]] = [
        (
            "kernel, one core, results in place",
            best(lambda: kernel(m, outer, inner, True, out)) / size,
        ),
        ("rotary_torques, one core", best(lambda: rotary_torques(DESIGN, grid, threads=1)) / size),
        (
            "rotary_torques, two threads",
            best(lambda: rotary_torques(DESIGN, grid, threads=2)) / size,
        ),
        (
            "solve_field, with reasons for masked cells",
            best(lambda: solve_field(GEOMETRY, grid, threads=1)) / size,
        ),
        ("static_torques on a list of poses", best(lambda: static_torques(DESIGN, poses)) / size),
        ("the same source on NumPy arrays", best(on_numpy) / size),
    ]
    few = poses[:: size // ENGINE_STATES]
    for name, engine in engines().items():
        timed.append((name, best(lambda e=engine: e.static_torques(few), seconds=1.0) / len(few)))
    heading("Static torques of M1..M3, 200 x 200 map")
    table(["what", "ns a pose", "ratio"], _rows(timed, timed[0][1]))


def sharing() -> None:
    """Time static torques on larger maps by one and by two threads."""
    rows = []
    for side in SIDES:
        grid = fig3_grid(side)
        one, two = (
            best(lambda n=n, g=grid: rotary_torques(DESIGN, g, threads=n)) / grid.size
            for n in (1, 2)
        )
        rows.append([f"{grid.size:,}", number(1e9 * one), number(1e9 * two), number(one / two)])
    heading("Static torques of M1..M3 by one and by two threads")
    table(["poses", "one [ns a pose]", "two [ns a pose]", "ratio"], rows)


def dynamics() -> None:
    """Time inverse dynamics on 10,000 random states."""
    p, v, a = random_states(10_000)
    m, e = leg.mechanism(GEOMETRY), term_factors(DESIGN, Misprint.NONE)
    c, s = np.cos(p[:, 2]), np.sin(p[:, 2])
    out, kernel = np.empty((len(p), 8)), compiled.inverse_dynamics_kernel

    def on_numpy() -> None:
        with backend.use_numpy():
            inverse_dynamics(DESIGN, p, v, a)

    size = len(p)
    timed: list[tuple[str, float]] = [
        (
            "kernel, one core: torques and multipliers",
            best(lambda: kernel(m, e, DESIGN.gravity, p, c, s, v, a, out)) / size,
        ),
        ("inverse_dynamics, with status", best(lambda: inverse_dynamics(DESIGN, p, v, a)) / size),
        (
            "regressor Y (72 numbers a state)",
            best(lambda: torque_regressor(GEOMETRY, p, v, a)) / size,
        ),
        ("the same source on NumPy arrays", best(on_numpy) / size),
    ]
    few = tuple(values[:ENGINE_STATES] for values in (p, v, a))
    for name, engine in engines().items():
        timed.append(
            (name, best(lambda e=engine: e.inverse_dynamics(*few), seconds=1.0) / ENGINE_STATES)
        )
    heading("Inverse dynamics, 10,000 random states")
    table(["what", "ns a state", "ratio"], _rows(timed, timed[0][1]))


def mass_change() -> None:
    """Time a change of masses along a 500-sample trajectory, Y known."""
    p, v, a = random_states(500)
    y = torque_regressor(GEOMETRY, p, v, a)
    c = lumped_coefficients(DESIGN)
    heavier = DESIGN.vary({"links.b3": 0.5})
    product = best(lambda: regressor_torques(y, c))
    whole = best(lambda: regressor_torques(y, lumped_coefficients(heavier)))
    heading("A change of masses along 500 samples")
    table(
        ["what", "µs"],
        [
            ["Q = Y c", number(1e6 * product)],
            ["c from the masses, then Q = Y c", number(1e6 * whole)],
        ],
    )


def sweep_grid(size: int) -> Grid:
    """Return a grid over all four coordinates with about ``size`` poses."""
    n = round(size**0.25)
    return Grid.over(
        (0.0, 0.0, 0.0, 0.0),
        z=np.linspace(-0.7, -0.35, max(1, round(size / n**3))),
        theta=np.linspace(-0.6, 0.6, n),
        y=np.linspace(-0.1, 0.1, n),
        x=np.linspace(-0.1, 0.1, n),
    )


def growth() -> None:
    """Time sweeps from 10^3 to 10^`LARGEST` poses; the last one's memory in its own process."""
    rows = []
    for exponent in range(3, LARGEST + 1):
        grid = sweep_grid(10**exponent)
        run: Callable[[], object] = lambda g=grid: sweep(DESIGN, g, ("max_torque",))  # noqa: E731
        t = best(run, seconds=0.3, least=2)
        rows.append([f"{grid.size:,}", number(1e3 * t), number(1e9 * t / grid.size)])
    heading("Sweep of all four coordinates: max |torque|, reasons and summary")
    table(["poses", "ms", "ns a pose"], rows)
    child = subprocess.run(
        [sys.executable, "-m", "benchmarks.model_speed", "--memory", str(LARGEST)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    print(child.stdout)


def peak_memory() -> float:
    """Return the largest memory this process has had since it was started [MB] (Linux)."""
    status = Path("/proc/self/status").read_text()
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    return float("nan") if found is None else int(found[1]) / 1024


def memory(exponent: int) -> None:
    """Print the peak memory of a process before and after a sweep of 10^exponent poses."""
    sweep(DESIGN, sweep_grid(1000))
    before = peak_memory()
    sweep(DESIGN, sweep_grid(10**exponent))
    after = peak_memory()
    swept = f"{after:.0f} MB after a sweep of 10^{exponent} poses"
    print(f"Peak memory: {before:.0f} MB before, {swept}.")


@compiled.kernel(error_model="numpy", fastmath={"contract"})
def _roots(x, out):  # type: ignore[no-untyped-def]
    """Do the divisions and roots of a static map's pose and nothing else."""
    for i in range(x.size):
        a = x[i]
        b, c, d = 1.0 / (a + 1.0), 1.0 / (a + 2.0), 1.0 / (a + 3.0)
        e, f, g = np.sqrt(b), np.sqrt(c), np.sqrt(d)
        out[i] = 0.5 / e + 0.5 / f + 0.5 / g + 1.0 / (a + 4.0)


@compiled.kernel(error_model="numpy")
def _store(out):  # type: ignore[no-untyped-def]
    for i in range(out.size):
        out[i] = 1.0


def limits() -> None:
    """Time what the machine needs for the bare arithmetic and the bare memory traffic."""
    x, out = np.linspace(0.0, 1.0, 40_000), np.empty(40_000)
    roots = best(lambda: _roots(x, out)) / x.size
    big = np.empty(3 * 40_000)
    store = best(lambda: _store(big)) / 40_000
    heading("The machine's limits for one pose of a static map, one core")
    table(
        ["what", "ns a pose"],
        [
            ["its 7 divisions and 3 square roots alone", number(1e9 * roots)],
            ["storing its 3 results alone", number(1e9 * store)],
        ],
    )


def main() -> None:
    """Run everything."""
    if "--memory" in sys.argv:
        memory(int(sys.argv[-1]))
        return
    compiled.warm_up()
    for part in (static_map, sharing, limits, dynamics, mass_change, growth):
        part()


if __name__ == "__main__":
    main()
