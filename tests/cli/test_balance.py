"""``balance``: what it prints is what the model finds, its exit code says whether it can be had."""

from __future__ import annotations

import json
from functools import partial

import pytest

from paminsa_viz.balancing import balance, whole_mass
from paminsa_viz.cli import COMMANDS, main
from paminsa_viz.files.design_file import load_design
from paminsa_viz.model import APPENDIX_4, static_imbalance
from paminsa_viz.trajectory import PRESET, analyze
from tests.support import commands

run = partial(commands.run, "balance")

RAIL = ("--rail", "b3", "7", "0", "200", "5")


def test_the_papers_balance_is_the_default(capsys) -> None:
    assert "balance" in COMMANDS
    code, out, err = run(capsys)
    assert (code, err) == (0, "")
    assert "joints.j7" in out
    assert "+2.783" in out
    assert "8.349" in out


def test_the_design_is_written_with_its_counterweights(capsys) -> None:
    code, out, _ = run(capsys, *RAIL, "--out", "balanced.toml")
    assert code == 0
    assert "balanced.toml: written" in out
    assert "B3, 200 mm beyond joint 7" in out
    assert "B3, 200 mm beyond joint 7: A steel disc of 43 mm radius there reaches at most" in out
    design = load_design("balanced.toml")
    assert design.name == "balanced"
    assert abs(static_imbalance(design)) < 1e-14
    assert [weight.beyond for weight in design.counterweights] == [0.2]
    assert main(["design", "show", "balanced.toml"]) == 0
    assert "200 mm beyond joint 7" in capsys.readouterr().out
    assert main(["design", "diff", "balanced.toml"]) == 0
    assert "1.14594 kg on B3" in capsys.readouterr().out
    assert main(["design", "check", "balanced.toml"]) == 0
    assert "1 value differs" in capsys.readouterr().out
    assert main(["design", "diff", "balanced.toml", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["counterweights"]
    assert (told["first"], told["second"][0]["mass"]) == ([], design.counterweights[0].mass)
    # balanced already: nothing is added
    code, out, _ = run(capsys, "--design", "balanced.toml", "--json")
    assert json.loads(out)["objective"] == pytest.approx(0.0, abs=1e-12)


def test_json_is_what_the_model_finds(capsys) -> None:
    code, out, _ = run(capsys, "--criterion", "moved", "--json")
    assert code == 0
    told = json.loads(out)
    found = balance(APPENDIX_4)
    assert told["changes"] == {
        "joints.j7": {"before": 0.28, "after": pytest.approx(found.after.joints.j7)}
    }
    assert told["gap"] <= 1e-9
    assert told["values"][0]["before"] == static_imbalance(APPENDIX_4)


def test_goals_on_a_motion(capsys) -> None:
    words = (
        "--goal", "rms", "--preset", "arch", "--rail", "b8", "8", "0", "150", "4",
        "--change", "links.b4", "0.4", "0.8", "--max-imbalance", "3", "--max-added", "4",
        "--out", "arch.toml",
    )  # fmt: skip
    code, _, err = run(capsys, *words)
    assert (code, err) == (0, "")
    design = load_design("arch.toml")
    assert static_imbalance(design) <= 3 + 1e-7
    assert whole_mass(design) - whole_mass(APPENDIX_4) <= 4 + 1e-7
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample()
    rms = [summary.rms**2 for summary in analyze(design, motion).summary[:3]]
    code, out, _ = run(capsys, *words, "--json")
    told = json.loads(out)
    assert told["objective"] == pytest.approx((sum(rms) / 3) ** 0.5, rel=1e-6)
    assert told["lower_bound"] == pytest.approx(told["objective"], rel=1e-7)


def test_what_the_bounds_do_not_allow(capsys) -> None:
    words = ("--change", "joints.j7", "0.2", "2")
    assert run(capsys, *words)[0] == 0
    code, out, err = run(capsys, *words, "--exact")
    assert (code, out) == (1, "")
    assert "raise the upper bound of joints.j7 from 2 kg to 3.063 kg" in err
    assert len(err.splitlines()) == 1


def test_a_motion_out_of_reach(capsys) -> None:
    with open("far.csv", "w") as file:
        file.write("t_s,x_m,y_m,theta_rad,z_m\n0,0,0,0,-0.5\n1,0.45,0,0,-0.5\n2,0.9,0,0,-0.5\n")
    code, _, err = run(capsys, "--goal", "peak", "--file", "far.csv")
    assert code == 1
    assert "cannot be run" in err
