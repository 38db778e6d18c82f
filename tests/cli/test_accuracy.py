"""``accuracy``: errors from the drives at a pose and over the workspace."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, Drive, DriveAccuracy, singular_rotation
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.leg_lengths import with_deviations
from paminsa_viz.precision.manufacture import manufactured_pose, monte_carlo, tolerance_errors
from paminsa_viz.units import number
from tests.support.commands import run, run_json

FOLD = float(np.degrees(singular_rotation(APPENDIX_4.geometry)))


def test_numbers_are_those_of_the_pose_in_si_units(capsys) -> None:
    words = "--pose 50 0 40 -500 --backlash 0.02 5 --control 0.001 1"
    found = run_json("accuracy", capsys, *words.split())
    accuracy = DriveAccuracy(
        backlash_rotary=np.radians(0.02), backlash_linear=5e-6,
        control_rotary=np.radians(0.001), control_linear=1e-6,
    )  # fmt: skip
    pose = (0.05, 0.0, np.radians(40), -0.5)
    expected = drive_errors(APPENDIX_4.geometry, accuracy, pose)
    assert found["bounded"]
    for index, name in enumerate(("x_m", "y_m", "theta_rad", "z_m")):
        for kind in ("worst", "linear", "rms"):
            value = getattr(expected, kind)[index]
            assert found["errors"][name][kind] == pytest.approx(value, rel=1e-9)
    assert found["errors"]["horizontal_m"]["worst"] == pytest.approx(float(expected.horizontal))
    assert found["half_widths"]["M4_m"] == pytest.approx(8.5e-6)


def test_table_over_the_region_has_the_statistics(capsys) -> None:
    found = run_json("accuracy", capsys, "--cells", "8")["region"]["errors"]["horizontal_m"]
    worst, linear, rms = (found[kind] for kind in ("worst", "linear", "rms"))
    values = (*worst.values(), linear["median"], rms["median"])
    texts = " ".join(number(1e6 * value, 3, padded=True) for value in values)
    _, printed, _ = run("accuracy", capsys, "--cells", "8")
    assert f"position [µm] {texts}" in " ".join(printed.split())
    assert linear["median"] < linear["p95"]


def test_no_bound_near_the_fold_has_its_reason_and_exit_code_1(capsys) -> None:
    words = ("--pose", "0", "0", f"{FOLD - 0.5}", "-300", "--theta", f"{FOLD - 2}", "--z", "-300")
    words += ("--radius", "250")
    code, out, err = run("accuracy", capsys, *words, "--json")
    assert (code, err) == (1, "")
    found = json.loads(out)
    assert not found["bounded"]
    assert found["reason"] == "within the errors of the drives the robot cannot be assembled"
    assert found["errors"]["theta_rad"]["worst"] is None
    assert 0 < found["errors"]["theta_rad"]["linear"] < np.radians(2)
    region = found["region"]
    assert 0 < region["unbounded"]["not-assembled"] < region["poses"]
    assert region["errors"]["x_m"]["worst"]["largest"] > 0
    _, printed, _ = run("accuracy", capsys, *words)
    assert "No bound at the pose: within the errors of the drives" in printed
    assert "No bound at 1" in printed


def test_encoders_of_the_drives_give_the_resolution(capsys, tmp_path: Path) -> None:
    drive = Drive(encoder_counts=4096, gear_ratio=10)
    design = replace(APPENDIX_4, drives=(drive, drive, drive, None))
    save_design(design, tmp_path / "driven.toml")
    found = run_json("accuracy", capsys, "--design", str(tmp_path / "driven.toml"), "--encoders")
    assert found["half_widths"]["M1_rad"] == pytest.approx(np.pi / 40960)
    assert found["half_widths"]["M4_m"] == pytest.approx(5e-6)


@pytest.mark.slow
def test_manufacture_has_tolerances_robots_and_the_design_s_own_legs(capsys) -> None:
    design = with_deviations(APPENDIX_4, np.full((3, 14), 1e-4) * [[1], [-1], [2]])
    save_design(design, "robot.toml")
    words = ("--design", "robot.toml", "--pose", "50", "0", "40", "-500", "--manufacture")
    found = run_json("accuracy", capsys, *words, "--robots", "20", "--cells", "5")["manufacture"]
    pose = (0.05, 0.0, np.radians(40), -0.5)
    errors = tolerance_errors(design, pose)
    drawn = monte_carlo(design, pose, robots=20)
    moved = manufactured_pose(design, pose)
    for index, name in enumerate(("x_m", "y_m", "theta_rad", "z_m", "tilt_x_rad", "tilt_y_rad")):
        assert found["worst"][name] == pytest.approx(errors.worst[index])
        assert found["robots"]["rms"][name] == pytest.approx(drawn.rms[index])
        assert found["actual"][name] == pytest.approx(moved.coordinates[index])
        assert sum(found["shares"][name].values()) == pytest.approx(1.0)
    code, out, _ = run("accuracy", capsys, *words, "--robots", "20", "--cells", "5")
    assert code == 0
    assert "Errors by the tolerances of the lengths" in out
    assert "With drives set for equal legs" in out
    code, out, _ = run("accuracy", capsys, "--manufacture", "--cells", "5")
    assert "set for equal legs" not in out
    assert "RMS of robots" not in out
