"""Bodies of another size than the prototype's: those of a robot of other lengths, enlarged.

All sizes in `dimensions` are the prototype's. What follows from them and from a robot's lengths,
for bodies s times as large, is s times what follows for the lengths over s. Masses of payload and
counterweights are over the cube of s there, so that their drawn bodies keep their densities.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from functools import wraps
from typing import Any, Concatenate, Final, ParamSpec, TypeVar

from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.parameters import Counterweight, Group

P = ParamSpec("P")
R = TypeVar("R")
G = TypeVar("G", bound=Group)

_POWERS: Final = {"m": 1, "kg": 3}
"""Powers of the size of the bodies that numbers are divided by, by their units."""


def geometry_over_scale(geometry: Geometry) -> Geometry:
    """Return a geometry with its lengths over the size of its bodies, which are the prototype's."""
    scale = geometry.body_scale
    return geometry if scale == 1.0 else _over(geometry, scale, body_scale=1.0)


def weight_over_scale(weight: Counterweight, scale: float) -> Counterweight:
    """Return a counterweight for a geometry over the size of its bodies."""
    return weight if scale == 1.0 else _over(weight, scale)


def design_over_scale(design: Design) -> Design:
    """Return a design with all that its bodies follow from over their size."""
    scale = design.geometry.body_scale
    if scale == 1.0:
        return design
    return replace(
        design,
        geometry=geometry_over_scale(design.geometry),
        payload=_over(design.payload, scale),
        counterweights=tuple(weight_over_scale(w, scale) for w in design.counterweights),
    )


def _over(group: G, scale: float, **others: float) -> G:
    """Return a group with its lengths and masses over powers of a scale.

    It is not checked: the ranges are those of robots, which the group itself was checked for.
    """
    made = object.__new__(type(group))
    vars(made).update(vars(group))
    for item in fields(group):  # type: ignore[arg-type]
        power, value = _POWERS.get(item.metadata.get("unit", "")), getattr(group, item.name)
        if power is not None and value is not None:
            vars(made)[item.name] = value / scale**power
    vars(made).update(others)
    return made


def times_body_scale(
    function: Callable[Concatenate[Geometry, P], R],
) -> Callable[Concatenate[Geometry, P], R]:
    """Let a function that returns lengths for the prototype's bodies know of their size.

    Its first argument is a geometry, its others are no lengths; it returns numbers, arrays, or
    tuples or dataclasses of them.
    """

    @wraps(function)
    def scaled(geometry: Geometry, *args: P.args, **kwargs: P.kwargs) -> R:
        if geometry.body_scale == 1.0:
            return function(geometry, *args, **kwargs)
        found = function(geometry_over_scale(geometry), *args, **kwargs)
        return _times(found, geometry.body_scale)

    return scaled


def _times(lengths: Any, scale: float) -> Any:
    if isinstance(lengths, tuple | list):
        return type(lengths)(_times(each, scale) for each in lengths)
    if is_dataclass(type(lengths)):
        values = {item.name: scale * getattr(lengths, item.name) for item in fields(lengths)}
        return replace(lengths, **values)
    return scale * lengths
