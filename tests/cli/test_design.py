"""``design``: check, show, default, diff."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.cli import main
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_file import load_design, read_design, save_design
from paminsa_viz.files.design_schema import KEYS
from paminsa_viz.model import APPENDIX_4, PARAMETER, PARAMETERS, KneeBranch, inverse_dynamics
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from tests.support import commands

run = partial(commands.run, "design")
run_json = partial(commands.run_json, "design")

OTHER = APPENDIX_4.vary({"links.b3": 0.203, "payload.mass": 2.0})
UPPER = APPENDIX_4.with_knee(KneeBranch.UPPER)
WEIGHTED = replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.2, 1.5),))


@pytest.fixture(autouse=True)
def designs(folder) -> None:
    """Designs in files."""
    for name, design in {"d": OTHER, "a": APPENDIX_4, "u": UPPER, "w": WEIGHTED}.items():
        save_design(design, f"{name}.toml")


def test_default_is_appendix_4_on_the_screen_and_in_a_file(capsys) -> None:
    assert read_design(run(capsys, "default")[1], "screen") == APPENDIX_4
    assert run(capsys, "default", "--out", "new.toml")[1] == "new.toml: written\n"
    assert load_design("new.toml") == APPENDIX_4


def test_check_goes_through_all_files(capsys) -> None:
    code, out, err = run(capsys, "check", "d.toml", "a.toml", "u.toml", "w.toml")
    assert (code, err) == (0, "")
    assert [line.rpartition('", ')[2] for line in out.splitlines()] == [
        "2 values differ from Appendix 4", "as Appendix 4",
        "1 value differs from Appendix 4", "1 value differs from Appendix 4",
    ]  # fmt: skip
    Path("bad.toml").write_text("schema_version = 1\nnam = 2\n")
    code, out, err = run(capsys, "check", "bad.toml", "none.toml", "d.toml")
    assert code == 2
    assert out.startswith('d.toml: fine, "Appendix 4, changed"')
    first, second = err.splitlines()
    assert first.startswith("paminsa-viz: bad.toml, line 2, nam: ")
    assert second.startswith("paminsa-viz: none.toml: cannot be read")


@pytest.mark.slow
def test_numbers_of_a_design_that_is_fine_do_not_overflow() -> None:
    draw = random.Random(1)
    for _ in range(1000):
        chosen = draw.sample(PARAMETERS, draw.randint(1, len(PARAMETERS)))
        values = {p.path: draw.choice([0.0, 1e-300, 1e-30, 1e-6, 1.0, p.largest]) for p in chosen}
        try:
            design = APPENDIX_4.vary(values)
        except InvalidDesign:
            continue
        found = inverse_dynamics(design, home_pose(design.geometry), np.ones(4), np.ones(4))
        assert found.status != 0 or np.isfinite(found.torque).all(), values


def test_show_prints_every_number(capsys) -> None:
    code, out, _ = run(capsys, "show", "d.toml")
    assert code == 0
    lines = [" ".join(line.split()) for line in out.splitlines()]
    values = {key.path: OTHER.value(key.parameter.path) for key in KEYS}
    texts = {key: f"{v:.10g}" if v < math.inf else "rigid" for key, v in values.items()}
    wanted = [f"{key.table} {key.name} {texts[key.path]} ".lstrip() for key in KEYS]
    for words in (*wanted, "geometry knee lower ", "load frame world "):
        assert sum(line.startswith(words) for line in lines) == 1, words
    shown = run_json(capsys, "show", "d.toml")
    assert shown["values"] == {
        key: value if value < math.inf else None for key, value in values.items()
    }
    assert (shown["name"], shown["knee"], shown["load_frame"]) == (
        "Appendix 4, changed",
        "lower",
        "world",
    )
    assert list(run_json(capsys, "show")["values"].values()) == [
        p.default if p.default < math.inf else None for p in PARAMETER.values()
    ]
    assert "200 mm beyond joint 7" in run(capsys, "show", "w.toml")[1]


def test_stiffness_that_was_rigid_has_no_change_in_percent(capsys) -> None:
    save_design(APPENDIX_4.vary({"elastic.guide": 1e7, "elastic.b4_outer": 0.06}), "e.toml")
    _, out, _ = run(capsys, "diff", "e.toml")
    rows = [" ".join(line.split()) for line in out.splitlines()[1:]]
    assert rows[0].startswith("elastic guide_N_per_m rigid 10000000 - k_g")
    assert rows[1].startswith("elastic b4_outer_m 0.04 0.06 +50.0 %")
    # the tube's values follow from its diameter
    assert len(rows) == 6
    found = run_json(capsys, "diff", "e.toml")["differences"]["elastic.guide_N_per_m"]
    assert found == {"first": None, "second": 1e7}


@pytest.mark.parametrize(
    ("files", "rows", "differences"),
    [
        ("d.toml", ["links b3_kg 0.406 0.203 -50.0 %", "payload mass_kg 0 2 new"],
         {"links.b3_kg": (0.406, 0.203), "payload.mass_kg": (0.0, 2.0)}),
        ("d.toml a.toml", ["links b3_kg 0.203 0.406 +100 %", "payload mass_kg 2 0 -100 %"],
         {"links.b3_kg": (0.203, 0.406), "payload.mass_kg": (2.0, 0.0)}),
        ("u.toml", ["geometry knee lower upper "], {"geometry.knee": ("lower", "upper")}),
        ("w.toml", ["counterweights mass_kg 0 1.5 new B3, 200 mm"], {}),
    ],
    ids=["appendix 4", "another file", "knee", "counterweight"],
)  # fmt: skip
def test_diff_shows_what_differs(capsys, files, rows, differences) -> None:
    code, out, _ = run(capsys, "diff", *files.split())
    assert code == 0
    found = [" ".join(line.split()) for line in out.splitlines()[1:]]
    assert len(found) == len(rows)
    assert all(line.startswith(row) for line, row in zip(found, rows, strict=True))
    found = run_json(capsys, "diff", *files.split())
    assert found["differences"] == {
        key: {"first": first, "second": second} for key, (first, second) in differences.items()
    }
    assert ("counterweights" in found) == (files == "w.toml")


@pytest.mark.slow  # it loads volumes and proofs
def test_diff_shows_what_one_file_requires_alone(capsys) -> None:
    bound = Requirement("condition", high=8.0)
    place = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.1))
    for name, needed in (
        ("one", Requirements((bound, Requirement("max_torque", high=15.0)), (-0.3, 0.3))),
        ("two", Requirements((bound, Requirement("max_torque", high=5.0)), (-0.3, 0.3), place)),
    ):
        save_design(APPENDIX_4, f"{name}.toml", requirements=needed)
    out = run(capsys, "diff", "one.toml", "two.toml")[1]
    assert [" ".join(line.split()) for line in out.splitlines()] == [
        "the designs have the same values",
        "",
        "Requirement one.toml two.toml",
        "max_torque <= 15 N m required -",
        "max_torque <= 5 N m - required",
        "workspace cylinder d 200 × 100 mm about x 0 mm, y 0 mm, z free - required",
    ]
    found = run_json(capsys, "diff", "a.toml", "one.toml")["requirements"]
    assert found["first"] == []
    assert found["second"][0] == "condition <= 8"
    assert len(found["second"]) == 3


def test_equal_designs_have_no_differences(capsys) -> None:
    assert run(capsys, "diff", "a.toml")[1] == "the designs have the same values\n"
    assert main(["design", "diff", "a.toml", "a.toml", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["differences"] == {}
