"""Speed of what a page does with a trajectory: masses, geometry, durations, simulation, files.

Run: ``python -m benchmarks.trajectory_speed``. The machine should be idle.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from io import StringIO

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.files.tables import table_csv, table_npz
from paminsa_viz.files.trajectory_table import analysis_table, parse_trajectory
from paminsa_viz.model import APPENDIX_4, backend, inverse_dynamics, torque_regressor
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    MotionLimits,
    analyze,
    check_path,
    load_kernel,
    shortest_stretch,
    simulate,
)

DESIGN = APPENDIX_4
PLAN = PRESET["waypoints"].build(DESIGN.geometry).lasting(10.0)
SAMPLES = PLAN.sample(1000.0)
"""The trajectory of the targets: 10 s at 1 kHz."""


def milliseconds(run: Callable[[], object]) -> str:
    """Time a call."""
    return number(1e3 * best(run, seconds=0.7))


def changes() -> None:
    """Time what follows when a slider moves, and the parts of it."""
    solved = analyze(DESIGN, SAMPLES).solved
    heavier = DESIGN.vary({"links.b3": 0.5})
    rough = DESIGN.vary({"friction.coulomb_rotary": 0.3, "friction.viscous_rotary": 1.0})
    wider = DESIGN.vary({"geometry.base_radius": 0.36})
    t = SAMPLES
    motion = (t.pose, t.velocity, t.acceleration)

    def on_numpy() -> None:
        with backend.use_numpy():
            torque_regressor(DESIGN.geometry, *motion)

    heading("A trajectory of 10 s at 1 kHz (10,001 states)")
    table(
        ["what", "ms", "target"],
        [
            ["a mass changes: torques", milliseconds(lambda: analyze(heavier, t, keep=solved)),
             "1"],
            ["the same with friction", milliseconds(lambda: analyze(rough, t, keep=solved)), "1"],
            ["a mass changes: the four parts",
             milliseconds(lambda: analyze(heavier, t, keep=solved).breakdown), ""],
            ["a mass changes: peaks, RMS, power, energy",
             milliseconds(lambda: analyze(heavier, t, keep=solved).summary), ""],
            ["the geometry changes: check, Y, torques", milliseconds(lambda: analyze(wider, t)),
             "50"],
            ["of which the check of the path",
             milliseconds(lambda: check_path(wider.geometry, t)), ""],
            ["of which the regressor Y",
             milliseconds(lambda: torque_regressor(wider.geometry, *motion)), ""],
            ["the geometry changes: with the four parts",
             milliseconds(lambda: analyze(wider, t).breakdown), ""],
            ["Y by the same formulas on NumPy arrays", milliseconds(on_numpy), ""],
            ["torques by inverse dynamics",
             milliseconds(lambda: inverse_dynamics(DESIGN, *motion)), ""],
            ["a new motion: samples of the plan", milliseconds(lambda: PLAN.sample(1000.0)), ""],
        ],
    )  # fmt: skip


def durations() -> None:
    """Time the search for the shortest duration."""
    limits = {
        "speed and acceleration": MotionLimits(speed=0.5, acceleration=2.0),
        "torque": MotionLimits(torque=10.0, force=350.0),
    }
    rows = []
    for key in ("quintic", "s-curve", "waypoints", "arch"):
        plan = PRESET[key].build(DESIGN.geometry)
        for name, limit in limits.items():
            found = shortest_stretch(plan, limit, DESIGN)
            run: Callable[[], object] = lambda p=plan, l=limit: shortest_stretch(p, l, DESIGN)  # noqa: E731, E741
            rows.append([plan.name, name, f"{found.plan.duration:.4f}", milliseconds(run)])
    heading("Shortest durations within limits, the check of the path included")
    table(["motion", "limits", "duration [s]", "ms"], rows)


def simulations() -> None:
    """Time simulations, and tell how well they keep the energy."""
    start = time.perf_counter()
    load_kernel()
    loading = time.perf_counter() - start
    samples = PLAN.sample(200.0)
    loaded = DESIGN.vary({"payload.mass": 0.5})
    rough = loaded.vary({"friction.coulomb_rotary": 0.3, "friction.viscous_rotary": 0.5})
    rows = []
    for control in ControlMode:
        for name, robot in (("exact", DESIGN), ("0.5 kg", loaded), ("0.5 kg, friction", rough)):
            controller = Controller(control)
            found = simulate(robot, samples, model=DESIGN, controller=controller)
            run: Callable[[], object] = lambda r=robot, c=controller: simulate(  # noqa: E731
                r, samples, model=DESIGN, controller=c
            )
            drift = float(np.abs(found.energy_drift).max())
            rows.append([
                control.value, name, f"{found.t[-1]:.2f}", milliseconds(run),
                f"{found.evaluations:,}", f"{1e3 * found.distance.max():.2g}", f"{drift:.1g}",
            ])  # fmt: skip
    heading("Simulation of 10 s, the controller believing in Appendix 4's robot")
    columns = ["control", "robot", "until [s]", "ms", "evaluations", "error [mm]", "drift [J]"]
    table(columns, rows)
    print(f"Loading (or compiling) the equations of motion took {loading:.1f} s.\n")


def files() -> None:
    """Time reading and writing."""
    series = analysis_table(analyze(DESIGN, SAMPLES))
    text = table_csv(series).decode()
    heading("Files of 10,001 rows, 45 columns")
    table(
        ["what", "ms", "MB"],
        [
            ["write CSV", milliseconds(lambda: table_csv(series)), number(len(text) / 1e6)],
            ["write NPZ", milliseconds(lambda: table_npz(series)),
             number(len(table_npz(series)) / 1e6)],
            ["read CSV", milliseconds(lambda: parse_trajectory(StringIO(text), "t.csv")), ""],
        ],
    )  # fmt: skip


def main() -> None:
    """Run everything."""
    backend.compile_now()
    for part in (changes, durations, simulations, files):
        part()


if __name__ == "__main__":
    main()
