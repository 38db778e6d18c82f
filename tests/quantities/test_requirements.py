"""Requirements: bounds on quantities over a workspace, and their text, there and back."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, solve_field, static_torques, xy_grid
from paminsa_viz.model.load import LoadCase
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirement_text import (
    ascii_unit,
    parse_requirement,
    requirement_label,
    requirement_text,
    shape_text,
)
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape

FINITE = st.floats(-1e6, 1e6)


@given(st.tuples(FINITE, FINITE).map(sorted), FINITE)
def test_margin_is_positive_inside_the_bounds_alone(bounds, value):
    low, high = bounds
    margin = Requirement("tau_1", low, high).margin(value)
    assert (margin >= 0) == (low <= value <= high)
    assert margin == min(value - low, high - value)


def test_margin_of_one_bound_is_the_distance_to_it():
    values = np.array([2.0, 10.0, 12.0, np.nan, np.inf])
    np.testing.assert_array_equal(
        Requirement("condition", high=10.0).margin(values), [8.0, 0.0, -2.0, np.nan, -np.inf]
    )
    np.testing.assert_array_equal(
        Requirement("reach_margin", low=10.0).margin(values), [-8.0, 0.0, 2.0, np.nan, np.inf]
    )


def test_headings_of_a_requirement_go_before_those_of_all():
    own = Requirement("condition", high=10.0, theta=(0.0, 0.1))
    common = Requirement("max_torque", high=10.0)
    needs = Requirements((own, common), theta=(-0.5, 0.5))
    assert needs.headings(own) == (0.0, 0.1)
    assert needs.headings(common) == (-0.5, 0.5)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Requirement("kappa", high=1.0), "kappa"),
        (lambda: Requirement("condition"), "a least or a largest value"),
        (lambda: Requirement("condition", low=2.0, high=1.0), "the least value has to be"),
        (lambda: Requirement("condition", high=math.nan), "the least value has to be a number"),
        (
            lambda: Requirement("condition", low=1.0, high=math.nan),
            "the least value has to be a number",
        ),
        (
            lambda: Requirement("condition", low=math.nan, high=1.0),
            "the least value has to be a number",
        ),
        (lambda: Requirement("condition", high=1.0, theta=(1.0, 0.0)), "theta"),
        (lambda: Requirement("condition", high=1.0, theta=(1.0,)), "theta: two finite"),
        (lambda: Requirement("condition", high=1.0, z=(0.0, math.inf)), "z: two finite"),
        (lambda: Requirements(theta=(0.0, math.nan)), "theta: two finite"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, 0.0, 1.0)), "workspace.size"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, 1.0)), "workspace.size: three positive"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, "1", 1.0)), "workspace.size: three positive"),
        (lambda: Workspace(WorkspaceShape.CYLINDER, (1.0, 2.0, 1.0)), "one diameter"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, 1.0, 1.0), (math.nan, 0, 0)), "center"),
        (lambda: Workspace("box", (1.0, 1.0, 1.0)), "shape"),
        (lambda: Requirements(workspace=(1.0, 1.0, 1.0)), "workspace"),
        (lambda: Requirements(("condition <= 10",)), "bounds"),
    ],
    ids=count(),
)
def test_impossible_requirements_are_refused(make, match):
    with pytest.raises(InvalidInput, match=match):
        make()


CASES = {
    "condition <= 10": Requirement("condition", None, 10.0),
    "κ ≤ 10": Requirement("condition", None, 10.0),
    "condition<=1e1": Requirement("condition", None, 10.0),
    "10 >= condition": Requirement("condition", None, 10.0),
    "|tau_1| <= 15": Requirement("tau_1", -15.0, 15.0),
    "|tau_1| <= 0": Requirement("tau_1", 0.0, 0.0),
    "| tau-1 | <= 15 N m": Requirement("tau_1", -15.0, 15.0),
    "max_torque <= 15 N m": Requirement("max_torque", None, 15.0),
    "max-torque <= 15 N·m": Requirement("max_torque", None, 15.0),
    "error_x <= 100 um": Requirement("error_x", None, 1e-4),
    "error_x <= 100 µm": Requirement("error_x", None, 1e-4),
    "reach_margin >= 10 mm": Requirement("reach_margin", 0.01, None),
    "2 <= condition <= 10": Requirement("condition", 2.0, 10.0),
    "stiffness_x >= 40 N/mm": Requirement("stiffness_x", 40_000.0, None),
    "pressure_1 <= 30 deg": Requirement("pressure_1", None, math.radians(30)),
    "f_4 <= 400 for z -900..-500": Requirement("f_4", None, 400.0, None, (-0.9, -0.5)),
    "f_4 <= 400 N for theta -30..30 deg, z -900..-500 mm": Requirement(
        "f_4", None, 400.0, (-math.radians(30), math.radians(30)), (-0.9, -0.5)
    ),
}


def close(first: Requirement, second: Requirement) -> bool:
    def near(a: float | None, b: float | None) -> bool:
        return (a is None) == (b is None) and (a is None or a == pytest.approx(b, rel=1e-12))

    pairs = [(first.low, second.low), (first.high, second.high)]
    for one, other in ((first.theta, second.theta), (first.z, second.z)):
        pairs += zip(one or (None, None), other or (None, None), strict=True)
    return first.quantity == second.quantity and all(near(a, b) for a, b in pairs)


@pytest.mark.parametrize("text", CASES)
def test_text_is_read_and_what_is_written_of_it_reads_back(text: str) -> None:
    requirement = parse_requirement(text)
    assert close(requirement, CASES[text])
    assert requirement_text(requirement).isascii()
    assert parse_requirement(requirement_text(requirement)) == requirement


NUMBERS = st.floats(-1e6, 1e6).map(lambda value: float(f"{value:.6g}"))


@given(st.sampled_from(list(QUANTITIES)), NUMBERS, NUMBERS, st.integers(0, 3))
def test_every_quantity_is_written_and_read(key: str, a: float, b: float, form: int) -> None:
    unit = QUANTITIES[key].display
    low, high = sorted((unit.to_si(a), unit.to_si(b)))
    requirement = (
        Requirement(key, low, high),
        Requirement(key, low, None),
        Requirement(key, None, high),
        Requirement(key, -abs(high), abs(high)),
    )[form]
    assert close(parse_requirement(requirement_text(requirement)), requirement)


def test_unit_of_every_quantity_is_understood() -> None:
    for key, quantity in QUANTITIES.items():
        text = requirement_text(Requirement(key, None, 1.0))
        assert parse_requirement(text).quantity == key
        unit = ascii_unit(quantity.display)  # told, so that a person reads what the number is
        assert text.partition(" <= ")[2].partition(" ")[2] == unit, key
        assert text == text.strip()


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("condition", "a bound"),
        ("", "a bound"),
        ("<= 10", "a bound"),
        ("condition <= ten", "a bound"),
        ("kondition <= 10", "did you mean condition"),
        ("nothing_like_it <= 10", "there is no quantity"),
        ("max_torque <= 15 Nmm", "given in N m"),
        ("condition <= 10 mm", "no unit"),
        ("condition <= 10,5", "not a comma: 10.5"),
        ("error_x <= 1 mm", "given in um"),
        ("|tau_1| >= 5", "a magnitude"),
        ("1 <= |tau_1| <= 5", "a magnitude"),
        ("|tau_1| <= -5", "a magnitude"),
        ("5 <= condition >= 2", "same side"),
        ("10 <= condition <= 2", "the least value has to be"),
        ("condition <= 10 for theta 30..-30", "least and largest"),
        ("condition <= 10 for theta 0..1e999", "least and largest"),
        ("condition <= 10 for theta 1..2, theta 1..2", "one range"),
        ("condition <= 10 for y 1..2", "no range"),
        ("condition <= 10 for theta 1..2 for z -900..-500", "no range|is in|theta"),
        ("condition <= 10 for z -9..-5 cm", "is in mm"),
        ("condition <= 10 for theta -1..1 rad", "is in deg"),
        ("condition <= 1e999", "finite"),
        ("condition <= " + "1" * 400, "characters"),
    ],
)
def test_what_is_no_requirement_is_refused(text: str, problem: str) -> None:
    with pytest.raises(InvalidInput, match=problem):
        parse_requirement(text)


@pytest.mark.parametrize("heights", ["-500..-900", "-900..1e999", "-9..-5 cm"])
def test_a_range_is_refused_by_its_text(heights: str) -> None:
    text = f"condition <= 10 for z {heights}"
    with pytest.raises(InvalidInput, match=r"least and largest|is in mm") as refused:
        parse_requirement(text)
    assert refused.value.argument == f"requirement {text!r}"


def test_labels_have_symbols_and_units() -> None:
    assert requirement_label(CASES["|tau_1| <= 15"]) == "|τ₁| ≤ 15 N·m"
    assert requirement_label(CASES["condition <= 10"]) == "κ ≤ 10"
    assert requirement_label(CASES["reach_margin >= 10 mm"]) == "margin ≥ 10 mm"
    label = requirement_label(CASES["f_4 <= 400 N for theta -30..30 deg, z -900..-500 mm"])
    assert label == "F₄ ≤ 400 N for θ −30..30°, z −900..−500 mm"


def test_label_shows_the_numbers_of_the_text() -> None:
    """In the units of the quantity, on both sides of it and in ranges."""
    text = "20 <= error_x <= 100 um for theta -30..25, z -900..-500"
    label = requirement_label(parse_requirement(text))
    numbers = [float(n) for n in re.findall(r"-?[0-9]+(?:[.][0-9]+)?", label.replace("−", "-"))]
    assert numbers == [20.0, 100.0, -30.0, 25.0, -900.0, -500.0]
    assert parse_requirement("condition <= 10 for theta 20..20").theta == pytest.approx(
        (np.radians(20.0), np.radians(20.0))
    )


def test_the_size_of_a_workspace_is_told_in_millimeters() -> None:
    size = (0.3, 0.3, 0.4)
    assert shape_text(Workspace(WorkspaceShape.CYLINDER, size)) == "cylinder ⌀ 300 × 400 mm"
    assert shape_text(Workspace(WorkspaceShape.BOX, size)) == "box 300 × 300 × 400 mm"


def test_torques_that_are_required_are_those_with_the_load() -> None:
    pose = np.array([0.05, -0.03, 0.2, -0.5])
    grid = xy_grid(pose[:1], pose[1:2], pose[2], pose[3])
    loaded = replace(APPENDIX_4, load=LoadCase(force_x=7.0, force_z=-30.0))
    for design in (APPENDIX_4, loaded):
        field, torque = solve_field(design.geometry, grid), static_torques(design, pose)
        for name, expected in (("tau_1", torque[0]), ("f_4", torque[3])):
            found = QUANTITIES[name].over(field, design)
            assert found.item() == pytest.approx(expected, rel=1e-9), name
        most = QUANTITIES["max_torque"].over(field, design)
        assert most.item() == pytest.approx(np.abs(torque[:3]).max(), rel=1e-9)


def test_a_text_of_300_characters_is_read_and_a_longer_one_is_not() -> None:
    text = "condition" + " " * 285 + "<= 10"
    assert len(text) == 299
    assert parse_requirement(text + "0").high == 100.0
    with pytest.raises(InvalidInput, match="at most 300 characters"):
        parse_requirement(text + "00")


@pytest.mark.parametrize("kind", [list, np.array, lambda values: tuple(map(np.float32, values))])
def test_lists_arrays_and_numbers_of_numpy_stand_for_tuples(kind) -> None:
    """What a script computes is taken as it is; the record is equal and can be hashed."""
    size, ends = (0.25, 0.25, 0.5), (-0.5, 0.25)  # the same in single precision
    made = Workspace(WorkspaceShape.CYLINDER, kind(size), kind(size))
    assert made == Workspace(WorkspaceShape.CYLINDER, size, size)
    one = Requirement("condition", high=np.int64(8), theta=kind(ends), z=kind(ends))
    assert one == Requirement("condition", high=8, theta=ends, z=ends)
    every = Requirements([one], kind(ends), made)
    assert hash(every) == hash(Requirements((one,), ends, made))
