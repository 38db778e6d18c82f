"""The report's section on drives: measured on the motion, and what is too weak."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.model import APPENDIX_4, Design, Drive
from paminsa_viz.report.request import Section
from paminsa_viz.report.sections import drives_section
from paminsa_viz.trajectory import PRESET, analyze

SERVO = Drive(
    "servo", 4e-6, gear_ratio=80.0, efficiency=0.8, rated_torque=0.3, peak_torque=0.9,
    top_speed=600.0, thermal_time_constant=300.0,
)  # fmt: skip


def section(design: Design) -> Section:
    motion = PRESET["arch"].build(design.geometry).sample(200)
    return drives_section(analyze(design, motion))


def notes(found: Section) -> list[str]:
    return [block.kind for block in found.blocks if isinstance(block, Note)]


def test_there_is_no_section_without_drives() -> None:
    assert section(APPENDIX_4).blocks == ()


def test_drives_are_listed_and_measured() -> None:
    found = section(replace(APPENDIX_4, drives=(SERVO, None, SERVO, None)))
    listed, measured = (block for block in found.blocks if isinstance(block, Table))
    assert [row.cells[0] for row in listed.rows] == ["M1", "M3"]
    assert [row.cells[0] for row in measured.rows] == ["M1", "M2", "M3", "M4"]
    assert [len(row.cells) == len(measured.head) for row in measured.rows] == [True, False] * 2
    assert [row.cells[1] == "none" for row in measured.rows] == [False, True] * 2
    assert notes(found) == ["plain", "ok"]


def test_drives_that_are_too_weak_are_named() -> None:
    weak = replace(SERVO, rated_torque=0.01)
    found = section(replace(APPENDIX_4, drives=(SERVO, weak, None, None)))
    assert notes(found) == ["plain", "bad"]
    text = next(b.text for b in found.blocks if isinstance(b, Note) and "M2" in b.text)
    assert "M1" not in text


def test_a_motion_that_cannot_be_run_is_not_measured() -> None:
    far = PRESET["arch"].build(APPENDIX_4.geometry).sample(200)
    far = replace(far, pose=np.add(far.pose, (0.5, 0.0, 0.0, 0.0)))
    design = replace(APPENDIX_4, drives=(SERVO, None, None, None))
    found = drives_section(analyze(design, far))
    assert notes(found) == ["plain", "bad"]
