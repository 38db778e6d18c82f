"""Checks on the robot that a public function takes as its first argument.

A function of lengths takes a whole `Design` as well; what is no robot at all is refused in one
line that says which argument, what came and what is allowed. The other arguments are checked by
their annotations, see `checks.kinds_checked`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

from paminsa_viz.checks import check_arguments, kind_of, way_to
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import PARAMETER, Design, Geometry

P = ParamSpec("P")
R = TypeVar("R")


def geometry_of(value: object) -> Geometry:
    """Return a geometry, or that of a design.

    Raises:
        InvalidInput: If it is neither.
    """
    if isinstance(value, Geometry):
        return value
    if isinstance(value, Design):
        return value.geometry
    problem = f"a Geometry or a Design is needed, not {kind_of(value)}"
    raise InvalidInput("geometry", problem + _way_to_robot((Geometry, Design), value))


def _way_to_robot(kinds: tuple[type, ...], value: object) -> str:
    """Return where a refused value has the robot, as the end of a sentence; often empty."""
    if isinstance(value, str | os.PathLike):
        return "; load_design(path) reads one"
    if isinstance(value, Geometry):
        return "; Design(geometry=...) has Appendix 4's masses"
    return way_to(kinds, value)


def require_gravity(gravity: float) -> None:
    """Raise `InvalidInput` unless this can be the gravity of a design."""
    parameter = PARAMETER["gravity"]
    problem = parameter.refusal(gravity, parameter.display)
    if problem:
        raise InvalidInput("gravity", f"{problem}, not {gravity!r}")


def of_geometry(
    function: Callable[Concatenate[Geometry, P], R],
) -> Callable[Concatenate[Geometry | Design, P], R]:
    """Let a function whose first argument is a `Geometry` take a `Design`, and refuse all else.

    The decorated function raises InvalidInput if its first argument is neither.
    """

    return cast(Any, _checked(function, "geometry", geometry_of))


def of_design(function: Callable[P, R]) -> Callable[P, R]:
    """Let a function whose first argument is a `Design` refuse all else.

    The decorated function raises InvalidInput if its first argument is no design. Its type is as
    before, so that a type checker lets ``design=`` be named, too.
    """

    def design_of(value: object) -> Design:
        if isinstance(value, Design):
            return value
        problem = f"a Design is needed, not {kind_of(value)}"
        raise InvalidInput("design", problem + _way_to_robot((Design,), value))

    return cast(Any, _checked(function, "design", design_of))


def _checked(
    function: Callable[..., R], argument: str, check: Callable[[object], object]
) -> Callable[..., R]:
    @wraps(function)
    def checked(*args: Any, **named: Any) -> R:
        if args:
            args = (check(args[0]), *args[1:])
        elif argument in named:
            named[argument] = check(named[argument])
        check_arguments(function, args, named)
        return function(*args, **named)

    return checked
