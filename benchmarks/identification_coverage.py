"""How often the 95 % intervals of an identification hold the true number, by cut-off and log.

Run: ``python -m benchmarks.identification_coverage``, which takes some ten minutes. Logs are those
of the tests: random motions of a period of 10 s, up to 1.4 Hz, torque noise of 2 % that is
correlated over 20 ms, positions rounded to 0.01 degrees and 10 µm. Figures do not depend on the
machine.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from benchmarks.measure import heading, table
from paminsa_viz.identification import IdentificationSettings, identify
from paminsa_viz.model import APPENDIX_4, Friction
from paminsa_viz.model.arrays import Array
from tests.support.identification_logs import simulated

DESIGN = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
RATE = 100.0
"""Rows a second."""

LOGS = {"20 s": (20.0, 0.0), "60 s": (60.0, 0.0), "60 s, encoders jitter": (60.0, 0.5)}
"""Duration [s], and by how many counts encoders jitter. Without, each period rounds alike."""


def coverage(cut_off: float, duration: float, jitter: float, motions: int, noises: int) -> Array:
    """Return the share of noises whose interval holds the truth, (motions, parameters)."""
    settings = IdentificationSettings(cut_off=cut_off, robustness=False)
    held = []
    for motion in range(1, motions + 1):
        for noise in range(noises):
            log = simulated(
                motion, DESIGN, noise_seed=100 * motion + noise, jitter=jitter,
                duration=duration, rate=RATE,
            )  # fmt: skip
            found = identify(DESIGN, log, settings).estimates
            held.append([abs(e.value - e.parameter.design) <= e.half_width for e in found])
    return np.reshape(held, (motions, noises, -1)).mean(axis=1)


def main() -> None:
    """Print the coverage of all cut-offs and kinds of logs."""
    parser = argparse.ArgumentParser(prog="identification_coverage", description=__doc__)
    parser.add_argument("--motions", type=int, default=10)
    parser.add_argument("--noises", type=int, default=15, help="logs of each motion")
    parser.add_argument("--cut-offs", type=float, nargs="+", default=[1.0, 2.0, 5.0, 10.0])
    given = parser.parse_args()
    heading(f"{given.motions * given.noises} logs each: coverage of all parameters, least of one")
    rows = []
    for cut_off in given.cut_offs:
        row = [f"{cut_off:g} Hz"]
        for log in LOGS.values():
            held = coverage(cut_off, *log, given.motions, given.noises)
            # parameters of a log are correlated, and so are logs of a motion
            error = held.mean(axis=1).std(ddof=1) / np.sqrt(given.motions)
            least = held.mean(axis=0).min()
            row.append(f"{100 * held.mean():.1f} ± {100 * error:.1f} %, {100 * least:.0f} %")
        rows.append(row)
    table(["cut-off", *LOGS], rows)


if __name__ == "__main__":
    main()
