"""``paminsa-viz identify``: from a log of the built robot to its parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from paminsa_viz.blocks.identification import identification_blocks, identification_data
from paminsa_viz.cli.arguments import OrNone, UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, pose_si
from paminsa_viz.cli.output import (
    print_blocks,
    print_heading,
    print_json,
    print_written,
    save_changed,
    status_line,
)
from paminsa_viz.files.atomic import make_folder, write_bytes
from paminsa_viz.files.example_logs import given_log
from paminsa_viz.files.identification_table import estimate_table, residual_table
from paminsa_viz.files.tables import save_table
from paminsa_viz.identification.columns import IdentificationSettings
from paminsa_viz.identification.findings import Findings, investigate
from paminsa_viz.identification.log import Log
from paminsa_viz.model.arrays import Pose

DESCRIPTION = """\
Find masses, balance and friction of the built robot from a log of positions and torques.

  paminsa-viz identify log.csv --design robot.toml
  paminsa-viz identify log.csv --validate other.csv --payload loaded.csv 2 --out found
  paminsa-viz identify example --validate example-other --payload example-payload 2

The log is a table with t_s, theta1_rad .. theta3_rad (or _deg), Z_m (or _mm), torque1_Nm ..
torque3_Nm and force4_N, or current1_A .. current4_A with --gains. Torques are what the actuators
deliver, friction included. Columns are in any order, between commas, semicolons or tabs, with a
decimal comma only between the latter two. A motion that shows all parameters comes from paminsa-viz
excite; see docs/identification.md.

Numbers come with 95 % intervals; what the log does not tell is called unknown.

Exit code: 0 masses and friction explain the log; 1 they do not, with what may be wrong; 2 a wrong
argument or file."""

DEFAULTS = IdentificationSettings()

FILES = ("parameters.csv", "residuals.csv", "identified.toml", "torques.svg")
"""What ``--out`` writes."""


@dataclass(frozen=True, kw_only=True)
class Identify(JsonFlags, DesignFlags):
    """Flags of the command."""

    log: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="LOG")]
    """Log to identify, a CSV file, or one that comes with the program: example, example-other,
    example-payload."""
    validate: Annotated[OrNone[str], tyro.conf.arg(metavar="LOG")] = None
    """Second log, on another motion, that the numbers of the first have to predict."""
    payload: Annotated[OrNone[tuple[str, float]], tyro.conf.arg(metavar="LOG KG")] = None
    """Third log, with a payload on the platform, and its mass [kg]; 0 if it was not weighed."""
    gains: Annotated[
        OrNone[tuple[float, float, float, float]], tyro.conf.arg(metavar="K1 K2 K3 K4")
    ] = None
    """Torque of M1 to M3 [N·m/A] and force of M4 [N/A] for each ampere, for logs of currents."""
    split: bool = False
    """Split logs at gaps, rows out of reach and singular ones, instead of refusing them."""
    start: Annotated[OrNone[Pose], tyro.conf.arg(metavar="X Y THETA Z")] = None
    """Pose near the start of the logs [mm, mm, °, mm]; it chooses the assembly mode. The
    home pose by default."""
    cut_off: Annotated[float, tyro.conf.arg(metavar="HZ")] = DEFAULTS.cut_off
    """Where the filter halves [Hz]; that of the positions at 10 Hz or above."""
    delay: bool = False
    """Fit a delay of the torques after the positions."""
    rotors: bool = False
    """Fit how the rotors' inertias of M1 to M3 differ."""
    legs: bool = False
    """Fit how the legs' own masses differ."""
    constrain: bool = False
    """Hold the identity of the masses, which only springs break."""
    out: Annotated[OrNone[Path], tyro.conf.arg(metavar="FOLDER")] = None
    """Folder to write into: parameters.csv, residuals.csv, identified.toml, torques.svg."""

    def run(self) -> int:
        """Identify and report."""
        design = self.given_design()
        settings = IdentificationSettings(
            cut_off=self.cut_off, delay=self.delay, rotors=self.rotors, legs=self.legs,
            constrain=self.constrain,
        )  # fmt: skip
        if self.start is not None and not all(map(math.isfinite, self.start)):
            raise UsageError(f"--start: four finite numbers are needed, not {self.start}")
        with status_line("reading") as update:
            log = self._read(self.log)
            other = None if self.validate is None else self._read(self.validate)
            loaded, mass = None, None
            if self.payload is not None:
                name, mass = self.payload
                if not (math.isfinite(mass) and mass >= 0):
                    raise UsageError(f"--payload: a mass of 0 kg or more is needed, not {mass!r}")
                loaded = self._read(name)
            if self.out is not None:  # before the work, so that a wrong place is known at once
                make_folder(self.out)

            def show(done: float, /, *, step: str, **_: Any) -> None:
                update(f"identification: {step}")

            found = investigate(
                log, design, settings, other=other, loaded=loaded, payload=mass or None,
                start=self.start and pose_si(self.start), progress=show,
            )  # fmt: skip
        written = [] if self.out is None else self._write(self.out, found)
        if self.json:
            print_json(identification_data(found, written))
        else:
            print_heading(design)
            print_blocks(identification_blocks(found))
            print_written(written)
        one = found.identification
        return 1 if found.causes.named or one.identity.holds is False or one.problem else 0

    def _read(self, name: str) -> Log:
        return given_log(name, gains=self.gains, split=self.split)

    def _write(self, folder: Path, found: Findings) -> list[Path]:
        from paminsa_viz.plots.identification_series import log_series  # late: matplotlib
        from paminsa_viz.plots.series_figure import render_series

        paths = [folder / name for name in FILES]
        save_table(estimate_table(found), paths[0])
        save_table(residual_table(found), paths[1])
        save_changed(found.nearest.design, paths[2], self.given_requirements())
        write_bytes(paths[3], render_series(log_series(found), "svg"))
        return paths


FLAGS = Identify
