"""Arguments of other kinds than those that a function is annotated with are refused by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, Protocol

import numpy as np
import pytest

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, name_hint


class Color(Enum):
    RED = 1


class Walk(Protocol):
    def __call__(self, done: float) -> bool: ...


class Shaped(Protocol):
    shape: tuple[int, ...]


@dataclass(frozen=True)
class Paint:
    size: float


@dataclass(frozen=True)
class Held:
    layer: Paint


@dataclass(frozen=True)
class Twice:
    before: Paint
    after: Paint


@dataclass(frozen=True)
class Made:
    size: float

    def other(self, size: float) -> Paint:
        return Paint(self.size + size)

    def paint(self, plain: bool = True) -> Paint:
        return Paint(self.size) if plain else self.other(0.0)


@kinds_checked
def painted(paint: Paint) -> float:
    """Return the size of some paint."""
    return paint.size


@kinds_checked
def function(
    color: Color,
    size: float = 1.0,
    *more: int,
    name: str | None = None,
    kind: Literal["a", "b"] = "a",
    walk: Walk | None = None,
    shaped: Shaped | None = None,
    table: Mapping[str, float] | None = None,
    items: Sequence[str] = (),
    call: Callable[[], None] = lambda: None,
    any_one: Any = None,
    unknown: NotThere | None = None,  # type: ignore[name-defined]  # noqa: F821
) -> tuple[Color, float, tuple[int, ...]]:
    """Return what came."""
    return color, size, more


@pytest.mark.parametrize(
    ("args", "named"),
    [
        ((Color.RED,), {}),
        ((), {"color": Color.RED, "size": 2}),
        ((Color.RED, np.float32(2.0), 3, np.int64(4)), {"name": "x"}),
        ((Color.RED, np.array(2.0)), {"walk": lambda done: True, "items": ["a"]}),
        ((Color.RED,), {"table": {}, "items": np.array(["a"]), "call": print, "kind": "b"}),
        ((Color.RED,), {"name": None, "walk": None, "shaped": "left to the function"}),
        ((Color.RED,), {"any_one": object(), "unknown": "known to type checkers alone"}),
    ],
)
def test_what_fits_goes_through(args: tuple[Any, ...], named: dict[str, Any]) -> None:
    assert function(*args, **named)[0] is Color.RED


@pytest.mark.parametrize(
    ("args", "named", "message"),
    [
        ((1,), {}, "color: a Color is needed, not an int"),
        ((), {"color": None}, "color: a Color is needed, not None"),
        ((Color.RED, "1"), {}, "size: a number is needed, not a str"),
        ((Color.RED, np.zeros(2)), {}, "size: a number is needed, not a ndarray"),
        ((Color.RED, True), {}, "size: a number is needed, not a bool"),
        ((Color.RED, 1.0, True), {}, "more: a whole number is needed, not a bool"),
        ((Color.RED, 1.0, 2, 2.5), {}, "more: a whole number is needed, not a float"),
        ((Color.RED,), {"name": 3}, "name: a text is needed, not an int"),
        ((Color.RED,), {"kind": 3}, "kind: a text is needed, not an int"),
        ((Color.RED,), {"walk": 3}, "walk: a Walk is needed, not an int"),
        ((Color.RED,), {"table": []}, "table: a mapping is needed, not a list"),
        ((Color.RED,), {"items": "ab"}, "items: a list is needed, not a str"),
        ((Color.RED,), {"call": 3}, "call: a function is needed, not an int"),
        ((Color.RED, Held(Paint(1.0))), {}, "size: a number is needed, not a Held"),
    ],
)
def test_what_does_not_fit_is_named(
    args: tuple[Any, ...], named: dict[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput) as caught:
        function(*args, **named)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("given", "came"),
    [
        (Held(Paint(1.0)), "a Held; its layer is one"),
        (Twice(Paint(1.0), Paint(2.0)), "a Twice; its before or after is one"),
        (Made(1.0), "a Made; its paint() returns one"),
        (Made, "a type"),
    ],
    ids=["field", "fields", "method", "class"],
)
def test_a_result_that_has_what_is_needed_says_where(given: Any, came: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        painted(given)
    assert str(caught.value) == f"paint: a Paint is needed, not {came}"


def test_the_function_keeps_its_name_and_text() -> None:
    assert (function.__name__, function.__doc__) == ("function", "Return what came.")


def test_a_hint_says_that_there_are_no_names() -> None:
    assert name_hint("x", []) == "there are none"
    assert name_hint("x", [], there="[links] has") == "[links] has none"
    assert name_hint("x", ["first", "second"]) == "there are first, second"
