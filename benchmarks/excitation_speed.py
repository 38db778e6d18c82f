"""Best motions for a log against the best of 300 random ones, within a minute.

Run: ``python -m benchmarks.excitation_speed``.
"""

from __future__ import annotations

from benchmarks.measure import heading, number, table
from paminsa_viz.actuation import actuator_limits
from paminsa_viz.identification import ExcitationLimits, ExcitationSettings, optimize_excitation
from paminsa_viz.model import APPENDIX_4, backend

SECONDS = 60.0
RUNS = ((5, 0), (5, 1), (8, 0))
"""Harmonics and seeds."""


def main() -> None:
    """Run everything."""
    backend.compile_now()
    own = actuator_limits(APPENDIX_4)
    limits = ExcitationLimits(own.speed, own.rated)
    heading(f"Excitation: {SECONDS:g} s")
    rows = []
    for harmonics, seed in RUNS:
        settings = ExcitationSettings(
            harmonics=harmonics, seed=seed, seconds=SECONDS, evaluations=100_000
        )
        found = optimize_excitation(APPENDIX_4, limits, settings)
        kept = all(row.kept for row in found.limits)
        rows.append(
            (
                f"{harmonics} harmonics, seed {seed}", number(found.random_log_det),
                number(found.log_det), number(found.gain), str(found.evaluations),
                f"{number(found.seconds)} s", "yes" if kept else "no",
            )
        )  # fmt: skip
    head = (
        "log det", "best of 300 random", "found", "difference", "evaluations", "time",
        "limits kept",
    )  # fmt: skip
    table(head, rows)


if __name__ == "__main__":
    main()
