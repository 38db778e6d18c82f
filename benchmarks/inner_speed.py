"""Speed of masses and springs of given lengths, as the outer search solves them for each trial.

Run: ``python -m benchmarks.inner_speed``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.balancing import CounterweightRange, SpringPlace, at_joint, beyond, on_slider
from paminsa_viz.model import APPENDIX_4, backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.answer.checks import AnswerMargins, built_robots
from paminsa_viz.synthesis.answer.engine_check import check_by_mujoco
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.synthesis.masses.program import solve_inner
from paminsa_viz.synthesis.masses.space import sampled_solution
from paminsa_viz.trajectory import PRESET, solve_trajectory

DESIGN = APPENDIX_4
MASSES = tuple(MassFactor(f"links.{bar}", 0.5, 2.0) for bar in ("b3", "b4", "b7", "b8"))
FIXED = (CounterweightRange("b8", 8, 0.2, 0.2, 4.0), CounterweightRange("b3", 7, 0.2, 0.2, 4.0))
FREE = (beyond("b8", 8, 0.2, 4.0), beyond("b3", 7, 0.2, 4.0))
SPRING = SpringPlace(on_slider(0.3), at_joint(9), 2000.0, 0.0, 0.2)


def workspace() -> Array:
    """Return 5 x 5 x 5 x 5 poses."""
    side = np.linspace(-0.1, 0.1, 5)
    axes = (side, side, np.linspace(-0.5, 0.5, 5), np.linspace(-0.6, -0.4, 5))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)


def main() -> None:
    """Run everything."""
    backend.compile_now()
    pose, motion = workspace(), PRESET["arch"].build(DESIGN.geometry).sample(40)
    bounds = (Requirement("max_torque", high=2.0), Requirement("f_4", high=250.0))
    plain = InnerCase("peak_torque", (motion,), MASSES, FIXED)
    cases = {
        "no mass is free: peak torque alone": InnerCase("peak_torque", (motion,)),
        "four masses, two counterweights": plain,
        "the same, torque and F4 limited": replace(plain, bounds=bounds, motion_force=270.0),
        "the same, levers free": replace(
            plain, counterweights=FREE, bounds=bounds, motion_force=270.0
        ),
        "the same, a spring": replace(
            plain, counterweights=FREE, springs=(SPRING,), bounds=bounds, motion_force=270.0
        ),
        "four masses, two counterweights, energy": replace(plain, goal="energy"),
        "four masses, two counterweights, least mass": InnerCase(
            "moving_mass", (), MASSES, FIXED, bounds=bounds
        ),
    }
    rows = []
    for name, case in cases.items():
        found = solve_inner(DESIGN, case, pose)
        exact = best(lambda case=case: solve_inner(DESIGN, case, pose))
        rough = best(lambda case=case: solve_inner(DESIGN, case, pose, tolerance=1e-4))
        gap = found.gap / found.objective
        rows.append(
            [name, number(1e3 * exact), number(1e3 * rough), str(found.rounds), f"{gap:.0e}"]
        )
    heading(f"Masses and springs of given lengths; {motion.size} samples, {len(pose)} poses")
    table(["what", "ms", "ms at 1e-4", "linear programs", "relative gap"], rows)

    limited = solve_inner(DESIGN, cases["the same, a spring"], pose)
    others = {
        "motion of a trial": lambda: sampled_solution(DESIGN.geometry, motion, DESIGN.gravity),
        "the same with what lies between samples": lambda: solve_trajectory(
            DESIGN.geometry, motion
        ),
        "100 robots built within tolerances": lambda: built_robots(DESIGN, 100),
        "MuJoCo's check, 60 poses and the motion": lambda: check_by_mujoco(
            limited.design, AnswerMargins(Requirements(bounds), limited.springs, (motion,)), pose
        ),
    }
    heading("What goes with it")
    table(["what", "ms"], [[name, number(1e3 * best(run))] for name, run in others.items()])


if __name__ == "__main__":
    main()
