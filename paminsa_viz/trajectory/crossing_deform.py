"""Paths changed along the escape twist, where no time law on the path itself will do.

Near a crossing s* the path is displaced by W(s) t_s. The window W leaves the pose at s*, the ends
and all outside of it as they are. An odd one, W = s - s* to first order, adds t_s^T M t_s to the
factor a of the condition for a unit of its slope; an even one, W = (s - s*)^2 / 2, the same to b.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.singularity import escape_twist
from paminsa_viz.trajectory.crossing import Crossing, CrossingRefused, crossings
from paminsa_viz.trajectory.limits import MotionLimits
from paminsa_viz.trajectory.paths import Path
from paminsa_viz.trajectory.time_optimal import TimeOptimalPlan, time_optimal

WIDEST = 0.25
"""Half of the widest window, in s."""

_BELL = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** 4  # three derivatives are zero at its ends
_ODD = np.polynomial.Polynomial([0.0, 1.0]) * _BELL
_EVEN = np.polynomial.Polynomial([0.0, 0.0, 0.5]) * _BELL


@dataclass(frozen=True, eq=False)
class DeformationWindow:
    """A displacement of a path near one of its points.

    Attributes:
        at: The point's s.
        half: Half of the window's width, in s.
        shift: (4,) displacement where the window's shape is one [m, m, rad, m].
        shape: Polynomial over -1 to 1.
    """

    at: float
    half: float
    shift: Array
    shape: np.polynomial.Polynomial


@dataclass(frozen=True, eq=False)
class DeformedPath:
    """A path with displacements near some of its points."""

    path: Path
    windows: tuple[DeformationWindow, ...]

    def __call__(self, s: Array, order: int = 0) -> Array:
        s = np.asarray(s, dtype=np.float64)
        value = self.path(s, order)
        for window in self.windows:
            x = (s - window.at) / window.half
            part = window.shape.deriv(order)(x) if order else window.shape(x)
            inside = np.where(np.abs(x) < 1.0, part / window.half**order, 0.0)
            value = value + inside[..., None] * window.shift
        return value


@dataclass(frozen=True, eq=False)
class DeformedPlan:
    """A motion on a path that was changed so that it can cross singularities.

    Attributes:
        found: The motion; its `path` is the changed one.
        deviation: Bound of the displacement of the platform's center and joints 5 from the given
            path [m]; zero if nothing had to be changed.
    """

    found: TimeOptimalPlan
    deviation: float


@of_design
def plan_deformed(
    design: Design,
    path: Path,
    limits: MotionLimits,
    duration: float | None = None,
    *,
    most: float = 0.02,
    name: str = "crossing",
) -> DeformedPlan:
    """Return a motion as `time_optimal` does, on a path changed along t_s if it has to be.

    Windows of both shapes and signs are tried, the same at every crossing, and the first deviation
    of a rising series at which one of them can be run is taken.

    Args:
        design: The robot.
        path: The path.
        limits: See `time_optimal`.
        duration: [s]; the shortest by default.
        most: Largest deviation [m].
        name: What a person calls it.

    Raises:
        InvalidInput: As `time_optimal`, or if the largest deviation is not above zero.
        CrossingRefused: If no such path can be run either: the cause on the given path.
    """
    require_positive(most, "most", "a length above 0 m")
    try:
        return DeformedPlan(time_optimal(design, path, limits, duration, name=name), 0.0)
    except CrossingRefused as refusal:
        if refusal.cause not in ("weak", "infeasible"):
            raise
        cause = refusal
    met = crossings(design.geometry, path)
    for deviation in most * 2.0 ** np.arange(-5, 1):
        for shape in (_ODD, _EVEN):
            for sign in (1.0, -1.0):
                changed = _deformed(design, path, met, shape, sign * float(deviation))
                try:
                    found = time_optimal(design, changed, limits, duration, name=name)
                except CrossingRefused:
                    continue
                if len(found.crossings) == len(met):
                    return DeformedPlan(found, float(deviation))
    problem = f"{cause}; nor on a path up to {1e3 * most:.3g} mm from it"
    raise CrossingRefused(cause.cause, problem, cause.s)


def _deformed(
    design: Design,
    path: Path,
    met: tuple[Crossing, ...],
    shape: np.polynomial.Polynomial,
    deviation: float,
) -> DeformedPath:
    """Return a path that is displaced by a signed deviation near each crossing."""
    places = [-met[0].s, *(item.s for item in met), 2.0 - met[-1].s]  # ends, mirrored
    halves = [min(WIDEST, 0.5 * (b - a)) for a, b in pairwise(places)]
    peak = float(shape(np.linspace(0.0, 1.0, 10_001)).max())
    windows = []
    for item, before, after in zip(met, halves[:-1], halves[1:], strict=True):
        twist = escape_twist(design.geometry, item.pose)
        size = float(np.hypot(*twist[:2])) + design.geometry.platform_radius
        shift = twist * deviation / (size * peak)
        windows.append(DeformationWindow(item.s, min(before, after), shift, shape))
    return DeformedPath(path, tuple(windows))
