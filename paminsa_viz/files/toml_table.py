"""A table of a design file, read key by key."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NoReturn, TypeVar

from paminsa_viz.errors import InvalidInput, PaminsaError, name_hint
from paminsa_viz.files.errors import DesignFileError

# ---------------------------------------------------------------------------------- lines of a text


def find_line(text: str, key: str) -> int | None:
    """Return the line of a TOML text, counted from 1, that sets a dotted key or opens a table.

    Reads headings and plain assignments only, which is what design files consist of; None if the
    key is not found that way. The tables of a list are numbered: ``"counterweights.1.bar"``. One
    pass over the text, by hand: a pattern could take quadratic time on a hostile one.
    """
    table = ""
    counts: dict[str, int] = {}
    for number, line in enumerate(text.split("\n") if key else (), 1):
        line = line.strip()
        if line.startswith("["):
            table = path = _plain(line.lstrip("[").partition("]")[0])
            if line.startswith("[["):
                counts[path] = counts.get(path, -1) + 1
                table = path = f"{path}.{counts[path]}"
        else:
            name = _left_side(line)
            if not name:
                continue
            path = f"{table}.{_plain(name)}" if table else _plain(name)
        if path == key or path.startswith(f"{key}."):
            return number
    return None


def nearest_line(text: str, key: str) -> int | None:
    """Return the line of a dotted key, or of the innermost table around it that has one."""
    line = None
    while key and line is None:
        line = find_line(text, key)
        key = key.rpartition(".")[0]
    return line


def _left_side(line: str) -> str:
    """Return the text before the first ``=`` outside of quotes, empty without one."""
    quote = ""
    for place, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "#=":
            return line[:place] if character == "=" else ""
    return ""


def _plain(dotted: str) -> str:
    """Return a dotted key without quotes and the blanks around its dots."""
    return ".".join(part.strip().strip("\"'") for part in dotted.split("."))


# --------------------------------------------------------------------------------- tables of a file

T = TypeVar("T")

_KINDS = {
    str: "a word", bool: "true or false", float: "a number", int: "a whole number",
    list: "a list", dict: "a table",
}  # fmt: skip


class TomlTable:
    """One table of a design file, whose keys are taken one by one; errors name their line.

    Args:
        text: The whole file.
        source: The file's name.
        path: The table's dotted name.
        table: Its content.
        key_of: Keys of arguments that are refused, where they have other names.
    """

    def __init__(
        self,
        text: str,
        source: str,
        path: str,
        table: object,
        key_of: Mapping[str, str] | None = None,
    ) -> None:
        self.text, self.source, self.path, self.key_of = text, source, path, key_of or {}
        self.known: list[str] = []
        if not isinstance(table, dict):
            self.refuse("", table, f"{_KINDS[dict]} is needed")
        self.left = dict(table)

    def refuse(self, name: str, value: object, problem: str) -> NoReturn:
        """Raise the file's error of a key, or of the table for an empty name."""
        key = f"{self.path}.{name}".rstrip(".")
        line = nearest_line(self.text, key)
        raise DesignFileError(self.source, problem, line=line, key=key, value=value)

    @contextmanager
    def errors_at(self, name: str) -> Iterator[None]:
        """Let what is refused within be the file's error at a key, or at the argument's own."""
        try:
            yield
        except DesignFileError:
            raise
        except InvalidInput as error:
            key = name or self.key_of.get(error.argument, error.argument)
            self.refuse(key, None, error.problem)
        except PaminsaError as error:
            self.refuse(name, None, str(error))

    def take(self, name: str, kind: type, default: Any = ...) -> Any:
        """Return a value of a kind: a number, a word, true or false, a list, a table, or any."""
        self.known.append(name)
        if name not in self.left:
            if default is ...:
                self.refuse(name, None, "this key is needed")
            return default
        value = self.left.pop(name)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind in (int, float)):
            self.refuse(name, value, f"{_KINDS[kind]} is needed")
        return value

    def numbers(self, name: str, count: int, default: Any = ..., *, needed: str = "") -> Any:
        """Return a list of so many numbers."""
        value = self.take(name, object, default)
        if value is default:
            return default
        right = isinstance(value, list) and len(value) == count
        if not right or any(isinstance(v, bool) or not isinstance(v, (int, float)) for v in value):
            self.refuse(name, value, needed or f"a list of {count} numbers is needed")
        return tuple(map(float, value))

    def words(self, name: str, kind: type, meanings: Mapping[str, T]) -> tuple[T, ...] | None:
        """Return what a word, or each of a list, means; None if the key is left out."""
        value = self.take(name, kind, None)
        if value is None:
            return None
        found = value if isinstance(value, list) else [value]
        for word in found:
            if not isinstance(word, str) or word not in meanings:
                needed = " or ".join(f'"{known}"' for known in meanings)
                self.refuse(name, word, f"{needed} is needed")
        return tuple(meanings[word] for word in found)

    def table(self, name: str, value: object) -> TomlTable:
        """Return a table within this one."""
        return TomlTable(self.text, self.source, f"{self.path}.{name}", value)

    def rows(self, name: str, read: Callable[[TomlTable], T]) -> tuple[T, ...]:
        """Return what is read from each of the tables of a list."""
        rows = self.take(name, object, [])
        if not isinstance(rows, list):
            self.refuse(name, rows, f"tables [[{self.path}.{name}]] are needed")
        found = []
        for number, row in enumerate(rows):
            item = self.table(f"{name}.{number}", row)
            with self.errors_at(name):
                found.append(read(item))
            item.end()
        return tuple(found)

    def each_key(
        self, name: str, meanings: Mapping[str, str], read: Callable[[TomlTable, str, str], T]
    ) -> tuple[T, ...]:
        """Return what is read for each key of a table by what the key means, in their order."""
        item = self.table(name, self.take(name, object, {}))
        keys = [key for key in item.left if key in meanings]
        item.known = list(meanings)
        found = []
        for key in keys:
            with item.errors_at(key):
                found.append(read(item, key, meanings[key]))
        item.end()
        return tuple(found)

    def end(self) -> None:
        """Refuse what is left."""
        for name in self.left:
            self.refuse(name, None, f"there is no such key; {name_hint(name, self.known, 0.5)}")
