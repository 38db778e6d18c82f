"""The report's section on accuracy: the numbers of the library, and why there are none."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from paminsa_viz.blocks.accuracy import manufacture_blocks
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.model import APPENDIX_4, Design, DriveAccuracy, singular_rotation
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.leg_lengths import LENGTHS
from paminsa_viz.precision.manufacture import monte_carlo, tolerance_errors
from paminsa_viz.precision.unequal_legs import Closure
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.report.sections import accuracy_section
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import ARCSEC

POSE = (0.04, -0.02, 0.3, -0.5)
FOLD = singular_rotation(APPENDIX_4.geometry)


def section(design: Design = APPENDIX_4, pose: tuple[float, ...] = POSE) -> Section:
    x, y, theta, z = pose
    motion = PRESET["arch"].build(design.geometry).sample(100)
    made = datetime(2026, 1, 2, tzinfo=UTC)
    return accuracy_section(ReportRequest(design, (x, y, theta, z), motion, made, ""))


def tables(found: Section) -> list[Table]:
    return [block for block in found.blocks if isinstance(block, Table)]


def notes(found: Section) -> str:
    return " ".join(block.text for block in found.blocks if isinstance(block, Note))


def test_tables_have_the_numbers_of_the_library() -> None:
    found = section()
    drives, _, manufacture = tables(found)
    here = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, POSE)
    assert [row.cells[0] for row in drives.rows[2:]] == ["position [µm]", "z [µm]", "θ [″]"]
    assert float(drives.rows[0].cells[1]) == pytest.approx(1e6 * here.worst[0], rel=5e-3)
    assert float(drives.rows[4].cells[3]) == pytest.approx(ARCSEC * here.rms[2], rel=5e-3)
    tolerance = tolerance_errors(APPENDIX_4, POSE)
    assert manufacture.rows[3].cells[0] == "z [µm]"
    assert float(manufacture.rows[3].cells[1]) == pytest.approx(1e6 * tolerance.worst[3], rel=5e-3)
    assert float(manufacture.rows[7].cells[1]) == pytest.approx(ARCSEC * tolerance.tilt, rel=5e-3)
    assert "%" in manufacture.rows[4].cells[4]
    assert all(len(row.cells) == len(drives.head) for row in drives.rows)
    named = [row.cells[0] for row in manufacture.rows if len(row.cells) < len(manufacture.head)]
    assert named == ["position [µm]", "tilt [″]"]
    assert "No bound" not in notes(found)
    assert "equal legs" not in notes(found)


def test_shares_and_robots_that_cannot_be_assembled_are_counted() -> None:
    share = tolerance_errors(APPENDIX_4, POSE).shares[0]
    best = int(np.argmax(share))
    drawn = monte_carlo(APPENDIX_4, POSE, robots=20, seed=1)
    status = np.array([Closure.OPEN] * 3 + [Closure.OK] * 17, np.uint8)
    blocks = manufacture_blocks(APPENDIX_4, POSE, replace(drawn, status=status))
    table, robots = (block for block in blocks if isinstance(block, Table))
    assert table.rows[0].cells[-1].startswith(f"{LENGTHS[best].symbol} {100 * share[best]:.1f} %")
    assert robots.head[0] == "20 robots, seed 1"
    assert float(robots.rows[0].cells[4]) == pytest.approx(1e6 * drawn.rms[0], rel=5e-3)
    assert isinstance(blocks[-1], Note)
    assert "3 of 20 robots cannot be assembled" in blocks[-1].text


def test_unbounded_poses_and_unequal_legs_are_named() -> None:
    coarse = replace(APPENDIX_4, accuracy=DriveAccuracy(resolution_rotary=np.radians(3.0)))
    text = notes(section(coarse.vary({"leg1.shaft": 2e-4}), (0.0, 0.0, FOLD - 0.05, -0.3)))
    assert "No bound at the pose: within the errors of the drives" in text
    assert "With drives set for equal legs" in text
    assert "tilt about x" in text
    assert "No bound at" in notes(
        section(
            replace(coarse, accuracy=replace(coarse.accuracy, backlash_rotary=np.radians(20.0)))
        )
    )


def test_a_singular_pose_has_reasons_in_place_of_numbers() -> None:
    found = section(pose=(0.0, 0.0, FOLD, -0.3))
    assert len(tables(found)) == 2
    assert "the pose is singular" in notes(found)
    assert tables(found)[0].rows[0].cells[1] == "–"


@pytest.mark.slow
def test_legs_that_cannot_close_say_so() -> None:
    assert "have no position" in notes(section(APPENDIX_4.vary({"leg3.bar_89": 0.9})))
