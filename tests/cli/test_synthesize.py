"""``synthesize``: the robot, what decides it, and why there is none."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from paminsa_viz.files.design_file import load_content
from paminsa_viz.synthesis.search.case_file import load_case
from paminsa_viz.synthesis.search.checkpoint import Checkpoint
from paminsa_viz.units import counted
from tests.support.commands import check_refused, run, run_json

CASE = """schema_version = 1
name = "small"
[workspace]
theta_min_rad = -0.3
theta_max_rad = 0.3
shape = "cylinder"
diameter_m = 0.2
height_m = 0.1
[[requirements]]
quantity = "condition"
max = 10.0
[synthesis]
generations = 6
population = 4
[synthesis.ranges]
base_radius_m = [0.2, 0.5]
crank_length_m = [0.2, 0.6]
coupler_length_m = [0.2, 0.8]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(CASE)


@pytest.mark.slow
def test_the_saved_robot_is_that_of_the_answer(capsys) -> None:
    search = ("small.toml", "--allow-overlap")  # its clearance would take longest
    words = (*search, "--out", "best.toml", "--checkpoint", "at.json", "--prove", "2")
    found = run_json("synthesize", capsys, *words)
    assert found["feasible"]
    assert found["regime"] == "R_pl < R_b"
    assert "R_pl > R_b" in found["refused"]
    assert found["proof"] in ("proven", "undecided")
    content = load_content("best.toml")
    assert content.design.geometry.base_radius == found["design"]["geometry.base_radius"]
    assert content.requirements is not None
    assert content.requirements.workspace is not None
    assert list(content.requirements.workspace.center) == found["workspace_center_m"]
    # the checkpoint has the whole search: nothing is tried again
    again = run_json("synthesize", capsys, *words[:-2])
    assert again["trials"] == found["trials"]
    assert again["design"] == found["design"]
    other = run_json("synthesize", capsys, *search, "--seed", "5")
    assert other["design"] != found["design"]


@pytest.mark.slow
def test_overlap_is_allowed_by_name_and_marked(capsys) -> None:
    allowed = run_json("synthesize", capsys, "small.toml", "--allow-overlap", "--out", "a.toml")
    assert allowed["overlap_allowed"]
    assert load_content("a.toml").design.name == "small, overlap allowed"
    assert "clearance" not in str(allowed["requirements"])
    found = run_json("synthesize", capsys, "small.toml", "--out", "b.toml")
    assert not found["overlap_allowed"]
    content = load_content("b.toml")
    assert content.design.name == "small"
    assert any(bound.quantity == "clearance" for bound in content.requirements.bounds)
    robot, reference = (found["buildability"][key] for key in ("robot", "reference"))
    assert robot["clearance_m"] >= 0.001
    assert robot["overlapping"] == 0
    assert robot["guide_m"] >= robot["needed_guide_m"]
    assert robot["shaft_m"] >= robot["needed_shaft_m"]
    assert reference["guide_m"] == 0.3635
    code, out, _ = run("synthesize", capsys, "small.toml", "--allow-overlap")
    assert code == 0
    assert "Overlap was allowed" in out
    for row in (
        "Least clearance as drawn", "Poses that overlap", "Least horizontal stiffness",
        "Least first natural frequency", "Guide B10", "Shaft B2", "Moving mass",
    ):  # fmt: skip
        assert row in out


def test_a_checkpoint_is_there_at_once_and_used_by_one_process(capsys) -> None:
    case = load_case("small.toml")
    with Checkpoint("at.json", case) as first:
        assert first.states == ()
        written = Path("at.json").read_bytes()
        place = "at.json: is being written by another process"
        check_refused("synthesize", capsys, "small.toml", "--checkpoint", "at.json", place=place)
        first.save(())  # a new file is in its place now
        check_refused("synthesize", capsys, "small.toml", "--checkpoint", "at.json", place=place)
    with Checkpoint("at.json", case) as second:
        assert second.states == ()
    assert Path("at.json").read_bytes() == written
    Path("at.json").write_bytes(b"")  # a kill between two steps may leave this
    with Checkpoint("at.json", case):
        assert Path("at.json").read_bytes() == written


@pytest.mark.slow
def test_what_people_read(capsys) -> None:
    code, out, err = run("synthesize", capsys, "small.toml")
    assert (code, err) == (0, "")
    assert "R_pl > R_b is excluded: |R_b - R_pl| has to be above 135.8 mm" in out
    assert "Least footprint radius found" in out
    assert "condition <= 10" in out
    assert "requirements were verified on" in out


@pytest.mark.slow
def test_no_robot_is_a_negative_result_with_its_reason(capsys) -> None:
    text = CASE + "[synthesis.limits]\nfootprint_m = 0.2\n"
    Path("tight.toml").write_text(text)
    code, out, err = run("synthesize", capsys, "tight.toml", "--allow-overlap", "--out", "no.toml")
    assert (code, err) == (1, "")
    assert "R_f <= 200 mm is required" in out
    assert "No robot meets all requirements" in out
    assert not Path("no.toml").exists()
    Path("weak.toml").write_text(
        CASE.replace(
            "[synthesis]\n", '[[requirements]]\nquantity = "f_4"\nmax_N = 50.0\n[synthesis]\n'
        )
    )
    code, out, _ = run("synthesize", capsys, "weak.toml", "--allow-overlap")
    assert code == 1
    assert "would have to be relaxed" in out
    assert "f_4 <= 50 N" in out


@pytest.mark.slow
def test_prices_robots_within_tolerances_and_mujoco(capsys) -> None:
    words = ("small.toml", "--allow-overlap", "--prices", "--built", "12")
    found = run_json("synthesize", capsys, *words)
    labels = [item["label"] for item in found["prices"]]
    assert "height of the workspace" in labels
    assert found["built"]["samples"] == 12
    assert 0 <= found["built"]["low"] <= found["built"]["high"] <= 1
    code, out, _ = run("synthesize", capsys, *words[:2], "--built", "4", "--mujoco")
    assert code == 0
    assert "of 4 robots meet all" in out
    assert "confirms" in out


@pytest.mark.slow
@pytest.mark.usefixtures("without_pictures", "report_of_the_motion")
def test_the_report_is_that_of_the_robot_with_its_search(capsys, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)  # verified elsewhere
    words = ("small.toml", "--allow-overlap", "--seed", "5", "--out", "best.toml")
    words += ("--report", "best.html")  # its maps of the clearance would take longest
    code, out, _ = run("synthesize", capsys, *words, "--json")
    assert (code, json.loads(out)["files"]) == (0, ["best.toml", "best.html"])
    text = Path("best.html").read_text()
    assert "PAMINSA design report: small, overlap allowed" in text
    assert "--seed 5" in text
    section = text[text.index('id="synthesis"') :]
    length = load_content("best.toml").design.geometry.crank_length
    assert f"{1e3 * length:.6g}" in section[: section.index("</section>")]


@pytest.mark.slow
def test_a_front_is_written_point_by_point(capsys) -> None:
    words = ("small.toml", "--allow-overlap", "--points", "2")
    words += ("--front", "footprint", "--front", "moving_mass")
    found = run_json("synthesize", capsys, *words, "--out", "f.toml")
    for number, point in enumerate(found["points"], 1):
        design = load_content(f"f-{number}.toml").design
        assert design.geometry.crank_length == point["numbers"]["geometry.crank_length"]
    code, out, _ = run("synthesize", capsys, *words)
    assert code == 0
    assert f"{counted(len(found['points']), 'Pareto-optimal robot')} by " in out


def test_contradictory_requirements_are_named(capsys) -> None:
    text = CASE.replace("generations = 6", "objective = 'moving_mass'\ngenerations = 6")
    limits = "[synthesis.limits]\nfootprint_m = 0.05\nmoving_mass_kg = 100.0\n"
    Path("none.toml").write_text(text + limits)
    code, out, _ = run("synthesize", capsys, "none.toml", "--conflict")
    assert code == 1
    assert "contradict, proven in closed form:\nfootprint <= 50 mm\n" in out


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("--out", "x.csv"), "--out"),
        (("--checkpoint", "x.csv"), "--checkpoint"),
        (("--objective", "beauty"), "objective"),
        (("--workers", "0"), "workers"),
        (("--workers", "2", "--dask", "tcp://x:1"), "--dask"),
        (("--prove", "-1"), "--prove"),
        (("--generations", "0"), "generations"),
        (("--built", "0"), "--built 0"),
        (("--mass-tolerance", "100"), "--mass-tolerance"),
        (("--front", "footprint"), "at least two"),
        (("--front", "footprint", "--front", "beauty"), "are known"),
        (("--front", "footprint", "--front", "volume", "--prices"), "--front excludes"),
        (
            ("--front", "footprint", "--front", "volume", "--checkpoint", "a.json"),
            "--front excludes",
        ),
        (("--front", "footprint", "--front", "volume", "--report", "a.html"), "--front excludes"),
        (("--report", "a.pdf"), "--report"),
    ],
)
def test_flags_that_make_no_sense_are_refused(words, place, capsys) -> None:
    check_refused("synthesize", capsys, "small.toml", *words, place=place)
