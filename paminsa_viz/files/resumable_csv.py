"""A resumable CSV table: a run that writes it for hours may be killed at any moment and continued.

Every row begins with its number. Rows are appended in order, so that all a kill can leave behind is
a last line without its end. That line is cut off, and the next row written in its place. A checksum
at the end of every row tells one that was changed since.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from typing import BinaryIO

from paminsa_viz.errors import TableFileError, printable
from paminsa_viz.files.atomic import file_errors, keep_others_off
from paminsa_viz.files.tables import header_lines

CHECKSUM = "crc32"
"""Column of the rows' checksums: CRC-32 of the text before it, in hexadecimal digits."""

LONGEST_LINE = 1_000_000
"""Longest line [bytes]; a file of something else must not fill the memory."""

AGAIN = "begin again with restart (--restart on the command line)"
"""What can always be done about a table that is refused."""


class ResumableCsv:
    """An open table that rows are appended to.

    Attributes:
        rows: Number of complete rows in the file.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        head: Mapping[str, str],
        columns: Sequence[str],
        *,
        identity: str,
        restart: bool = False,
    ) -> None:
        """Open a table, or start one where there is none.

        Args:
            path: The file.
            head: Key and value of the ``#`` lines at the top of a new table, each on one line. A
                table begins with the first of them.
            columns: Names of the columns; the first one is the row's number.
            identity: Key of the head that tells this table from others. The lines below it are
                what it follows from: where it differs, the first of them that does is named.
            restart: Throw away what the file holds.

        Raises:
            TableFileError: If the file cannot be used, holds something else, or is being written
                by another process.
        """
        self._source = os.fspath(path)
        self._columns = tuple(columns)
        self.rows = 0
        with self._named():
            # Neither "r+" nor "w": what is there stays, and what is not there is made.
            number = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
            self._file: BinaryIO = open(number, "r+b")  # noqa: SIM115  closed in close()
        try:
            keep_others_off(number, self._source, TableFileError)
            with self._named():
                if restart:
                    self._file.truncate(0)
                if not self._find_head(head, identity):
                    self._begin(head)
        except BaseException:
            self._release()
            raise

    def __enter__(self) -> ResumableCsv:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Put everything on the disk and close the file."""
        with suppress(OSError):  # what cannot be synced, such as a pipe, has no more to offer
            os.fsync(self._file.fileno())
        self._release()

    def _release(self) -> None:
        # What could not be written has been reported; closing the file would try it once more.
        with suppress(OSError):
            self._file.close()

    def _named(self) -> AbstractContextManager[None]:
        return file_errors(self._source, "written", TableFileError)

    def read(self) -> Iterable[tuple[str, ...]]:
        """Yield the rows that are there, check them, and cut off a last one without its end.

        Has to be run through before `append`.

        Raises:
            TableFileError: At a row that is none, is not the next one, or was changed, and if the
                file cannot be read or cut off.
        """
        with self._named():
            yield from self._rows()

    def _rows(self) -> Iterator[tuple[str, ...]]:
        self.rows = 0
        end = self._file.seek(self._start)
        while (line := self._file.readline(LONGEST_LINE)).endswith(b"\n"):
            text = line.decode("utf-8", "replace")[:-1]
            *cells, checksum = text.split(",")
            if not cells or cells[0] != str(self.rows):
                raise self._row_error(f"is not the row {self.rows} that belongs here")
            if checksum != _checksum(",".join(cells)):
                raise self._row_error("was changed after it was written: its checksum differs")
            if len(cells) != len(self._columns):
                raise self._row_error(f"is not the row {self.rows} that belongs here")
            end += len(line)
            yield tuple(cells)
            self.rows += 1
        self._file.truncate(end)
        self._file.seek(end)

    def _row_error(self, problem: str) -> TableFileError:
        """Return the error of the row that is being read, with what can be done about it."""
        problem += f"; restore it, cut the file off before it, or {AGAIN}"
        return TableFileError(self._source, problem, row=self._head_lines + self.rows + 1)

    def append(self, rows: Iterable[Sequence[str]]) -> None:
        """Append rows, numbered on from those that are there, and hand them to the system.

        Raises:
            TableFileError: If they cannot be written; the file can still be continued.
        """
        lines = []
        for cells in rows:
            if cells[0] != str(self.rows + len(lines)):
                raise ValueError(f"row {cells[0]} is not the next one")
            text = ",".join(cells)
            lines.append(f"{text},{_checksum(text)}\n")
        self._write("".join(lines))
        self.rows += len(lines)

    def _write(self, text: str) -> None:
        with self._named():
            self._file.write(text.encode())
            self._file.flush()

    def _find_head(self, head: Mapping[str, str], identity: str) -> bool:
        """Read the lines above the rows; return false if a kill left no more than a part of them.

        Raises:
            TableFileError: If they are not those of this table.
        """
        wanted = f"# {identity}: {head[identity]}"
        first = _first(head).encode()
        found: list[str] = []
        for number in range(1, 10_000):
            line = self._file.readline(LONGEST_LINE)
            if number == 1 and not (line.startswith(first) or first.startswith(line)):
                break
            if not line.endswith(b"\n"):
                return False
            text = line.decode("utf-8", "replace").rstrip("\n")
            if text.startswith("#"):
                found.append(text)
            elif wanted in found and text == self._heading():
                self._head_lines, self._start = number, self._file.tell()
                return True
            else:
                break
        other = _difference(found, head, identity)
        problem = f"holds {other}; take another name, or {AGAIN}"
        raise TableFileError(self._source, problem)

    def _heading(self) -> str:
        return ",".join((*self._columns, CHECKSUM))

    def _begin(self, head: Mapping[str, str]) -> None:
        self._file.seek(0)
        self._file.truncate()
        self._write(header_lines(head, [self._heading()]))
        self._head_lines, self._start = len(head) + 1, self._file.tell()


def _checksum(text: str) -> str:
    return f"{zlib.crc32(text.encode()):08x}"


def _first(head: Mapping[str, str]) -> str:
    key, value = next(iter(head.items()))
    return f"# {key}: {value}\n"


def _difference(found: Sequence[str], head: Mapping[str, str], identity: str) -> str:
    """Return what a table holds instead, by the first value below the identity that differs."""
    theirs = {key: value for key, _, value in (line[2:].partition(": ") for line in found)}
    if identity not in theirs:
        return "something else"
    for key in (*_below(head, identity), *_below(theirs, identity)):
        there, here = (printable(each.get(key, "none")[:80]) for each in (theirs, head))
        if there != here:
            return f'another {identity}, whose {key} is "{there}", not "{here}"'
    return "something else" if theirs[identity] == head[identity] else f"another {identity}"


def _below(head: Mapping[str, str], identity: str) -> list[str]:
    keys = list(head)
    return keys[keys.index(identity) + 1 :]
