"""``paminsa-viz sweep``: many designs, each measured, into a resumable table."""

from __future__ import annotations

import math
import shlex
import sys
import time
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.cli.arguments import PROGRAM, UsageError, parse, print_error
from paminsa_viz.cli.inputs import Assembly, PresetName, design_of, motion_of
from paminsa_viz.cli.output import print_json
from paminsa_viz.cli.sweep_report import print_report, progress_bar, report
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.studies import (
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
    Study,
    StudySummary,
    Workers,
    cluster,
    default_region,
    processes,
    run_study,
)
from paminsa_viz.studies.running import WorkersLost
from paminsa_viz.studies.variations import check_path

DESCRIPTION = """\
Measure many designs over the workspace: torques, masses, distances to every limit, one row each.

  paminsa-viz sweep --vary links.b3=0.2:0.6:5 --vary joints.j7=0.2:0.4:3 --out grid.csv
  paminsa-viz sweep --vary links.b3=0.2,0.406,0.9 --radius 120 --theta 0 --theta 60 --out three.csv
  paminsa-viz sweep --random 10000 --vary geometry.base_radius --vary geometry.crank_length
      --spread 0.2 --seed 1 --scale-bars --out random.csv
  paminsa-viz sweep --vary joints.j7=0:1:11 --preset arch --out arch.csv

A grid is every combination of LOW:HIGH:COUNT or of values between commas. Random designs are drawn
evenly from LOW:HIGH or, for a path alone, from --spread around the design's own value. Names are
those of the model, values in SI units; `paminsa-viz design show` lists both.

With --preset or --file, each design is also measured on that motion: torques, forces and energy as
`paminsa-viz trajectory` has them. A preset is sized for the design that the others are made from,
so that all of them run the same motion. A design that cannot run it has no such numbers; the
columns motion and motion_fails_s say why not and when.

Rows are written as they come. After Ctrl-C, a kill or a power cut the same command goes on where
the table ends; no row is lost or written twice. --jobs and --dask change nothing in the table.

Exit code: 0 done; 1 workers died; 2 a wrong argument or file; 130 stopped with Ctrl-C."""

MOST = 10**9
"""Most designs in one table."""

MOST_VALUES = 10**6
"""Most values of one axis."""

WORTH_PROCESSES = 10**7
"""Number of poses that take about as long as processes take to start, some seconds."""


@dataclass(frozen=True)
class Sweep:
    """Flags of the command."""

    out: Annotated[Path, tyro.conf.arg(metavar="FILE.csv")]
    """Table to write, or to go on with."""
    vary: Annotated[tuple[str, ...], tyro.conf.arg(metavar="PATH[=VALUES]")] = ()
    """A design value that varies, and how; can be repeated."""
    random: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Draw this many random designs, instead of a grid."""
    seed: int = 0
    """Seed of random designs."""
    spread: Annotated[float, tyro.conf.arg(metavar="SHARE")] = 0.2
    """Spread of random values around the design's own; 0.2 is 20 % less to 20 % more."""
    scale_bars: bool = False
    """Let bars keep their cross section, so that mass and inertia follow their length."""
    design: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML) for what does not vary, instead of the paper's Appendix 4."""
    assembly: Assembly | None = None
    """Branch of the knee 9: as Appendix 1 prints it (lower), or its mirror image; by default the
    design's own."""

    radius: Annotated[float | None, tyro.conf.arg(metavar="MM")] = None
    """Radius of the disc of positions that is looked at [mm]; half of R_b if left out."""
    theta: Annotated[tuple[float, ...], tyro.conf.arg(metavar="DEG")] = (0.0, 30.0)
    """An angle that is looked at [°]; can be repeated."""
    z: Annotated[tuple[float, ...], tyro.conf.arg(metavar="MM")] = ()
    """A height that is looked at [mm]; can be repeated. In the middle of the workspace if left
    out."""
    cells: int = 40
    """Positions along the disc's diameter."""
    max_condition: float = 10.0
    """Largest condition number at which torques count; beyond it they grow without bound."""

    preset: PresetName | None = None
    """A ready-made motion to measure the designs on as well."""
    file: Annotated[Path | None, tyro.conf.arg(metavar="FILE.csv")] = None
    """A motion as a table, instead of a preset."""

    restart: bool = False
    """Begin again, whatever the table holds."""
    jobs: int | None = None
    """Number of processes; one on each core if left out, where that pays."""
    dask: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None
    """Work on the Dask cluster with this scheduler, such as tcp://10.0.0.1:8786."""
    json: bool = False
    """Print JSON for other programs, in SI units."""


def main(words: list[str]) -> int:
    """Run the command."""
    flags = parse(Sweep, words, "sweep", DESCRIPTION)
    if flags.dask is not None and flags.jobs is not None:
        raise UsageError("--dask and --jobs exclude each other")
    if flags.preset is not None and flags.file is not None:
        raise UsageError("--preset and --file exclude each other")
    study = study_of(flags, design_of(flags.design, flags.assembly))
    started = time.monotonic()
    latest = StudySummary(study)

    def note(summary: StudySummary) -> None:
        nonlocal latest
        latest = summary
        show(summary)

    with progress_bar(study.size) as show:
        try:
            with _workers(flags, study) as workers:
                run_study(
                    study, flags.out, workers, restart=flags.restart, progress=note,
                    command=shlex.join([PROGRAM, "sweep", *words]),
                )  # fmt: skip
        except WorkersLost as error:
            print_error(error)
            return 1
        except KeyboardInterrupt:
            print(
                f"{PROGRAM}: stopped after {latest.rows} of {study.size} rows; the same command "
                "goes on from there",
                file=sys.stderr,
            )
            raise
    seconds = time.monotonic() - started
    if flags.json:
        print_json(report(flags.out, latest, seconds))
    else:
        print_report(flags.out, latest, seconds)
    return 0


def study_of(flags: Sweep, design: Design) -> Study:
    """Return the study that the flags ask for.

    Raises:
        UsageError, InvalidInput: Which value is not possible, and what is.
        TableFileError: If the motion's file cannot be read.
    """
    if not flags.vary:
        raise UsageError("--vary is needed, such as --vary links.b3=0.2:0.6:5")
    if not 0 < flags.spread <= 1:
        raise UsageError(f"--spread: a share from 0 to 1 is needed, not {flags.spread:g}")
    region = default_region(design)
    if flags.radius is not None:
        region = replace(region, radius=1e-3 * flags.radius)
    if flags.z:
        region = replace(region, z=tuple(1e-3 * z for z in flags.z))
    theta = tuple(math.radians(angle) for angle in flags.theta)
    region = replace(region, theta=theta, cells=flags.cells, max_condition=flags.max_condition)
    variation = _random(flags, design) if flags.random is not None else _grid(flags)
    if variation.size > MOST:
        raise UsageError(f"{variation.size} designs are too many; {MOST} are possible")
    motion = None
    if flags.preset is not None or flags.file is not None:
        motion = motion_of(flags.preset or "paper-like", flags.file, design.geometry)
    return Study(design, variation, region, flags.scale_bars, motion)


def _grid(flags: Sweep) -> DesignGrid:
    return DesignGrid(tuple(map(_axis, flags.vary)))


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


def _random(flags: Sweep, design: Design) -> RandomDesigns:
    ranges = tuple(_range(text, design, flags.spread) for text in flags.vary)
    return RandomDesigns(ranges, flags.random or 0, flags.seed)


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
    if any(value > most for value in values):
        raise UsageError(f"--vary {path}: at most {most:g} is possible")


def _workers(flags: Sweep, study: Study) -> AbstractContextManager[Workers]:
    if flags.dask is not None:
        return cluster(flags.dask)
    small = flags.jobs is None and study.work < WORTH_PROCESSES
    return processes(1 if small else flags.jobs)
