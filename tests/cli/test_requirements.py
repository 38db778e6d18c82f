"""``paminsa-viz requirements``."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from tests.support.commands import check_refused, run, run_json

COARSE = ("check", "--coarse", "--theta", "-30", "30")
CYLINDER = ("--cylinder", "200", "300", "--center", "0", "0", "-550")


def test_requirements_that_hold(capsys) -> None:
    code, out, err = run(
        "requirements", capsys, *COARSE, "--require", "condition <= 10",
        "--require", "|tau_1| <= 15 N m", *CYLINDER,
    )  # fmt: skip
    assert (code, err) == (0, "")
    assert out.count("  holds  ") == 4
    assert "cylinder d 200 × 300 mm about x 0 mm, y 0 mm, z -550 mm" in out


def test_broken_requirement_gives_exit_code_1(capsys) -> None:
    words = (*COARSE, "--require", "condition <= 2", *CYLINDER)
    code, out, _ = run("requirements", capsys, *words)
    assert code == 1
    (line,) = (line for line in out.splitlines() if line.startswith("*"))
    assert "condition <= 2" in line
    assert re.search(r"x -?[\d.]+ mm, y -?[\d.]+ mm, theta 0°, z -[\d.]+ mm$", line)


@pytest.mark.slow
def test_volume_with_error_share_and_causes(capsys) -> None:
    words = (*COARSE, "--require", "condition <= 10", "--volume")
    code, out, _ = run("requirements", capsys, *words)
    assert code == 0
    assert re.search(r"hold in [\d.]+ \+- [\d.]+ dm³, [\d.]+ % of [\d.]+ dm³ that", out)
    assert "dm³ that can be reached" in out
    data = run_json("requirements", capsys, *words)
    assert (data["holds"], data["center_m"]) == (True, None)
    assert data["theta_rad"] == pytest.approx([-np.pi / 6, np.pi / 6])
    volume = data["volume"]
    assert 0.09 < volume["volume_m3"] < 0.11
    assert volume["reachable_share"] == pytest.approx(volume["volume_m3"] / volume["reachable_m3"])
    assert sum(volume["shares"].values()) == pytest.approx(1.0)


def test_contradiction_is_named_with_the_nearest_bounds(capsys) -> None:
    words = (*COARSE, "--require", "condition <= 5", "--require", "condition >= 7")
    code, out, _ = run("requirements", capsys, *words, "--require", "f_4 <= 450")
    assert code == 1
    assert "all requirements hold is empty" in out
    assert "No pose meets these together: condition <= 5; condition >= 7" in out
    assert "condition <= 5: would do with at most " in out
    assert "f_4 <= 450 N: " not in out


def test_workspace_that_does_not_fit_names_the_requirement(capsys) -> None:
    words = (*COARSE, "--require", "condition <= 3", "--require", "f_4 <= 450")
    code, out, _ = run("requirements", capsys, *words, "--cylinder", "300", "200")
    assert code == 1
    assert "No place of the workspace meets condition <= 3" in out


def test_requirements_come_from_the_file(folder: Path, capsys) -> None:
    cylinder = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.3), (0.0, 0.0, -0.55))
    given = Requirements((parse_requirement("condition <= 10"),), (-0.5, 0.5), cylinder)
    save_design(APPENDIX_4, folder / "robot.toml", requirements=given)
    for place in (("robot.toml",), ("--design", "robot.toml")):
        code, out, _ = run("requirements", capsys, "check", *place, "--coarse")
        assert code == 0
        assert "condition <= 10" in out
        assert "from theta -28.65° to 28.65°" in out
    code, out, _ = run(
        "requirements", capsys, "check", "robot.toml", "--coarse", "--require", "condition <= 2",
        "--theta", "0", "0",
    )  # fmt: skip
    assert code == 1
    assert "condition <= 2" in out
    assert "workspace, at theta 0°." in out


def test_files_of_the_volume(folder: Path, capsys) -> None:
    names = [f"volume.{kind}" for kind in ("stl", "glb", "csv", "npz")]
    words = [word for name in names for word in ("--out", name)]
    code, out, _ = run("requirements", capsys, *COARSE, "--require", "condition <= 10", *words)
    assert code == 0
    assert all(f"{name}: written" in out for name in names)
    assert (folder / "volume.glb").read_bytes()[:4] == b"glTF"
    with np.load(folder / "volume.npz") as arrays:
        assert arrays["cause"].ndim == 3
    assert "requirement 1: condition <= 10" in (folder / "volume.csv").read_text(encoding="utf-8")


def test_quantities_are_listed(capsys) -> None:
    code, out, _ = run("requirements", capsys, "quantities")
    assert code == 0
    row = next(line for line in out.splitlines() if line.startswith("max_torque"))
    assert "N m" in row
    data = run_json("requirements", capsys, "quantities")
    assert data["condition"]["symbol"] == "κ"


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("check",), "there is no requirement"),
        (("check", "--require", "kondition <= 5"), "did you mean condition"),
        (("check", "--require", "condition"), "a bound"),
        (("check", "robot.toml", "--design", "other.toml"), "exclude each other"),
        (("check", "robot.toml"), "robot.toml"),
        (("check", "--cylinder", "1", "1", "--box", "1", "1", "1"), "exclude each other"),
        (("check", "--center", "0", "0", "0", "--require", "condition <= 5"), "--center"),
        (("check", "--cylinder", "200", "300", "--center", "a", "0", "0"), "'free'"),
        (("check", "--cylinder", "-200", "300"), "--cylinder: lengths above 0 mm"),
        (("check", "--require", "condition <= 5", "--theta", "30", "-30"), "theta"),
        (("check", "--require", "condition <= 5", "--out", "volume.obj"), "--out"),
        (("check", "--coarse", "--require", "condition <= 1", "--out", "v.stl"), "empty"),
    ],
)
def test_bad_input_is_refused_in_one_line(words: tuple[str, ...], place: str, capsys) -> None:
    if words[-1] == "v.stl":
        code, _, err = run("requirements", capsys, *words)
        assert code == 2
        assert place in err
        assert not Path("v.stl").exists()
    else:
        check_refused("requirements", capsys, *words, place=place)


PROVABLE = (
    "--require", "condition <= 10", "--require", "max_torque <= 15 N m", "--require", "f_4 <= 450",
    "--theta", "-30", "30",
)  # fmt: skip
CENTERED = ("--cylinder", "300", "400", "--center", "0", "0", "-600")


@pytest.mark.slow
def test_largest_proven_workspace_with_its_gap(capsys) -> None:
    words = ("largest", *PROVABLE, *CENTERED, "--grow", "horizontal", "--tolerance", "40")
    code, out, err = run("requirements", capsys, *words)
    assert (code, err) == (0, "")
    assert out.startswith('design "Appendix 4"\nLargest proven workspace: cylinder d 3')
    assert "× 400 mm about x 0 mm, y 0 mm, z -600 mm, theta -30° to 30°" in out
    assert "condition <= 10 breaks at x" in out
    data = run_json("requirements", capsys, *words)
    assert data["found"]
    assert 0 < data["gap_m"] <= 0.04
    assert data["limit_m"][0] - data["size_m"][0] == pytest.approx(data["gap_m"])
    assert [item["verdict"] for item in data["evidence"]] == ["proven"] * 6


def test_largest_workspace_that_does_not_exist_gives_exit_code_1(capsys) -> None:
    words = ("largest", "--require", "f_4 <= 100", *CENTERED)
    code, out, _ = run("requirements", capsys, *words)
    assert code == 1
    assert "none: f_4 <= 100 N breaks at x" in out
    words = ("largest", "--require", "condition <= 0.5", "--cylinder", "200", "200")
    code, out, _ = run("requirements", capsys, *words)
    assert code == 1
    assert "none: no position meets all requirements" in out
    assert "'paminsa-viz requirements check' names those that contradict" in out


@pytest.mark.slow
def test_proof_of_a_workspace(capsys) -> None:
    code, out, err = run("requirements", capsys, "prove", *PROVABLE, *CENTERED)
    assert (code, err) == (0, "")
    assert out.startswith('design "Appendix 4"\nRequirements over the cylinder d 300 × 400 mm')
    assert "about x 0 mm, y 0 mm, z -600 mm, theta -30° to 30°: proven" in out
    code, out, _ = run(
        "requirements", capsys, "prove", *PROVABLE, "--require", "|tau_1| <= 1 N m", *CENTERED
    )
    assert code == 1
    assert "broken at x" in out


def test_undecided_answers_name_the_flag_that_may_decide_them(capsys) -> None:
    for command, words, flags in (
        ("prove", ("--time", "1e-6"), "--time"),
        ("largest", ("--time", "1e-6"), "--time or a smaller --tolerance"),
        ("largest", ("--tolerance", "1e5"), "--time or a smaller --tolerance"),
    ):
        code, out, _ = run("requirements", capsys, command, *PROVABLE, *CENTERED, *words)
        assert code == 1
        assert "undecided" in out
        assert f"a longer {flags} may decide it\n" in out


def test_what_is_only_sampled_is_not_called_proven(capsys) -> None:
    words = ("prove", "--require", "condition <= 10", "--require", "error_x <= 100 um", *CENTERED)
    code, out, _ = run("requirements", capsys, *words)
    assert code == 0
    assert "theta 0°: proven, but for requirements that are only sampled\n" in out


def test_a_workspace_beyond_all_reach_is_answered_at_once(capsys) -> None:
    for size in (("--cylinder", "1e9", "100"), ("--box", "100", "100", "1e300")):
        words = ("check", "--coarse", "--require", "condition <= 10", *size)
        code, out, _ = run("requirements", capsys, *words)
        assert code == 1
        assert "No place for the workspace can be reached" in out


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("prove",), "--cylinder"),
        (("prove", "--cylinder", "100", "100"), "--center"),
        (("prove", *CENTERED, "--time", "0"), "--time"),
        (("largest", *CENTERED, "--tolerance", "-1"), "--tolerance"),
        (("largest",), "--cylinder"),
    ],
)
def test_proofs_refuse_what_they_cannot_use(
    capsys, words: tuple[str, ...], place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    check_refused("requirements", capsys, *words, place=place)
