"""``paminsa-viz calibrate``: the legs' own lengths from measured poses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output
from paminsa_viz.cli.output import print_json, print_table, print_written
from paminsa_viz.files.design_file import save_design
from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.measurements import measurement_table, read_measurements
from paminsa_viz.files.tables import save_table, table_endings
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.precision.calibration import Calibration, calibrate, describe
from paminsa_viz.precision.calibration_problem import measuring_poses
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from paminsa_viz.precision.measurements import InvalidMeasurement, Measurements, PredictionErrors
from paminsa_viz.precision.unequal_legs import SIX_COORDINATES
from paminsa_viz.units import MM, format_ascii
from paminsa_viz.version import MADE_BY

DESCRIPTION = """\
Identify the lengths of each leg from measured poses, and write the corrected design.

  paminsa-viz calibrate log.csv --validate 0.3            30 % of the poses are held back
  paminsa-viz calibrate log.csv --design robot.toml --out calibrated.toml
  paminsa-viz calibrate --propose 40 --out poses.csv      poses to measure, and their actuators

LOG is a table with x_m,y_m,theta_rad,z_m, if measured tiltx_rad,tilty_rad, and the readings
theta1_rad,theta2_rad,theta3_rad,Z_m; other units as x_mm, theta_deg. Poses are those of the
platform's center in the robot's base frame. Combinations of lengths that the poses show are fitted,
the rest keeps its value; see docs/calibration.md. The design file gets them as tables [leg1],
[leg2], [leg3].

Exit code: 0 done; 1 held-back poses are not predicted better than before; 2 a wrong argument or
file."""

MOST_COMBINATIONS = 10


@dataclass(frozen=True, kw_only=True)
class Calibrate(JsonFlags, DesignFlags):
    """Flags of the command."""

    log: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="LOG")] = None
    """Table of measured poses and readings, .csv."""
    propose: Annotated[int | None, tyro.conf.arg(metavar="POSES")] = None
    """Instead of calibrating, choose poses to measure, and write them with --out, .csv or .npz."""
    validate: Annotated[float, tyro.conf.arg(metavar="SHARE")] = 0.0
    """Share of the poses that are held back, drawn at random, to check the result with; 0 to
    0.9."""
    seed: int = 0
    """Seed of that draw."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file to write, .toml, or the table of --propose; one that exists is replaced. The
    design is not written where held-back poses are not predicted better than before."""
    all: bool = False
    """Print every combination of lengths, not only the best and worst known ones."""

    def run(self) -> int:
        """Calibrate and report, or propose poses."""
        if (self.log is None) == (self.propose is None):
            raise UsageError("either LOG or --propose is needed; see paminsa-viz calibrate --help")
        if self.propose is not None:
            return self._propose(self.propose)
        check_output("--out", self.out, [".toml"])
        if not 0 <= self.validate <= 0.9:
            raise UsageError(f"--validate {self.validate:g}: a share from 0 to 0.9 is needed")
        if self.seed < 0:
            raise UsageError(f"--seed {self.seed}: a whole number of at least 0 is needed")
        design = self.given_design()
        assert self.log is not None
        table = read_measurements(self.log)
        try:
            found = calibrate(design, table.measurements, validate=self.validate, seed=self.seed)
        except InvalidMeasurement as error:
            row = table.first_row + error.index
            raise TableFileError(str(self.log), error.problem, row=row) from error
        if self.json:
            print_json(_data(found, str(self.log)))
        else:
            self._print(found)
        if self.out is not None and found.improved:
            comment = f"Calibrated by {MADE_BY} with {self.log.name}."
            path = save_design(found.design, self.out, comment=comment)
            if not self.json:
                print_written([path])
        return 0 if found.improved else 1

    def _propose(self, poses: int) -> int:
        check_output("--out", self.out, table_endings())
        if self.out is None:
            raise UsageError("--propose writes a table: --out FILE.csv is needed")
        design = self.given_design()
        chosen = measuring_poses(design, poses, seed=self.seed)
        actuators = inverse_kinematics(design.geometry, chosen).actuators
        table = measurement_table(
            Measurements(actuators, chosen), design=design.name, seed=str(self.seed)
        )
        save_table(table, self.out)
        if self.json:
            print_json({"poses": chosen.tolist(), "actuators": actuators.tolist()})
        else:
            print_written([self.out])
        return 0

    def _print(self, found: Calibration) -> None:
        width = len(found.after.rms)
        fitted, held = found.after.poses, found.after_held.poses
        back = f", {held} held back" if held else ""
        print(f'design "{found.start.name}": {fitted} poses of {width} coordinates fitted{back}\n')
        print_table(_error_rows(found), words=1)
        count, rank = len(found.combinations), found.rank
        values = found.singular_values
        after = f", then {values[rank]:.2g}" if rank < len(values) else ""
        print(
            f"\n{rank} of 42 combinations show with equal legs: singular values {values[0]:.2g} to "
            f"{values[rank - 1]:.2g}{after}\n{count} are known to 1 mm and fitted, "
            f"{42 - count} keep their value; noise {format_ascii(found.noise, 'm:um', 3)}\n"
        )
        chosen = list(enumerate(found.combinations, 1))
        if not self.all and count > MOST_COMBINATIONS:
            half = MOST_COMBINATIONS // 2
            chosen = chosen[:half] + chosen[-half:]
        head = ("", "combination", "value [mm]", "95 % [mm]")
        print_table([head, *(
            (str(number), describe(item), f"{item.value * MM:.4f}", f"+-{item.half_width * MM:.4f}")
            for number, item in chosen
        )])  # fmt: skip
        print("\ndeviations" + ("" if found.determined.all() else ", of which only sums are known"))
        print_table(_deviation_rows(found))


FLAGS = Calibrate


def _error_rows(found: Calibration) -> list[tuple[str, ...]]:
    sets = [("fitted", found.before, found.after)]
    if found.after_held.poses:
        sets.append(("held back", found.before_held, found.after_held))
    rows = [
        ("", *(f"{name}: {kind}" for name, *_ in sets for kind in ("RMS before", "RMS", "largest")))
    ]
    for place in range(len(found.after.rms)):
        unit = "m:um" if SIX_COORDINATES[place] in "xyz" else "rad:arcsec"
        cells = [
            format_ascii(float(values[place]), unit, 4)
            for _, before, after in sets
            for values in (before.rms, after.rms, after.largest)
        ]
        rows.append((SIX_COORDINATES[place], *cells))
    return rows


def _deviation_rows(found: Calibration) -> list[tuple[str, ...]]:
    values = deviation_array(found.design)
    rows = [("", "leg 1", "leg 2", "leg 3", "")]
    rows += [
        (
            length.symbol,
            *(f"{format_ascii(float(values[leg, place]), length.unit, 4)}" for leg in range(3)),
            length.label,
        )
        for place, length in enumerate(LENGTHS)
    ]
    return rows


def _data(found: Calibration, source: str) -> dict[str, Any]:
    names = [f"{leg}.{length.name}_{length.unit}" for leg in LEG_NAMES for length in LENGTHS]

    def errors(values: PredictionErrors) -> dict[str, Any]:
        keys = [f"{name}_{'m' if name in 'xyz' else 'rad'}" for name in SIX_COORDINATES]
        return {
            "poses": values.poses,
            "rms": dict(zip(keys, values.rms.tolist(), strict=False)),
            "largest": dict(zip(keys, values.largest.tolist(), strict=False)),
        }

    deviations = deviation_array(found.design).ravel()
    return {
        "design": found.start.name,
        "log": source,
        "improved": found.improved,
        "rank": found.rank,
        "singular_values": found.singular_values.tolist(),
        "noise_m": found.noise,
        "fitted": {"before": errors(found.before), "after": errors(found.after)},
        "held_back": {"before": errors(found.before_held), "after": errors(found.after_held)},
        "combinations": [
            {
                "leading": describe(item),
                "singular_value": item.singular_value,
                "value_m": item.value,
                "half_width_m": item.half_width,
                "weights": {
                    name: float(weight)
                    for name, weight in zip(names, item.weights.ravel(), strict=True)
                    if np.abs(weight) > 1e-6
                },
            }
            for item in found.combinations
        ],
        "deviations": dict(zip(names, deviations.tolist(), strict=True)),
    }
