"""The source of formulas as syntax trees: functions, records, comments, docstrings."""

from __future__ import annotations

import ast
import inspect
import io
import textwrap
import tokenize
from dataclasses import dataclass
from types import FunctionType
from typing import Any, NamedTuple, TypeGuard, Union

from paminsa_viz.errors import PaminsaError


class NotPrintable(PaminsaError):
    """A formula uses Python that has no counterpart in the printed languages."""

    def __init__(self, function: str, line: int, what: str) -> None:
        self.function, self.line, self.what = function, line, what
        super().__init__(f"{function}, line {line}: {what} cannot be printed")


@dataclass(frozen=True)
class Record:
    """A named tuple, or what a function returns as a plain tuple.

    Attributes:
        name: Name of the type or of the function.
        fields: Names of the values; empty for a tuple whose values have no names.
        size: Number of values.
        comments: What the source says beside each field.
        doc: The docstring.
    """

    name: str
    fields: tuple[str, ...]
    size: int
    comments: tuple[str, ...] = ()
    doc: str = ""


class Plain(NamedTuple):
    """A type that is no record: ``"real"``, ``"truth"`` or ``"index"``."""

    name: str


REAL, TRUTH, INDEX = Plain("real"), Plain("truth"), Plain("index")

Kind = Union[Plain, Record]  # noqa: UP007


@dataclass(frozen=True)
class Source:
    """A function: its syntax tree, the names that it sees, and the comments by line."""

    function: FunctionType
    tree: ast.FunctionDef
    comments: dict[int, str]
    doc: str

    @property
    def names(self) -> dict[str, Any]:
        """Names of the module that the function is in."""
        return getattr(self.function, "__globals__")  # noqa: B009


def read_source(function: FunctionType) -> Source:
    """Return a function's source.

    Raises:
        NotPrintable: If there is no source.
    """
    try:
        text = textwrap.dedent(inspect.getsource(function))
    except OSError:
        raise NotPrintable(function.__name__, 0, "a function without source") from None
    tree = ast.parse(text).body[0]
    if not isinstance(tree, ast.FunctionDef):
        raise NotPrintable(function.__name__, 1, "what is no function")
    return Source(function, tree, _comments(text), ast.get_docstring(tree) or "")


def read_record(kind: type) -> Record:
    """Return a named tuple's fields with the comments beside them."""
    text = textwrap.dedent(inspect.getsource(kind))
    tree, comments = ast.parse(text).body[0], _comments(text)
    assert isinstance(tree, ast.ClassDef)
    lines = {
        item.target.id: comments.get(item.lineno, "")
        for item in tree.body
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name)
    }
    names: tuple[str, ...] = getattr(kind, "_fields")  # noqa: B009
    beside = tuple(lines.get(name, "") for name in names)
    return Record(kind.__name__, names, len(names), beside, ast.get_docstring(tree) or "")


def is_record(value: object) -> TypeGuard[type]:
    """Whether a value is a class of named tuples."""
    return isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields")


def _comments(text: str) -> dict[int, str]:
    """Return comments by line, without those that are for tools."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    found = {t.start[0]: t.string.lstrip("# ") for t in tokens if t.type == tokenize.COMMENT}
    return {line: c for line, c in found.items() if not c.startswith(("fmt:", "type:", "noqa"))}
