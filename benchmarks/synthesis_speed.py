"""Speed of synthesis: trial robots a second on one core, and the palletizing cell on two.

Run: ``python -m benchmarks.synthesis_speed``.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace

import numpy as np

from benchmarks.measure import best, heading, number, table
from paminsa_viz.studies import here, processes
from paminsa_viz.synthesis import Evaluator, Regime, SynthesisCase, synthesize
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case
from paminsa_viz.synthesis.search.evaluation import STAGES

TRIALS = 2000
PROTOTYPE = 20.0 / 33_000
"""Time of a trial in a first prototype on one core [s]."""


def trials(cases: dict[str, SynthesisCase]) -> None:
    """Time trials drawn evenly from the ranges, and about the answer, where all is evaluated."""
    rows = []
    for name, case in cases.items():
        evaluator = Evaluator(case, Regime.SMALLER)
        low, high = case.bounds.T
        rng = np.random.default_rng(0)
        anywhere = rng.uniform(low, high, (TRIALS, len(low)))
        answer = np.array(synthesize(case).states[0].best)
        near = np.clip(rng.normal(answer, 0.01 * (high - low), (TRIALS, len(low))), low, high)
        for place, numbers in (("anywhere", anywhere), ("near the answer", near)):
            seconds = best(lambda e=evaluator, n=numbers: e.evaluate(n), seconds=2.0) / TRIALS
            stages = Counter(item.stage for item in evaluator.evaluate(numbers))
            rows.append(
                [f"{name}, {place}", number(1e3 * seconds), number(1 / seconds),
                 f"{PROTOTYPE / seconds:.1f}", f"{100 * stages[STAGES] / TRIALS:.0f} %"]
            )  # fmt: skip
    heading("Trial robots on one core")
    columns = ["case, trials", "ms a robot", "robots a second", "prototype / this", "feasible"]
    table(columns, rows)


def searches(cases: dict[str, SynthesisCase]) -> None:
    """Time whole searches with verification, in this process and in two."""
    rows = []
    with processes(2) as pool:
        synthesize(replace(cases["cell"], effort=replace(cases["cell"].effort, generations=1)),
                   workers=pool, relax=False)  # starts them  # fmt: skip
        for name, case in cases.items():
            for place, workers in (("this process", here), ("two processes", pool)):
                start = time.perf_counter()
                found = synthesize(case, workers=workers)
                seconds = time.perf_counter() - start
                rows.append(
                    [name, place, number(seconds), str(found.trials), number(1e3 * found.objective)]
                )
    heading("Whole searches")
    table(["case", "where", "s", "robots", "R_f [mm]"], rows)


def main() -> None:
    """Run everything."""
    cases = {name: load_case(EXAMPLES[name]) for name in ("cylinder", "cell")}
    trials(cases)
    searches(cases)


if __name__ == "__main__":
    main()
