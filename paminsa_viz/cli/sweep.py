"""``paminsa-viz sweep``: many designs, each measured, into a resumable table."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from paminsa_viz.blocks.sweep import sweep_blocks, sweep_data
from paminsa_viz.cli.arguments import OrNone, UsageError, Words, check_needs, command_line
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, RegionFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags, PresetName
from paminsa_viz.cli.output import print_blocks, print_error, print_json, print_left_out
from paminsa_viz.errors import InvalidInput
from paminsa_viz.interrupts import on_interrupt
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.quantities import find
from paminsa_viz.studies import (
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
    Study,
    StudySummary,
    Workers,
    cluster,
    processes,
    run_study,
)
from paminsa_viz.studies.running import WorkersLost
from paminsa_viz.studies.variations import check_path
from paminsa_viz.units import counted

DESCRIPTION = """\
Measure many designs over the workspace: torques, masses, distances to every limit, one row each.

  paminsa-viz sweep --vary links.b3=0.2:0.6:5 --vary joints.j7=0.2:0.4:3 --out grid.csv
  paminsa-viz sweep --vary links.b3=0.2,0.406,0.9 --radius 120 --theta 0 --theta 60 --out three.csv
  paminsa-viz sweep --random 10000 --vary geometry.base_radius --vary geometry.crank_length \\
      --spread 0.2 --seed 1 --scale-bars --out random.csv
  paminsa-viz sweep --vary joints.j7=0:1:11 --preset arch --out arch.csv

A grid is every combination of LOW:HIGH:COUNT or of values between commas. Random designs are drawn
evenly from LOW:HIGH or, for a path alone, from --spread around the design's own value. `paminsa-viz
design show` lists what can be varied, in SI units: j7_kg of joints there is joints.j7 here.

With --preset or --file, each design is also measured on that motion: torques, forces and energy as
`paminsa-viz trajectory` has them. A preset is sized for the design that the others are made from,
so that all of them run the same motion. A design that cannot run it has no such numbers; the
columns motion and motion_fails_s say why not and when.

Rows are written as they come. After Ctrl-C, a kill or a power cut the same command resumes where
the table ends; no row is lost or written twice, and a row that was changed since is refused.
--workers and --dask change nothing in the table.

Exit code: 0 done; 1 workers died; 2 a wrong argument or file; 130 stopped with Ctrl-C."""

MOST = 10**9
"""Most designs in one table."""

MOST_VALUES = 10**6
"""Most values of one axis."""

WORTH_PROCESSES = 10**7
"""Number of poses that take about as long as processes take to start, some seconds."""


@dataclass(frozen=True, kw_only=True)
class Sweep(JsonFlags, RegionFlags, MotionFlags, DesignFlags):
    """Flags of the command."""

    preset: OrNone[PresetName] = None
    """A ready-made motion to measure the designs on as well."""
    out: Annotated[Path, tyro.conf.arg(metavar="FILE.csv")]
    """Table to write, or to resume."""
    vary: Annotated[Words, tyro.conf.arg(metavar="PATH[=VALUES]")] = ()
    """A design value that varies, and how; can be repeated."""
    random: Annotated[OrNone[int], tyro.conf.arg(metavar="N")] = None
    """Draw this many random designs, instead of a grid."""
    seed: int = 0
    """Seed of random designs."""
    spread: Annotated[float, tyro.conf.arg(metavar="SHARE")] = 0.2
    """Spread of random values around the design's own; 0.2 is 20 % less to 20 % more."""
    scale_bars: bool = False
    """Let bars keep their cross section, so that mass and inertia follow their length."""

    max_condition: float = CONDITION_LIMIT
    """Largest condition number at which torques count; beyond it they grow without bound."""

    index: Annotated[Words, tyro.conf.arg(metavar="QUANTITY")] = ()
    """A quantity of maps whose global indices are measured: mean, least and spread over the
    region, such as horizontal-force or transmission; can be repeated."""

    restart: bool = False
    """Start over, whatever the table holds."""
    workers: OrNone[int] = None
    """Number of processes; one on each core if left out, where that pays."""
    dask: Annotated[OrNone[str], tyro.conf.arg(metavar="ADDRESS")] = None
    """Work on the Dask cluster with this scheduler, such as tcp://10.0.0.1:8786."""

    def run(self) -> int:
        """Measure the designs."""
        if self.dask is not None and self.workers is not None:
            raise UsageError("--dask and --workers exclude each other")
        check_output("--out", self.out, [".csv"])
        study = study_of(self, self.given_design())
        started = time.monotonic()
        latest = StudySummary(study)

        def note(done: float, /, *, summary: StudySummary, **_: Any) -> None:
            nonlocal latest
            latest = summary
            show(summary)

        def stopped() -> str:
            rows = f"{latest.rows:,} of {counted(study.size, 'row')}"
            return f"stopped after {rows}; the same command resumes it"

        with on_interrupt(stopped), _progress_bar(study.size) as show:
            try:
                with _workers(self, study) as workers:
                    run_study(
                        study, self.out, workers,
                        restart=self.restart, progress=note, command=command_line.get(),
                    )  # fmt: skip
            except WorkersLost as error:
                print_error(error)
                return 1
        seconds = time.monotonic() - started
        if self.json:
            print_json(sweep_data(self.out, latest, seconds))
        else:
            print_blocks(sweep_blocks(self.out, latest, seconds))
            if not study.own_legs:
                print_left_out(study.design)
        return 0


FLAGS = Sweep


def study_of(flags: Sweep, design: Design) -> Study:
    """Return the study that the flags describe.

    Raises:
        UsageError, InvalidInput: Which value is not possible, and what is.
        TableFileError: If the motion's file cannot be read.
    """
    if not flags.vary:
        raise UsageError("--vary is needed, such as --vary links.b3=0.2:0.6:5")
    check_needs(flags, flags.random is not None, "--random", "spread", "seed")
    if flags.random is not None and flags.random < 1:
        raise UsageError(f"--random: one design at least is needed, not {flags.random}")
    if not 0 < flags.spread <= 1:
        raise UsageError(f"--spread: a share from 0 to 1 is needed, not {flags.spread:g}")
    region = replace(flags.given_region(design), max_condition=flags.max_condition)
    variation: DesignGrid | RandomDesigns
    if flags.random is None:
        variation = DesignGrid(tuple(map(_axis, flags.vary)))
    else:
        ranges = tuple(_range(text, design, flags.spread) for text in flags.vary)
        variation = RandomDesigns(ranges, flags.random, flags.seed)
    if variation.size > MOST:
        raise UsageError(f"{variation.size:,} designs are too many; {MOST:,} are possible")
    moving = flags.preset is not None or flags.file is not None
    motion = flags.given_motion(design.geometry) if moving else None
    indices = tuple(key.replace("-", "_") for key in flags.index)
    try:
        find(indices)
    except InvalidInput as error:
        raise UsageError(f"--index: {error.problem}") from error
    return Study(design, variation, region, flags.scale_bars, motion, indices)


def _axis(text: str) -> DesignAxis:
    """Return what ``PATH=LOW:HIGH:COUNT`` or ``PATH=VALUE,VALUE`` says."""
    path, _, values_text = text.partition("=")
    check_path(path)
    problem = f"--vary {text[:60]}: a grid needs {path}=LOW:HIGH:COUNT or {path}=VALUE,VALUE,..."
    parts = values_text.split(":")
    try:
        if len(parts) == 1:
            values = tuple(map(float, values_text.split(",")))
        else:
            low, high, count = parts
            if not 1 <= int(count) <= MOST_VALUES:
                raise UsageError(f"--vary {text[:60]}: a count from 1 to {MOST_VALUES} is needed")
            values = tuple(np.linspace(float(low), float(high), int(count)).tolist())
    except UsageError:
        raise
    except ValueError:
        raise UsageError(problem) from None
    _check_size(path, values)
    return DesignAxis(path, values)


def _range(text: str, design: Design, spread: float) -> DesignRange:
    """Return what ``PATH=LOW:HIGH`` or ``PATH`` alone says."""
    path, given, values_text = text.partition("=")
    check_path(path)
    if not given:
        return DesignRange.around(design, path, spread)
    try:
        low, high = map(float, values_text.split(":"))
    except ValueError:
        problem = f"--vary {text[:60]}: random designs need {path} or {path}=LOW:HIGH"
        raise UsageError(problem) from None
    _check_size(path, (low, high))
    return DesignRange(path, low, high)


def _check_size(path: str, values: tuple[float, ...]) -> None:
    most = PARAMETER[path].largest
    if any(abs(value) > most for value in values):
        raise UsageError(f"--vary {path}: at most {most:g} is possible")


def _workers(flags: Sweep, study: Study) -> AbstractContextManager[Workers]:
    if flags.dask is not None:
        return cluster(flags.dask)
    small = flags.workers is None and study.work < WORTH_PROCESSES
    return processes(1 if small else flags.workers)


@contextmanager
def _progress_bar(total: int) -> Iterator[Callable[[StudySummary], None]]:
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
    bar = Progress(*columns, console=console, disable=not console.is_terminal)
    with on_interrupt(bar.stop), bar:  # or a terminal is left without its cursor
        task = bar.add_task("designs", total=total)

        def show(summary: StudySummary) -> None:
            bar.update(task, completed=summary.rows)
            if summary.rows == summary.found:
                bar.reset(task, completed=summary.rows)  # what was there says nothing of the speed

        yield show
