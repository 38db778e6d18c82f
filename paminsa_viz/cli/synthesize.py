"""``paminsa-viz synthesize``: the robot that meets requirements and minimizes an objective."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.answer_checks import AnswerChecks, answer_blocks, checks_data
from paminsa_viz.blocks.synthesis import (
    bound_text,
    front_blocks,
    front_data,
    synthesis_blocks,
    synthesis_data,
)
from paminsa_viz.cli.arguments import OneOf, OrNone, UsageError, Words, check_needs, command_line
from paminsa_viz.cli.flags import JsonFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import (
    print_blocks,
    print_json,
    print_written,
    status_line,
    write_report,
)
from paminsa_viz.engines import EngineMissing
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_file import save_design
from paminsa_viz.interrupts import on_interrupt
from paminsa_viz.model.design import Design
from paminsa_viz.model.reach import home_pose
from paminsa_viz.progress import Progress
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.studies import Workers, cluster, processes
from paminsa_viz.synthesis import (
    RegimeState,
    SynthesisCase,
    SynthesisResult,
    find_objective,
    synthesize,
)
from paminsa_viz.synthesis.answer.checks import AnswerMargins, build_yield
from paminsa_viz.synthesis.answer.engine_check import MujocoCheck, check_by_mujoco
from paminsa_viz.synthesis.answer.prices import requirement_prices
from paminsa_viz.synthesis.search.case_conflict import case_conflict
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case
from paminsa_viz.synthesis.search.checkpoint import Checkpoint
from paminsa_viz.synthesis.search.front import design_front
from paminsa_viz.synthesis.search.objectives import OBJECTIVES
from paminsa_viz.units import counted, format_ascii
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Find the lengths of the robot that meets requirements over a workspace and minimizes an objective.

  paminsa-viz synthesize cylinder                       a worked case that comes with the program
  paminsa-viz synthesize mine.toml --seed 1 --out best.toml
  paminsa-viz synthesize mine.toml --workers 4 --checkpoint mine.json
  paminsa-viz synthesize cell --objective moving_mass --prove 30
  paminsa-viz synthesize arch --prices --built 400 --mujoco
  paminsa-viz synthesize cylinder --front footprint --front moving_mass --points 6

A case is a design file, for the reference, with [workspace], [[requirements]] and a table
[synthesis] that says what is searched and what is to be least; see docs/synthesis.md. R_pl < R_b
and R_pl > R_b are searched one after the other; what closed forms exclude is refused at once.
No two bodies of the robot may overlap as they are drawn, unless --allow-overlap says so.
The answer is verified on poses four times as close as those of the search. The same seed gives the
same answer, with any number of workers.

With --checkpoint the search is written down as it goes, and the same command resumes it.

Exit code: 0 a robot that meets all requirements; 1 none was found, with the reason and the nearest
requirements that can be met; 2 a wrong argument or file; 130 stopped with Ctrl-C."""

PERCENT = 100.0


@dataclass(frozen=True, kw_only=True)
class AnswerFlags:
    """What to say besides the answer."""

    prices: bool = False
    """What each active requirement costs: the search again near the answer, with it moved."""
    built: Annotated[OrNone[int], tyro.conf.arg(metavar="N")] = None
    """Build so many robots within tolerances: the part of them that meets all requirements."""
    mass_tolerance: Annotated[float, tyro.conf.arg(metavar="%")] = 2.0
    """Tolerance of each mass to either side [%]; those of lengths are the design's."""
    mujoco: bool = False
    """Check torques and forces in MuJoCo."""
    conflict: bool = False
    """Where no robot meets the requirements, look for the fewest that contradict."""
    front: Annotated[Words, tyro.conf.arg(metavar="OBJECTIVE")] = ()
    """An objective of a front: robots of which none is better than another in all of them, instead
    of one; repeated at least once. --out FILE.toml writes them to FILE-1.toml, FILE-2.toml ..."""
    points: int = 8
    """Points of the front."""

    def check_flags(self) -> None:
        """Refuse what cannot be.

        Raises:
            UsageError: If two flags exclude each other, or a number is not possible.
        """
        check_needs(self, self.built is not None, "--built", "mass_tolerance")
        check_needs(self, self.front, "--front", "points")
        if self.built is not None and self.built < 1:
            raise UsageError(f"--built {self.built}: at least one robot is needed")
        if not 0 <= self.mass_tolerance < PERCENT:
            problem = f"at least 0 % and below 100 % is needed, not {self.mass_tolerance:g}"
            raise UsageError(f"--mass-tolerance: {problem}")
        if self.front and len(set(self.front)) < max(2, len(self.front)):
            problem = "at least two different objectives are needed, each once"
            raise UsageError(f"--front: {problem}, not {', '.join(self.front)}")
        if self.front and (self.prices or self.built or self.mujoco or self.conflict):
            raise UsageError("--front excludes --prices, --built, --mujoco and --conflict")

    def checks(self, result: SynthesisResult, workers: Workers) -> AnswerChecks:
        """Return what the flags ask for."""
        ok = result.feasible
        return AnswerChecks(
            requirement_prices(result, workers=workers) if ok and self.prices else None,
            build_yield(
                result.design, AnswerMargins.of(result), samples=self.built, workers=workers,
                seed=result.case.seed, mass_tolerance=self.mass_tolerance / PERCENT,
            )
            if ok and self.built
            else None,
            _mujoco(result) if ok and self.mujoco else None,
            case_conflict(result.case, workers=workers) if self.conflict and not ok else None,
        )  # fmt: skip


def _mujoco(result: SynthesisResult) -> MujocoCheck | str:
    """Return what MuJoCo says, or why it has no such robot."""
    try:
        return check_by_mujoco(result.design, AnswerMargins.of(result))
    except (EngineMissing, InvalidDesign) as error:
        return str(error)


def _numbered(path: Path, number: int) -> Path:
    """Return the file of a point of a front."""
    return path.with_name(f"{path.stem}-{number}{path.suffix}")


@dataclass(frozen=True, kw_only=True)
class Synthesize(AnswerFlags, JsonFlags):
    """Flags of the command."""

    case: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="CASE.toml")]
    """Case file, or a worked case: cylinder, cell, arch."""
    objective: OrNone[OneOf[str, tuple(OBJECTIVES)]] = None
    """What is minimized, instead of the file's; torques of motions and energy need motions."""
    seed: OrNone[int] = None
    """Seed of the search, instead of the file's."""
    allow_overlap: bool = False
    """Let bodies of the robot overlap as they are drawn; the answer is marked with it."""
    generations: OrNone[int] = None
    """Most generations for each of R_pl < R_b and R_pl > R_b, instead of the file's."""
    workers: int = 1
    """Number of processes."""
    dask: Annotated[OrNone[str], tyro.conf.arg(metavar="ADDRESS")] = None
    """Work on the Dask cluster with this scheduler, such as tcp://10.0.0.1:8786."""
    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.toml")] = None
    """Design file to write, of the robot with its requirements; one that exists is replaced."""
    report: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.html")] = None
    """Design report to write on the robot, with the search; see paminsa-viz report."""
    checkpoint: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.json")] = None
    """File that keeps where the search is; one that exists is resumed."""
    prove: Annotated[OrNone[float], tyro.conf.arg(metavar="S")] = None
    """Try to prove the answer over the whole workspace, for at most this time [s]."""

    def run(self) -> int:
        """Search and report."""
        check_output("--out", self.out, [".toml"])
        check_output("--report", self.report, [".html", ".htm"])
        check_output("--checkpoint", self.checkpoint, [".json"])
        if self.dask is not None and self.workers != 1:
            raise UsageError("--dask and --workers exclude each other")
        if self.prove is not None and not 0 < self.prove < 1e6:
            raise UsageError(f"--prove {self.prove:g}: a positive number of seconds is needed")
        self.check_flags()
        case = self._case()
        if self.front:
            return self._front(case)
        started = time.monotonic()
        kept = "" if self.checkpoint is None else "; the same command resumes it"
        with (
            nullcontext() if self.checkpoint is None else Checkpoint(self.checkpoint, case) as at,
            on_interrupt(lambda: f"stopped{kept}"),
            _progress_line(case) as show,
            self._executor() as workers,
        ):
            result = synthesize(
                case, workers=workers, progress=show, states=() if at is None else at.states,
                prove=self.prove, checkpoint=None if at is None else at.save,
            )  # fmt: skip
            seconds = time.monotonic() - started
            checks = self.checks(result, workers)
        written = [_save(result, self.out)] if self.out is not None and result.feasible else []
        if not self.json:
            print(f"{case.name}: {seconds:.1f} s, seed {case.seed}")
            print_blocks([*synthesis_blocks(result, bound_text), *answer_blocks(result, checks)])
            print_written(written)
        if self.report is not None and result.feasible:
            written.append(self._report(result, self.report))
        if self.json:
            data = synthesis_data(result, seconds) | checks_data(result, checks)
            print_json(data | {"files": written})
        return 0 if result.feasible else 1

    def _report(self, result: SynthesisResult, path: Path) -> Path:
        design = _named(result)
        request = ReportRequest(
            design=design, pose=home_pose(design.geometry),
            trajectory=MotionFlags().given_motion(design.geometry), made=datetime.now(UTC),
            command=command_line.get(), requirements=_requirements(result), synthesis=result,
        )  # fmt: skip
        write_report(request, path)
        if not self.json:
            print_written([path])
        return path

    def _front(self, case: SynthesisCase) -> int:
        """Search a front and report."""
        for name in ("checkpoint", "report", "prove"):
            if getattr(self, name) is not None:
                raise UsageError(f"--front excludes --{name}")
        started = time.monotonic()
        with _progress_line(case) as show, self._executor() as workers:
            front = design_front(
                case, self.front, points=self.points, workers=workers,
                progress=show,
            )  # fmt: skip
        seconds = time.monotonic() - started
        written = []
        if self.out is not None:
            for number, point in enumerate(front.points, 1):
                written.append(_save(point.result, _numbered(self.out, number)))
        if self.json:
            print_json(front_data(case, front, seconds) | {"files": written})
        else:
            print(f"{case.name}: {seconds:.1f} s, seed {case.seed}")
            print_blocks(front_blocks(case, front))
            print_written(written)
        return 0 if front.points else 1

    def _case(self) -> SynthesisCase:
        known = self.case in EXAMPLES and not Path(self.case).exists()
        case = load_case(
            EXAMPLES[self.case] if known else self.case, allow_overlap=self.allow_overlap
        )
        if self.objective is not None:
            case = replace(case, objective=self.objective)
        if self.seed is not None:
            case = replace(case, seed=self.seed)
        if self.generations is not None:
            case = replace(case, effort=replace(case.effort, generations=self.generations))
        return case

    def _executor(self) -> AbstractContextManager[Workers]:
        return processes(self.workers) if self.dask is None else cluster(self.dask)


FLAGS = Synthesize


def _save(result: SynthesisResult, path: Path) -> Path:
    return save_design(
        _named(result), path, requirements=_requirements(result),
        comment=f"Made by {MADE_BY}: {command_line.get()}",
    )  # fmt: skip


def _requirements(result: SynthesisResult) -> Requirements:
    return replace(result.case.requirements, workspace=result.workspace)


def _named(result: SynthesisResult) -> Design:
    return replace(result.design, name=result.case.title)


@contextmanager
def _progress_line(case: SynthesisCase) -> Iterator[Progress]:
    """Show the best so far while the work goes on."""
    objective = find_objective(case.objective)
    with status_line("searching") as update:

        def show(done: float, /, *, state: RegimeState, **_: Any) -> None:
            best = "no robot yet"
            if state.feasible:
                best = format_ascii(objective.sign * state.cost, objective.unit)
            update(
                f"{state.regime.value}: generation {state.generation}, "
                f"{counted(state.trials, 'robot')}, {objective.label} {best}"
            )

        yield show
