"""Accuracy of the drives: its parts, its place in designs, files and studies."""

from __future__ import annotations

import re
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_file import read_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model import APPENDIX_4, Drive, DriveAccuracy
from paminsa_viz.model.accuracy import NO_TOLERANCES, Tolerances
from paminsa_viz.model.drive import NO_DRIVES

PARTS = DriveAccuracy(2e-4, 3e-5, 4e-4, 1e-5, 1e-4, 2e-5)


def test_half_widths_add_and_variances_add() -> None:
    assert PARTS.half_widths == pytest.approx((4e-4, 4e-4, 4e-4, 4e-5))
    assert PARTS.deviations[:3] == pytest.approx([np.sqrt((4e-8 + 16e-8 + 4e-8) / 12)] * 3)
    assert PARTS.deviations[3] == pytest.approx(np.sqrt((9e-10 + 1e-10 + 16e-10) / 12))
    default = DriveAccuracy()
    assert default.resolution_rotary == 1.74532925e-4  # 0.01 degrees, in digits of an input
    assert np.degrees(default.half_widths[:3]) == pytest.approx([0.005] * 3)
    assert default.half_widths[3] == 5e-6


@pytest.mark.parametrize("value", [-1e-4, float("nan"), 2.0, "0.1"])
def test_impossible_accuracies_are_refused(value: Any) -> None:
    with pytest.raises(InvalidDesign, match=r"accuracy\.backlash_rotary"):
        DriveAccuracy(backlash_rotary=value)


def test_parts_are_from_a_millionth_of_a_micrometer_to_a_meter_or_a_radian() -> None:
    for name in ("resolution_linear", "control_rotary"):
        for possible, beyond in ((1e-12, 0.0), (1.0, 2.0)):
            assert getattr(DriveAccuracy(**{name: possible}), name) == possible
            with pytest.raises(InvalidDesign, match=rf"accuracy\.{name}"):
                DriveAccuracy(**{name: np.nextafter(possible, beyond)})


def test_encoders_of_drives_give_the_resolutions() -> None:
    coarse, fine = Drive(encoder_counts=1000, gear_ratio=50), Drive(encoder_counts=4096)
    screw = Drive(encoder_counts=2000, transmission="screw", lead=0.01)
    found = PARTS.with_encoders((fine, coarse, None, screw))
    assert found.resolution_rotary == pytest.approx(2 * np.pi / 4096)  # the coarsest
    assert found.resolution_linear == pytest.approx(5e-6)
    assert found == replace(
        PARTS, resolution_rotary=found.resolution_rotary, resolution_linear=found.resolution_linear
    )
    slow = PARTS.with_encoders((fine, fine, fine, replace(screw, encoder_counts=1, lead=1.0)))
    assert slow.half_widths[0] < slow.half_widths[3]  # and none of M4's for the others
    assert slow.resolution_rotary == found.resolution_rotary
    assert PARTS.with_encoders(NO_DRIVES) == PARTS
    assert PARTS.with_encoders((Drive(), None, None, None)) == PARTS


def test_a_design_file_names_it_only_where_it_is_not_the_default() -> None:
    assert "accuracy" not in write_design(APPENDIX_4)
    design = APPENDIX_4.vary({"accuracy.backlash_rotary": 1e-3, "accuracy.resolution_linear": 0.0})
    text = write_design(design)
    assert read_design(text, "a.toml") == design
    lines = text.partition("[accuracy]")[2].splitlines()[1:]
    assert [line.split(" =")[0] for line in lines] == [
        "resolution_linear_m", "backlash_rotary_rad"
    ]  # fmt: skip


def fine(length: float) -> float:
    """Return the deviation that ISO 2768-1 allows a length in class f; both in [m]."""
    classes = ((6, 0.05), (30, 0.1), (120, 0.15), (400, 0.2), (1000, 0.3), (2000, 0.5))
    return next(1e-3 * allowed for most, allowed in classes if 1e3 * length <= most)


def test_tolerances_are_those_of_iso_2768_at_the_prototypes_sizes() -> None:
    """Angles to the digits in which they are given, and clearances those of H7/g6 on average."""
    found, g = Tolerances(), APPENDIX_4.geometry
    assert found.bar == fine(g.short_coupler_length)
    assert found.shaft == fine(g.shaft_length)
    assert found.joint_height == fine(g.platform_joint_height)
    assert found.axis_radius == found.guide_height == fine(g.base_radius)
    assert found.joint_radius == fine(g.platform_radius)
    assert found.joint_angle == pytest.approx(found.joint_radius / g.platform_radius)
    assert found.axis_angle == pytest.approx(found.axis_radius / g.base_radius, abs=5e-5)
    holes, shafts = (0.0, 18e-6), (-17e-6, -6e-6)  # above 10 mm
    middle = sum(holes) / 2 - sum(shafts) / 2
    assert found.pin_clearance == found.guide_clearance == pytest.approx(middle, abs=1e-6)
    assert set(astuple(NO_TOLERANCES)) == {0.0}


def test_zeros_of_the_actuators_turn_the_platform_as_documented() -> None:
    """At home a leg's line passes joint 5 aside by its tangential errors, a third of which turn."""
    found, g = Tolerances(), APPENDIX_4.geometry
    aside = g.base_radius * found.axis_angle + g.platform_radius * found.joint_angle
    aside += (g.base_radius - g.platform_radius) * found.actuator_zero
    turn = np.degrees(3 * aside / (3 * g.platform_radius)) * 3600
    page = Path(__file__).parents[2] / "docs" / "calibration.md"
    worst = re.search(r"^\| θ \| (\d+)″ \|", page.read_text(encoding="utf-8"), re.MULTILINE)
    assert worst
    assert turn == pytest.approx(float(worst[1]), abs=0.5)
