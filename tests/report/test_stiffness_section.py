"""The report's section on stiffness: the library's numbers, and what it says without a load."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np
import pytest

from paminsa_viz.blocks.kinds import Block, Note, Table
from paminsa_viz.blocks.kinds import shown as shown_as
from paminsa_viz.blocks.stiffness import stiffness_blocks
from paminsa_viz.elastostatics.drive_stiffness import drive_modes, drive_stiffness
from paminsa_viz.elastostatics.stiffness import platform_stiffness, strain_shares
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.report.request import ReportRequest
from paminsa_viz.report.sections import stiffness_section
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import NONE, format_value

POSE = (0.05, 0.02, 0.5, -0.6)
MADE = datetime(2026, 1, 2, tzinfo=UTC)
MOTION = PRESET["arch"].build(APPENDIX_4.geometry).sample(200)


def section(design: Design, pose=POSE) -> tuple[list[Table], list[Note]]:
    return sorted_out(stiffness_section(ReportRequest(design, pose, MOTION, MADE, "")).blocks)


def at_the_pose(design: Design, pose=POSE) -> tuple[list[Table], list[Note]]:
    """What the section says but for lengths and the workspace."""
    return sorted_out(stiffness_blocks(design, platform_stiffness(design, pose)))


def sorted_out(found: Sequence[Block]) -> tuple[list[Table], list[Note]]:
    tables = [block for block in found if isinstance(block, Table)]
    return tables, [block for block in found if isinstance(block, Note)]


@pytest.mark.slow
def test_stiffness_and_shares_are_the_librarys() -> None:
    design = APPENDIX_4.vary({"payload.mass": 10.0, "elastic.b4_outer": 0.05})
    (data, stiffness, directions, deflection, shares, modes), (_, note) = section(design)
    assert ("B4", "tube 50/33.1 mm") in [row.cells[:2] for row in data.rows]
    found = platform_stiffness(design, POSE)
    shown = {row.cells[0]: row.cells[2] for row in stiffness.rows}
    assert shown["K_z"] == format_value(float(found.along(2)), "N/m")
    assert shown["K_tilt"] == format_value(float(found.tilt), "N m/rad")
    assert all(len(row.cells) == len(stiffness.head) for row in stiffness.rows)
    best = strain_shares(design, POSE).share.max()
    assert shares.rows[0].cells == ("B1", f"{100 * best:.1f} %")
    assert "M4" in [row.cells[0] for row in shares.rows]
    assert directions.rows[2].cells[:2] == ("z [N/mm]", shown_as(found.along(2), "N/m", 4))
    compliance = np.diag(np.linalg.inv(drive_stiffness(design, POSE)))  # of x, y, theta, z
    x, y, z = (shown_as(1 / compliance[i], "N/m", 4) for i in (0, 1, 3))
    turn = shown_as(1 / compliance[2], "N m/rad", 4)
    assert [row.cells[2] for row in directions.rows[:6]] == [x, y, z, "rigid", "rigid", turn]
    assert deflection.rows[2].cells[0] == "z [mm]"
    assert float(deflection.rows[2].cells[2].replace("−", "-")) == pytest.approx(
        1e3 * found.deflection()[2], rel=5e-3
    )
    assert "a tilt of" in note.text
    first = robot_modes(design, POSE).frequencies[0]
    alone = drive_modes(design, POSE).frequencies[0]
    assert modes.rows[0].cells == ("1", shown_as(first, "Hz", 4), shown_as(alone, "Hz", 4))
    assert modes.rows[5].cells[2] == NONE


def test_without_a_hold_there_is_no_frequency() -> None:
    weak = APPENDIX_4.vary({"elastic.drive_rotary": 1.0, "payload.mass": 20.0})
    _, notes = at_the_pose(weak, (0.08, 0.05, 0.6, -0.5))
    assert "no natural frequencies" in notes[-1].text


def test_without_a_load_nothing_is_deflected() -> None:
    (_, shares, _), (_, note) = at_the_pose(APPENDIX_4)
    assert "nothing is deflected" in note.text
    assert shares.head == ("Part", "force x", "force y", "force z", "moment z")
    assert {"M1–M3", "M4"} <= {row.cells[0] for row in shares.rows}
    for column in range(1, 5):
        total = sum(float(row.cells[column].removesuffix(" %")) for row in shares.rows)
        assert total == pytest.approx(100, abs=0.5)


def test_singular_pose_has_a_reason() -> None:
    radius = float(singular_radius(APPENDIX_4.geometry, 0.5))
    tables, (note,) = section(APPENDIX_4, (radius, 0.0, 0.5, -0.5))
    assert len(tables) == 1
    assert "singular" in note.text
    assert note.kind == "warn"


def test_a_bar_without_length_has_no_frequencies_and_all_else() -> None:
    design = APPENDIX_4.vary({"geometry.shaft_length": 0.0})
    tables, notes = section(design, (0.0, 0.0, 0.0, -0.5))
    assert "geometry.shaft_length: a bar without length" in notes[-1].text
    indices = next(table for table in tables if "Mean" in table.head)
    without = [row.cells[0] for row in indices.rows if set(row.cells[2:]) == {NONE}]
    assert 0 < len(without) < len(indices.rows)
    assert f"{', '.join(without)}: no value, geometry.shaft_length" in indices.caption
