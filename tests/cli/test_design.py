"""``design``: check, show, default, diff."""

from __future__ import annotations

import json

import pytest

from paminsa_viz.cli import main
from paminsa_viz.files.design_file import load_design, read_design, save_design
from paminsa_viz.files.design_schema import KEYS, TABLES
from paminsa_viz.model.design import APPENDIX_4, PARAMETERS, KneeBranch

OTHER = APPENDIX_4.vary({"links.b3": 0.203, "payload.mass": 2.0})


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return save_design(OTHER, "d.toml")


def test_default_is_appendix_4_on_the_screen_and_in_a_file(file, capsys) -> None:
    assert main(["design", "default"]) == 0
    assert read_design(capsys.readouterr().out, "screen") == APPENDIX_4
    assert main(["design", "default", "--out", "new.toml"]) == 0
    assert load_design("new.toml") == APPENDIX_4
    assert capsys.readouterr().out == "new.toml: written\n"


def test_check_goes_through_all_files(file, capsys) -> None:
    assert main(["design", "check", "d.toml"]) == 0
    assert capsys.readouterr().out == (
        'd.toml: fine, "Appendix 4", 2 values differ from Appendix 4\n'
    )
    with open("bad.toml", "w") as bad:
        bad.write("schema_version = 1\nnam = 2\n")
    assert main(["design", "check", "bad.toml", "none.toml", "d.toml"]) == 2
    said = capsys.readouterr()
    assert said.out.startswith("d.toml: fine")
    first, second = said.err.splitlines()
    assert first.startswith("paminsa-viz: bad.toml, line 2, nam: ")
    assert second.startswith("paminsa-viz: none.toml: cannot be read")
    assert main(["design", "check"]) == 2


def test_show_prints_every_number(file, capsys) -> None:
    assert main(["design", "show", "d.toml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "Appendix 4"
    knee = lines.pop(1 + len(TABLES["geometry"]))
    assert knee.split()[:3] == ["geometry", "knee", "printed"]
    (frame,) = [line for line in lines if line.split()[:3] == ["load", "frame", "world"]]
    lines.remove(frame)
    for line, key in zip(lines[1:], KEYS, strict=True):
        words = line.split()
        assert key.name in words
        assert f"{OTHER.value(key.parameter.path):.10g}" in words
    assert main(["design", "show", "d.toml", "--json"]) == 0
    values = json.loads(capsys.readouterr().out)["values"]
    assert values == {key.path: OTHER.value(key.parameter.path) for key in KEYS}
    assert main(["design", "show", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["values"].values()) == [
        parameter.default for parameter in PARAMETERS
    ]


def test_another_branch_of_the_knee_is_a_difference(file, capsys) -> None:
    save_design(APPENDIX_4.with_knee(KneeBranch.UPPER), "upper.toml")
    assert main(["design", "check", "upper.toml"]) == 0
    assert "1 value differs" in capsys.readouterr().out
    assert main(["design", "diff", "upper.toml"]) == 0
    (row,) = capsys.readouterr().out.splitlines()[1:]
    assert row.split()[:4] == ["geometry", "knee", "printed", "mirror"]
    assert main(["design", "diff", "upper.toml", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["differences"] == {
        "geometry.knee": {"first": "printed", "second": "mirror"}
    }


def test_diff_compares_with_appendix_4_or_another_file(file, capsys) -> None:
    save_design(APPENDIX_4, "a.toml")
    assert main(["design", "diff", "d.toml"]) == 0
    head, load, *rest = sorted(capsys.readouterr().out.splitlines())
    assert head.split() == ["Appendix", "4", "d.toml", "change"]
    assert load.split()[:5] == ["links", "b3_kg", "0.406", "0.203", "-50"]
    assert rest[0].split()[:4] == ["payload", "mass_kg", "0", "2"]
    assert main(["design", "diff", "d.toml", "a.toml", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["differences"] == {
        "links.b3_kg": {"first": 0.203, "second": 0.406},
        "payload.mass_kg": {"first": 2.0, "second": 0.0},
    }
    assert main(["design", "diff", "a.toml"]) == 0
    assert capsys.readouterr().out == "the designs have the same values\n"
