"""Checks of arguments that are no arrays, each in one line: which, what is allowed, what came.

Those of arrays are in `model.arrays`, those of robots in `model.arguments`.
"""

from __future__ import annotations

import inspect
import math
import os
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache, wraps
from typing import Any, NamedTuple, TypeVar

import numpy as np

from paminsa_viz.errors import InvalidInput

F = TypeVar("F", bound=Callable[..., Any])


def kind_of(value: object) -> str:
    """Return the type of a value that is refused, with its article; None is none."""
    if value is None:
        return "None"
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def way_to(kinds: tuple[Any, ...], value: object) -> str:
    """Return where a refused result has what is needed, as the end of a sentence; often empty."""
    kinds = tuple(kind for kind in kinds if is_dataclass(kind))  # any result holds some number
    if not kinds or not is_dataclass(value) or isinstance(value, type):
        return ""
    held = [item.name for item in fields(value) if isinstance(getattr(value, item.name), kinds)]
    if held:
        return f"; its {' or '.join(held)} is one"
    for name, member in inspect.getmembers(type(value)):
        made = member.fget if isinstance(member, property) else member
        if name[0] != "_" and inspect.isfunction(made) and _returned(made) in kinds:
            return f"; its {name} is one" if made is not member else f"; its {name}() returns one"
    return ""


def _returned(method: Callable[..., Any]) -> Any:
    """Return the annotation of what a method makes of its object alone; None if it needs more."""
    found = inspect.signature(method)
    needed = [item.name for item in found.parameters.values() if item.default is item.empty]
    return None if needed != ["self"] else _annotation(found.return_annotation, method)


def require_kind(value: object, argument: str, *kinds: type) -> None:
    """Raise `InvalidInput` unless a value is of one of some types."""
    if not isinstance(value, kinds):
        allowed = " or ".join(kind.__name__ for kind in kinds)
        article = "an" if allowed[0] in "aeiouAEIOU" else "a"
        raise InvalidInput(argument, f"{article} {allowed} is needed, not {kind_of(value)}")


def require_each(values: Iterable[Any], argument: str, *kinds: type) -> None:
    """Raise `InvalidInput` unless values are a list or tuple of such types."""
    allowed = " or ".join(kind.__name__ for kind in kinds)
    if not isinstance(values, list | tuple):
        raise InvalidInput(argument, f"a list of {allowed} is needed, not {kind_of(values)}")
    for value in values:
        if not isinstance(value, kinds):
            raise InvalidInput(argument, f"each has to be a {allowed}, not {kind_of(value)}")


def require_count(value: Any, argument: str, most: int, least: int = 1) -> None:
    """Raise `InvalidInput` unless a value is a whole number from the least to the most."""
    whole = _is_number(value) and isinstance(value, int | np.integer)
    if not (whole and least <= value <= most):
        raise InvalidInput(argument, f"{least} to {most} are possible, not {value!r}")


def require_positive(
    value: Any, argument: str, what: str = "a number above 0", *, finite: bool = True
) -> None:
    """Raise `InvalidInput` unless a value is a number above 0.

    Args:
        value: The value.
        argument: Its name.
        what: What is needed, in words.
        finite: Whether infinity, such as that of no limit, is refused.
    """
    if not (_is_number(value) and value > 0 and (not finite or math.isfinite(value))):
        raise InvalidInput(argument, f"{what} is needed, not {value!r}")


def require_at_least(
    value: Any,
    argument: str,
    least: float = 0.0,
    what: str = "a number of at least 0",
    *,
    finite: bool = True,
) -> None:
    """Raise `InvalidInput` unless a value is a number of at least ``least``.

    Args:
        value: The value.
        argument: Its name.
        least: The smallest that is possible.
        what: What is needed, in words.
        finite: Whether infinity, such as that of no limit, is refused.
    """
    if not (_is_number(value) and value >= least and (not finite or math.isfinite(value))):
        raise InvalidInput(argument, f"{what} is needed, not {value!r}")


def require_range(low: Any, high: Any, argument: str) -> None:
    """Raise `InvalidInput` unless two values are finite numbers, the first one less."""
    ends = (low, high)
    if not (all(_is_number(end) and math.isfinite(end) for end in ends) and low < high):
        problem = f"a range with low < high is needed, not {low!r} to {high!r}"
        raise InvalidInput(argument, problem)


def require_share(value: Any, argument: str) -> None:
    """Raise `InvalidInput` unless a value is a number from 0 to 1."""
    if not (_is_number(value) and 0 <= value <= 1):
        raise InvalidInput(argument, f"a number from 0 to 1 is needed, not {value!r:.60}")


def require_seed(value: Any) -> None:
    """Raise `InvalidInput` unless a value can be the seed of random numbers."""
    whole = _is_number(value) and isinstance(value, int | np.integer)
    if not (whole and value >= 0):
        raise InvalidInput("seed", f"a whole number of at least 0 is needed, not {value!r}")


def _is_number(value: object) -> bool:
    """Return whether a value is a real number; a truth value is none."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


_KINDS: dict[Any, tuple[tuple[Any, ...], str]] = {
    type(None): ((type(None),), ""),
    bool: ((bool, np.bool_), "bool"),
    float: ((int, float, np.integer, np.floating), "number"),
    int: ((int, np.integer), "whole number"),
    str: ((str,), "text"),
    os.PathLike: ((os.PathLike,), "path"),
    Mapping: ((Mapping,), "mapping"),
    Sequence: ((list, tuple, np.ndarray, range), "list"),
    list: ((list, tuple), "list"),
    Callable: ((Callable,), "function"),
}
"""What is taken for an annotation, and its name in messages; other classes stand for themselves."""


class _Rule(NamedTuple):
    """What an argument may be, by its annotation."""

    place: int
    name: str
    kinds: tuple[Any, ...]
    allowed: str
    rest: bool  # whether it takes all further arguments, as ``*plans`` does

    def check(self, value: object) -> None:
        # A bool is an int to Python, but True is a slip where a number is asked for.
        if isinstance(value, self.kinds) and (bool in self.kinds or not isinstance(value, bool)):
            return
        if float in self.kinds and isinstance(value, np.ndarray) and value.shape == ():
            return
        article = "an" if self.allowed[0] in "aeiouAEIOU" else "a"
        problem = f"{article} {self.allowed} is needed, not {kind_of(value)}"
        raise InvalidInput(self.name, problem + way_to(self.kinds, value))


def kinds_checked(function: F) -> F:
    """Let a function refuse arguments that are not of the kinds that it is annotated with.

    The decorated function raises InvalidInput. Arrays, protocols of more than a call, and the items
    of lists are left to the function itself.
    """

    @wraps(function)
    def call(*args: Any, **named: Any) -> Any:
        check_arguments(function, args, named)
        return function(*args, **named)

    return typing.cast(F, call)


def check_arguments(
    function: Callable[..., Any], args: tuple[Any, ...], named: Mapping[str, Any]
) -> None:
    """Raise `InvalidInput` if an argument is not of the kind that it is annotated with."""
    for rule in _rules(function):
        if rule.rest:
            for value in args[rule.place :]:
                rule.check(value)
        elif rule.place < len(args):
            rule.check(args[rule.place])
        elif rule.name in named:
            rule.check(named[rule.name])


def check_fields(record: object) -> None:
    """Raise `InvalidInput` if a field of a data class is not of the kind of its annotation."""
    for rule in _rules(type(record).__init__):
        if rule.name in vars(record):
            rule.check(getattr(record, rule.name))


@cache
def _rules(function: Callable[..., Any]) -> tuple[_Rule, ...]:
    rules = []
    for place, item in enumerate(inspect.signature(function).parameters.values()):
        if item.annotation is item.empty:  # such as self
            continue
        found = _kinds(_annotation(item.annotation, function))
        if found and item.kind is not item.VAR_KEYWORD:
            kinds, allowed = found
            where = place if item.kind is not item.KEYWORD_ONLY else 1_000
            rest = item.kind is item.VAR_POSITIONAL
            rules.append(_Rule(where, item.name, kinds, allowed, rest))
    return tuple(rules)


def _annotation(text: Any, function: Callable[..., Any]) -> Any:
    """Return what an annotation stands for; `Any` where it is imported for type checkers alone."""
    try:
        return eval(text, inspect.unwrap(function).__globals__) if isinstance(text, str) else text
    except (NameError, TypeError):
        return Any


def _kinds(annotation: Any) -> tuple[tuple[Any, ...], str] | None:
    """Return the types that an annotation allows, and their names; None if any will do."""
    origin = typing.get_origin(annotation)
    if origin in (types.UnionType, typing.Union, typing.Literal):
        parts = typing.get_args(annotation)
        words = origin is typing.Literal
        found = [_kinds(type(part) if words else part) for part in parts]
        if not all(found):
            return None
        kinds = tuple(kind for part in found if part for kind in part[0])
        return kinds, " or ".join(dict.fromkeys(part[1] for part in found if part and part[1]))
    if origin is typing.Annotated:
        return _kinds(typing.get_args(annotation)[0])
    kind = origin or annotation or type(None)
    if kind in _KINDS:
        return _KINDS[kind]
    if not isinstance(kind, type) or kind in (object, Any):
        return None
    if getattr(kind, "_is_protocol", False):
        return ((Callable,), kind.__name__) if "__call__" in vars(kind) else None
    return None if issubclass(kind, np.ndarray) else ((kind,), kind.__name__)
