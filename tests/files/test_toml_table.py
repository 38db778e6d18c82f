"""Tables of a design file: what is taken, and what is refused with its line and key."""

from __future__ import annotations

from itertools import count
from typing import Any

import pytest

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.toml_table import TomlTable

TEXT = """\
[need]
word = "a"
size = 2
share = 0.5
on = true
pair = [1, 2.5]
names = ["a", "b"]

[need.inner]
a = 1
b = 2

[[need.rows]]
size = 3

[[need.rows]]
size = 4
"""
CONTENT: dict[str, Any] = {
    "word": "a", "size": 2, "share": 0.5, "on": True, "pair": [1, 2.5], "names": ["a", "b"],
    "inner": {"a": 1, "b": 2}, "rows": [{"size": 3}, {"size": 4}],
}  # fmt: skip


def table(**changes: Any) -> TomlTable:
    return TomlTable(TEXT, "case.toml", "need", CONTENT | changes, {"width": "size"})


def test_values_are_taken_as_their_kinds() -> None:
    need = table()
    assert need.take("word", str) == "a"
    size, share = need.take("size", float), need.take("share", float)
    assert (size, type(size), share) == (2.0, float, 0.5)
    assert need.take("on", bool) is True
    assert need.numbers("pair", 2) == (1.0, 2.5)
    assert all(type(value) is float for value in table().numbers("pair", 2))
    assert need.words("names", list, {"a": 1, "b": 2}) == (1, 2)
    assert need.take("missing", float, 7) == 7
    assert need.numbers("missing", 2, None) is None
    assert need.words("missing", str, {"a": 1}) is None
    assert need.rows("missing", lambda row: row) == ()
    assert table().words("word", str, {"a": 1}) == (1,)
    assert table().take("size", int) == 2
    read = need.each_key("inner", {"b": "B", "a": "A"}, lambda item, k, m: (m, item.take(k, int)))
    assert read == (("A", 1), ("B", 2))
    assert need.rows("rows", lambda row: row.take("size", int)) == (3, 4)
    need.end()


@pytest.mark.parametrize(
    ("changes", "take", "line", "problem"),
    [
        ({}, lambda t: t.take("gone", str), 1, "need.gone: this key is needed"),
        ({}, lambda t: t.take("size", str), 3, "need.size = 2: a word is needed"),
        ({}, lambda t: t.take("word", float), 2, "need.word = 'a': a number is needed"),
        ({}, lambda t: t.take("on", float), 5, "need.on = True: a number is needed"),
        ({}, lambda t: t.take("on", int), 5, "need.on = True: a whole number is needed"),
        ({}, lambda t: t.take("share", int), 4, "need.share = 0.5: a whole number is needed"),
        ({}, lambda t: t.take("size", bool), 3, "need.size = 2: true or false is needed"),
        ({}, lambda t: t.take("word", list), 2, "need.word = 'a': a list is needed"),
        ({}, lambda t: t.numbers("pair", 3), 6, "a list of 3 numbers is needed"),
        ({}, lambda t: t.numbers("names", 2), 7, "a list of 2 numbers is needed"),
        ({"pair": [1, True]}, lambda t: t.numbers("pair", 2), 6, "a list of 2 numbers is needed"),
        ({}, lambda t: t.numbers("share", 2, needed="two ends are needed"), 4, "two ends are"),
        ({}, lambda t: t.words("names", list, {"a": 1, "c": 3}), 7, 'b\': "a" or "c" is needed'),
        ({"names": ["a", 1]}, lambda t: t.words("names", list, {"a": 1}), 7, '"a" is needed'),
        ({"rows": 1}, lambda t: t.rows("rows", None), 13, "tables [[need.rows]] are needed"),
        ({"rows": [{}, 1]}, lambda t: t.rows("rows", id), 16, "need.rows.1 = 1: a table is needed"),
        ({}, lambda t: t.rows("rows", id), 14, "need.rows.0.size: there is no such key"),
        ({"inner": 1}, lambda t: t.each_key("inner", {}, id), 9, "need.inner = 1: a table is"),
        (
            {},
            lambda t: t.each_key("inner", {"a": "A", "bee": "B"}, lambda i, k, _: i.take(k, int)),
            11, "need.inner.b: there is no such key; did you mean bee",
        ),
        ({}, lambda t: (t.take("sizes", int, 1), t.end()), 2, "need.word: there is no such key"),
    ],
    ids=count(),
)  # fmt: skip
def test_what_is_refused_names_line_and_key(changes, take, line: int, problem: str) -> None:
    with pytest.raises(DesignFileError) as caught:
        take(table(**changes))
    found = caught.value
    said = f" = {found.value!r}" if found.value is not None else ""
    assert problem in f"{found.key}{said}: {found.problem}"
    assert found.line == line
    assert str(found).startswith(f"case.toml, line {line}, [need")


def test_errors_within_are_the_files_at_their_key_or_at_the_arguments_own() -> None:
    def error_of(name: str, error: Exception) -> DesignFileError:
        with pytest.raises(DesignFileError) as caught, table().errors_at(name):
            raise error
        return caught.value

    for name, error, line, key in (
        ("", InvalidInput("width", "is odd"), 3, "need.size"),
        ("", InvalidInput("share", "is odd"), 4, "need.share"),
        ("pair", InvalidInput("width", "is odd"), 6, "need.pair"),
        ("word", PaminsaError("is odd"), 2, "need.word"),
    ):
        found = error_of(name, error)
        assert (found.line, found.key, found.problem) == (line, key, "is odd")
    own = DesignFileError("other.toml", "is odd", line=9)
    assert error_of("word", own) is own
    with pytest.raises(DesignFileError, match="a table is needed"):
        TomlTable(TEXT, "case.toml", "need", [1])
