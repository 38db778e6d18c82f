"""``paminsa-viz excite``: a motion that shows the robot's parameters best."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.blocks.excitation import excitation_blocks, excitation_data
from paminsa_viz.cli.arguments import OrNone, UsageError, check_limits
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output
from paminsa_viz.cli.output import (
    print_began,
    print_blocks,
    print_failure,
    print_heading,
    print_json,
    print_written,
)
from paminsa_viz.files.identification_table import excitation_table
from paminsa_viz.files.tables import save_table, table_endings
from paminsa_viz.identification import (
    ExcitationLimits,
    ExcitationSettings,
    NoExcitation,
    optimize_excitation,
)
from paminsa_viz.model.design import Design
from paminsa_viz.model.singular_limit import serial_clearance
from paminsa_viz.trajectory.sampled import sample_times

DESCRIPTION = """\
Find the motion that shows the robot's masses and friction best, to record a log for identify.

  paminsa-viz excite --out motion.csv                     within the drives' limits, or usual ones
  paminsa-viz excite --design robot.toml --seconds 300 --max-torque 8 --out motion.csv

It is a periodic multi-sine of x, y, theta and z that starts and ends at rest, D-optimal for base
parameters, friction and offsets within reach, speed, torque and condition number; see
docs/identification.md. The table is a trajectory like any other: paminsa-viz trajectory --file
motion.csv, or open it on the page.

Exit code: 0 done; 1 no motion keeps the limits; 2 a wrong argument or file."""

DEFAULTS = ExcitationSettings()


@dataclass(frozen=True, kw_only=True)
class Excite(JsonFlags, DesignFlags):
    """Flags of the command."""

    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
    """Table to write, .csv or .npz; one that exists is replaced."""
    period: Annotated[float, tyro.conf.arg(metavar="S")] = DEFAULTS.period
    """Period of the motion [s]."""
    periods: int = DEFAULTS.periods
    """How often it is run."""
    harmonics: int = DEFAULTS.harmonics
    """Number of harmonics of each coordinate, 3 to 20."""
    max_torque: Annotated[OrNone[float], tyro.conf.arg(metavar="NM")] = None
    """Limit of the torque of M1, M2 and M3 [N·m]; by default those of their drives, and 20 without
    drives."""
    max_force: Annotated[OrNone[float], tyro.conf.arg(metavar="N")] = None
    """Limit of the force of M4 [N]; by default that of its drive, and 1000 without one."""
    max_speed: Annotated[OrNone[float], tyro.conf.arg(metavar="RAD/S")] = None
    """Limit of the speed of M1, M2 and M3 [rad/s], not of the platform's as in paminsa-viz
    trajectory; by default those of their drives, and 3 without drives. The printed limits are in
    °/s: 3 rad/s are 172°/s."""
    max_lift_speed: Annotated[OrNone[float], tyro.conf.arg(metavar="M/S")] = None
    """Limit of the speed of M4 [m/s]; by default that of its drive, and 0.25 without one."""
    max_condition: float = 5.0
    """Largest condition number on the way."""
    clearance: Annotated[OrNone[float], tyro.conf.arg(metavar="MM")] = None
    """Least distance to the limits of reach [mm]; by default 10 at Appendix 4's lengths, and in
    proportion to crank plus coupler at others."""
    seconds: Annotated[float, tyro.conf.arg(metavar="S")] = DEFAULTS.seconds
    """Time for the search [s]; at most a quarter of it goes to the random motions that it starts
    with."""
    evaluations: int = DEFAULTS.evaluations
    """Most evaluations of a motion; a search that they end is reproducible by the same command."""
    rate: Annotated[float, tyro.conf.arg(metavar="HZ")] = 250.0
    """Samples a second of the table; more than twice the frequency of its highest harmonic."""
    seed: int = DEFAULTS.seed
    """Seed of the random motions that the search starts with."""

    def run(self) -> int:
        """Search and report."""
        check_output("--out", self.out, table_endings())
        design = self.given_design()
        limits = self._limits(design)
        settings = ExcitationSettings(
            period=self.period, harmonics=self.harmonics, periods=self.periods,
            evaluations=self.evaluations, seconds=self.seconds, seed=self.seed,
        )  # fmt: skip
        self._check_rate(settings)
        if not self.json:
            print_began(f"searching for up to {self.seconds:g} s")
        try:
            found = optimize_excitation(design, limits, settings)
        except NoExcitation as error:
            return print_failure(error, as_json=self.json)
        written = [] if self.out is None else [self.out]
        for path in written:
            save_table(excitation_table(design, found, self.rate), path)
        if self.json:
            print_json(excitation_data(design, found) | {"files": written})
        else:
            print_heading(design)
            print_blocks(excitation_blocks(found))
            print_written(written)
        return 0

    def _check_rate(self, settings: ExcitationSettings) -> None:
        """Refuse a rate of the table before the search.

        Raises:
            InvalidInput: If it makes too many samples.
            UsageError: If the highest harmonic is not seen in samples so far apart.
        """
        sample_times(0.0, settings.period * settings.periods, self.rate)
        needed = 2 * settings.harmonics / settings.period
        if self.rate <= needed:
            raise UsageError(
                f"--rate: more than {needed:.4g} Hz are needed, twice the frequency of the highest "
                f"harmonic, not {self.rate:g}"
            )

    def _limits(self, design: Design) -> ExcitationLimits:
        """Return the limits that are given, and those of the drives for the others.

        Raises:
            UsageError: If one is not above 0.
        """
        own = actuator_limits(design)
        torque, speed = own.rated.copy(), own.speed.copy()
        for values, part, flag in (
            (torque, slice(0, 3), "max_torque"), (torque, slice(3, 4), "max_force"),
            (speed, slice(0, 3), "max_speed"), (speed, slice(3, 4), "max_lift_speed"),
            (np.empty(1), slice(0), "max_condition"),
        ):  # fmt: skip
            check_limits(self, flag)
            limit = getattr(self, flag)
            if limit is not None:
                values[part] = limit
        if self.clearance is None:
            clearance = serial_clearance(design.geometry)
        elif 0 <= self.clearance <= 1e6:
            clearance = self.clearance / 1e3
        else:
            raise UsageError(f"--clearance: 0 to 1e6 mm are possible, not {self.clearance!r}")
        return ExcitationLimits(speed, torque, self.max_condition, clearance)


FLAGS = Excite
