"""``balance``: what it prints is what the model finds, its exit code says whether it can be had."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import pytest

from paminsa_viz.balancing import balance, paper_changes, whole_mass
from paminsa_viz.cli.balance import DESCRIPTION
from paminsa_viz.files.design_file import load_design
from paminsa_viz.model import APPENDIX_4, static_imbalance
from paminsa_viz.trajectory import PRESET, analyze
from tests.support import commands

run = partial(commands.run, "balance")
run_json = partial(commands.run_json, "balance")


def test_the_papers_balance_is_the_default(capsys) -> None:
    code, out, err = run(capsys)
    assert (code, err) == (0, "")
    for text in ("joints.j7", "3.063", "+994 %", "8.349"):
        assert text in out


def test_the_design_is_written_with_its_counterweights(capsys) -> None:
    code, out, _ = run(capsys, "--rail", "b3", "7", "0", "200", "5", "--out", "balanced.toml")
    assert code == 0
    assert out.endswith("balanced.toml: written\n")
    assert "B3, 200 mm beyond joint 7: A steel disc of 43 mm radius there reaches at most" in out
    design = load_design("balanced.toml")
    assert design.name == "balanced"
    assert design.name == "balanced"
    assert abs(static_imbalance(design)) < 1e-14
    assert [weight.beyond for weight in design.counterweights] == [0.2]
    # balanced already: nothing is added
    found = run_json(capsys, "--design", "balanced.toml")
    assert found["objective"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_examples_of_the_help_can_be_had(capsys) -> None:
    lines = re.findall(r"^  paminsa-viz balance(.*)$", DESCRIPTION, re.M)
    assert len(lines) == 4
    for line in lines:
        words, _, _ = line.partition("   ")  # what an example is about stands behind it
        assert run(capsys, *words.split())[0] == 0, words


def test_inertias_follow_masses_that_are_named_and_stay_by_default(capsys) -> None:
    """As the help says."""
    assert run(capsys, "--change", "links.b7", "0.1", "8", "--out", "b7.toml")[0] == 0
    design = load_design("b7.toml")
    grown = design.links.b7 / APPENDIX_4.links.b7
    assert grown > 10
    assert design.inertias.b7_transverse == pytest.approx(
        grown * APPENDIX_4.inertias.b7_transverse, rel=1e-12
    )
    assert not any(mass.inertia_follows for mass in paper_changes(APPENDIX_4).masses)


def test_json_is_the_models_result(capsys) -> None:
    facts = run_json(capsys, "--criterion", "moved")
    found = balance(APPENDIX_4)
    assert facts["changes"] == {
        "joints.j7": {"before": 0.28, "after": pytest.approx(found.after.joints.j7)}
    }
    assert facts["gap"] <= 1e-9
    assert facts["values"][0]["before"] == static_imbalance(APPENDIX_4)


def test_a_goal_on_a_motion_is_reached_within_the_limits(capsys) -> None:
    facts = run_json(
        capsys, "--goal", "rms", "--preset", "arch", "--rail", "b8", "8", "0", "150", "4",
        "--change", "links.b4", "0.4", "0.8", "--max-imbalance", "3", "--max-added", "4",
        "--out", "arch.toml",
    )  # fmt: skip
    design = load_design("arch.toml")
    assert static_imbalance(design) <= 3 + 1e-7
    assert whole_mass(design) - whole_mass(APPENDIX_4) <= 4 + 1e-7
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample()
    rms = [summary.rms**2 for summary in analyze(design, motion).summary[:3]]
    assert facts["objective"] == pytest.approx((sum(rms) / 3) ** 0.5, rel=1e-6)
    assert facts["lower_bound"] == pytest.approx(facts["objective"], rel=1e-7)


FAR = "t_s,x_m,y_m,theta_rad,z_m\n0,0,0,0,-0.5\n1,0.45,0,0,-0.5\n2,0.9,0,0,-0.5\n"


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ("--change joints.j7 0.2 2 --exact", "upper bound of joints.j7 from 2 kg to 3.063 kg"),
        ("--goal peak --file far.csv", "cannot be run"),
    ],
    ids=["bounds", "motion out of reach"],
)
def test_an_impossible_goal_is_exit_code_1_in_one_line(capsys, words, problem) -> None:
    Path("far.csv").write_text(FAR)
    code, out, err = run(capsys, *words.split())
    assert (code, out, err.count("\n")) == (1, "", 1)
    assert problem in err
