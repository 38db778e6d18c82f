"""Sensitivity of torques to each mass and each length: the data of a tornado chart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from paminsa_viz.balancing.changes import AMOUNTS, Changes, MassRange, mass_space
from paminsa_viz.balancing.convex import ConvexTerm
from paminsa_viz.balancing.terms import (
    MP2,
    StaticPeak,
    StaticRms,
    TrajectoryPeak,
    TrajectoryRms,
)
from paminsa_viz.errors import InvalidDesign, InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import MECHANISM_PATHS, PARAMETER, Design
from paminsa_viz.model.grids import Field, Grid, solve_field
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.reach import Limit
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.trajectory.sampled import Trajectory
from paminsa_viz.trajectory.solved import solve_trajectory

OUTPUTS = (
    ("M_p2", "N"),
    ("peak static torque", "N m"),
    ("RMS static torque", "N m"),
    ("peak torque on the trajectory", "N m"),
    ("RMS torque on the trajectory", "N m"),
)
"""Outputs with units, in the order of a bar's values; torques are those of M1..M3."""

STEP = 1e-5
"""Relative step of the difference quotients for lengths."""

MASSES: tuple[str, ...] = tuple(path for path in MASS_PATHS if PARAMETER[path].unit == "kg")
"""Masses of a design without counterweights."""

LENGTHS: tuple[str, ...] = tuple(
    path
    for path in MECHANISM_PATHS
    if path not in ("geometry.guide_stroke", "geometry.axis_clearance")
)
"""Lengths, and the magnification factor, that shape the robot; limits of reach are not among them.
"""


@dataclass(frozen=True, eq=False)
class TornadoBar:
    """Effect of one value of the design on `OUTPUTS`; NaN where an output has no value.

    Attributes:
        path, symbol, unit: The value.
        value: Its current size.
        minus, plus: (5,) outputs with the value smaller and larger by the relative change.
        derivative: (5,) derivatives of the outputs by the value [unit of the output per unit].
        base: (5,) outputs as they are, over the poses that can be taken in all variants.
        lost: Poses of the grid that a variant cannot take.
        problem: Why a variant has no outputs, or an empty string.
    """

    path: str
    symbol: str
    unit: str
    value: float
    minus: Array
    plus: Array
    derivative: Array
    base: Array
    lost: int = 0
    problem: str = ""

    def swing(self, output: int) -> float:
        """Return the larger change of an output [its unit]; NaN if there is none."""
        ends = np.array([self.minus[output], self.plus[output]]) - self.base[output]
        return float(np.abs(ends).max())


@dataclass(frozen=True, eq=False)
class Tornado:
    """Sensitivity to each value of a design.

    Attributes:
        design: The design.
        change: Share by which each value is made smaller and larger.
        base: (5,) outputs of the design as it is, in the order of `OUTPUTS`.
        bars: One for each value.
    """

    design: Design
    change: float
    base: Array
    bars: tuple[TornadoBar, ...]

    def ranked(self, output: int) -> list[TornadoBar]:
        """Return the bars with an effect on an output, the longest first."""
        found = [bar for bar in self.bars if bar.swing(output) > 0]
        return sorted(found, key=lambda bar: -bar.swing(output))


@of_design
def tornado(
    design: Design,
    grid: Grid,
    trajectory: Trajectory | None = None,
    *,
    change: float = 0.05,
    paths: Sequence[str] = MASSES + LENGTHS,
    progress: Progress = go_on,
) -> Tornado:
    """Change each mass and each length by itself.

    Args:
        design: The design.
        grid: Workspace for the static torques.
        trajectory: Motion for the dynamic ones; without it they are NaN.
        change: Relative change to both sides, for the ends of the bars.
        paths: Values to change; counterweights' masses are added to them.
        progress: Called before each length, for which all is solved again; may end the work.

    Raises:
        Canceled: If ``progress`` ends it.
        InvalidInput: If the change is not between 0 and 1, a path is no mass or length, or the
            design itself can take no pose of the grid.
    """
    if not 0 < change < 1:
        raise InvalidInput("change", f"a part between 0 and 1 is needed, not {change!r}")
    weights = tuple(f"counterweights.{i}.mass" for i in range(len(design.counterweights)))
    for path in paths:
        if path not in MASSES + LENGTHS:
            raise InvalidInput(path, "this is neither a mass nor a length of the design")
    field = solve_field(design.geometry, grid)
    moving = _in_motion(design, trajectory)
    outputs, state = _outputs(design, field, moving)
    masses = [path for path in paths if path in MASSES] + list(weights)
    bars = _mass_bars(design, outputs, state, change, masses)
    lengths = [path for path in paths if path in LENGTHS]
    for done, path in enumerate(lengths):
        keep_on(progress, done / len(lengths))
        bars.append(_length_bar(design, field, moving, trajectory, change, path))
    return Tornado(design, change, outputs(state), tuple(bars))


def _in_motion(design: Design, trajectory: Trajectory | None) -> list[ConvexTerm]:
    """Return the outputs on a motion as functions of a state; none without one."""
    if trajectory is None:
        return []
    space = mass_space(design, Changes())
    solved = solve_trajectory(design.geometry, trajectory, gravity=design.gravity)
    return [term.convex_term(space) for term in (TrajectoryPeak(solved), TrajectoryRms(solved))]


def _outputs(
    design: Design, field: Field, moving: list[ConvexTerm]
) -> tuple[Callable[[Array], Array], Array]:
    """Return the outputs (5,) as a function of a state, and the state of the design."""
    space = mass_space(design, Changes())
    at_rest = [term.convex_term(space) for term in (StaticPeak(field), StaticRms(field))]
    functions = at_rest + moving

    def outputs(state: Array) -> Array:
        found = [state[MP2]] + [function.value(state) for function in functions]
        return np.array(found + [np.nan] * (len(OUTPUTS) - len(found)))

    return outputs, space.before


def _mass_bars(
    design: Design, outputs: Callable[[Array], Array], state: Array, change: float, paths: list[str]
) -> list[TornadoBar]:
    """Masses: torques are linear in them, so one state and its columns suffice."""
    # the inertia of a thicker tube grows with its mass
    ranges = tuple(MassRange(path, 0.0, design.value(path)) for path in paths)
    bars = []
    for path, variable in zip(paths, mass_space(design, Changes(ranges)).variables, strict=True):
        value, column = design.value(path), variable.effect[0, :AMOUNTS]
        step = 1e-6 * max(value, 1e-3)
        minus, plus, lower, upper = (
            outputs(state + kilos * column)
            for kilos in (-change * value, change * value, -step, step)
        )
        symbol = PARAMETER[path].symbol if path in PARAMETER else path
        slope = (upper - lower) / (2 * step)
        bars.append(TornadoBar(path, symbol, "kg", value, minus, plus, slope, outputs(state)))
    return bars


def _length_bar(
    design: Design,
    field: Field,
    moving: list[ConvexTerm],
    trajectory: Trajectory | None,
    change: float,
    path: str,
) -> TornadoBar:
    """Lengths: the geometry is solved again for each variant; masses stay as they are.

    ``moving`` are those of the design itself, see `_in_motion`.
    """
    parameter, value = PARAMETER[path], design.value(path)
    nothing = np.full(len(OUTPUTS), np.nan)
    bar = partial(TornadoBar, path, parameter.symbol, parameter.unit, value)
    try:
        variants = [
            design.vary({path: value * factor})
            for factor in (1 - change, 1 + change, 1 - STEP, 1 + STEP)
        ]
        fields = [field, *(solve_field(v.geometry, field.grid) for v in variants)]
        shared = np.all([found.status == Limit.OK for found in fields], axis=0)
        found = []
        for variant, solved in zip((design, *variants), fields, strict=True):
            # poses that another variant cannot take do not count
            status = np.where(shared, solved.status, np.uint8(Limit.SINGULAR))
            own = moving if variant is design else _in_motion(variant, trajectory)
            outputs, state = _outputs(variant, replace(solved, status=status), own)
            found.append(outputs(state))
    except (InvalidDesign, InvalidInput) as error:
        return bar(nothing, nothing, nothing, nothing, problem=str(error))
    base, minus, plus, lower, upper = found
    slope = (upper - lower) / (2 * STEP * value) if value > 0 else nothing
    return bar(minus, plus, slope, base, int((field.status == Limit.OK).sum() - shared.sum()))
