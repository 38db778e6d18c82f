"""``paminsa-viz report``: the design report as one HTML file."""

from __future__ import annotations

import math
import shlex
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import PROGRAM, parse
from paminsa_viz.cli.inputs import Assembly, PresetName, design_of, motion_of
from paminsa_viz.files.atomic import open_atomically
from paminsa_viz.trajectory import home

DESCRIPTION = """\
Write a design report: one HTML file with everything inside, to attach to a design review.

  paminsa-viz report --out report.html
  paminsa-viz report --out report.html --design robot.toml --pose 50 -30 20 -550 --preset arch

It holds the design and where it differs from Appendix 4, geometry and workspace, torque maps, the
trajectory with loads and figures, the verification against physics engines if they are installed
(pip install 'paminsa-viz[verify]'), the static balance, and where all of it comes from. For a PDF,
open it in a browser and print."""


@dataclass(frozen=True)
class Report:
    """Flags of the command."""

    out: Annotated[Path, tyro.conf.arg(metavar="FILE.html")]
    """File to write; one that exists is replaced."""
    design: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML), instead of the paper's Appendix 4."""
    assembly: Assembly | None = None
    """Branch of the knee 9: as Appendix 1 prints it (lower), or its mirror image; by default the
    design's own."""
    pose: Annotated[
        tuple[float, float, float, float] | None, tyro.conf.arg(metavar="X Y THETA Z")
    ] = None
    """Pose in mm, mm, degrees, mm; maps are at its angle and height. In the middle of the
    workspace if left out."""
    preset: PresetName = "paper-like"
    """A ready-made motion, sized for the robot. None of them is the paper's own."""
    file: Annotated[Path | None, tyro.conf.arg(metavar="FILE.csv")] = None
    """A motion as a table with t_s,x_m,y_m,theta_rad,z_m, instead of a preset."""
    verify: bool = True
    """Check the formulas against the physics engines that are installed."""
    seed: int = 0
    """Seed of random poses."""


def main(words: list[str]) -> int:
    """Run the command."""
    flags = parse(Report, words, "report", DESCRIPTION)
    design = design_of(flags.design, flags.assembly)
    if flags.pose is None:
        x, y, theta, z = home(design.geometry).tolist()
    else:
        x, y, theta, z = flags.pose
        x, y, theta, z = 1e-3 * x, 1e-3 * y, math.radians(theta), 1e-3 * z
    trajectory = motion_of(flags.preset, flags.file, design.geometry)

    from paminsa_viz.report import ReportRequest, report_html  # figures take a second to load

    request = ReportRequest(
        design=design,
        pose=(x, y, theta, z),
        trajectory=trajectory,
        made=datetime.now(UTC),
        command=shlex.join([PROGRAM, "report", *words]),
        verified=flags.verify,
        seed=flags.seed,
    )
    # Opened first, so that a place which cannot be written to is known before the work.
    with open_atomically(flags.out) as file:
        file.write(report_html(request, _say))
    print(f"{flags.out}: written")
    return 0


def _say(words: str) -> None:
    print(f"{words} ...", file=sys.stderr)
