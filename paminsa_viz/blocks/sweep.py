"""Sweeps: what a table of many designs holds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from paminsa_viz.blocks.data import record, robot
from paminsa_viz.blocks.kinds import Block, Note, Table, rows
from paminsa_viz.studies import StudySummary
from paminsa_viz.studies.metrics import RUNS
from paminsa_viz.studies.study import OK
from paminsa_viz.units import NONE, counted, number


def sweep_blocks(path: Path, summary: StudySummary, seconds: float) -> list[Block]:
    """Return the extremes of each metric and where they are, and how many designs count."""
    cells = (
        (name, *_cells(found.least, found.least_row), *_cells(found.largest, found.largest_row))
        for name, found in summary.extremes.items()
    )
    before = f", {summary.found} of them found there" if summary.found else ""
    others = _others(summary.status, OK)
    blocks: list[Block] = [
        Table(("", "Least", "In row", "Largest", "In row"), rows(*cells)),
        Note(f"{path}: {counted(summary.rows, 'design')}{before}{others}, {seconds:.1f} s"),
    ]
    motion = summary.study.trajectory
    if motion is not None:
        run = summary.motion.get(RUNS, 0)
        text = f"{motion.name}: {counted(run, 'design')} can run it{_others(summary.motion, RUNS)}"
        blocks += [Note(text), *(Note(f"  {note}") for note in motion.notes)]
    return blocks


def _others(counts: Mapping[str, int], good: str) -> str:
    return "".join(f", {count:,} {word}" for word, count in counts.items() if word != good)


def _cells(value: float, row: int) -> tuple[str, str]:
    return (NONE, NONE) if row < 0 else (number(value), str(row))


def sweep_data(path: Path, summary: StudySummary, seconds: float) -> dict[str, Any]:
    """Return what the table holds as data for JSON, in SI units."""
    study, motion = summary.study, summary.study.trajectory
    return {
        "files": [path],
        **robot(study.design),
        "seconds": round(seconds, 3),
        **record(summary, "rows", "found", "status"),
        "motion": motion
        and {
            **record(motion, "name", "duration_s", "notes"),
            "samples": motion.size,
            "status": summary.motion,
        },
        "metrics": summary.extremes,
    }
