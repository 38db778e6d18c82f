"""``paminsa-viz drives``: motors, gears, screws and belts for a motion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from paminsa_viz.actuation.catalog import Catalog, generic_catalog, load_catalog
from paminsa_viz.actuation.drive_table import drive_table
from paminsa_viz.actuation.duty import ActuatorLoad, Duty, DutyCycle, duty_cycle
from paminsa_viz.actuation.ratios import ratio_intervals
from paminsa_viz.actuation.selection import DriveFigures, Selection, select_drives, size_design
from paminsa_viz.actuation.sizing import Order
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, MotionFlags, check_output
from paminsa_viz.cli.output import print_error, print_json, print_table, print_written
from paminsa_viz.files.design_file import save_design
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.trajectory import PRESET, ImpossibleTrajectory, Trajectory
from paminsa_viz.units import format_ascii
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Find motors and gears for M1 to M3, and motors, gears and screws or belts for M4.

  paminsa-viz drives                                        generic sizes, for the default motion
  paminsa-viz drives --preset arch --dwell 0.5 --catalog my.csv --order margin
  paminsa-viz drives --cycle arch 10 0.2 --cycle home.csv 1 30
  paminsa-viz drives --ratios                               the gear ratios each motor can have
  paminsa-viz drives --same --save driven.toml              the design with the first of each list

A drive is feasible if it keeps RMS torque, torque-speed envelope, top and mean speed, the winding's
temperature and the gear's torques; see docs/drives.md. The catalog that comes with the program
holds generic sizes and no products; --catalog reads a CSV file of your own.

Exit code: 0 every actuator has a feasible drive; 1 one has none, with what would make it feasible,
or the robot cannot run a motion; 2 a wrong argument or file."""

PERCENT = 100.0


@dataclass(frozen=True, kw_only=True)
class Drives(JsonFlags, MotionFlags, DesignFlags):
    """Flags of the command."""

    cycle: Annotated[
        tuple[tuple[str, float, float], ...], tyro.conf.arg(metavar="MOTION COUNT DWELL")
    ] = ()
    """A motion of the duty cycle, a preset or a table, how often it is made, and how long the robot
    waits after each [s]; may be given several times."""
    dwell: Annotated[float, tyro.conf.arg(metavar="S")] = 0.0
    """How long the robot waits after the one motion of --preset or --file [s]."""
    catalog: Annotated[Path | None, tyro.conf.arg(metavar="FILE.csv")] = None
    """Catalog of motors, gears, screws and belts; generic sizes if left out."""
    order: Order = "mass"
    """What comes first: the lightest, the cheapest, or the one with most margin."""
    inertia_ratio: Annotated[float | None, tyro.conf.arg(metavar="RATIO")] = None
    """Largest inertia of the robot over that of the motor, at the motor's shaft; any if left
    out."""
    same: bool = False
    """M1, M2 and M3 have the same drive."""
    rows: int = 5
    """How many drives to list for each actuator."""
    ratios: bool = False
    """List the feasible gear ratios of every motor instead, for a gear without inertia and losses;
    for M4 with each screw and belt, whose inertia is left out too."""
    save: Annotated[Path | None, tyro.conf.arg(metavar="FILE.toml")] = None
    """Write the design with the first drive of each list."""

    def run(self) -> int:
        """Find the drives and report."""
        self._check()
        design = self.given_design()
        catalog = generic_catalog() if self.catalog is None else load_catalog(self.catalog)
        try:
            cycle = duty_cycle(design, self._duties(design.geometry))
        except ImpossibleTrajectory as error:
            print_error(error)
            return 1
        if self.ratios:
            return self._print_ratios(cycle, catalog)
        most = np.inf if self.inertia_ratio is None else self.inertia_ratio
        found = select_drives(cycle, catalog, order=self.order, inertia_ratio=most, same=self.same)
        advice = [found.advice(j) for j in range(4)]
        if self.json:
            print_json(self._data(design, catalog, found, advice))
        else:
            self._print(design, catalog, found, advice)
        if self.save is not None and found.feasible:
            comment = f"Drives by {MADE_BY} from {catalog.name}."
            path = save_design(found.design(design), self.save, comment=comment)
            if not self.json:
                print_written([path])
        return 0 if found.feasible else 1

    def _check(self) -> None:
        check_output("--save", self.save, [".toml"])
        one = self.preset is not None or self.file is not None or self.dwell != 0
        for wrong, problem in (
            (self.cycle and one, "--cycle excludes --preset, --file and --dwell"),
            (not 1 <= self.rows <= 1000, "--rows: 1 to 1000 are possible"),
            (self.ratios and self.save is not None, "--save excludes --ratios"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz drives --help")

    def _duties(self, geometry: Geometry) -> list[Duty]:
        if not self.cycle:
            return [Duty(self.given_motion(geometry), 1.0, self.dwell)]
        return [Duty(_motion(name, geometry), count, dwell) for name, count, dwell in self.cycle]

    def _print(self, design: Design, catalog: Catalog, found: Selection, advice: list[str]) -> None:
        motions = ", ".join(
            f"{duty.trajectory.name} ({duty.trajectory.duration:.3g} s, {duty.repeats:g} times, "
            f"dwell {duty.dwell:g} s)"
            for duty in found.cycle.duties
        )
        print(f'design "{design.name}", catalog {catalog.name}: {motions}\n')
        rows: list[tuple[str, ...]] = [_LOAD_HEAD]
        rows += [_load_row(load) for load in found.cycle.loads]
        print_table(rows, words=1)
        own = size_design(found.cycle, design)
        if any(own):
            print("\nthe design's own drives")
            listed = [(f"M{j + 1}", one) for j, one in enumerate(own) if one is not None]
            print_table([_HEAD, *(_row(name, one) for name, one in listed)])
        for j, sizing in enumerate(found.sizings):
            if self.same and j in (1, 2):
                continue
            name = "M1 to M3" if self.same and j == 0 else f"M{j + 1}"
            print(f"\n{name}: {len(found.rows[j])} of {len(sizing.table)} drives are feasible")
            if advice[j]:
                print(advice[j])
                continue
            listed = found.figures(j, self.rows)
            print_table([_HEAD, *(_row(f"{i}", one) for i, one in enumerate(listed, 1))])

    def _data(
        self, design: Design, catalog: Catalog, found: Selection, advice: list[str]
    ) -> dict[str, Any]:
        return {
            "design": design.name,
            "catalog": catalog.name,
            "motions": [
                {
                    "name": duty.trajectory.name, "duration_s": duty.trajectory.duration,
                    "repeats": duty.repeats, "dwell_s": duty.dwell,
                }
                for duty in found.cycle.duties
            ],
            "order": self.order,
            "feasible": found.feasible,
            "actuators": [
                {
                    "name": load.name,
                    "peak": load.peak, "rms": load.rms, "top_speed": load.top_speed,
                    "top_power_W": load.top_power, "inertia": load.inertia,
                    "pairs": len(found.sizings[j].table),
                    "feasible": len(found.rows[j]),
                    "advice": advice[j],
                    "drives": [_facts(one) for one in found.figures(j, self.rows)],
                }
                for j, load in enumerate(found.cycle.loads)
            ],
            "own": [one and _facts(one) for one in size_design(found.cycle, design)],
        }  # fmt: skip

    def _print_ratios(self, cycle: DutyCycle, catalog: Catalog) -> int:
        catalog.pairs(3)  # says what the catalog lacks
        screws = catalog.transmissions
        data: list[dict[str, Any]] = []
        for j, load in enumerate(cycle.loads):
            bare = catalog.motors if j < 3 else catalog.motors * len(screws)
            leads = [1.0] * len(bare)
            names = [motor.name for motor in bare]
            table = drive_table(bare)
            if j == 3:
                each = [screw for screw in screws for _ in catalog.motors]
                leads = [2 * np.pi / screw.lead for screw in each if screw.lead is not None]
                names = [f"{a}, {b.name}" for a, b in zip(names, each, strict=True)]
                table.efficiency[:] = [screw.lead_efficiency for screw in each]
                table.holds[:] |= [screw.holds for screw in each]
            most = np.inf if self.inertia_ratio is None else self.inertia_ratio
            found = ratio_intervals(load, table, inertia_ratio=most)
            data += [
                {
                    "actuator": load.name, "motor": names[i],
                    "low": found.low[i] / leads[i] if found.feasible[i] else None,
                    "high": found.high[i] / leads[i] if found.feasible[i] else None,
                    "scanned": bool(found.scanned[i]), "gaps": bool(found.gaps[i]),
                }
                for i in range(len(bare))
            ]  # fmt: skip
        if self.json:
            print_json({"ratios": data})
        else:
            rows = [("", "motor", "gear ratio", "")]
            rows += [
                (
                    row["actuator"], row["motor"],
                    "none" if row["low"] is None else f"{row['low']:.4g} to {row['high']:.4g}",
                    "by scan, with gaps" if row["gaps"] else "by scan" if row["scanned"] else "",
                )
                for row in data
            ]  # fmt: skip
            print_table(rows)
        fits = {row["actuator"] for row in data if row["low"] is not None}
        return 0 if len(fits) == 4 else 1


FLAGS = Drives


def _motion(name: str, geometry: Geometry) -> Trajectory:
    if name in PRESET:
        return PRESET[name].build(geometry).sample()
    if not name.lower().endswith((".csv", ".npz")):
        raise UsageError(f"--cycle {name}: a table, or one of {', '.join(PRESET)}, is needed")
    return read_trajectory(Path(name))


_LOAD_HEAD = ("load", "peak", "RMS", "top speed", "peak power", "inertia")


def _load_row(load: ActuatorLoad) -> tuple[str, ...]:
    linear = load.name == "M4"
    force, speed, inertia = ("N", "m/s", "kg") if linear else ("N m", "rad/s", "kg m^2")
    return (
        load.name,
        format_ascii(load.peak, force, 3),
        format_ascii(load.rms, force, 3),
        f"{load.top_speed:.3g} {speed}",
        format_ascii(load.top_power, "W", 3),
        format_ascii(load.inertia, inertia, 3),
    )


_HEAD = (
    "", "drive", "ratio", "margin", "by", "RMS [N m]", "peak [N m]", "rpm", "W", "inertia ratio",
    "winding", "kg", "cost",
)  # fmt: skip


def _row(name: str, one: DriveFigures) -> tuple[str, ...]:
    drive = one.drive
    return (
        name,
        drive.name,
        f"{drive.gear_ratio:g}",
        f"{PERCENT * (1 - one.use):.0f} %",
        one.limit,
        f"{one.rms:.3g}",
        f"{one.peak:.3g}",
        f"{one.top_speed * 30 / np.pi:.0f}",
        f"{one.top_power:.3g}",
        f"{one.inertia_ratio:.3g}",
        "-" if np.isnan(one.thermal) else f"{PERCENT * one.thermal:.0f} %",
        "-" if drive.mass is None else f"{drive.mass:g}",
        "-" if drive.cost is None else f"{drive.cost:g}",
    )


def _facts(one: DriveFigures) -> dict[str, Any]:
    drive = one.drive
    return {
        "name": drive.name, "gear_ratio": drive.gear_ratio, "lead_m": drive.lead,
        "feasible": one.feasible, "margin": 1 - one.use, "limit": one.limit,
        "rms_Nm": one.rms, "peak_Nm": one.peak, "top_speed_rad_s": one.top_speed,
        "top_power_W": one.top_power, "envelope": one.envelope,
        "inertia_ratio": one.inertia_ratio, "thermal": one.thermal,
        "mass_kg": drive.mass, "cost": drive.cost, "feasible_gear_ratios": list(one.ratios),
    }  # fmt: skip
