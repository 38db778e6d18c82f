"""``calibrate``: from a log to a corrected design file; poses to measure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.design_file import load_design
from paminsa_viz.files.measurements import measurement_table, read_measurements
from paminsa_viz.files.tables import table_bytes
from paminsa_viz.model import APPENDIX_4, check_reach
from paminsa_viz.precision.leg_lengths import deviation_array
from paminsa_viz.precision.measurements import Measurements, coordinate_scales, predict
from tests.support.commands import check_refused, run, run_json

TRUE = np.random.default_rng(7).uniform(-3e-4, 3e-4, (3, 14))
LOG = Path("log.csv")


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Measurements of a robot with deviations `TRUE`, with 10 um of noise."""
    path = tmp_path_factory.mktemp("poses") / "poses.csv"
    from paminsa_viz.cli import main

    assert main(["calibrate", "--propose", "30", "--out", str(path)]) == 0
    asked = read_measurements(path).measurements
    assert check_reach(APPENDIX_4.geometry, asked.poses).ok.all()
    poses = predict(APPENDIX_4, TRUE, asked).coordinates
    noise = np.random.default_rng(8).normal(size=poses.shape) * 1e-5
    return Measurements(asked.actuators, poses + noise / coordinate_scales(APPENDIX_4))


@pytest.fixture
def log(measured: Measurements) -> Measurements:
    write_bytes(LOG, table_bytes(measurement_table(measured), "csv"))
    return measured


@pytest.mark.slow
def test_a_log_gives_a_design_that_predicts_it(log: Measurements, capsys: Any) -> None:
    words = ("log.csv", "--validate", "0.2", "--out", "robot.toml")
    found = run_json("calibrate", capsys, *words)
    assert found["improved"]
    assert found["rank"] == 30
    assert len(found["singular_values"]) == 42
    assert found["noise_m"] == pytest.approx(1e-5, rel=0.3)
    assert (found["fitted"]["after"]["poses"], found["held_back"]["after"]["poses"]) == (24, 6)
    for name in ("x_m", "y_m", "z_m"):
        assert found["held_back"]["after"]["rms"][name] < 4e-5
        assert found["fitted"]["before"]["rms"][name] > 1e-4
    design = load_design("robot.toml")
    assert design.name == "robot"
    written = deviation_array(design).ravel()
    assert written.tolist() == list(found["deviations"].values())
    error = predict(design, deviation_array(design), log).coordinates - log.poses
    assert np.abs(error[:, [0, 1, 3]]).max() < 1e-4
    # and again, from there: nothing is gained on the noise
    again = run_json("calibrate", capsys, "log.csv", "--design", "robot.toml")
    assert again["fitted"]["before"]["rms"]["x_m"] < 4e-5


@pytest.mark.slow
def test_the_report_names_numbers_and_files(log: Measurements, capsys: Any) -> None:
    code, out, err = run("calibrate", capsys, "log.csv", "--out", "robot.toml")
    assert (code, err) == (0, "")
    assert "30 poses of 6 coordinates fitted" in out
    assert "30 of 42 combinations show with equal legs" in out
    assert "robot.toml: written" in out
    assert out.partition("Deviations")[0].count("+-") == 10
    code, everything, _ = run("calibrate", capsys, "log.csv", "--all")
    assert code == 0
    assert everything.count("+-") >= 30


@pytest.mark.slow
def test_no_gain_is_exit_code_1_and_writes_nothing(measured: Measurements, capsys: Any) -> None:
    """Noise as large as the deviations: held-back poses get worse."""
    random = np.random.default_rng(1)
    poses = predict(APPENDIX_4, np.zeros((3, 14)), measured).coordinates
    noise = random.normal(size=poses.shape) * 1e-4 / coordinate_scales(APPENDIX_4)
    data = Measurements(measured.actuators, poses + noise)
    write_bytes(LOG, table_bytes(measurement_table(data), "csv"))
    code, _, err = run("calibrate", capsys, "log.csv", "--validate", "0.5", "--out", "robot.toml")
    assert (code, err) == (1, "")
    assert not Path("robot.toml").exists()


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ((), "either POSES.csv or --propose"),
        (("log.csv", "--propose", "3"), "either POSES.csv or --propose"),
        (("none.csv",), "none.csv"),
        (("log.csv", "--validate", "1"), "--validate 1: a share from 0 to 0.9"),
        (("log.csv", "--validate", "0.9"), "log.csv: at least 8 poses are needed besides the 27"),
        (("log.csv", "--validate", "0.3", "--seed", "-1"), "--seed -1"),
        (("log.csv", "--out", "robot.csv"), "--out robot.csv: its ending has to be .toml"),
        (("--propose", "3"), "--out FILE.csv is needed"),
        (("--propose", "0", "--out", "a.csv"), "viz: --propose: 1 to 1000"),
        (("--propose", "3", "--out", "a.toml"), "its ending has to be one of"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_wrong_words_are_refused(
    log: Measurements, capsys: Any, words: tuple[str, ...], place: str
) -> None:
    check_refused("calibrate", capsys, *words, place=place)


def test_a_pose_in_wrong_units_is_refused_with_its_row(log: Measurements, capsys: Any) -> None:
    poses = log.poses.copy()
    poses[4, 3] *= 1e3
    write_bytes(LOG, table_bytes(measurement_table(Measurements(log.actuators, poses)), "csv"))
    lines = LOG.read_text().splitlines()
    row = next(i for i, line in enumerate(lines, 1) if line.startswith("x_m")) + 5
    check_refused(
        "calibrate", capsys, "log.csv", place=f"log.csv, row {row}: the design has no such"
    )
