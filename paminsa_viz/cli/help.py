"""What ``--help`` says of flags: their docstrings as running text, and choices without None."""

from __future__ import annotations

import ast
import inspect
import textwrap
import typing
from dataclasses import field, fields, make_dataclass
from itertools import pairwise
from typing import Annotated, Any, Union, cast

import tyro


def described(kind: Any) -> Any:
    """Return flags whose help reads well in place of those that are used.

    By itself tyro keeps the line breaks of docstrings, lists None among the choices and as the
    default of a flag that may be left out, and says again what can be repeated.

    Args:
        kind: A dataclass, or a union of subcommands.
    """
    if not inspect.isclass(kind):
        commands = map(typing.get_args, typing.get_args(kind))
        return Union[tuple(Annotated[described(one), mark] for one, mark in commands)]  # noqa: UP007
    texts, hints = flag_texts(kind), typing.get_type_hints(kind, include_extras=True)
    flags = []
    for item in fields(cast(Any, kind)):
        marks = tyro.conf.arg(
            help=texts[item.name], metavar=_taken(hints[item.name]),
            help_behavior_hint="" if item.default in (None, ()) else None,
        )  # fmt: skip
        same = field(default=item.default, default_factory=item.default_factory)  # pyright: ignore
        flags.append((item.name, Annotated[hints[item.name], marks], same))
    made = make_dataclass(kind.__name__, flags, kw_only=True)
    made.__doc__ = ast.get_docstring(_tree(kind))  # what a list of subcommands says
    return made


def flag_texts(kind: type) -> dict[str, str]:
    """Return the text below each field of a dataclass, inherited ones included."""
    found: dict[str, str] = {}
    for owner in reversed(kind.__mro__[:-1]):
        for item, after in pairwise(_tree(owner).body):
            if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
                assert isinstance(after, ast.Expr)
                assert isinstance(after.value, ast.Constant)
                found[item.target.id] = " ".join(str(after.value.value).split())
    return found


def _tree(kind: type) -> ast.ClassDef:
    """Return the source of a class: that of fields is kept nowhere else, nor any by python -OO."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
    assert isinstance(tree, ast.ClassDef)
    return tree


KINDS = {int: "N", float: "X", str: "NAME"}
"""What a flag takes, where nothing says more."""


def _taken(hint: Any) -> str | None:
    """Return how a number or the words are written that a flag takes, or None if tyro knows."""
    kind, *marks = typing.get_args(hint) if hasattr(hint, "__metadata__") else (hint,)
    if any(getattr(mark, "metavar", None) for mark in marks):
        return None
    numbers = [KINDS[one] for one in (kind, *typing.get_args(kind)) if one in KINDS]
    words = [
        word
        for one in typing.get_args(kind)
        if typing.get_origin(one) is typing.Literal
        for word in typing.get_args(one)
    ]
    return f"{{{','.join(map(str, words))}}}" if words else next(iter(numbers), None)
