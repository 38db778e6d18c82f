"""Stiffnesses and free lengths of springs for the best balance over a workspace."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.balancing.convex import MaxAbs, Norm
from paminsa_viz.balancing.program import Program, Variable
from paminsa_viz.balancing.solver import solve
from paminsa_viz.balancing.springs import Spring, SpringPlace, spring_lengths, unit_spring_torques
from paminsa_viz.checks import require_each
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.statics import static_torques


@dataclass(frozen=True)
class SpringFit:
    """The best springs.

    Attributes:
        springs: In the order of the places; a stiffness of zero means that it is not needed.
        before, after: Peak or RMS torque without springs and with them [N m].
        lower_bound: No other stiffnesses and free lengths give less [N m].
        reach: For each spring its shortest and longest length over the poses [m].
        seconds: Time it took.
    """

    springs: tuple[Spring, ...]
    before: float
    after: float
    lower_bound: float
    reach: tuple[tuple[float, float], ...]
    seconds: float

    @property
    def gap(self) -> float:
        """By how much better springs could be better at most [N m]."""
        return max(0.0, self.after - self.lower_bound)


def spring_variable(place: SpringPlace, column: int, size: int) -> Variable:
    """Return a spring's K as a variable, whose lever is L.

    Args:
        place: The spring's place and ranges.
        column: Where K is in the state [N/m]; K L follows it [N].
        size: Length of the state.
    """
    effect = np.zeros((3, size))
    effect[0, column] = effect[1, column + 1] = 1.0
    span = (place.min_free_length, place.max_free_length)
    name = f"{place.first.name} to {place.second.name}"
    return Variable(name, 0.0, place.max_stiffness, effect, span)


def springs_of(places: Sequence[SpringPlace], state: Array) -> tuple[Spring, ...]:
    """Return the springs for a state (2 places,) of K [N/m] and K L [N] by turns."""
    springs = []
    for place, (stiffness, product) in zip(places, state.reshape(-1, 2).tolist(), strict=True):
        free = product / stiffness if stiffness > 0 else place.min_free_length
        springs.append(Spring(place.first, place.second, stiffness, free))
    return tuple(springs)


@of_design
def fit_springs(
    design: Design, places: Sequence[SpringPlace], pose: ArrayLike, *, measure: str = "peak"
) -> SpringFit:
    """Find the stiffnesses and free lengths that balance M1..M3 best over a workspace.

    Args:
        design: The robot, with its masses as they are.
        places: Where springs may be.
        pose: (..., 4) the workspace, for example ``grid.poses()``; poses out of reach do not count.
        measure: ``"peak"`` or ``"rms"`` of the static torques of M1..M3 over the poses.

    Raises:
        InvalidInput: If no pose can be taken, or the measure is another.
    """
    began = time.perf_counter()
    if measure not in ("peak", "rms"):
        raise InvalidInput("measure", f"'peak' or 'rms' is needed, not {measure!r}")
    require_each(places, "places", SpringPlace)
    pose = as_vectors(pose, "pose").reshape(-1, 4)
    gravity = static_torques(design, pose)[:, :3]
    columns = [unit_spring_torques(design.geometry, place, pose) for place in places]
    matrix = np.array([part[:, :3] for pair in columns for part in pair])
    matrix = matrix.reshape(2 * len(places), len(pose), 3)
    good = np.isfinite(gravity).all(axis=1) & np.isfinite(matrix).all(axis=(0, 2))
    if not good.any():
        raise InvalidInput("pose", "the robot cannot take a single one of the poses")
    offset = gravity[good].ravel()
    rows = np.ascontiguousarray(matrix[:, good].reshape(-1, offset.size).T)
    root = np.sqrt(offset.size)
    peak = measure == "peak"
    function = MaxAbs(rows, offset) if peak else Norm.of_many(rows / root, offset / root)
    size = 2 * len(places)
    variables = [spring_variable(place, 2 * i, size) for i, place in enumerate(places)]
    scale = float(np.abs(offset).max())
    found = solve(Program(np.zeros(size), tuple(variables), ((1.0, function),), scale=scale))
    springs = springs_of(places, found.state)
    lengths = [spring_lengths(design.geometry, place, pose[good]) for place in places]
    return SpringFit(
        springs=springs,
        before=function.value(np.zeros(2 * len(places))),
        after=found.value,
        lower_bound=found.bound,
        reach=tuple((float(d.min()), float(d.max())) for d in lengths),
        seconds=time.perf_counter() - began,
    )
