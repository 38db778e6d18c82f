"""``paminsa-viz balance``: the best distribution of masses within bounds, with its proof."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from paminsa_viz.balancing import (
    MOTION_GOALS,
    AddedMass,
    Changes,
    CounterweightRange,
    Imbalance,
    InfeasibleBounds,
    MassChange,
    MassRange,
    Optimum,
    Term,
    balance,
    optimize,
    paper_changes,
)
from paminsa_viz.blocks.balance import optimum_blocks, optimum_data
from paminsa_viz.cli.arguments import OneOf, OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output, check_range
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import (
    print_blocks,
    print_failure,
    print_heading,
    print_json,
    print_written,
    save_changed,
)
from paminsa_viz.model.design import Design
from paminsa_viz.model.parameters import LARGEST, PANTOGRAPH
from paminsa_viz.trajectory import ImpossibleTrajectory, Trajectory, solve_trajectory
from paminsa_viz.units import MM
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Find the masses that balance the robot best, within bounds, and prove that none are better.

  paminsa-viz balance                                    the paper's balance of Appendix 4's robot
  paminsa-viz balance --rail b3 7 0 200 5 --out balanced.toml
  paminsa-viz balance --change joints.j7 0.2 3 --change links.b4 0.5 0.8 --exact
  paminsa-viz balance --goal peak --preset arch --rail b8 8 0 150 4 --max-imbalance 2

Static balance (M_p2 = 0, Eq. 8) takes gravity off M1, M2 and M3 in every pose. Of all masses that
do it, those with the least added mass are taken (--criterion moved: the least mass moved); where
the bounds do not allow it, those that come nearest. The other goals are about a motion, which the
inertia of added masses makes harder: the largest torque or the RMS torque of M1 to M3, or the
energy that all four actuators put in.

What may change, unless --change or --rail is given: the masses in M_p2, each only upward, without
a change of moments of inertia, as by a weight at a bar's middle. With --change a link's moments
of inertia follow its mass. A rail is a place for counterweights on each leg: a bar, the joint at
one of its ends, from where to where beyond that joint (negative: on the bar itself), and the
largest mass.

Exit code: 0 done; 1 the bounds do not allow the goal (the line names what to relax), or the robot
cannot run the motion; 2 a wrong argument or file."""

GOALS = ("static", *MOTION_GOALS)

MassFlag = tuple[str, float, float]
RailFlag = tuple[OneOf[str, PANTOGRAPH], int, float, float, float]


@dataclass(frozen=True, kw_only=True)
class BalanceFlags(JsonFlags, MotionFlags, DesignFlags):
    """Flags of the command."""

    goal: OneOf[str, GOALS] = "static"
    """What to make small. A static balance holds for both branches of the knee and any motion."""
    change: Annotated[tuple[MassFlag, ...], tyro.conf.arg(metavar="PATH LOW HIGH")] = ()
    """A mass that may change, such as links.b3, and its bounds [kg]; can be repeated."""
    rail: Annotated[tuple[RailFlag, ...], tyro.conf.arg(metavar="BAR JOINT FROM TO MOST")] = ()
    """A place for counterweights: bar and joint, range [mm], most mass [kg]; can be repeated."""
    criterion: Literal["added", "moved"] = "added"
    """Of all balanced designs, the one with the least added mass, or the least mass moved."""
    exact: bool = False
    """Nothing but M_p2 = 0 will do."""
    max_imbalance: Annotated[OrNone[float], tyro.conf.arg(metavar="N")] = None
    """Largest |M_p2|, for goals on a motion [N]."""
    max_added: Annotated[OrNone[float], tyro.conf.arg(metavar="KG")] = None
    """Largest added mass of the whole robot, for goals on a motion [kg]."""
    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.toml")] = None
    """Design file to write; one that exists is replaced."""

    def check(self) -> None:
        """Refuse contradictions, and numbers that no machine has and the arithmetic cannot take.

        Raises:
            UsageError: Which flag.
        """
        kilograms = LARGEST["kg"]
        for flag, unit, most, numbers in (
            ("--change", "kg", kilograms, [high for _, _, high in self.change]),
            ("--rail", "mm", MM * LARGEST["m"], [end for rail in self.rail for end in rail[2:4]]),
            ("--rail", "kg", kilograms, [rail[4] for rail in self.rail]),
            ("--max-imbalance", "N", 1e6, [self.max_imbalance or 0.0]),
            ("--max-added", "kg", kilograms, [self.max_added or 0.0]),
        ):
            for number in numbers:
                if not abs(number) <= most:
                    raise UsageError(f"{flag} {number:g}: at most {most:g} {unit} are possible")
        for bar, joint, start, end, _ in self.rail:
            check_range(f"--rail {bar} {joint}", "mm", (start, end))
        if self.max_imbalance is not None and self.max_imbalance < 0:
            raise UsageError(f"--max-imbalance {self.max_imbalance:g}: a size is needed, 0 or more")
        limited = self.max_imbalance is not None or self.max_added is not None
        if self.goal == "static" and limited:
            raise UsageError("--max-imbalance and --max-added belong to a goal on a motion")
        if self.goal == "static" and (self.preset is not None or self.file is not None):
            raise UsageError("--preset and --file belong to a goal on a motion")
        check_needs(self, self.goal == "static", "--goal static", "criterion")
        if self.exact and self.max_imbalance is not None:
            raise UsageError("--exact and --max-imbalance exclude each other")
        check_output("--out", self.out, [".toml"])

    def run(self) -> int:
        """Find the masses."""
        self.check()
        design = self.given_design()
        changes = _changes(self, design)
        motion = None if self.goal == "static" else self.given_motion(design.geometry)
        try:
            if motion is None:
                criterion = AddedMass() if self.criterion == "added" else MassChange()
                found = balance(design, changes, criterion, exact=self.exact)
            else:
                found = _on_motion(self, design, changes, motion)
        except (InfeasibleBounds, ImpossibleTrajectory) as error:
            return print_failure(error, as_json=self.json)
        written = []
        if self.out is not None:
            comment, requirements = f"Balanced by {MADE_BY}.", self.given_requirements()
            written = [save_changed(found.after, self.out, requirements, comment=comment)]
        if self.json:
            print_json(optimum_data(found) | {"files": written})
        else:
            print_heading(design, *([] if motion is None else [f'motion "{motion.name}"']))
            print_blocks(optimum_blocks(found))
            print_written(written)
        return 0


FLAGS = BalanceFlags


def _changes(flags: BalanceFlags, design: Design) -> Changes:
    """Return what may change.

    Raises:
        InvalidInput: If bounds or levers contradict each other.
    """
    if not flags.change and not flags.rail:
        return paper_changes(design)
    rails = [
        CounterweightRange(bar, joint, start / MM, end / MM, most)
        for bar, joint, start, end, most in flags.rail
    ]
    return Changes(tuple(MassRange(*item) for item in flags.change), tuple(rails))


def _on_motion(
    flags: BalanceFlags, design: Design, changes: Changes, motion: Trajectory
) -> Optimum:
    """Return the optimum for a goal on a motion.

    Raises:
        ImpossibleTrajectory: If the robot cannot run it.
        InfeasibleBounds: If the bounds do not allow the limits.
    """
    solved = solve_trajectory(design.geometry, motion, gravity=design.gravity)
    solved.check.require()
    limits: list[tuple[Term, float]] = []
    if flags.exact:
        limits.append((Imbalance(), 0.0))
    elif flags.max_imbalance is not None:
        limits.append((Imbalance(), flags.max_imbalance))
    if flags.max_added is not None:
        limits.append((AddedMass(), flags.max_added))
    return optimize(design, changes, MOTION_GOALS[flags.goal](solved), limits=limits)
