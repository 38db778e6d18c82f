"""Requirements in design files: written, read back, refused with the key that is wrong."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.files.design_file import load_content, read_content, read_design, save_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.requirement_tables import bound_keys
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)

HEAD = "schema_version = 1\n"
NUMBER = st.floats(-1e6, 1e6, allow_subnormal=False)
RANGE = st.none() | st.tuples(NUMBER, NUMBER).map(lambda ends: (min(ends), max(ends)))


@st.composite
def requirement(draw: st.DrawFn) -> Requirement:
    low, high = sorted(draw(st.tuples(NUMBER, NUMBER)))
    form = draw(st.integers(0, 2))
    return Requirement(
        draw(st.sampled_from(list(QUANTITIES))),
        None if form == 0 else low,
        None if form == 1 else high,
        draw(RANGE),
        draw(RANGE),
    )


@st.composite
def workspace(draw: st.DrawFn) -> Workspace:
    shape = draw(st.sampled_from(WorkspaceShape))
    x, y, z = draw(st.tuples(*[st.floats(1e-3, 10.0)] * 3))
    center = draw(st.tuples(*[st.none() | NUMBER] * 3))
    return Workspace(shape, (x, x if shape is WorkspaceShape.CYLINDER else y, z), center)


@given(st.lists(requirement(), max_size=4), RANGE, st.none() | workspace())
def test_written_requirements_read_back_exactly(
    bounds: list[Requirement], theta: tuple[float, float] | None, space: Workspace | None
) -> None:
    given_ = Requirements(tuple(bounds), theta or (0.0, 0.0), space)
    text = write_design(APPENDIX_4, requirements=given_)
    content = read_content(text, "robot.toml")
    assert content.design == APPENDIX_4
    assert (content.requirements or Requirements()) == given_


def test_without_requirements_the_file_is_as_before() -> None:
    plain = write_design(APPENDIX_4)
    assert write_design(APPENDIX_4, requirements=Requirements()) == plain
    assert "workspace" not in plain
    assert read_content(plain, "robot.toml").requirements is None


def test_design_alone_can_be_read_from_a_file_with_requirements(tmp_path) -> None:  # type: ignore[no-untyped-def]
    requirements = Requirements((Requirement("condition", None, 10.0),), (-0.5, 0.5))
    path = save_design(APPENDIX_4, tmp_path / "robot.toml", requirements=requirements)
    assert load_content(path).requirements == requirements
    assert read_design(path.read_text(encoding="utf-8"), "robot.toml") == APPENDIX_4
    assert "κ ≤ 10" in path.read_text(encoding="utf-8")


def test_a_file_that_was_cut_short_is_refused() -> None:
    requirements = Requirements((Requirement("condition", None, 10.0),), (-0.5, 0.5))
    lines = write_design(APPENDIX_4, requirements=requirements).rstrip().split("\n")
    for end in range(len(lines) - 8, len(lines)):
        if "=" not in lines[end]:
            continue
        with pytest.raises(DesignFileError, match=r"cut short|needed|missing"):
            read_content("\n".join(lines[:end]), "robot.toml")


def test_keys_of_bounds_end_in_the_unit() -> None:
    assert bound_keys(QUANTITIES["max_torque"]) == ("min_Nm", "max_Nm")
    assert bound_keys(QUANTITIES["condition"]) == ("min", "max")
    assert bound_keys(QUANTITIES["error_x"]) == ("min_m", "max_m")


def test_a_short_file_by_hand() -> None:
    text = HEAD + (
        "[workspace]\ntheta_min_rad = -0.5\ntheta_max_rad = 0.5\n"
        'shape = "cylinder"\ndiameter_m = 0.3\nheight_m = 0.4\ncenter_x_m = 0\ncenter_y_m = 0\n'
        '[[requirements]]\nquantity = "max_torque"\nmax_Nm = 15\nz_min_m = -0.9\nz_max_m = -0.5\n'
    )
    found = read_content(text, "robot.toml").requirements
    assert found is not None
    assert found.bounds == (Requirement("max_torque", None, 15.0, None, (-0.9, -0.5)),)
    assert found.theta == (-0.5, 0.5)
    cylinder = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.4), (0.0, 0.0, None))
    assert found.workspace == cylinder
    again = read_content(write_design(APPENDIX_4, requirements=found), "robot.toml")
    assert again.requirements == found


ENTRY = HEAD + '[[requirements]]\nquantity = "max_torque"\n'
SPACE = HEAD + "[workspace]\n"


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        (
            HEAD + '[[requirements]]\nquantity = "kondition"\nmax = 1.0\n',
            3,
            "did you mean condition",
        ),
        (HEAD + '[[requirements]]\nquantity = "x"\nmax = 1.0\n', 3, "no such quantity"),
        (HEAD + "[[requirements]]\nquantity = 5\nmax = 1.0\n", 3, "name of a quantity"),
        (
            HEAD + "[[requirements]]\nmax = 1.0\n",
            2,
            "quantity is missing; each needs one, and its min",
        ),
        (ENTRY, 3, "max_Nm is needed"),
        (ENTRY + "max = 15.0\n", 4, "did you mean max_Nm"),
        (ENTRY + "max_Nm = 15.0\nheight = 3\n", 5, "no such key"),
        (ENTRY + 'max_Nm = "15"\n', 4, "a number is needed"),
        (ENTRY + "max_Nm = inf\n", 4, "finite"),
        (ENTRY + "min_Nm = 5.0\nmax_Nm = 2.0\n", 5, "the least value has to be"),
        (ENTRY + "max_Nm = 5.0\nz_min_m = 2.0\n", 5, "z_max_m is needed"),
        (ENTRY + "max_Nm = 5.0\nz_min_m = 2.0\nz_max_m = 1.0\n", 6, "below z_min_m"),
        (HEAD + '[requirements]\nquantity = "condition"\n', 2, "double brackets"),
        (SPACE + 'shape = "ball"\n', 3, '"cylinder" or "box"'),
        (SPACE + 'shape = "box"\nsize_x_m = 1.0\n', 3, "a box has"),
        (SPACE + 'shape = "cylinder"\ndiameter_m = 1.0\nheight_m = 0.0\n', 5, "above 0"),
        (SPACE + "diameter_m = 1.0\n", 3, "shape is needed"),
        (SPACE + "theta_min_rad = 1.0\n", 3, "theta_max_rad is needed"),
        (SPACE + "theta_min_deg = 1.0\n", 3, "did you mean theta_min_rad"),
        (HEAD + "[[workspace]]\ntheta_min_rad = 1.0\n", 2, "single brackets"),
        (HEAD + "[workspacee]\n", 2, r"did you mean \[workspace\]"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(text: str, line: int, problem: str) -> None:
    with pytest.raises(DesignFileError, match=problem) as caught:
        read_content(text, "robot.toml")
    assert caught.value.line == line
    assert "requirements.0" not in str(caught.value)


def test_headings_alone_are_possible() -> None:
    found = read_content(SPACE + "theta_min_rad = 0.0\ntheta_max_rad = 1.0\n", "x").requirements
    assert found == Requirements((), (0.0, 1.0))
    assert math.isclose(found.theta[1], 1.0)


def test_headings_that_are_not_given_are_the_one_of_zero() -> None:
    text = HEAD + '[workspace]\nshape = "cylinder"\ndiameter_m = 0.2\nheight_m = 0.3\n'
    found = read_content(text, "a.toml").requirements
    assert found is not None
    assert found.theta == (0.0, 0.0)
    assert found.workspace is not None
    assert found.workspace.center == (None, None, None)
