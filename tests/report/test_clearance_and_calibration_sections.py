"""Sections on clearance and on calibration: their numbers are those of the functions they name."""

from __future__ import annotations

import re

import numpy as np
import pytest

from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.clearance import clearance
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.calibration_plan import plan_calibration
from paminsa_viz.precision.measurements import simulated_measurements
from paminsa_viz.report.sections import calibration_section, clearance_section
from paminsa_viz.trajectory import analyze, paper_like

POSE = (0.05, -0.03, 0.35, -0.55)


def test_clearance_is_that_of_the_pose_and_of_the_motion() -> None:
    analysis = analyze(APPENDIX_4, paper_like(APPENDIX_4.geometry).lasting(0.4).sample(50))
    section = clearance_section(analysis, POSE)
    notes = [block.text for block in section.blocks if isinstance(block, Note)]
    tables = [block for block in section.blocks if isinstance(block, Table)]
    here = 1e3 * float(clearance(APPENDIX_4, np.array(POSE)).least)
    along = clearance(APPENDIX_4, analysis.trajectory.pose)
    assert float(re.findall(r"Least clearance: ([\d.]+) mm", notes[0])[0]) == pytest.approx(
        here, rel=1e-3
    )
    assert notes[1].startswith(f"{along.least.size} of {along.least.size} samples")
    cells = [row.cells for row in tables[1].rows]
    assert sum(int(count) for *_, count, _ in cells) == along.least.size
    least = min(float(text.split()[0]) for *_, text in cells)
    assert least == pytest.approx(1e3 * float(along.least.min()), rel=1e-3)


@pytest.mark.slow
def test_calibration_is_that_of_the_measured_poses() -> None:
    asked = plan_calibration(APPENDIX_4, 40, coordinates=6, noise=2e-5).measurements
    measured = simulated_measurements(APPENDIX_4, asked, seed=2)
    found = calibrate(APPENDIX_4, measured)
    section = calibration_section(APPENDIX_4, measured)
    assert isinstance(section.blocks[0], Note)
    assert section.blocks[0].text.startswith("40 poses of")
    errors = section.blocks[2]
    assert isinstance(errors, Table)
    names = ["x [µm]", "y [µm]", "z [µm]", "θ [″]", "tilt about x [″]", "tilt about y [″]"]
    assert [row.cells[0] for row in errors.rows] == names
    for row, place in zip(errors.rows, (0, 1, 3, 2, 4, 5), strict=True):
        scale = 1e6 if "µm" in row.cells[0] else 180 * 3600 / np.pi
        expected = [scale * found.before.rms[place], scale * found.after.rms[place]]
        assert list(map(float, row.cells[1:3])) == pytest.approx(expected, rel=0.01, abs=0.01)
