"""``clearance``: nearest bodies at a pose and over poses."""

from __future__ import annotations

from pathlib import Path

import pytest

from paminsa_viz.clearance import clearance
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from tests.support.commands import run, run_json

pytestmark = pytest.mark.slow


def test_numbers_are_those_of_the_pose(capsys) -> None:
    found = run_json("clearance", capsys, "--pose", "50", "0", "40", "-500")
    expected = clearance(APPENDIX_4, (0.05, 0.0, 0.6981317007977318, -0.5))
    assert found["least"]["distance_m"] == pytest.approx(float(expected.least))
    assert tuple(found["least"]["bodies"]) == expected.pairs[int(expected.pair)]
    assert found["groups"]["payload"] is None
    assert found["groups"]["frame"]["distance_m"] > 0


def test_an_overlap_is_a_negative_result(capsys, tmp_path: Path) -> None:
    code, text, _ = run("clearance", capsys, "--pose", "0", "200", "0", "-500")
    assert code == 1
    assert "joint 1 of leg 3 and slider of leg 3 overlap by" in text
    code, text, _ = run("clearance", capsys, "--least", "20")
    assert code == 1
    assert "20 mm is required" in text
    path = tmp_path / "loaded.toml"
    save_design(APPENDIX_4.vary({"payload.mass": 3.0}), path)
    code, text, _ = run("clearance", capsys, "--design", str(path))
    assert code == 0
    assert "payload" in text


def test_random_poses_are_counted(capsys) -> None:
    words = ("--poses", "200", "--radius", "150")
    found = run_json("clearance", capsys, *words)["poses"]
    assert found["drawn"] == 200
    assert found["reached"] == sum(entry["poses"] for entry in found["nearest"])
    assert found == run_json("clearance", capsys, *words)["poses"]
    assert "of leg" not in str(found["nearest"])
    _, text, _ = run("clearance", capsys, *words)
    assert f"{found['reached']} of 200 poses can be taken" in text
