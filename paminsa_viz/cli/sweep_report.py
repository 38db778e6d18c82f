"""What ``paminsa-viz sweep`` says, while it works and at its end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from paminsa_viz.blocks.kinds import Table, rows
from paminsa_viz.cli.output import print_blocks, record
from paminsa_viz.studies import StudySummary
from paminsa_viz.studies.metrics import RUNS
from paminsa_viz.studies.study import OK
from paminsa_viz.units import NONE, number


@contextmanager
def progress_bar(total: int) -> Iterator[Callable[[StudySummary], None]]:
    """Show a bar while the work goes on, to people: not to files and other programs."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("designs", total=total)

        def show(summary: StudySummary) -> None:
            bar.update(task, completed=summary.rows)
            if summary.rows == summary.found:
                bar.reset(task, completed=summary.rows)  # what was there says nothing of the speed

        yield show


def report(path: Path, summary: StudySummary, seconds: float) -> dict[str, Any]:
    """Return what the table holds as data for JSON, in SI units."""
    study, motion = summary.study, summary.study.trajectory
    return {
        "file": path,
        "design": study.design.name,
        "knee": study.design.geometry.knee.value,
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


def print_report(path: Path, summary: StudySummary, seconds: float) -> None:
    """Print what the table holds, for people."""
    cells = (
        (name, *_cells(found.least, found.least_row), *_cells(found.largest, found.largest_row))
        for name, found in summary.extremes.items()
    )
    print_blocks([Table(("", "Least", "In row", "Largest", "In row"), rows(*cells))])
    before = f", {summary.found} of them found there" if summary.found else ""
    others = _others(summary.status, OK)
    print(f"{path}: {summary.rows} designs{before}{others}, {seconds:.1f} s")
    motion = summary.study.trajectory
    if motion is not None:
        run = summary.motion.get(RUNS, 0)
        print(f"{motion.name}: {run} designs can run it{_others(summary.motion, RUNS)}")
        for note in motion.notes:
            print(f"  {note}")


def _others(counts: Mapping[str, int], good: str) -> str:
    return "".join(f", {count} {word}" for word, count in counts.items() if word != good)


def _cells(value: float, row: int) -> tuple[str, str]:
    return (NONE, NONE) if row < 0 else (number(value), str(row))
