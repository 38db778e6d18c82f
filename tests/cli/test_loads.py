"""``loads``: joint forces of a pose, bearing loads of a motion, tables."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.elastostatics.joint_forces import JOINTS, joint_forces
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.model.statics import static_torques
from tests.support.commands import run, run_json

POSE = ("--pose", "50", "-20", "10", "-500")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def rows_of(path: str) -> list[dict[str, str]]:
    lines = [line for line in Path(path).read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_forces_of_a_pose_are_the_models(capsys) -> None:
    found = run_json("loads", capsys, *POSE, "--load", "0", "0", "-100", "0", "0", "0",
                     "--out", "joints.csv")  # fmt: skip
    pose = np.array([0.05, -0.02, np.radians(10), -0.5])
    design = APPENDIX_4.vary({"load.force_z": -100.0})
    np.testing.assert_allclose(found["torque"], static_torques(design, pose), rtol=1e-10)
    expected = joint_forces(design, pose)
    rows = rows_of("joints.csv")
    assert len(rows) == 30
    assert rows[6]["joint"] == "7"
    assert float(rows[6]["vertical_N"]) == expected.of("7")[0, 2]
    assert float(rows[6]["tangential_N"]) == sideways_forces(design, pose).force[0, 6]
    assert found["legs"][1]["joints"]["9"]["force_N"][0] == expected.of("9")[1, 0]
    code, out, _ = run("loads", capsys, *POSE)
    assert code == 0
    assert "shared by elasticity" in out


def test_sections_along_a_bar_are_written(capsys) -> None:
    code, _, err = run("loads", capsys, *POSE, "--bar", "b10", "--out", "bar.csv")
    assert (code, err) == (0, "")
    rows = rows_of("bar.csv")
    assert float(rows[0]["s_m"]) == 0
    assert float(rows[-1]["s_m"]) == APPENDIX_4.geometry.guide_link_length
    assert float(rows[0]["leg1_M_Nm"]) == 0
    assert abs(float(rows[-1]["leg3_M_Nm"])) > 0.1


@pytest.mark.slow
def test_loads_of_a_motion_and_its_tables(capsys) -> None:
    found = run_json("loads", capsys, "--preset", "arch", "--out", "samples.csv")
    run("loads", capsys, "--preset", "arch", "--bearings", "--out", "bearings.csv")
    samples, bearings = rows_of("samples.csv"), rows_of("bearings.csv")
    nine = found["legs"][0]["joints"]["9"]
    size = [
        np.hypot(float(row["leg1_9_radial_N"]), float(row["leg1_9_vertical_N"])) for row in samples
    ]
    assert max(size) == pytest.approx(nine["peak_N"], rel=1e-12)
    row = next(row for row in bearings if (row["leg"], row["joint"]) == ("1", "9"))
    assert float(row["equivalent_N"]) == nine["equivalent_N"]
    assert 0 < nine["equivalent_N"] <= nine["peak_N"]


def test_a_singular_pose_has_a_reason_and_no_numbers(capsys) -> None:
    singular = str(np.degrees(singular_rotation(APPENDIX_4.geometry)))
    code, out, err = run("loads", capsys, "--pose", "0", "0", singular, "-500", "--out", "x.csv")
    assert (code, out) == (1, "")
    assert "singular" in err
    assert not Path("x.csv").exists()


def test_sideways_shares_at_rest_come_from_the_elasticity(capsys) -> None:
    found = run_json("loads", capsys, *POSE, "--load", "0", "30", "0", "0", "0", "0")
    pose = np.array([0.05, -0.02, np.radians(10), -0.5])
    expected = sideways_forces(APPENDIX_4.vary({"load.force_y": 30.0}), pose)
    for leg in range(3):
        for index, joint in enumerate(JOINTS):
            values = found["legs"][leg]["joints"][joint.key]
            assert values["sideways_N"] == pytest.approx(float(expected.force[leg, index]))
            moments = values["sideways_moments_Nm"]
            np.testing.assert_allclose(moments, expected.moment[leg, index])
    assert "shared by elasticity" in run("loads", capsys, *POSE)[1]
