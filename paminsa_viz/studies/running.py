"""Runs a study into a file, row by row, and resumes where an earlier run was stopped."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass, field

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.resumable_csv import ResumableCsv
from paminsa_viz.progress import Progress, go_on
from paminsa_viz.studies.executors import Workers, here
from paminsa_viz.studies.metrics import MOTION_METRICS, RUNS
from paminsa_viz.studies.study import OK, Study

PART = 8
"""Rows handed to a worker at a time: some ten milliseconds of work."""


class WorkersLost(PaminsaError):
    """Worker processes that died, of lack of memory for example."""


@dataclass
class Extremes:
    """Least and largest value of a metric, with the rows that have them.

    Attributes:
        least, largest: The values; NaN if no row has any.
        least_row, largest_row: Numbers of the first rows that have them; -1 if none has.
    """

    least: float = math.nan
    largest: float = math.nan
    least_row: int = -1
    largest_row: int = -1

    def add(self, row: int, value: float) -> None:
        """Count one more value."""
        if self.least_row < 0 or value < self.least:
            self.least, self.least_row = value, row
        if self.largest_row < 0 or value > self.largest:
            self.largest, self.largest_row = value, row


@dataclass
class StudySummary:
    """Contents of a study's table.

    Attributes:
        study: The study.
        rows: Number of rows in the file.
        found: How many of them were there before this run.
        status: How many rows have which status; an impossible design's counts as ``impossible``.
        motion: How many rows have which word for the motion, without the leg.
        extremes: By column of the study's metrics. Of those over the region, rows count whose
            status is ok; of those on the motion, rows whose design can run it.
    """

    study: Study
    rows: int = 0
    found: int = 0
    status: Counter[str] = field(default_factory=Counter)
    motion: Counter[str] = field(default_factory=Counter)
    extremes: dict[str, Extremes] = field(init=False)

    def __post_init__(self) -> None:
        self.extremes = {metric.column: Extremes() for metric in self.study.metrics}

    def add(self, cells: Sequence[str]) -> None:
        """Count one more row of the table."""
        self.rows += 1
        row = dict(zip(self.study.columns, cells, strict=True))
        parts = (
            (self.status, "status", OK, self.study.region_metrics),
            (self.motion, "motion", RUNS, MOTION_METRICS),
        )
        for counts, column, good, metrics in parts:
            word = row.get(column, "").partition(":")[0]
            if word:
                counts[word] += 1
            for metric in metrics if word == good else ():
                if row[metric.column]:
                    self.extremes[metric.column].add(int(row["row"]), float(row[metric.column]))


@kinds_checked
def run_study(
    study: Study,
    path: str | os.PathLike[str],
    workers: Workers = here,
    *,
    restart: bool = False,
    command: str = "",
    progress: Progress = go_on,
) -> StudySummary:
    """Compute every row of a study and append it to a resumable CSV table.

    A run that is stopped, by Ctrl-C, a kill or a power cut, is resumed by the same call: no
    row is lost or written twice, and the finished file is the same to the last byte.

    Args:
        study: The study.
        path: The table; a part of this very study is resumed.
        workers: Where the work is done; the file does not depend on it.
        restart: Begin again, whatever the file holds.
        command: The command line, for the head of a new table.
        progress: Called with the ``summary`` so far, after the rows that are there and after each
            part; true ends it, with the rows that are written by then.

    Raises:
        TableFileError: If the file cannot be written or holds something else.
        WorkersLost: If worker processes died; what is written can be resumed.
    """
    head = study.provenance(command)
    summary = StudySummary(study)
    with ResumableCsv(path, head, study.columns, identity="study", restart=restart) as table:
        for cells in table.read():
            summary.add(cells)
        summary.found = summary.rows
        if progress(summary.rows / study.size, summary=summary):
            return summary
        starts = range(summary.found, study.size, PART)
        parts = (range(start, min(start + PART, study.size)) for start in starts)
        try:
            for rows in workers.in_order(study.rows, parts):
                table.append(rows)
                for cells in rows:
                    summary.add(cells)
                if progress(summary.rows / study.size, summary=summary):
                    break
        except BrokenExecutor as error:
            problem = (
                f"a worker process died, perhaps of lack of memory; {summary.rows} of {study.size} "
                "rows are written, and the same command resumes there"
            )
            raise WorkersLost(problem) from error
    return summary
