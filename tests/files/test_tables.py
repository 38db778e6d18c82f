"""Tables are read with every cell in its place, or refused by row and column."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput, TableFileError
from paminsa_viz.files.columns import ACCELERATION, POSE, POSES, VELOCITY
from paminsa_viz.files.logs import parse_log
from paminsa_viz.files.table_reader import (
    LONGEST_ROW,
    TableBlock,
    TableReader,
    open_table,
    uploaded_table,
)
from paminsa_viz.files.tables import (
    DataTable,
    csv_rows,
    save_table,
    table_bytes,
    table_csv,
    table_endings,
    table_npz,
    table_text,
)
from paminsa_viz.files.trajectory_table import parse_trajectory, read_trajectory
from paminsa_viz.trajectory import Trajectory

ALL = POSES.columns
HEAD = ",".join(POSE)
TIMED = f"t_s,{HEAD}"
ROWS = "0,0,0,0,-0.5\n0.5,0.01,0,0,-0.5\n"
FLOATS = st.floats(allow_nan=False, allow_infinity=False)


def read(text: str, rows_at_once: int = 1000) -> list[TableBlock]:
    return list(TableReader(io.StringIO(text, newline=""), POSES, "in.csv").blocks(rows_at_once))


def parse(text: str) -> object:
    return parse_trajectory(io.StringIO(text, newline=""), "in.csv")


def check_refused(reader, *words) -> TableFileError:
    with pytest.raises(TableFileError) as caught:
        reader(*words)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 500
    return caught.value


@given(
    st.sampled_from([POSE, POSE + VELOCITY, POSE + ACCELERATION, ALL]).flatmap(st.permutations),
    st.lists(st.lists(FLOATS, min_size=len(ALL), max_size=len(ALL)), max_size=7),
    st.sampled_from(["\n", "\r\n", "\r"]),
    st.sampled_from(["{!r}", '"{!r}"', " {!r} "]),
    st.sampled_from([",.", ";.", ";,", "\t.", "\t,"]),
    st.integers(1, 4),
    st.integers(0, 3),
)
def test_every_cell_arrives_in_its_place(
    columns, rows, end, style, signs, rows_at_once, blanks
) -> None:
    between, decimal = signs
    lines = [between.join(columns)]
    lines += [
        between.join(style.format(x).replace(".", decimal) for x in row[: len(columns)])
        for row in rows
    ]
    pieces = read(end.join(lines) + end + blanks * end, rows_at_once)
    assert sum(len(piece.cells) for piece in pieces) == len(rows)
    if not rows:
        return
    wanted = {name: [row[i] for row in rows] for i, name in enumerate(columns)}
    zeros = [0.0] * len(rows)
    for names in (POSE, VELOCITY, ACCELERATION):
        got = np.concatenate([piece.group(names) for piece in pieces])
        assert got.shape == (len(rows), 4)
        for column, name in enumerate(names):
            assert got[:, column].tolist() == wanted.get(name, zeros)


@pytest.mark.parametrize(
    ("text", "row", "column", "words"),
    [
        ("", None, "", "is empty; a header row with x_m,y_m,theta_rad,z_m"),
        ("1,2,3,4\n", 1, "1", "the first row has to name the columns"),
        ("x_m,y_m,theta_rad\n", 1, "z_m", "a pose needs x_m,y_m,theta_rad,z_m"),
        ("x_m;y_m;theta_rad;z_m\n0,5;0;0;0\n0;1.5;0;0\n", 3, "y_m", "where decimals before it"),
        ("x_m;y_m;theta_rad;z_m\n0;0;0;1.234,5\n", 2, "z_m", "'1.234,5' has a comma"),
        ("x_m;y_m;theta_rad;z_m\n0;0;0;1,234,5\n", 2, "z_m", "is not a number"),
        (f"{HEAD},x_m\n", 1, "x_m", "twice"),
        (f"{HEAD},\n", 1, "", "column 5 has no name"),
        ("x_m,y_m,theta_grad,z_m\n", 1, "theta_grad", "write theta_rad or theta_deg"),
        ("x_m,y_m,theta_rad,Z_m\n", 1, "Z_m", "did you mean z_m?"),
        (f"{HEAD},Z_m\n", 1, "Z_m", "it is a result"),
        (f"{HEAD},comment\n", 1, "comment", "there are x_m,"),
        (f"{HEAD},vx_m_s\n", 1, "vy_m_s", "with velocity columns come vx_m_s,vy_m_s"),
        (f"{HEAD}\n0,0,0,0\n0,,0,0\n", 3, "y_m", "the value is missing"),
        (f"{HEAD}\n0,0,0\n", 2, "z_m", "the value is missing"),
        (f"{HEAD}\n0,0,0,0,0\n", 2, "", "there are 5 values for 4 columns"),
        (f"{HEAD}\n0,0,0,0\n0,0,1e,0\n", 3, "theta_rad", "'1e' is not a number"),
        (f"{HEAD}\n0,0,1_0,0\n", 2, "theta_rad", "'1_0' is not a number"),
        (f"{HEAD}\n0,0,٣,0\n", 2, "theta_rad", "'٣' is not a number"),
        (f"{HEAD}\n0,0,0,nan\n", 2, "z_m", "'nan' is not a finite number"),
        (f"{HEAD}\n0,0,0,1e999\n", 2, "z_m", "'1e999' is not a finite number"),
        (f"{HEAD}\n0,0,0,a\0b\x1b\n", 2, "z_m", "is not a number"),
        (f"{HEAD}\n0,0,0,0\n\n\n0,0,0,0\n", 3, "", "the row is empty, but others follow"),
        (f"{HEAD}\n0,0,0,0\n,,,\n0,0,0,0\n", 3, "", "the row is empty, but others follow"),
        (f'{HEAD}\n0,0,0,"0', 2, "", "is not valid CSV"),
        (f'{HEAD}\n0,0,0,"0"1\n', 2, "", "is not valid CSV"),
        (f'{HEAD}\n0,0,"0\n",0\n0,0,0,x\n', 3, "z_m", "'x' is not a number"),
        (f"{HEAD}\n0,0,0,0\n{'1' * (LONGEST_ROW + 1)}", 3, "", "longer than"),
        (f"{HEAD}\n0,0,0,{'v' * 5000}\n", 2, "z_m", "is not a number"),
    ],
)
def test_a_refused_pose_is_named_by_row_and_column(text, row, column, words) -> None:
    for rows_at_once in (1, 2, 1000):
        error = check_refused(read, text, rows_at_once)
        assert (error.row, error.column) == (row, column)
        assert words in str(error)
        assert row is None or f"in.csv, row {row}" in str(error)


@pytest.mark.parametrize(
    ("text", "row", "column", "words"),
    [
        ("x_m,y_m,theta_rad,z_m\n", 1, "t_s", "the column is missing"),
        ("t_s,x_m,y_m,z_m\n", 1, "theta_rad", "a trajectory needs"),
        ("t,x_m,y_m,theta_rad,z_m\n", 1, "t", "its unit is missing; write t_s or t_ms"),
        ("t_s,x_m,y_m,theta,z_m\n", 1, "theta", "write theta_rad or theta_deg"),
        ("t_s,x_inch,y_m,theta_rad,z_m\n", 1, "x_inch", "'inch' is no unit of it"),
        ("t_s,x [rad],y_m,theta_rad,z_m\n", 1, "x [rad]", "'rad' is no unit of it"),
        (f"{TIMED},velocityx_m_s\n", 1, "velocityx_m_s", "there is no such column"),
        (f"T_S{TIMED[3:]}\n", 1, "T_S", "did you mean t_s?"),
        (f"{TIMED},vx_m_s\n", 1, "vy_m_s", "with velocity columns come"),
        (f"{TIMED},ax_m_s2\n", 1, "vx_m_s", "with acceleration columns come"),
        (f"{TIMED}\n", None, "", "at least two rows; there are 0"),
        (f"{TIMED}\n{ROWS}0.5,0,0,0,0\n", 4, "t_s", "0.5 follows 0.5"),
        (f"# a\n# b\n{TIMED}\n{ROWS}0.4,0,0,0,0\n", 6, "t_s", "0.4 follows 0.5"),
        (f'# a\n{TIMED}\n{ROWS}1,0,0,0,"0\n', 5, "", "is not valid CSV"),
        ("t_ms" + TIMED[3:] + "\n0,0,0,0,0\n1500,0,0,0,0\n900,0,0,0,0\n", 4, "t_ms",
         "900.0 follows 1500.0"),
    ],
)  # fmt: skip
def test_a_refused_trajectory_is_named_by_row_and_column(text, row, column, words) -> None:
    error = check_refused(parse, text)
    assert (error.row, error.column) == (row, column)
    assert words in str(error)


@given(st.integers(0, 30), st.integers(0, 3), st.sampled_from(["", "x", "nan"]), st.integers(1, 9))
def test_the_bad_cell_is_found_wherever_it_is(row, column, bad, rows_at_once) -> None:
    rows = [["0.5"] * 4 for _ in range(31)]
    rows[row][column] = bad
    error = check_refused(read, "\n".join([HEAD, *map(",".join, rows)]), rows_at_once)
    assert (error.row, error.column, error.value) == (row + 2, POSE[column], bad)


@pytest.mark.parametrize(("reader", "head"), [(read, HEAD), (parse, TIMED)], ids=["poses", "times"])
@given(text=st.text(max_size=100))
def test_any_text_is_refused_in_one_line_or_read(reader, head, text: str) -> None:
    check_refused(reader, text)
    try:
        reader(f"{head}\n{text}")
    except TableFileError:
        check_refused(reader, f"{head}\n{text}")
    else:
        assert not text.strip() or text.count(",") >= 3


def test_too_many_rows_and_too_long_a_time_are_refused(monkeypatch) -> None:
    monkeypatch.setattr("paminsa_viz.files.trajectory_table.MOST_SAMPLES", 2)
    assert "more than 2 rows" in str(check_refused(parse, f"{TIMED}\n{ROWS}1,0,0,0,0\n"))
    lines = io.StringIO(f"{TIMED}\n{ROWS}", newline="")
    with pytest.raises(TableFileError, match=r"in\.csv: takes longer than 0 s to read"):
        parse_trajectory(lines, "in.csv", timeout=0.0)


def test_a_header_alone_has_no_rows() -> None:
    assert read(HEAD) == read(f"{HEAD}\n\n") == []


@pytest.mark.parametrize(
    ("data", "row", "words"),
    [
        (b"\xff\xfex\0", None, "is UTF-16"),
        (b"PK\x03\x04\x14\0", None, "is a zip file"),
        (b"\n" + HEAD.encode(), 1, "the row is empty, but has to name the columns: x_m,y_m,"),
        (
            HEAD.encode() + b'\n0,0,"0,5",0\n',
            2,
            "is not a number; decimals are written with a point",
        ),
        (f"{HEAD}\n0,0,0,−0.5\n".encode(), 2, "'−0.5' is not a number; minus is written -$"),
        (HEAD.encode() + b'\n0,0,"1,0,5",0\n', 2, "'1,0,5' is not a number$"),
        (HEAD.encode() + b"\n0,0,\x80,0\n", 2, "is not a number"),
        (b"\x80x_m,y_m,theta_rad,z_m", 1, "did you mean x_m"),
        (b"\x7fELF\0\0", None, "is not a text file"),
        (b"\x7fELF", 1, "there is no such column"),
    ],
)
def test_bytes_that_are_no_utf8_are_refused(tmp_path, data, row, words) -> None:
    path = tmp_path / "in.csv"
    path.write_bytes(data)
    with pytest.raises(TableFileError, match=words) as caught, open_table(path) as lines:
        list(TableReader(lines, POSES, "in.csv").blocks())
    assert caught.value.row == row
    assert str(caught.value).isprintable()


def test_a_byte_order_mark_is_no_part_of_the_first_column(tmp_path) -> None:
    path = tmp_path / "in.csv"
    path.write_bytes(b"\xef\xbb\xbf" + HEAD.encode())
    with open_table(path) as lines:
        assert TableReader(lines, POSES, "in.csv").header == POSE


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="open pipes have no paths here")
def test_a_pipe_is_read_from_its_first_byte(tmp_path: Path) -> None:
    text = f"{TIMED}\n" + "".join(f"{t},0.01,0,0,-0.5\n" for t in range(1000))  # over one buffer
    (tmp_path / "whole.csv").write_text(text)
    end, start = os.pipe()
    os.write(start, text.encode())
    os.close(start)
    piped, whole = read_trajectory(f"/dev/fd/{end}"), read_trajectory(tmp_path / "whole.csv")
    os.close(end)
    np.testing.assert_array_equal(piped.t, whole.t)
    np.testing.assert_array_equal(piped.pose, whole.pose)


@pytest.mark.parametrize("reader", [open_table, read_trajectory])
def test_files_that_cannot_be_opened_are_refused(tmp_path, reader) -> None:
    for path, problem in ((tmp_path / "none.csv", "no such file"), (tmp_path, "is a directory")):
        with pytest.raises(TableFileError, match=problem):
            reader(path)


@given(st.lists(st.lists(FLOATS, min_size=2, max_size=2), min_size=1, max_size=4))
def test_numbers_are_written_with_all_their_digits_and_nan_as_nothing(rows) -> None:
    numbers = np.array([*rows, [np.nan, 7.0]])
    words = np.array(["ok"] * len(rows) + ["stretched:leg2"])
    lines = [line.split(",") for line in csv_rows([*numbers.T, words]).splitlines()]
    assert [[float(cell) for cell in line[:2]] for line in lines[:-1]] == rows
    assert [line[2] for line in lines] == words.tolist()
    assert lines[-1] == ["", "7.0", "stretched:leg2"]


TABLE = DataTable(
    {"name": np.array(["a", "b"]), "value_N": np.array([0.1, np.nan])}, {"made by": "a test"}
)


def test_a_table_is_written_in_the_format_of_the_files_ending(tmp_path) -> None:
    assert table_endings() == (".csv", ".npz")
    for kind, content in (("csv", table_csv(TABLE)), ("npz", table_npz(TABLE))):
        assert table_bytes(TABLE, kind)[:100] == content[:100]
        path = tmp_path / f"table.{kind.upper()}"
        save_table(TABLE, path)
        assert path.stat().st_size == len(content)
    with np.load(tmp_path / "table.NPZ") as arrays:
        assert arrays["name"].tolist() == ["a", "b"]
        assert str(arrays["provenance"]) == '{"made by": "a test"}'
    with pytest.raises(InvalidInput, match="kind: csv or npz is needed, not 'txt'"):
        save_table(TABLE, tmp_path / "table.txt")


def test_whole_numbers_and_lists_are_columns_too() -> None:
    columns = {"count": np.arange(2), "sure": np.array([True, False]), "x_m": [0.5, np.nan]}
    assert table_csv(DataTable(columns, {})) == b"count,sure,x_m\n0,True,0.5\n1,False,\n"  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("columns", "problem"),
    [
        ({}, "columns of one length are needed, not none"),
        ({"a_m": np.zeros(3), "b": ["x"]}, "not a_m has 3, b has 1"),
    ],
)  # fmt: skip
def test_columns_of_a_table_have_one_length(columns, problem) -> None:
    with pytest.raises(InvalidInput, match=problem):
        DataTable(columns, {})


def test_a_table_for_the_clipboard_has_tabs_between_its_cells() -> None:
    lines = table_text(TABLE).splitlines()
    assert lines == [*table_csv(TABLE).decode().splitlines()[:-3], "name\tvalue_N", "a\t0.1", "b\t"]


def test_an_uploaded_table_is_read_as_a_file_is(tmp_path) -> None:
    content = f"\ufeff{HEAD}\r\n0,0,0,-0.5\r\n".encode()
    path = tmp_path / "in.csv"
    path.write_bytes(content)
    with open_table(path) as lines:
        assert lines.read() == uploaded_table("in.csv", content).read()
    check_refused(uploaded_table, "in.csv", b"\xff\xfea").problem.index("is UTF-16")
    check_refused(uploaded_table, "in.csv", b"PK\x03\x04").problem.index("is a zip file")


def test_a_table_may_take_only_so_long_to_read(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter(np.arange(0.0, 100.0, 0.4))
    monkeypatch.setattr("paminsa_viz.files.table_reader.time.monotonic", lambda: next(clock))
    text = f"{HEAD}\n" + "0,0,0,-0.5\n" * 9

    def rows(timeout: float | None) -> int:
        table = TableReader(io.StringIO(text, newline=""), POSES, "in.csv", timeout)
        return sum(len(block.cells) for block in table.blocks())

    assert rows(None) == rows(5.0) == 9  # ten lines of 0.4 s
    found = check_refused(rows, 3.0)
    assert found.problem == "takes longer than 3 s to read; thin it out"


@pytest.mark.parametrize(("most", "rows", "passes"), [(3, 3, True), (3, 4, False)])
def test_a_table_has_only_so_many_rows(most: int, rows: int, passes: bool) -> None:
    text = f"# a comment\n{HEAD}\n" + "0,0,0,-0.5\n" * rows
    table = TableReader(io.StringIO(text, newline=""), POSES, "in.csv")
    if passes:
        first, columns = table.read_all(most, "poses")
        assert (first, columns["z_m"].tolist()) == (3, [-0.5] * rows)
    else:
        assert check_refused(table.read_all, most, "poses").problem == (
            "there are more than 3 poses; thin them out"
        )
    empty = TableReader(io.StringIO(f"{HEAD}\n", newline=""), POSES, "in.csv")
    assert empty.read_all(1)[0] == 0


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("x[mm]", ""), ("x (mm)", ""), ("x_mm", ""), ("x (old) [mm]", "is no unit of it"),
        ("x [mm] (old)", "is no unit of it"), ("x[mm", "there is no such column"),
        ("xmm]", "there is no such column"), ("x]", "there is no such column"),
        ("[mm]x", "there is no such column"), ("(x)", "there is no such column"),
    ],
)  # fmt: skip
def test_units_are_in_the_first_bracket_that_the_end_closes(header: str, words: str) -> None:
    text = f"t_s,{header},y_m,theta_rad,z_m\n" + ROWS
    if not words:
        made = parse_trajectory(io.StringIO(text, newline=""), "in.csv")
        np.testing.assert_allclose(made.pose[:, 0], [0.0, 1e-5])
        return
    assert words in str(check_refused(parse, text))


def test_a_hint_is_one_name_that_is_near() -> None:
    """Whatever comes after fifty letters; columns that are far from it are all told."""
    text = f"t_s,{HEAD},vxx_m_s\n" + ROWS.replace("\n", ",0\n")
    assert "did you mean vx_m_s?" in str(check_refused(parse, text))
    far = str(check_refused(parse, text.replace("vxx_m_s", "weight")))
    assert "there are t_s,x_m" in far
    for name, hint in (("vxx_mab", "did you mean vx_m_s?"), ("vxx_mabc", "there are x_m")):
        assert hint in str(check_refused(read, f"{HEAD},{name}\n"))


def test_a_table_of_another_kind_is_named() -> None:
    """What it is for, in any units; a misspelled column makes no other kind of it."""
    angles, rest = (
        "theta1_rad,theta2_rad,theta3_rad,Z_m",
        "torque1_Nm,torque2_Nm,torque3_Nm,force4_N",
    )
    log, measured = f"t_s,{angles},{rest}\n", f"{HEAD},{angles},tiltx_rad,tilty_rad\n"
    in_degrees = log.replace("rad", "deg").replace("Z_m", "Z [mm]")
    for table in (log, in_degrees):
        told = str(check_refused(parse, table))
        assert "looks like a log, to identify a robot from; a trajectory needs t_s,x_m" in told
        assert "looks like a log" in str(check_refused(read, table))
    assert "looks like measured poses, to calib" in str(check_refused(parse, f"t_s,{measured}"))
    rates = ",".join((*VELOCITY, *ACCELERATION))
    for motion in (TIMED, f"{TIMED},{rates},{angles},tau1_Nm"):  # as `trajectory` writes it
        told = str(check_refused(parse_log, io.StringIO(f"{motion}\n", newline=""), "in.csv"))
        assert "column x_m: there is no such column; the table looks like a motion; a log" in told
    assert "looks like" not in str(check_refused(parse, f"{TIMED},torque_Nm\n"))
    assert "looks like" not in str(check_refused(read, f"{HEAD},{angles}\n"))  # of `evaluate`


def test_waypoints_are_at_rest_at_their_ends_only_if_it_is_said() -> None:
    """And a table may take as long as it takes."""
    text = f"{TIMED}\n" + "".join(f"{n / 4},{n * n / 90},0,0,-0.5\n" for n in range(5))

    def made(**options: bool) -> Trajectory:
        return parse_trajectory(io.StringIO(text, newline=""), "in.csv", **options)

    np.testing.assert_array_equal(made().velocity, made(rest=False).velocity)
    assert np.abs(made().velocity[-1, 0]) > 0.1
    assert np.abs(made(rest=True).velocity[[0, -1]]).max() < 1e-9
