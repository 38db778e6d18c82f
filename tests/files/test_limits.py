"""Limits of what files may hold: what is just possible is read, one more is refused."""

from __future__ import annotations

import io
import json

import pytest

from paminsa_viz.errors import LONGEST_VALUE, PaminsaError, TableFileError
from paminsa_viz.files import measurements, published_table
from paminsa_viz.files.columns import POSES
from paminsa_viz.files.design_file import LARGEST_FILE, LONGEST_LINE, parse_toml, read_design
from paminsa_viz.files.errors import DesignFileError, shown
from paminsa_viz.files.plain_data import (
    LARGEST_INTEGER,
    MOST_LEVELS,
    UnusableData,
    parse_json,
    parse_plain_toml,
)
from paminsa_viz.files.table_reader import LONGEST_ROW, MOST_BLANK_ROWS, TableReader
from paminsa_viz.trajectory.sampled import MOST_SAMPLES
from tests.support.documentation import missing


def table_rows(text: str) -> int:
    reader = TableReader(io.StringIO(text, newline=""), POSES, "in.csv")
    return sum(len(block.cells) for block in reader.blocks())


def test_the_documentation_states_the_limits() -> None:
    stated = (
        f"at most {LARGEST_FILE:,} bytes, lines of {LONGEST_LINE:,} characters, and {MOST_LEVELS} ",
        f"lines of at most {LONGEST_ROW:,} characters, and at most {MOST_BLANK_ROWS:,} blank rows",
        f"published torques at most {published_table.MOST_ROWS:,} rows are read, "
        f"of measured poses {measurements.MOST_ROWS:,}, of a motion or a log {MOST_SAMPLES:,}.",
    )
    assert missing("scripts", stated) == []


def test_lines_and_files_of_designs() -> None:
    line = "#" * LONGEST_LINE
    assert parse_toml(f"{line}\na = 1", "a.toml") == {"a": 1}
    with pytest.raises(DesignFileError, match="line 2: the line is too long") as caught:
        parse_toml(f"a = 1\n{line}#", "a.toml")
    assert caught.value.line == 2
    rest = "schema_version = 1\n"
    comments = "#\n" * ((LARGEST_FILE - len(rest)) // 2)
    whole = rest + comments + "#" * (LARGEST_FILE - len(rest) - len(comments))
    assert len(whole) == LARGEST_FILE
    read_design(whole, "a.toml")
    for larger in (whole + "#", (whole + "#").encode()):
        with pytest.raises(DesignFileError, match="is too large for a design file"):
            read_design(larger, "a.toml")


def test_levels_and_whole_numbers_of_plain_data() -> None:
    for sign in (1, -1):
        assert parse_json(str(sign * LARGEST_INTEGER)) == sign * LARGEST_INTEGER
        with pytest.raises(UnusableData, match="fewer digits") as caught:
            parse_json(json.dumps({"a": [0, sign * (LARGEST_INTEGER + 1)]}))
        assert (caught.value.path, caught.value.value) == ("a.1", sign * (LARGEST_INTEGER + 1))
    lists = "[" * MOST_LEVELS + "]" * MOST_LEVELS
    parse_json(lists)
    parse_plain_toml(f"a = {lists[1:-1]}")
    for text in (f"[{lists}]", "[" * 100_000):
        with pytest.raises(UnusableData, match="nested too deeply"):
            parse_json(text)
    with pytest.raises(UnusableData, match="nested too deeply"):
        parse_plain_toml(f"a = {lists}")
    assert parse_json('"\\ud83d\\ude00"') == "\U0001f600"
    with pytest.raises(UnusableData, match="half a character") as caught:
        parse_json('{"b": {"c": "whole\\ud83d"}}')
    assert caught.value.path == "b.c"


@pytest.mark.slow
def test_rows_of_tables() -> None:
    head, row = "x_m,y_m,theta_rad,z_m\n", "0,0,0,-0.5\n"
    assert table_rows(f"{head}{row}" + "\n" * MOST_BLANK_ROWS) == 1
    with pytest.raises(TableFileError, match="row 3: over 20,000 blank rows end the table"):
        table_rows(f"{head}{row}" + "\n" * (MOST_BLANK_ROWS + 1))
    for more in (0, 1):
        long = "0,0,0," + "0" * (LONGEST_ROW - 7 + more) + "\n"
        assert len(long) == LONGEST_ROW + more
        if more:
            with pytest.raises(TableFileError, match=r"row 2: .* the row is longer than"):
                table_rows(f"{head}{long}")
        else:
            assert table_rows(f"{head}{long}") == 1


def test_what_a_message_shows_of_a_value_is_short() -> None:
    assert shown("x" * (LONGEST_VALUE - 2)) == repr("x" * (LONGEST_VALUE - 2))
    cut = shown("x" * (LONGEST_VALUE - 1))
    assert len(cut) == LONGEST_VALUE
    assert cut.endswith("x...'")
    for value, text in (
        (True, "true"), ({}, "a table"), ([1], "a list"), (1.5, "1.5"),
        (10**60 - 1, "9" * 60), (10**60, "1" + "0" * 56 + "..."),
        (2**200, "a number of very many digits"),
    ):  # fmt: skip
        assert shown(value) == text
    long = "y" * 100
    found = str(DesignFileError("a.toml", "is odd", key=f"{long}.{long}", value=long))
    assert f"[{long[:60]}] {long[:60]} = 'yyy" in found
    assert "y" * 61 not in found
    found = str(TableFileError("a.csv", "is odd", row=3, column=long))
    assert found == f"a.csv, row 3, column {long[:60]}: is odd"
    assert isinstance(DesignFileError("a", "b"), PaminsaError)
