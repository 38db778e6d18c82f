"""``verify``: the verdict, its exit code, its figures, and one line for whatever is wrong."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from paminsa_viz.cli import main
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from tests.support import commands

pytestmark = pytest.mark.slow


QUICK = ("--file", "motion.csv", "--poses", "9")

run = partial(commands.run, "verify")
run_json = partial(commands.run_json, "verify")


@pytest.fixture(autouse=True)
def motion(folder, mujoco) -> None:
    commands.write_short_motion(Path("motion.csv"))


def test_a_pass_is_shown_in_a_table(capsys) -> None:
    code, out, _ = run(capsys, *QUICK)
    assert code == 0
    assert out.startswith('design "Appendix 4", lower knee, motion "')
    for text in (
        "\nPassed: the largest difference between", "9 random poses at rest and 31 states",
        "Formulas and MuJoCo", "At rest", "Moving", "τ₁", "F₄", "Eq. 14: signs of sin²ψ",
        "MuJoCo ran 0.3 s",
    ):  # fmt: skip
        assert text in out


def test_json_holds_the_same(capsys) -> None:
    found = run_json(capsys, *QUICK, "--seed", "5")
    assert found["passed"] is True
    assert (found["static_poses"], found["dynamic_states"], found["seed"]) == (9, 31, 5)
    assert [row["actuator"] for row in found["engines"][0]["dynamic"]][3] == "F_4"
    assert found["worst_relative"] < 1e-10
    assert found["as_published"]["ALL"][0]["max_relative"] > 1e-3


def test_another_design_with_the_upper_knee_passes(capsys) -> None:
    lengths = {"geometry.magnification": 2.6, "geometry.crank_length": 0.45}
    heavier = APPENDIX_4.vary({"payload.mass": 2.0, "links.b4": 0.9, **lengths})
    save_design(replace(heavier, name="heavier"), "d.toml")
    found = run_json(capsys, *QUICK, "--design", "d.toml", "--knee", "upper")
    assert (found["design"], found["knee"]) == ("heavier", "upper")


@pytest.mark.parametrize(
    ("mass", "tolerance", "code"),
    [("0.672", "1e-6", 0), ("0.673", "1e-6", 1), ("0.673", "0.1", 0), ("6.72", "0.1", 1)],
)
def test_a_wrong_mass_in_a_model_fails_beyond_the_tolerance(capsys, mass, tolerance, code) -> None:
    text = mjcf_text(APPENDIX_4)
    assert 'mass="0.672"' in text
    Path("model.xml").write_text(text.replace('mass="0.672"', f'mass="{mass}"', 1))
    found, out, _ = run(capsys, *QUICK, "--model", "model.xml", "--tolerance", tolerance)
    assert found == code
    assert f"\n{'Failed' if code else 'Passed'}: the largest difference" in out


def test_a_model_with_meshes_can_be_checked_too(capsys) -> None:
    assert main(["export", "--meshes", "robot"]) == 0
    assert run(capsys, *QUICK, "--model", "robot/robot.xml")[0] == 0


def test_figures_are_written_into_their_folder(capsys) -> None:
    found = run_json(capsys, *QUICK, "--figures", "a/b", "--format", "svg")
    names = {path.name for path in Path("a/b").iterdir()}
    assert {"formulas_mujoco.svg", "formulas_as_published_mujoco.svg"} <= names
    assert {Path(path).name for path in found["files"]} == names
    assert b"<svg" in Path("a/b/formulas_mujoco.svg").read_bytes()


def test_without_the_engine_the_line_says_how_to_install_it(capsys, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    code, _, err = run(capsys, *QUICK)
    assert code == 2
    assert err == (
        "paminsa-viz: MuJoCo is not installed; it is part of the installation: pip install mujoco\n"
    )


def test_report_is_a_page(capsys) -> None:
    """What is in it is tested with the claims."""
    code, _, err = run(capsys, *QUICK, "--report", "claims.txt")
    assert code == 2
    assert "--report" in err
