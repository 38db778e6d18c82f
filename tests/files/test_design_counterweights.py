"""Counterweights in design files: exact both ways, and refused with the line that is wrong."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.files.design_file import read_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model import APPENDIX_4, BAR_ENDS, Counterweight

PLACES = [(bar, joint) for bar, joints in BAR_ENDS.items() for joint in joints]
WEIGHTS = st.lists(
    st.builds(
        lambda place, beyond, mass: Counterweight(*place, beyond, mass),
        st.sampled_from(PLACES),
        st.floats(-10, 10),
        st.floats(0, 1e300),
    ),
    max_size=4,
)
HEAD = "schema_version = 1\n"
GOOD = '[[counterweights]]\nbar = "B8"\njoint = 8\nbeyond_m = 0.1\nmass_kg = 1\n'


@given(WEIGHTS)
def test_what_is_written_reads_back(weights: list[Counterweight]) -> None:
    design = replace(APPENDIX_4, counterweights=tuple(weights))
    assert read_design(write_design(design), "a.toml") == design


def test_a_file_with_counterweights_that_was_cut_short_is_refused() -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.0), Counterweight("b3", 7, 0.05, 2.0))
    text = write_design(replace(APPENDIX_4, counterweights=weights))
    lines = text.splitlines(keepends=True)
    for count in range(len(lines)):
        with pytest.raises(DesignFileError):
            read_design("".join(lines[:count]), "a.toml")


def test_a_short_file() -> None:
    weights = read_design(HEAD + GOOD + GOOD.replace('"B8"', "'b7'"), "a.toml").counterweights
    assert weights == (Counterweight("b8", 8, 0.1, 1.0), Counterweight("b7", 8, 0.1, 1.0))


@pytest.mark.parametrize(
    ("old", "new", "line", "key", "said"),
    [
        ('"B8"', '"B5"', 8, "counterweights.bar", "one of the bars B3, B4, B7, B8"),
        ('"B8"', "8", 8, "counterweights.bar", "one of the bars"),
        ("= 8", "= 5", 9, "counterweights.joint", "the ends of B8 are joints 8 and 9"),
        ("= 8", "= true", 9, "counterweights.joint", "number"),
        ("0.1", "nan", 10, "counterweights.beyond_m", "finite"),
        ("0.1", '"0.1"', 10, "counterweights.beyond_m", "without quotes"),
        ("= 1\n", "= -1\n", 11, "counterweights.mass_kg", "at least 0"),
        ("mass_kg", "mass", 11, "counterweights.mass", "no such key"),
        ("mass_kg = 1", "", 7, "counterweights", "mass_kg is missing"),
        ("[[counterweights]]", "[counterweights]", None, "", "twice"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(old, new, line, key, said) -> None:
    text = HEAD + GOOD + GOOD.replace(old, new)
    with pytest.raises(DesignFileError, match=said) as caught:
        read_design(text, "a.toml")
    assert caught.value.key == key
    if line:
        assert caught.value.line == line


def test_one_table_in_single_brackets_is_explained() -> None:
    with pytest.raises(DesignFileError, match="double brackets"):
        read_design(HEAD + GOOD.replace("[[counterweights]]", "[counterweights]"), "a.toml")
