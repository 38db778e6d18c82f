"""The table that goes on after a kill: whatever a kill leaves of it."""

from __future__ import annotations

import os
import zlib

import pytest

from paminsa_viz.errors import TableFileError
from paminsa_viz.files.resumable_csv import AGAIN, ResumableCsv

HEAD = {"format": "test 1", "command": "one", "study": "abc"}
COLUMNS = ("row", "value")
ROWS = [(str(i), repr(i / 7)) for i in range(5)]


def grow(path, *, head=HEAD, rows=ROWS, **options) -> int:
    """Write the rows that are missing; return how many were there."""
    with ResumableCsv(path, head, COLUMNS, identity="study", **options) as table:
        found = list(table.read())
        assert found == rows[: table.rows]
        table.append(rows[table.rows :])
    return len(found)


@pytest.fixture
def whole(tmp_path) -> bytes:
    assert grow(tmp_path / "whole.csv") == 0
    return (tmp_path / "whole.csv").read_bytes()


def test_a_table_has_provenance_header_and_rows(whole) -> None:
    lines = whole.decode().splitlines()
    assert lines[:4] == ["# format: test 1", "# command: one", "# study: abc", "row,value,crc32"]
    rows = [line.rpartition(",") for line in lines[4:]]
    assert [row for row, _, _ in rows] == [",".join(row) for row in ROWS]
    assert [int(crc, 16) for _, _, crc in rows] == [zlib.crc32(row.encode()) for row, _, _ in rows]


def test_resuming_after_a_cut_anywhere_gives_the_same_bytes(whole, tmp_path) -> None:
    path = tmp_path / "cut.csv"
    start = whole.index(b"0,0.0")
    for size in range(len(whole) + 1):
        path.write_bytes(whole[:size])
        found = grow(path)
        assert path.read_bytes() == whole, size
        assert found == whole[start : max(size, start)].count(b"\n")


def test_rows_may_be_appended_in_any_batches(whole, tmp_path) -> None:
    path = tmp_path / "pieces.csv"
    for end in (0, 1, 3, 3, 5):
        grow(path, rows=ROWS[:end])
    assert path.read_bytes() == whole


def test_a_last_row_without_its_end_is_cut_off_where_no_row_is_missing(whole, tmp_path) -> None:
    path = tmp_path / "longer.csv"
    path.write_bytes(whole + b"5,0.71")
    assert grow(path) == len(ROWS)
    assert path.read_bytes() == whole


def test_rows_are_on_the_disk_when_the_table_is_closed(tmp_path, monkeypatch) -> None:
    path, synced = tmp_path / "a.csv", []
    monkeypatch.setattr(os, "fsync", lambda number: synced.append(os.fstat(number).st_size))
    table = ResumableCsv(path, HEAD, COLUMNS, identity="study")
    table.append(ROWS)
    synced.clear()
    table.close()
    assert synced == [path.stat().st_size]


def test_resuming_keeps_the_first_command(whole, tmp_path) -> None:
    path = tmp_path / "whole.csv"
    assert grow(path, head=HEAD | {"command": "two"}) == len(ROWS)
    assert path.read_bytes() == whole


@pytest.mark.parametrize(
    "content",
    [
        b"\n",
        b"something else",
        b"a,b\n1,2\n",
        b"# format: test 2\n",
        b"# format: test 1\n# study: abc\nrow,other\n",
        b"# format: test 1\nrow,value\n",
        b"# format: test 1\r\n# study: abc\r\nrow,value\r\n",
        b"\x00" * 100,
    ],
)
def test_another_file_is_refused_and_kept_unless_restarted(content, whole, tmp_path) -> None:
    path = tmp_path / "other.csv"
    path.write_bytes(content)
    with pytest.raises(TableFileError, match=r"other\.csv: holds something else"):
        grow(path)
    assert path.read_bytes() == content
    assert grow(path, restart=True) == 0
    assert path.read_bytes() == whole


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"# study: abcd\n", "; take"),
        (b"# study: abcd\n# motion: line\n# z: 1\n", 'whose z is "1", not "0"'),
        (b"# study: abcd\n# motion: ring\n# z: 1\n", 'whose motion is "ring", not "line"'),
        (b"# study: abcd\n# z: 0\n", 'whose motion is "none", not "line"'),
        (b"# study: abcd\n# motion: line\n# z: 0\n# w: 2\n", 'whose w is "2", not "none"'),
        (b"# study: abcd\n# motion: \x1b[2J" + b"x" * 200 + b"\n", r"is \"\?\[2Jx{76}\", not"),
        (b"# w: 2\n# study: abcd\n# motion: line\n# z: 0\n", "; take"),
    ],
)
def test_another_study_is_named_by_its_first_difference(content, words, tmp_path) -> None:
    path = tmp_path / "other.csv"
    path.write_bytes(b"# format: test 1\n# command: two\n" + content + b"row,value\n")
    head = HEAD if content.count(b"\n") == 1 else HEAD | {"motion": "line", "z": "0"}
    with pytest.raises(TableFileError, match=rf"other\.csv: holds another study.*{words}"):
        grow(path, head=head)


@pytest.mark.slow
def test_any_changed_byte_is_refused_with_its_row(whole, tmp_path) -> None:
    path = tmp_path / "edited.csv"
    start = whole.index(b"0,0.0")
    for place in range(start, len(whole) - 1):
        for byte in (b"7", b",", b"\n", b"\xff"):
            if whole[place : place + 1] == byte:
                continue
            path.write_bytes(whole[:place] + byte + whole[place + 1 :])
            with pytest.raises(TableFileError) as caught:
                grow(path)
            assert caught.value.row == 1 + whole.count(b"\n", 0, place)
            assert str(caught.value).endswith(f"restore it, cut the file off before it, or {AGAIN}")


def test_a_second_writer_is_refused(tmp_path) -> None:
    pytest.importorskip("fcntl")
    path = tmp_path / "shared.csv"
    with (
        ResumableCsv(path, HEAD, COLUMNS, identity="study"),
        pytest.raises(TableFileError, match="being written by another process"),
    ):
        ResumableCsv(path, HEAD, COLUMNS, identity="study", restart=True)
    assert grow(path) == 0


def test_a_head_has_fewer_than_ten_thousand_lines(tmp_path) -> None:
    """A file of nothing but such lines must not fill the memory."""
    head = HEAD | {f"n{i}": "" for i in range(9_995)}  # and the names of the columns
    assert [grow(tmp_path / "a.csv", head=head) for _ in range(2)] == [0, len(ROWS)]
    longer = head | {"more": ""}
    assert grow(tmp_path / "b.csv", head=longer) == 0
    with pytest.raises(TableFileError, match="holds something else"):
        grow(tmp_path / "b.csv", head=longer)


def test_appending_a_row_out_of_order_raises(tmp_path) -> None:
    with ResumableCsv(tmp_path / "a.csv", HEAD, COLUMNS, identity="study") as table:
        list(table.read())
        with pytest.raises(ValueError, match="row 1 is not the next one"):
            table.append([("1", "x")])


def test_an_unwritable_path_is_a_one_line_error(tmp_path) -> None:
    with pytest.raises(TableFileError, match="its folder does not exist"):
        grow(tmp_path / "no" / "a.csv")
    with pytest.raises(TableFileError, match="is a directory"):
        grow(tmp_path)


def test_a_new_table_counts_its_rows_and_those_of_its_head(tmp_path) -> None:
    """A row that someone changes before it is read again is named where it stands."""
    path = tmp_path / "new.csv"
    with ResumableCsv(path, HEAD, COLUMNS, identity="study") as table:
        assert table.rows == 0
        list(table.read())
        table.append(ROWS[:3])
        assert table.rows == 3
        text = path.read_bytes()
        path.write_bytes(text.replace(b"1,0.14", b"1,0.15"))
        with pytest.raises(TableFileError, match="its checksum differs") as caught:
            list(table.read())
    assert caught.value.row == 6  # three lines of the head, the names, row 0
    umask = os.umask(0)
    os.umask(umask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~umask
