"""``paminsa-viz evaluate``: actuator positions and torques for a table of poses."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.blocks.evaluation import evaluation_text
from paminsa_viz.cli.flags import DesignFlags, check_output
from paminsa_viz.cli.output import ascii_numbers, print_left_out
from paminsa_viz.files.atomic import open_atomically
from paminsa_viz.files.columns import (
    ACCELERATION,
    ACTUATORS,
    LOAD,
    POSE,
    POSES,
    STATUS,
    TORQUES,
    VELOCITY,
)
from paminsa_viz.files.table_reader import TableBlock, TableReader, open_table
from paminsa_viz.files.tables import csv_rows, header_lines
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.reach import Limit, status_words

DESCRIPTION = """\
Compute the actuators' positions and torques for every row of a table of poses.

Columns of IN.csv, in any order; other units are written as x_mm or theta_deg:
  pose           x_m,y_m,theta_rad,z_m
  velocity       vx_m_s,vy_m_s,omega_rad_s,vz_m_s          (optional; 0 if left out)
  acceleration   ax_m_s2,ay_m_s2,alpha_rad_s2,az_m_s2      (optional; 0 if left out)
  load           Fx_N,Fy_N,Fz_N,Mx_Nm,My_Nm,Mz_Nm          (any of them; 0 if left out)

OUT.csv repeats them, row by row, below the lines that begin with # before their header, and adds
  theta1_rad,theta2_rad,theta3_rad,Z_m,tau1_Nm,tau2_Nm,tau3_Nm,f4_N,status

The status is ok, or the reason why a row has no numbers: stretched, folded, guide or axis with the
leg (stretched:leg2), singular, or not-finite for numbers too large to compute with. OUT.csv is
written completely or, when IN.csv is refused, not at all."""


@dataclass(frozen=True, kw_only=True)
class Evaluate(DesignFlags):
    """Flags of the command."""

    table: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="IN.csv")]
    """Table of poses."""
    out: Annotated[Path, tyro.conf.arg(metavar="OUT.csv")]
    """Table to write; may be IN.csv itself."""

    def run(self) -> int:
        """Evaluate the table."""
        check_output("--out", self.out, [".csv"])
        design = self.given_design()
        found = evaluate_table(self.table, self.out, design)
        print(f"{self.out}: {ascii_numbers(evaluation_text(*found))}")
        print_left_out(design)
        return 0


FLAGS = Evaluate


def evaluate_table(
    source: str | os.PathLike[str],
    target: str | os.PathLike[str],
    design: Design = APPENDIX_4,
) -> tuple[Counter[str], float]:
    """Evaluate a CSV table of poses into another one, of any length in bounded memory.

    Args:
        source: Table to read.
        target: Table to write; it may be the same file, and appears only when it is complete.
        design: The robot.

    Returns:
        How many rows have which status, and the largest |theta| of a column in radians [rad].

    Raises:
        FileError: If a file cannot be read or written, or holds something else than poses.
    """
    counts: Counter[str] = Counter()
    turn = 0.0
    with open_table(source) as lines:
        table = TableReader(lines, POSES, os.fspath(source))
        with open_atomically(target) as file:
            file.writelines(f"{line}\n" for line in table.comments)
            file.write(header_lines({}, (*table.header, *ACTUATORS, *TORQUES, STATUS)))
            for block in table.blocks():
                results, words = evaluate_block(block, design)
                texts = np.array([",".join(map(str.strip, row)) for row in block.cells], object)
                file.write(csv_rows([texts, *results.T, words]))
                counts.update(words.tolist())
                if "theta_rad" in table.header:
                    turn = max(turn, float(np.abs(block.values["theta_rad"]).max(initial=0.0)))
            # Some systems do not let an open file be replaced, and it may be this one.
            lines.close()
    return counts, turn


def evaluate_block(block: TableBlock, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Return (n, 8) actuator positions and torques, NaN in rows without, and each row's status."""
    pose, velocity, acceleration, load = (
        block.group(names) for names in (POSE, VELOCITY, ACCELERATION, LOAD)
    )
    configuration = inverse_kinematics(design.geometry, pose)
    dynamics = inverse_dynamics(
        design, pose, velocity, acceleration, load=load if load.any() else None
    )
    results = np.concatenate([configuration.actuators, dynamics.torque], axis=-1)
    # A finite motion can still be too large for its torque to be a finite number.
    overflow = (dynamics.status == Limit.OK) & ~np.isfinite(results).all(axis=-1)
    status = np.where(overflow, Limit.NOT_FINITE, dynamics.status)
    results[status != Limit.OK] = np.nan
    return results, status_words(status, dynamics.leg)
