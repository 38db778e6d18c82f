"""``paminsa-viz trajectory``: actuator torques of a motion: numbers, figures, a page."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

import tyro

from paminsa_viz.cli.arguments import UsageError, parse, print_error
from paminsa_viz.cli.inputs import Assembly, PresetName, design_of
from paminsa_viz.cli.output import print_json
from paminsa_viz.cli.trajectory_files import output_endings, write_files
from paminsa_viz.cli.trajectory_report import Results, SimulationStopped, print_report, report
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.plots.formats import figure_endings
from paminsa_viz.plots.series import FigureKind
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    ImpossibleTrajectory,
    InfeasibleMotion,
    MinimumTime,
    MotionLimits,
    Simulation,
    SimulationFailed,
    Trajectory,
    analyze,
    minimum_time,
    simulate,
    via_points,
)
from paminsa_viz.trajectory.sampled import RATE

DESCRIPTION = """\
Required torques, speeds, power and energy of every actuator on a motion.

  paminsa-viz trajectory                                     four coordinates at 1 m/s²
  paminsa-viz trajectory --preset circle --out circle.pdf    torques as a figure
  paminsa-viz trajectory --file motion.csv --out loads.csv   every sample as a table
  paminsa-viz trajectory --preset arch --shortest --max-speed 1 --max-torque 4
  paminsa-viz trajectory --preset line --out line.html       the robot moves, in any browser
  paminsa-viz trajectory --simulate computed-torque --payload-mismatch 0.5 --out run.png

A table has the columns t_s,x_m,y_m,theta_rad,z_m, and may have velocities and accelerations; other
units go into the header (t_ms, x_mm, theta_deg). The ending of --out says what is written:
  .csv .npz         every sample; with --simulate, of the simulated motion
  .png .svg .pdf    a figure for print, see --figure
  .html             the motion with the robot, playable without a server

Exit code: 0 the robot can run the motion; 1 it cannot (leaves its workspace, comes too close to a
singular pose, is too weak, or the simulation stopped), with the time and the reason; 2 a wrong
argument or file."""


MOST_BANDWIDTH = 1000.0
"""Highest bandwidth of the controller [Hz]; that of good drives is a tenth of it."""


MOST_LIMIT = 1e9
"""Largest limit of a motion, in the unit of its flag; beyond it none is meant."""


@dataclass(frozen=True)
class TrajectoryFlags:
    """TrajectoryFlags of the command."""

    preset: PresetName | None = None
    """A ready-made motion, sized for the robot; paper-like by default.
    None of them is the paper's own."""
    file: Annotated[Path | None, tyro.conf.arg(metavar="FILE.csv")] = None
    """A motion as a table, instead of a preset."""
    waypoints: bool = False
    """The rows of --file are a few waypoints: start and end at rest, smoothly through them."""
    design: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML), instead of the paper's Appendix 4; also for friction and payload."""
    reference: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Another design file, to compare with on the same motion."""
    assembly: Assembly | None = None
    """Branch of the knee 9: as Appendix 1 prints it (lower), or its mirror image; by default the
    design's own."""
    printed: bool = False
    """Also work it out by the formulas as published, misprints included."""

    duration: Annotated[float | None, tyro.conf.arg(metavar="S")] = None
    """Duration [s], instead of the motion's own."""
    shortest: bool = False
    """Run the motion in the shortest time that keeps the limits below."""
    max_speed: Annotated[float | None, tyro.conf.arg(metavar="M/S")] = None
    """Limit of the platform's speed [m/s]."""
    max_turn_speed: Annotated[float | None, tyro.conf.arg(metavar="DEG/S")] = None
    """Limit of its turning speed [°/s]."""
    max_acceleration: Annotated[float | None, tyro.conf.arg(metavar="M/S2")] = None
    """Limit of its acceleration [m/s²]."""
    max_turn_acceleration: Annotated[float | None, tyro.conf.arg(metavar="DEG/S2")] = None
    """Limit of its turning acceleration [°/s²]."""
    max_jerk: Annotated[float | None, tyro.conf.arg(metavar="M/S3")] = None
    """Limit of its jerk [m/s³]."""
    max_turn_jerk: Annotated[float | None, tyro.conf.arg(metavar="DEG/S3")] = None
    """Limit of its turning jerk [°/s³]."""
    max_torque: Annotated[float | None, tyro.conf.arg(metavar="NM")] = None
    """Limit of the torque of M1, M2 and M3 [N m]."""
    max_force: Annotated[float | None, tyro.conf.arg(metavar="N")] = None
    """Limit of the force of M4 [N]."""
    rate: Annotated[float | None, tyro.conf.arg(metavar="HZ")] = None
    """Samples a second; 1000 for planned motions, and as they are for a table."""

    simulate: Literal["computed-torque", "pd", "feed-forward"] | None = None
    """Let a controller drive the robot: computed torque, feed-forward with PD, or feed-forward.
    With the last one alone the robot is unstable."""
    payload_mismatch: Annotated[float, tyro.conf.arg(metavar="KG")] = 0.0
    """Payload of the simulated robot that its controller does not know of [kg]."""
    bandwidth: Annotated[float, tyro.conf.arg(metavar="HZ")] = Controller().bandwidth
    """Bandwidth of the controller [Hz]."""

    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """File to write; may be given several times."""
    figure: FigureKind | None = None
    """What figures show: torques, or with --simulate the tracking, by default.
    A comparison is with --engine, else --printed, else --reference."""
    engine: Literal["mujoco", "pinocchio"] | None = None
    """Work the torques out in a physics engine too, for the comparison."""
    width: Annotated[float, tyro.conf.arg(metavar="MM")] = 170.0
    """Width of figures [mm]; 85 is a column, 170 a page."""
    dpi: float = 300.0
    """Pixels per inch of PNG."""
    json: bool = False
    """Print JSON for other programs, in SI units."""

    def check(self) -> None:
        """Refuse flags that do not belong together, before anything is computed.

        Raises:
            UsageError: Which flag, and what to do.
        """
        limits = [name for name in vars(self) if name.startswith("max_") and self.given(name)]
        limit = f"--{(limits or ['max_speed'])[0].replace('_', '-')}"
        unplanned = self.file is not None and not self.waypoints
        drawn = any(path.suffix.lower() in figure_endings() for path in self.out)
        kind, second = self.figure_kind, self.engine or self.printed or self.reference
        pictures = "needs --out with .png, .svg or .pdf"
        plan = "needs a planned motion: a preset, or --file with --waypoints"
        for wrong, problem in (
            (self.preset and self.file, "--preset and --file exclude each other"),
            (self.waypoints and self.file is None, "--waypoints belongs to --file"),
            (self.shortest and self.given("duration"), "--duration excludes --shortest"),
            (self.given("duration") and unplanned, f"--duration {plan}"),
            (self.shortest and unplanned, f"--shortest {plan}"),
            (self.shortest and not limits, f"--shortest needs a limit, such as {limit}"),
            (limits and not self.shortest, f"{limit} belongs to --shortest"),
            (self.payload_mismatch and not self.simulate, "--payload-mismatch needs --simulate"),
            (kind == "tracking" and not self.simulate, "--figure tracking needs --simulate"),
            (
                kind == "comparison" and not second,
                "--figure comparison needs --engine, --printed or --reference",
            ),
            (
                not 0 <= self.bandwidth <= MOST_BANDWIDTH,
                f"--bandwidth: 0 to {MOST_BANDWIDTH:g} Hz are possible",
            ),
            (
                any(getattr(self, name) > MOST_LIMIT for name in limits),
                f"{limit}: at most {MOST_LIMIT:g} is possible",
            ),
            (self.engine and kind != "comparison", "--engine belongs to --figure comparison"),
            (self.figure and not drawn, f"--figure {pictures}"),
            (self.engine and not drawn, f"--engine {pictures}"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz trajectory --help")
        for path in self.out:
            endings = output_endings()
            if path.suffix.lower() not in endings:
                raise UsageError(f"--out {path}: its ending has to be one of {', '.join(endings)}")

    def given(self, name: str) -> bool:
        """Whether a flag without a default is given."""
        return getattr(self, name) is not None

    @property
    def figure_kind(self) -> FigureKind:
        """What figures show."""
        if self.figure is not None:
            return self.figure
        if self.engine is not None:
            return "comparison"
        return "torques" if self.simulate is None else "tracking"

    @property
    def limits(self) -> MotionLimits:
        """The limits, in SI units."""

        def turn(value: float | None) -> float | None:
            return None if value is None else math.radians(value)

        return MotionLimits(
            speed=self.max_speed,
            turn_speed=turn(self.max_turn_speed),
            acceleration=self.max_acceleration,
            turn_acceleration=turn(self.max_turn_acceleration),
            jerk=self.max_jerk,
            turn_jerk=turn(self.max_turn_jerk),
            torque=self.max_torque,
            force=self.max_force,
        )


def main(words: list[str]) -> int:
    """Run the command."""
    flags = parse(TrajectoryFlags, words, "trajectory", DESCRIPTION)
    flags.check()
    design = design_of(flags.design, flags.assembly)
    reference = None
    if flags.reference is not None:
        reference = design_of(flags.reference).with_knee(design.geometry.knee)
    try:
        results = _worked_out(flags, design, reference)
    except (ImpossibleTrajectory, InfeasibleMotion) as error:
        print_error(error)
        if flags.json:
            print_json({"ok": False, "problems": [str(error)]})
        return 1
    for problem in results.problems:
        print_error(problem)
    written = write_files(
        results, flags.out, kind=flags.figure_kind, engine=flags.engine,
        width_mm=flags.width, dpi=flags.dpi, simulated=flags.simulate is not None,
    )  # fmt: skip
    if flags.json:
        print_json(report(results, written))
    else:
        print_report(results, written)
    return 1 if results.problems else 0


def _worked_out(flags: TrajectoryFlags, design: Design, reference: Design | None) -> Results:
    """Return all that is asked for.

    Raises:
        ImpossibleTrajectory, InfeasibleMotion: If there is no motion to work out.
    """
    trajectory, quickest = _motion(flags, design)
    analysis = analyze(design, trajectory)
    results = Results(analysis, quickest)
    if reference is not None:
        results = replace(results, reference=analyze(reference, trajectory))
    if flags.printed:
        as_printed = analyze(design, trajectory, misprints=Misprint.ALL)
        results = replace(results, printed=as_printed)
    if analysis.check.first is not None:
        return replace(results, problems=(ImpossibleTrajectory(analysis.check.first),))
    if flags.simulate is None:
        return results
    try:
        simulation = _simulated(flags, design, trajectory)
    except SimulationFailed as error:
        return replace(results, problems=(error,))
    results = replace(results, simulation=simulation)
    if simulation.stopped is None:
        return results
    return replace(results, problems=(SimulationStopped(simulation.stopped),))


def _motion(flags: TrajectoryFlags, design: Design) -> tuple[Trajectory, MinimumTime | None]:
    """Return the motion as samples, and what its duration follows from if that was asked."""
    if flags.file is None:
        plan = PRESET[flags.preset or "paper-like"].build(design.geometry)
    else:
        read = read_trajectory(flags.file)
        if not flags.waypoints:
            return (read if flags.rate is None else read.resampled(flags.rate)), None
        way = via_points(read.pose, times=read.t, name=read.name)
        plan = replace(way, notes=read.notes)
    quickest = None
    if flags.duration is not None:
        plan = plan.lasting(flags.duration)
    elif flags.shortest:
        quickest = minimum_time(plan, flags.limits, design)
        plan = quickest.plan
    return plan.sample(RATE if flags.rate is None else flags.rate), quickest


def _simulated(flags: TrajectoryFlags, design: Design, trajectory: Trajectory) -> Simulation:
    payload = design.payload.mass + flags.payload_mismatch
    robot = design.vary({"payload.mass": payload})
    control = _CONTROLS[flags.simulate or "pd"]
    controller = Controller(control, bandwidth=flags.bandwidth)
    return simulate(robot, trajectory, model=design, controller=controller)


_CONTROLS = {
    "computed-torque": ControlMode.COMPUTED_TORQUE,
    "pd": ControlMode.PD,
    "feed-forward": ControlMode.FEED_FORWARD,
}
