"""The first-principles robot of `tests.oracle` with counterweights, and random ones of those."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from paminsa_viz.model import BAR_ENDS, Counterweight, Design
from tests import oracle

Place = tuple[str, int, float]


def bodies(design: Design, q: tuple[Any, Any, Any, Any]) -> list[oracle.Body]:
    """List the robot's bodies with its counterweights, each a point off an end of its bar."""
    found = _BARE(design, q)
    for index in range(3):
        points = oracle.leg(design, q, index).points
        for number, weight in enumerate(design.counterweights):
            end, other = points[weight.joint], points[weight.other]
            outward = oracle.unit(oracle.add(end, other, -1.0))
            place = oracle.add(end, outward, weight.beyond)
            found.append(oracle.Body(f"leg {index + 1}: weight {number}", weight.mass, place))
    return found


_BARE = oracle.bodies


@contextmanager
def on_the_bars() -> Iterator[None]:
    """Make the oracle's functions count the counterweights of a design."""
    oracle.bodies = bodies
    try:
        yield
    finally:
        oracle.bodies = _BARE


def random_weights(rng: np.random.Generator, count: int = 6) -> tuple[Counterweight, ...]:
    """Draw counterweights on all bars, at both ends, on the bars and beyond them."""
    ends = [(bar, joint) for bar, joints in BAR_ENDS.items() for joint in joints]
    chosen = rng.permutation(len(ends))[:count]
    return tuple(
        Counterweight(*ends[i], beyond=rng.uniform(-0.15, 0.25), mass=rng.uniform(0.1, 3.0))
        for i in chosen
    )
