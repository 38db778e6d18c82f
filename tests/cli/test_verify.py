"""``verify``: the verdict, its exit code, its figures, and one line for whatever is wrong."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.cli import main
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.files.columns import TRAJECTORY
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import paper_like

pytestmark = pytest.mark.slow


pytest.importorskip("mujoco", reason="mujoco comes with the extra 'verify'")


@pytest.fixture
def motion(tmp_path, monkeypatch) -> str:
    """A short motion as a table, in the folder that the test runs in."""
    monkeypatch.chdir(tmp_path)
    t = paper_like(APPENDIX_4.geometry).lasting(0.3).sample(100)
    rows = np.column_stack([t.t, t.pose, t.velocity, t.acceleration]).tolist()
    lines = [",".join(TRAJECTORY.columns), *(",".join(map(repr, row)) for row in rows)]
    Path("motion.csv").write_text("\n".join(lines) + "\n")
    return "motion.csv"


def test_a_pass_is_told_in_a_table(motion, capsys) -> None:
    assert main(["verify", "--file", motion, "--poses", "20"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("Appendix 4, lower knee: 20 poses at rest, 31 states of")
    assert "Formulas and MuJoCo" in said
    for line in ("at rest, tau_1 [N m]", "moving, F_4 [N]", "EQ14_SINE_SIGNS", "MuJoCo ran 0.3 s"):
        assert line in said
    assert said.splitlines()[-1].startswith("PASS: the largest difference is ")


def test_json_holds_the_same(motion, capsys) -> None:
    words = ["verify", "--file", motion, "--poses", "9", "--seed", "5", "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["passed"] is True
    assert (found["static_poses"], found["dynamic_states"], found["seed"]) == (9, 31, 5)
    assert [row["actuator"] for row in found["engines"][0]["dynamic"]][3] == "F_4"
    assert found["worst_relative"] < 1e-10
    assert found["as_printed"]["ALL"][0]["max_relative"] > 1e-3


def test_a_design_of_ones_own_in_the_mirror_assembly(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    lengths = {"geometry.magnification": 2.6, "geometry.crank_length": 0.45}
    heavier = APPENDIX_4.vary({"payload.mass": 2.0, "links.b4": 0.9, **lengths})
    save_design(replace(heavier, name="heavier"), "d.toml")
    words = ["verify", "--design", "d.toml", "--assembly", "mirror", "--poses", "9"]
    assert main([*words, "--preset", "arch", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["design"], found["assembly"]) == ("heavier", "mirror")


def test_a_wrong_mass_in_an_exported_model_fails(motion, capsys) -> None:
    text = mjcf_text(APPENDIX_4)
    Path("right.xml").write_text(text)
    assert 'mass="0.672"' in text
    Path("wrong.xml").write_text(text.replace('mass="0.672"', 'mass="0.673"', 1))
    words = ["verify", "--file", motion, "--poses", "9", "--model"]
    assert main([*words, "right.xml"]) == 0
    assert main([*words, "wrong.xml"]) == 1
    assert capsys.readouterr().out.splitlines()[-1].startswith("FAIL: the largest difference")


def test_a_model_with_meshes_can_be_checked_too(motion, capsys) -> None:
    assert main(["export", "--meshes", "robot"]) == 0
    words = ["verify", "--file", motion, "--poses", "9", "--model", "robot/robot.xml"]
    assert main(words) == 0


def test_figures_are_written_where_they_are_wanted(motion, capsys) -> None:
    words = ["verify", "--file", motion, "--poses", "9", "--figures", "a/b"]
    assert main([*words, "--format", "svg", "--json"]) == 0
    names = {path.name for path in Path("a/b").iterdir()}
    assert {"formulae_mujoco.svg", "formulae_as_printed_mujoco.svg"} <= names
    assert {Path(path).name for path in json.loads(capsys.readouterr().out)["figures"]} == names
    assert b"<svg" in Path("a/b/formulae_mujoco.svg").read_bytes()


def test_without_the_engine_it_says_how_to_get_it(motion, capsys, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert main(["verify", "--file", motion]) == 2
    assert capsys.readouterr().err == (
        "paminsa-viz: MuJoCo is not installed; it comes with the extra 'verify': "
        "pip install 'paminsa-viz[verify]'\n"
    )
