"""Cases and their files: what is read, and what is refused with its line."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.balancing import (
    CounterweightRange,
    MassRange,
    SpringPlace,
    at_joint,
    on_bar,
    on_guide,
    on_slider,
)
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import APPENDIX_4, BarLaw
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Effort, Guide, ObjectiveLimit, Regime, SearchRange, SynthesisCase
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.synthesis.search.case_file import EXAMPLES, RATE, load_case, read_case
from tests.synthesis.search_cases import CELL, CYLINDER, arch_case

HEAD = """schema_version = 1
name = "mine"
[workspace]
shape = "cylinder"
diameter_m = 0.3
height_m = 0.4
"""


def test_worked_cases_are_those_of_the_tests() -> None:
    assert load_case(EXAMPLES["cylinder"], allow_overlap=True) == CYLINDER
    stronger = (*CELL.requirements.bounds[:2], Requirement("f_4", high=500.0))
    required = replace(CELL.requirements, bounds=stronger)
    assert load_case(EXAMPLES["cell"], allow_overlap=True) == replace(CELL, requirements=required)


def test_bodies_may_not_overlap_unless_it_is_said() -> None:
    apart = Requirement("clearance", low=0.001)
    case = load_case(EXAMPLES["cylinder"])
    assert case.clear
    assert not case.allow_overlap
    assert case.requirements.bounds == (*CYLINDER.requirements.bounds, apart)
    assert replace(case, seed=1).requirements == case.requirements  # it is added once
    text = f"{HEAD}[synthesis]\n{{}}{RANGES}"
    assert not read_case(text.format("allow_overlap = true\n"), "mine.toml").clear
    (wide,) = read_case(text.format("clearance_m = 0.004\n"), "mine.toml").requirements.bounds
    assert wide == replace(apart, low=0.004)
    own = f'{HEAD}[[requirements]]\nquantity = "clearance"\nmin_m = 0.02\n[synthesis]\n{RANGES}'
    assert read_case(own, "mine.toml").requirements.bounds == (replace(apart, low=0.02),)
    bars = read_case(text.format("tubes_grow = true\ntube_masses = true\n"), "mine.toml").bars
    assert bars == BarLaw(grow=True, tubes=True)
    with pytest.raises(DesignFileError, match=r"line 8.*scale_bars"):
        read_case(text.format("scale_bars = false\ntubes_grow = true\n"), "mine.toml")


def test_all_keys() -> None:
    text = (
        HEAD
        + """
[links]
b3_kg = 0.5
[synthesis]
objective = "moving_mass"
margin_m = 0.005
guide = "kept"
scale_bars = false
arm_follows = false
shaft_follows = false
clearance_m = 0.003
above_guides = true
regimes = ["larger"]
seed = 7
generations = 90
population = 5
[synthesis.ranges]
base_radius_m = [0.1, 0.6]
guide_link_length_m = [0.1, 0.5]
workspace_z_m = [-0.9, -0.4]
[synthesis.limits]
footprint_m = 0.7
"""
    )
    workspace = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4), (0.0, 0.0, None))
    expected = SynthesisCase(
        Requirements((), (0.0, 0.0), workspace),
        (
            SearchRange("geometry.base_radius", 0.1, 0.6),
            SearchRange("geometry.guide_link_length", 0.1, 0.5),
            SearchRange("workspace.z", -0.9, -0.4),
        ),
        APPENDIX_4.vary({"links.b3": 0.5}),
        "moving_mass", (ObjectiveLimit("footprint", 0.7),), BarLaw(follow=False), Guide.KEPT,
        arm_follows=False, shaft_follows=False, clearance=0.003, margin=0.005, above_guides=True,
        regimes=(Regime.LARGER,), seed=7, effort=Effort(90, 5),
    )  # fmt: skip
    found = read_case(text, "mine.toml")
    assert found == expected
    assert found.name == "mine"


def test_what_a_file_leaves_out_is_what_the_documentation_says() -> None:
    """Each default of its table, written into the file, makes the case that is there without it."""
    plain = read_case(f"{HEAD}[synthesis]\n{RANGES}", "mine.toml")
    page = Path(__file__).parents[2] / "docs" / "synthesis.md"
    rows = re.findall(r"^\| (`[a-z_`, ]+`) \| ([^|]+) \|", page.read_text("utf-8"), re.MULTILINE)
    given = {
        key: value
        for names, values in rows
        for key, value in zip(re.findall(r"[a-z_]+", names), values.split(","), strict=True)
        if value.strip() not in ("", "both")
    }
    assert len(given) == 14
    for key, value in given.items():
        text = value.strip().strip("`")
        text = text if re.fullmatch(r"true|false|[\d.]+", text) else f'"{text}"'
        assert read_case(f"{HEAD}[synthesis]\n{key} = {text}\n{RANGES}", "mine.toml") == plain
    assert plain.regimes == tuple(Regime)


RANGES = "[synthesis.ranges]\nbase_radius_m = [0.1, 0.6]\n"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", None, "[synthesis] is needed"),
        ("[synthesis]\nobjective = 'x'\n" + RANGES, 8, "footprint, moving_mass"),
        ("[synthesis]\nobjective = 3\n", 8, "a word is needed"),
        ("[synthesis]\nobjectiv = 'x'\n", 8, "did you mean objective?"),
        ("[synthesis]\nguide = 'x'\n" + RANGES, 8, '"follows" or "kept"'),
        ("[synthesis]\nregimes = ['x']\n" + RANGES, 8, '"smaller" or "larger"'),
        ("[synthesis]\nregimes = []\n" + RANGES, 8, "at least one"),
        ("[synthesis]\nseed = true\n", 8, "whole number is needed"),
        ("[synthesis]\nmargin_m = -1.0\n" + RANGES, 8, "at least 0"),
        ("[synthesis]\ngenerations = 0\n" + RANGES, 8, "1 to 100000"),
        ("[synthesis]\n", 7, "at least one length"),
        ("[synthesis.ranges]\nbase_radius = [0.1, 0.6]\n", 8, "did you mean base_radius_m?"),
        ("[synthesis.ranges]\nbase_radius_m = [0.6, 0.1]\n", 8, "low < high"),
        ("[synthesis.ranges]\nbase_radius_m = [0.1]\n", 8, "[least, largest]"),
        ("[synthesis.ranges]\nbase_radius_m = [0.1, 'b']\n", 8, "two numbers are needed"),
        ("[synthesis.ranges]\nguide_link_length_m = [0.1, 0.2]\n", 8, 'guide = "kept"'),
        ("[synthesis.ranges]\narm_length_m = [0.1, 0.2]\n", 8, "arm_follows = false"),
        ("[synthesis]\n" + RANGES + "[synthesis.limits]\nfootprint = 0.5\n", 11, "footprint_m"),
    ],
)
def test_what_is_refused(text: str, line: int | None, words: str) -> None:
    with pytest.raises(DesignFileError) as error:
        read_case(HEAD + text, "mine.toml")
    assert error.value.line == line
    assert words in str(error.value)


def test_a_workspace_is_needed() -> None:
    with pytest.raises(DesignFileError, match="workspace"):
        read_case("schema_version = 1\n[synthesis]\n" + RANGES, "mine.toml")


@pytest.mark.parametrize(
    "make",
    [
        lambda: replace(CYLINDER, requirements=Requirements()),
        lambda: replace(CYLINDER, ranges=CYLINDER.ranges[:1] * 2),
        lambda: replace(CYLINDER, objective="beauty"),
        lambda: replace(CYLINDER, margin=np.nan),
        lambda: replace(CYLINDER, regimes=()),
        lambda: SearchRange("links.b3", 0.1, 0.2),
        lambda: SearchRange("geometry.base_radius", 0.0, 0.2),
        lambda: SearchRange("geometry.base_radius", 0.1, np.inf),
        lambda: ObjectiveLimit("footprint", np.inf),
        lambda: ObjectiveLimit("beauty", 1.0),
        lambda: Effort(0),
        lambda: Effort(10, 3),
    ],
    ids=count(),
)
def test_impossible_cases_are_rejected(make) -> None:
    with pytest.raises(InvalidInput):
        make()


def test_heights_follow_from_the_longest_bars() -> None:
    height = CYLINDER.ranges[-1]
    assert height.path == "workspace.z"
    # the top of the workspace is at the guides or below, its center no deeper than the bars reach
    assert (height.low, height.high) == pytest.approx((-1.7 - 0.0275, -0.2 - 0.0275))


TEXT = EXAMPLES["arch"].read_text("utf-8")
MORE = """
[[synthesis.masses]]
mass = "links.b8"
factor = [0.5, 2]

[[synthesis.masses]]
mass = "joints.j9"
range_kg = [0.1, 0.2]
inertia_follows = false

[[synthesis.springs]]
first = { kind = "slider", height_m = 0.3 }
second = { kind = "joint", joint = 9 }
max_stiffness_N_per_m = 2000.0
free_length_m = [0.0, 0.2]

[[synthesis.springs]]
first = { kind = "bar", bar = "b4", joint = 9, beyond_m = 0.1 }
second = { kind = "guide", radius_m = 0.05, height_m = -0.2 }
max_stiffness_N_per_m = 100
"""


def test_the_arch_goes_there_and_back_about_the_center():
    inner = arch_case().inner
    (motion,) = inner.motions
    assert inner.from_center
    assert inner.motion_force == 300.0
    assert motion.t[-1] - motion.t[0] == pytest.approx(2.0)
    extent = np.ptp(motion.pose, axis=0)
    np.testing.assert_allclose(extent, [0.3, 0.0, np.radians(60.0), 0.1], atol=1e-3)
    np.testing.assert_allclose(motion.pose[0], motion.pose[-1], atol=1e-12)
    assert motion.pose[:, 3].max() == pytest.approx(0.05, abs=1e-3)
    assert inner.counterweights == (
        CounterweightRange("b8", 8, 0.2, 0.2, 4.0), CounterweightRange("b3", 7, 0.2, 0.2, 4.0)
    )  # fmt: skip


def test_masses_and_springs_are_read():
    inner = read_case(TEXT + MORE, "arch.toml").inner
    assert inner.masses == (
        MassFactor("links.b8", 0.5, 2.0),
        MassRange("joints.j9", 0.1, 0.2, inertia_follows=False),
    )
    first, second = inner.springs
    assert (first.first, first.second) == (on_slider(0.3), at_joint(9))
    assert (first.max_stiffness, first.min_free_length, first.max_free_length) == (2000, 0, 0.2)
    assert second == SpringPlace(on_bar("b4", 9, 0.1), on_guide(0.05, -0.2), 100.0, 0.0, 0.0)
    assert inner.goal == "peak_torque"


STILL = f"""{HEAD}
[[counterweights]]
bar = "b8"
joint = 8
beyond_m = 0.1
mass_kg = 0.7
[synthesis.ranges]
base_radius_m = [0.1, 0.6]
"""


def test_what_a_file_leaves_out_of_masses_and_motions() -> None:
    """Nothing is to be carried fast: the moving mass counts; motions are straight and one way."""
    own = read_case(
        f'{STILL}[[synthesis.masses]]\nmass = "counterweights.0.mass"\nfactor = [0, 2]', ""
    )
    assert own.inner == InnerCase(
        "moving_mass", (), (MassFactor("counterweights.0.mass", 0.0, 2.0),), from_center=True
    )
    move = "[[synthesis.motions]]\nfrom = [0, 0, 0, 0]\nto = [0.1, 0, 0.2, 0]\nduration_s = 0.5\n"
    inner = read_case(STILL + move, "mine.toml").inner
    assert inner is not None
    (motion,) = inner.motions
    assert (inner.goal, motion.t[-1]) == ("peak_torque", 0.5)
    assert np.diff(motion.t) == pytest.approx(np.full(len(motion.t) - 1, 1 / RATE))
    assert motion.pose[-1].tolist() == pytest.approx([0.1, 0.0, 0.2, 0.0])
    assert np.ptp(motion.pose[:, 3]) == 0.0
    for wrong in ("counterweights.0.beyond", "inertias.b8_axial", "payload.mass_"):
        text = f'{STILL}[[synthesis.masses]]\nmass = "{wrong}"\nfactor = [0, 2]'
        with pytest.raises(DesignFileError, match=r"no mass of the design|no design value"):
            read_case(text, "mine.toml")


def test_a_file_without_them_has_none():
    assert read_case(EXAMPLES["cylinder"].read_text("utf-8"), "cylinder.toml").inner is None


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("duration_s = 1.0", "duration_s = -1.0", "are possible, not -1"),
        ("duration_s = 1.0", 'duration_s = "1"', "a number is needed"),
        ("arch_m = 0.1", "arc_m = 0.1", "no such key"),
        ("from = [-0.15, 0.0, ", "from = [-0.15, ", "4 numbers"),
        ("joint = 8", "joint = 5", "joints"),
        ("force_N = 300.0", "force_N = -1.0", "at least 0"),
        ('mass = "links.b8"', 'mass = "links.b99"', "no design value"),
        ('mass = "links.b8"', 'mass = "gravity"', "no mass of the design"),
        ("factor = [0.5, 2]", "factor = [2, 0.5]", "factors"),
        ('kind = "slider"', 'kind = "ceiling"', "ceiling"),
        ('objective = "peak_torque"', 'objective = "static_torque"', "M_p2 = 0"),
        ("[[synthesis.motions]]", "[[synthesis.motion]]", "did you mean motions"),
    ],
)
def test_wrong_entries_are_refused_with_the_reason(old, new, match):
    text = TEXT + MORE
    assert old in text
    with pytest.raises(DesignFileError, match=match):
        read_case(text.replace(old, new), "arch.toml")


def test_overlap_can_be_allowed_and_forbidden_again_later() -> None:
    strict = replace(CYLINDER, allow_overlap=False)
    assert strict.clear
    assert replace(strict, allow_overlap=True) == CYLINDER
    assert replace(replace(strict, allow_overlap=True), allow_overlap=False) == strict
    required = Requirement("clearance", low=0.02)  # a person's own bound stays
    own = replace(CYLINDER.requirements, bounds=(*CYLINDER.requirements.bounds, required))
    assert required in replace(CYLINDER, requirements=own).requirements.bounds
