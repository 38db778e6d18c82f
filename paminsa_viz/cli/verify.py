"""``paminsa-viz verify``: the formulas against physics engines, with a verdict."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.blocks.verification import verification_blocks, verification_data
from paminsa_viz.cli.arguments import OneOf, OrNone, check_needs
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, check_output
from paminsa_viz.cli.motion_flags import MotionFlags
from paminsa_viz.cli.output import print_blocks, print_heading, print_json, print_written
from paminsa_viz.engines.verification import POSES, TOLERANCE, Verification, verify
from paminsa_viz.errors import FileError, InvalidInput
from paminsa_viz.files.atomic import as_file_error, check_folder, make_folder, write_bytes
from paminsa_viz.plots.formats import FIGURE_FORMATS
from paminsa_viz.units import number

DESCRIPTION = """\
Check the formulas against MuJoCo and Pinocchio, two independent physics engines.

  paminsa-viz verify                                  Appendix 4 on a motion with 1 m/s²
  paminsa-viz verify --design robot.toml --preset circle --figures checked
  paminsa-viz verify --file motion.csv --json         for other programs
  paminsa-viz verify --report verification.html       the documentation's claims, measured

Static torques at random poses of the workspace and dynamic torques along a trajectory, of all four
actuators: by how much formulas and engine differ, at most and on average (RMS), over the largest
torque of the same actuator. Also: the formulas as published, and a simulation in which
MuJoCo moves under the calculated torques. Joint friction is left out.

Exit code: 0 passed, 1 failed, 2 a wrong argument or no engine."""


@dataclass(frozen=True, kw_only=True)
class Verify(JsonFlags, MotionFlags, DesignFlags):
    """Flags of the command."""

    poses: int = POSES
    """Number of random poses at rest."""
    seed: int = 0
    """Seed of the random poses."""
    tolerance: float = TOLERANCE
    """Largest difference that passes, over the largest torque of the actuator."""
    model: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.xml")] = None
    """Check this exported MJCF model against the design, instead of the design's own."""
    figures: Annotated[OrNone[Path], tyro.conf.arg(metavar="FOLDER")] = None
    """Write figures like the paper's Figs. 6 and 7 there: both curves and their difference."""
    format: OneOf[str, tuple(FIGURE_FORMATS)] = "png"
    """Format of the figures."""
    report: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.html")] = None
    """Also measure claims of the documentation about numbers, and write them, how each is checked,
    and the engines' results as one page."""

    def run(self) -> int:
        """Compare, and return the verdict."""
        check_needs(self, self.figures, "--figures", "format")
        if self.figures is not None:
            check_folder(self.figures)
        if self.report is not None:
            check_output("--report", self.report, [".html", ".htm"])
        design = self.given_design()
        motion = self.given_motion(design.geometry)
        xml = None if self.model is None else _mechanics(self.model)
        try:
            found = verify(
                design, motion,
                poses=self.poses, seed=self.seed, tolerance=self.tolerance, xml=xml,
            )  # fmt: skip
        except InvalidInput as error:
            if self.model is None or error.argument != "model":
                raise
            raise FileError(str(self.model), error.problem) from error
        files = [] if self.figures is None else _figures(found, self.figures, self.format)
        measured, holding, verdict = {}, True, ""
        if self.report is not None:
            # Late: the page's figures, and what the claims need, take seconds to load.
            from paminsa_viz.report.claims import measured_claims
            from paminsa_viz.report.claims_page import claims_data, claims_html, holding_text

            claims = list(measured_claims())
            write_bytes(self.report, claims_html(found, claims, datetime.now(UTC)).encode())
            files.append(self.report)
            measured = {"claims": claims_data(claims)}
            holding, verdict = all(one.holds for one in claims), holding_text(claims)
        if self.json:
            facts = verification_data(found) | {"seed": self.seed} | measured
            print_json(facts | {"files": files})
        else:
            moving = f'motion "{motion.name}"'
            print_heading(
                design, design.geometry.knee.label, moving, f"{number(motion.duration, 3)} s"
            )
            print_blocks(verification_blocks(found))
            if verdict:
                print(f"\n{verdict}")
            print_written(files)
        return 0 if found.passed and holding else 1


FLAGS = Verify


def _mechanics(path: Path) -> str:
    """Return the text of an MJCF file without its meshes, which are other files."""
    try:
        root = ET.fromstring(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise as_file_error(str(path), error, "read") from error
    except ET.ParseError as error:
        raise FileError(str(path), f"is no valid XML: {error}") from error
    for parent in root.iter():
        for child in list(parent):
            if child.tag == "mesh" or child.get("type") == "mesh":
                parent.remove(child)
    return ET.tostring(root, encoding="unicode")


def _figures(found: Verification, folder: Path, kind: str) -> list[Path]:
    """Write a figure for each engine, and one of the formulas as published; return their paths."""
    # Late: matplotlib takes a second to load.
    from paminsa_viz.plots.series_figure import render_series
    from paminsa_viz.plots.verified import verification_figures

    make_folder(folder)
    written = []
    for stem, title, data in verification_figures(found):
        path = folder / f"{stem}.{kind}"
        write_bytes(path, render_series(data, kind, title=title))
        written.append(path)
    return written
