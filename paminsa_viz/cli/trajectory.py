"""``paminsa-viz trajectory``: actuator torques of a motion: numbers, figures, a page."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Literal

import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError, check_limits
from paminsa_viz.cli.flags import NEEDS_FIGURE, ComparedDesignFlags, FilesFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import print_error, print_failure, print_json
from paminsa_viz.cli.trajectory_report import (
    PAGE,
    Results,
    SimulationStopped,
    print_report,
    report,
    write_files,
    write_log,
)
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.published_table import read_published
from paminsa_viz.files.trajectory_table import read_trajectory, read_waypoints
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import Misprint
from paminsa_viz.plots.series import FigureKind
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    ImpossibleTrajectory,
    InfeasibleMotion,
    MotionLimits,
    ShortestStretch,
    SimulationFailed,
    Trajectory,
    analyze,
    shortest_motion,
    shortest_stretch,
    simulate,
    via_points,
)
from paminsa_viz.trajectory.paths import spline_path
from paminsa_viz.trajectory.sampled import RATE
from paminsa_viz.trajectory.time_optimal import CrossingRefused, time_optimal

DESCRIPTION = """\
Required torques, speeds, power and energy of every actuator on a motion.

  paminsa-viz trajectory                                     four coordinates at 1 m/s²
  paminsa-viz trajectory --preset circle --out circle.pdf    torques as a figure
  paminsa-viz trajectory --file motion.csv --out loads.csv   every sample as a table
  paminsa-viz trajectory --preset arch --shortest --max-speed 1 --max-torque 4
  paminsa-viz trajectory --preset line --out line.html       the robot moves, in any browser
  paminsa-viz trajectory --file waypoints.csv --waypoints --cross --max-torque 10
  paminsa-viz trajectory --simulate computed-torque --payload-mismatch 0.5 --out run.png
  paminsa-viz trajectory --file motion.csv --simulate pd --log log.csv    a log for identify

A table has the columns t_s,x_m,y_m,theta_rad,z_m, and may have velocities and accelerations; other
units go into the header (t_ms, x_mm, theta_deg). The ending of --out says what is written:
  .csv .npz         every sample; with --simulate, of the simulated motion
  .png .svg .pdf    a figure for print, see --figure
  .html             the motion with the robot, playable without a server

Columns of a table that is written, in this order:
  time, pose      t_s,x_m,y_m,theta_rad,z_m
  rates           vx_m_s,vy_m_s,omega_rad_s,vz_m_s,ax_m_s2,ay_m_s2,alpha_rad_s2,az_m_s2
  load            Fx_N,Fy_N,Fz_N,Mx_Nm,My_Nm,Mz_Nm          (where --file has one)
  actuators       theta1_rad,theta2_rad,theta3_rad,Z_m, then their speeds
                  theta1_rate_rad_s,theta2_rate_rad_s,theta3_rate_rad_s,Z_rate_m_s
  torques         tau1_Nm,tau2_Nm,tau3_Nm,f4_N: in all, then by cause, tau1_gravity_Nm and so on:
                  gravity, inertial, velocity, friction, load (where there is one)
  power           power1_W,power2_W,power3_W,power4_W
  whether reached status: ok, or why there are no torques
With --simulate time, pose, velocity, wanted_x_m,wanted_y_m,wanted_theta_rad,wanted_z_m, torques in
all, work_J,friction_loss_J,energy_drift_J.

Exit code: 0 the robot can run the motion; 1 it cannot (leaves its workspace, comes too close to a
singular pose, is too weak, or the simulation stopped), with the time and the reason; 2 a wrong
argument or file."""


MOST_BANDWIDTH = 1000.0
"""Highest bandwidth of the controller [Hz]; that of good drives is a tenth of it."""


MOST_LIMIT = 1e9
"""Largest limit of a motion, in the unit of its flag; beyond it none is meant."""


@dataclass(frozen=True, kw_only=True)
class LimitFlags:
    """Limits of the shortest motion."""

    max_speed: Annotated[OrNone[float], tyro.conf.arg(metavar="M/S")] = None
    """Limit of the platform's speed [m/s]. Limits are for --shortest, --stretch and --cross; one
    that is left out is none."""
    max_turn_speed: Annotated[OrNone[float], tyro.conf.arg(metavar="DEG/S")] = None
    """Limit of its turning speed [°/s]."""
    max_acceleration: Annotated[OrNone[float], tyro.conf.arg(metavar="M/S2")] = None
    """Limit of its acceleration [m/s²]."""
    max_turn_acceleration: Annotated[OrNone[float], tyro.conf.arg(metavar="DEG/S2")] = None
    """Limit of its turning acceleration [°/s²]."""
    max_jerk: Annotated[OrNone[float], tyro.conf.arg(metavar="M/S3")] = None
    """Limit of its jerk [m/s³]."""
    max_turn_jerk: Annotated[OrNone[float], tyro.conf.arg(metavar="DEG/S3")] = None
    """Limit of its turning jerk [°/s³]."""
    max_torque: Annotated[OrNone[float], tyro.conf.arg(metavar="NM")] = None
    """Limit of the torque of M1, M2 and M3 [N·m]."""
    max_force: Annotated[OrNone[float], tyro.conf.arg(metavar="N")] = None
    """Limit of the force of M4 [N]."""

    @property
    def given_limits(self) -> dict[str, float]:
        """The limits that are given, in the units of the flags, by the names of the fields."""
        names = [f"max_{field.name}" for field in fields(MotionLimits)]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    @property
    def limits(self) -> MotionLimits:
        """The limits, in SI units.

        Raises:
            UsageError: If one is not above 0.
        """
        check_limits(self, *self.given_limits)
        given = {name.removeprefix("max_"): value for name, value in self.given_limits.items()}
        turns = {name: math.radians(value) for name, value in given.items() if "turn" in name}
        return MotionLimits(**given | turns)


@dataclass(frozen=True, kw_only=True)
class TrajectoryFlags(FilesFlags, LimitFlags, MotionFlags, ComparedDesignFlags):
    """Flags of the command."""

    waypoints: bool = False
    """The rows of --file are a few waypoints: start and end at rest, smoothly through them, at
    their times t_s. Without that column each stretch gets time by the root of its length, in all
    as --duration, --shortest, --stretch or --cross say; --cross takes no times."""
    printed: bool = False
    """Also work it out by the formulas as published, misprints included."""

    duration: Annotated[OrNone[float], tyro.conf.arg(metavar="S")] = None
    """Duration [s], instead of the motion's own."""
    shortest: bool = False
    """Run the motion by the time-optimal law on its path: the shortest time that keeps the limits
    --max-... and those of the design's drives, if it has any. With a limit of the jerk as
    --stretch, since that is not convex."""
    stretch: bool = False
    """Keep the motion's own time law, and stretch it to the shortest time within those limits."""
    cross: bool = False
    """Let the motion through --waypoints pass type-2 singularities: its time law is planned such
    that torques stay bounded there, and within the limits --max-torque and --max-force, and
    --max-speed and --max-turn-speed if given. In the shortest time, or with --duration in that
    time. Friction adds to these torques, and limits of drives are not kept."""
    rate: Annotated[OrNone[float], tyro.conf.arg(metavar="HZ")] = None
    """Samples a second; 1000 for planned motions, and as they are for a table."""

    simulate: OrNone[Literal["computed-torque", "pd", "feed-forward"]] = None
    """Let a controller drive the robot: computed torque, feed-forward with PD, or feed-forward.
    With the last one alone the robot is unstable."""
    payload_mismatch: Annotated[float, tyro.conf.arg(metavar="KG")] = 0.0
    """Payload of the simulated robot that its controller does not know of [kg]."""
    bandwidth: Annotated[float, tyro.conf.arg(metavar="HZ")] = Controller().bandwidth
    """Bandwidth of the controller [Hz]."""
    log: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.csv")] = None
    """Log of the simulated robot to write, positions and torques of its actuators, for paminsa-viz
    identify."""

    figure: OrNone[FigureKind] = None
    """What figures show: torques, or with --simulate the tracking, by default.
    A comparison is with --engine or --published, else --printed, else --reference."""
    engine: OrNone[Literal["mujoco", "pinocchio"]] = None
    """Work the torques out in a physics engine too, for the comparison."""

    published: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.csv")] = None
    """Published or measured torques over time, t_s with tau1_Nm, tau2_Nm, tau3_Nm, f4_N or some of
    them: drawn beside the computed ones, and by how much these are off."""

    def check(self) -> None:
        """Refuse flags that do not belong together, before anything is computed.

        Raises:
            UsageError: Which flag, and what to do.
        """
        limits = self.given_limits
        limit = f"--{next(iter(limits), 'max_speed').replace('_', '-')}"
        crossed = {"max_speed", "max_turn_speed", "max_torque", "max_force"}
        others = (f"--{name.replace('_', '-')}" for name in limits if name not in crossed)
        beyond = next(others, "")
        unplanned = self.file is not None and not self.waypoints
        timed = self.duration is not None
        quick, quickest = (
            self.shortest or self.stretch,
            f"--{'stretch' if self.stretch else 'shortest'}",
        )
        kind, second = (
            self.figure_kind,
            self.engine or self.published or self.printed or self.reference,
        )
        plan = "needs a planned motion: a preset, or --file with --waypoints"
        self.exclude_both()
        for wrong, problem in (
            (self.waypoints and self.file is None, "--waypoints belongs to --file"),
            (self.shortest and self.stretch, "--stretch excludes --shortest"),
            (quick and timed, f"--duration excludes {quickest}"),
            (timed and unplanned, f"--duration {plan}"),
            (quick and unplanned, f"{quickest} {plan}"),
            (
                quick and not limits and self.design is None,
                f"{quickest} needs a limit, such as {limit}, or a design with drives",
            ),
            (limits and not (quick or self.cross), f"{limit} belongs to --shortest or --stretch"),
            (self.cross and not self.waypoints, "--cross needs --file with --waypoints"),
            (self.cross and quick, f"--cross is the shortest motion; leave out {quickest}"),
            (
                self.cross and not limits.keys() & {"max_torque", "max_force"},
                "--cross needs --max-torque or --max-force",
            ),
            (
                self.cross and beyond,
                f"{beyond} belongs to --shortest; --cross takes limits of speed, torque and force",
            ),
            (self.payload_mismatch and not self.simulate, "--payload-mismatch needs --simulate"),
            (
                self.bandwidth != Controller().bandwidth and not self.simulate,
                "--bandwidth needs --simulate",
            ),
            (self.log and not self.simulate, "--log needs --simulate"),
            (kind == "tracking" and not self.simulate, "--figure tracking needs --simulate"),
            (
                kind == "comparison" and not second,
                "--figure comparison needs --engine, --published, --printed or --reference",
            ),
            (self.engine and self.published, "--published excludes --engine"),
            (
                self.published and self.figure not in (None, "torques", "comparison"),
                "--published belongs to --figure torques or comparison",
            ),
            (
                not 0 <= self.bandwidth <= MOST_BANDWIDTH,
                f"--bandwidth: 0 to {MOST_BANDWIDTH:g} Hz are possible, not {self.bandwidth:g}",
            ),
            (
                any(value > MOST_LIMIT for value in limits.values()),
                f"{limit}: at most {MOST_LIMIT:g} is possible",
            ),
            (self.engine and kind != "comparison", "--engine belongs to --figure comparison"),
            (self.figure and not self.draws, f"--figure needs {NEEDS_FIGURE}"),
            (self.engine and not self.draws, f"--engine needs {NEEDS_FIGURE}"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz trajectory --help")
        self.check_files(PAGE)
        check_output("--log", self.log, [".csv"])

    @property
    def figure_kind(self) -> FigureKind:
        """What figures show."""
        if self.figure is not None:
            return self.figure
        if self.engine is not None:
            return "comparison"
        return "torques" if self.simulate is None else "tracking"

    def run(self) -> int:
        """Work the motion out, write the files and report."""
        self.check()
        design = self.given_design()
        reference = self.given_reference(design)
        try:
            results = _worked_out(self, design, reference)
        except (ImpossibleTrajectory, InfeasibleMotion, CrossingRefused) as error:
            return print_failure(error, as_json=self.json)
        for problem in results.problems:
            print_error(problem)
        written = write_files(
            results, self.out, kind=self.figure_kind, engine=self.engine,
            width_mm=self.width, dpi=self.dpi, simulated=self.simulate is not None,
        )  # fmt: skip
        if self.log is not None:
            written += write_log(results, self.log)
        if self.json:
            print_json(report(results, written))
        else:
            print_report(results, written)
        asked = [*self.out, *filter(None, [self.log])]
        return 1 if results.problems or len(written) < len(asked) else 0


FLAGS = TrajectoryFlags


def _worked_out(flags: TrajectoryFlags, design: Design, reference: Design | None) -> Results:
    """Return all that the flags require.

    Raises:
        ImpossibleTrajectory, InfeasibleMotion, CrossingRefused: If there is no motion to work out.
    """
    trajectory, quickest = _motion(flags, design)
    analysis = analyze(design, trajectory)
    published = None if flags.published is None else read_published(flags.published)
    results = Results(
        analysis,
        quickest,
        None if reference is None else analyze(reference, trajectory),
        analyze(design, trajectory, misprints=Misprint.ALL) if flags.printed else None,
        published=published,
    )
    if analysis.failure is not None:
        return replace(results, problems=(ImpossibleTrajectory(analysis.failure),))
    if flags.simulate is None:
        return results
    payload = design.payload.mass + flags.payload_mismatch
    try:
        robot = design.vary({"payload.mass": payload})
    except InvalidDesign as error:
        raise UsageError(
            f"--payload-mismatch {flags.payload_mismatch:g} makes a payload of {payload:g} kg: "
            f"{error.allowed}"
        ) from error
    controller = Controller(
        ControlMode[flags.simulate.replace("-", "_").upper()], bandwidth=flags.bandwidth
    )
    try:
        simulation = simulate(robot, trajectory, model=design, controller=controller)
    except SimulationFailed as error:
        return replace(results, problems=(error,))
    stopped = () if simulation.stopped is None else (SimulationStopped(simulation.stopped),)
    return replace(results, simulation=simulation, problems=stopped)


def _motion(flags: TrajectoryFlags, design: Design) -> tuple[Trajectory, ShortestStretch | None]:
    """Return the motion as samples, and what its duration follows from if it is the shortest."""
    if flags.file is None:
        plan = PRESET[flags.preset or "paper-like"].build(design.geometry)
    else:
        if not flags.waypoints:
            read = read_trajectory(flags.file)
            return (read if flags.rate is None else read.resampled(flags.rate)), None
        poses, times = read_waypoints(flags.file)
        name = flags.file.stem
        if flags.cross:
            path = spline_path(poses, design)
            found = time_optimal(design, path, flags.limits, flags.duration, name=name)
            return found.plan.sample(RATE if flags.rate is None else flags.rate), None
        timed = times is not None or flags.duration is not None
        if not (timed or flags.shortest or flags.stretch):
            raise UsageError(
                f"{flags.file} has no times t_s, so that --waypoints needs --duration, --shortest "
                f"or --stretch"
            )
        plan = via_points(poses, times=times, name=name)
    quickest = None
    if flags.duration is not None:
        plan = plan.lasting(flags.duration)
    elif flags.shortest or flags.stretch:
        shortest = shortest_motion if flags.shortest else shortest_stretch
        quickest = shortest(plan, flags.limits, design)
        plan = quickest.plan
    return plan.sample(RATE if flags.rate is None else flags.rate), quickest
