"""Springs against gravity: stiffness and free length for the best balance over a workspace.

Each leg has the same springs between two points of its plane. A spring of stiffness K and free
length L stores K (d - L)^2 / 2 at a length d, so that an actuator has to hold

    Q_j = K d dd/dq_j - K L dd/dq_j:

linear in K and K L together. So stiffnesses and free lengths come out of one convex program, with
a global optimum; a free length of zero is the special case that L is held there. The springs'
own mass is left out.

From a mast of height h on slider 8 to the knee 9, a spring of free length zero stores
K (l_B8^2 + h^2) / 2 - K h z_9: with K h = M_p2 it balances the leg exactly, and adds no inertia.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.balancing.convex import MaxAbs, Norm
from paminsa_viz.balancing.program import Program, Variable
from paminsa_viz.balancing.solver import solve
from paminsa_viz.checks import kinds_checked, require_at_least, require_each
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import geometry_of, of_design, of_geometry
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.kinematics import leg_states
from paminsa_viz.model.leg import LegPosition
from paminsa_viz.model.leg_points import PointWeights, bar_point, point_weights
from paminsa_viz.model.parameters import LARGEST, LEG_JOINTS, Counterweight
from paminsa_viz.model.statics import static_torques, torques_of_legs
from paminsa_viz.units import format_ascii

ROUNDING = 1e-9
"""Part of a torque by which springs may lower it and yet help with nothing."""

STIFFEST = 1e9
"""Largest stiffness of a spring [N/m]."""

KINDS = ("joint", "bar", "guide", "slider")


@dataclass(frozen=True)
class Anchor:
    """A named point; make it with `at_joint`, `on_bar`, `on_guide` or `on_slider`.

    Attributes:
        kind: One of `KINDS`.
        joint: Number of the joint, for a joint or a place on a bar.
        bar: The bar, for a place on one.
        beyond: As in `Counterweight` [m].
        radius: Distance from the leg axis toward the platform, for the guide [m].
        height: Above the guides, for guide and slider [m].
    """

    kind: str
    joint: int = 0
    bar: str = ""
    beyond: float = 0.0
    radius: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InvalidInput("anchor", f"{self.kind!r} is none of {', '.join(KINDS)}")
        if self.kind == "joint" and self.joint not in LEG_JOINTS:
            known = ", ".join(map(str, LEG_JOINTS))
            raise InvalidInput("anchor", f"a leg has joints {known}, not {self.joint}")
        if self.kind == "bar":
            Counterweight(self.bar, self.joint, self.beyond)
        if not np.abs([self.radius, self.height]).max() <= LARGEST["m"]:
            raise InvalidInput("anchor", f"its radius and height are up to {LARGEST['m']:g} m")

    def weights(self, geometry: Geometry | Design) -> PointWeights:
        """Return where it is, as a weighted sum of the leg's joints 5 and 9."""
        geometry = geometry_of(geometry)
        if self.kind == "joint":
            return point_weights(geometry)[self.joint]
        if self.kind == "bar":
            return bar_point(geometry, self.bar, self.joint, self.beyond)
        if self.kind == "slider":
            return point_weights(geometry)[8]._replace(z0=self.height)
        return PointWeights(0.0, 0.0, 0.0, self.height, self.radius)

    @property
    def name(self) -> str:
        """The point in words, lengths in mm."""
        if self.kind == "joint":
            return f"joint {self.joint}"
        if self.kind == "bar":
            return Counterweight(self.bar, self.joint, self.beyond).place
        height = f"{format_ascii(self.height, 'm')} above"
        if self.kind == "slider":
            return f"mast on slider 8, {height}"
        return f"post on the guide link, {format_ascii(self.radius, 'm')} from the axis, {height}"


@kinds_checked
def at_joint(joint: int) -> Anchor:
    """Return a joint, by the paper's number."""
    return Anchor("joint", joint=joint)


@kinds_checked
def on_bar(bar: str, joint: int, beyond: float) -> Anchor:
    """Return a point of a bar or of its extension; arguments as in `Counterweight`."""
    return Anchor("bar", joint=joint, bar=bar, beyond=beyond)


@kinds_checked
def on_guide(radius: float, height: float) -> Anchor:
    """Return a point fixed to the guide link B10, which turns with the leg; radius 0: the axis.

    Args:
        radius: Distance from the leg axis toward the platform [m].
        height: Above the plane of the guides [m].
    """
    return Anchor("guide", radius=radius, height=height)


@kinds_checked
def on_slider(height: float) -> Anchor:
    """Return the top of a mast on slider 8, which travels along the guide.

    Args:
        height: Above the plane of the guides, in which joint 8 is [m].
    """
    return Anchor("slider", height=height)


@dataclass(frozen=True)
class SpringPlace:
    """Anchors of a spring and the ranges of its numbers.

    Attributes:
        first, second: Its two points.
        max_stiffness: Largest stiffness on each leg [N/m].
        min_free_length, max_free_length: Range of its free length [m]; both zero for a
            zero-free-length spring.
    """

    first: Anchor
    second: Anchor
    max_stiffness: float = 1e5
    min_free_length: float = 0.0
    max_free_length: float = 0.0

    def __post_init__(self) -> None:
        stiffness, least, most = self.max_stiffness, self.min_free_length, self.max_free_length
        if not 0 <= stiffness <= STIFFEST:
            problem = f"0 to {STIFFEST:g} N/m is possible, not {stiffness!r}"
            raise InvalidInput("max_stiffness", problem)
        if not 0 <= least <= most <= LARGEST["m"]:
            problem = f"0 <= least <= most <= {LARGEST['m']:g} m is needed, not {least} to {most}"
            raise InvalidInput("max_free_length", problem)


@dataclass(frozen=True)
class Spring:
    """A spring on each leg.

    Attributes:
        first, second: The points that it is fixed to.
        stiffness: [N/m].
        free_length: Its length without a force [m].

    Raises:
        InvalidInput: If stiffness or free length is negative or not finite.
    """

    first: Anchor
    second: Anchor
    stiffness: float
    free_length: float = 0.0

    def __post_init__(self) -> None:
        require_at_least(self.stiffness, "stiffness", what="a stiffness of at least 0 N/m")
        require_at_least(self.free_length, "free_length", what="a length of at least 0 m")


@np.errstate(all="ignore")
def _lengths(
    geometry: Geometry, legs: LegPosition, first: Anchor, second: Anchor
) -> tuple[Array, Array, Array]:
    """Return d (..., 3), and the derivatives of d^2/2 by X_1 and z_5, (..., 3) each."""
    a, b = first.weights(geometry), second.weights(geometry)
    r5, r9, z5, z0, r0 = (q - p for p, q in zip(a, b, strict=True))
    across = r5 * legs.rho + r9 * legs.r9 + r0
    up = z5 * legs.zeta + r9 * legs.z9 + z0
    by_rho = across * (r5 + r9 * legs.r9_rho) + up * (r9 * legs.z9_rho)
    by_zeta = across * (r9 * legs.r9_zeta) + up * (z5 + r9 * legs.z9_zeta)
    return np.hypot(across, up), by_rho, by_zeta


def _legs(geometry: Geometry, pose: Array) -> LegPosition:
    still = np.zeros_like(pose)
    return leg_states(geometry, pose, still, still)[0]


@of_geometry
def spring_lengths(geometry: Geometry, spring: Spring | SpringPlace, pose: ArrayLike) -> Array:
    """Return how long a spring is, (..., 3 legs) [m]; NaN where the bars cannot close.

    Args:
        geometry: Lengths of the mechanism.
        spring: The spring, or the place of one.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    legs = _legs(geometry, as_vectors(pose, "pose"))
    return _lengths(geometry, legs, spring.first, spring.second)[0]


@of_geometry
def spring_energy(geometry: Geometry, spring: Spring, pose: ArrayLike) -> Array:
    """Return the energy in the three springs together, (...) [J].

    It is the sum of K (d - L)^2/2 over the legs, d as in `spring_lengths`, as are the arguments.
    """
    stretch = spring_lengths(geometry, spring, pose) - spring.free_length
    return 0.5 * spring.stiffness * (stretch**2).sum(axis=-1)


@np.errstate(all="ignore")
def unit_spring_torques(
    geometry: Geometry, place: Spring | SpringPlace, pose: Array
) -> tuple[Array, Array]:
    """Return what actuators hold against a spring for K = 1 and for K L = 1, (..., 4) each.

    In [m^2, m] a unit of K [N/m] and in [m, 1] a unit of K L [N]; NaN where the bars cannot close.
    """
    legs = _legs(geometry, pose)
    length, by_rho, by_zeta = _lengths(geometry, legs, place.first, place.second)
    whole = torques_of_legs(geometry, pose, legs, by_rho, by_zeta).sum(axis=-1)
    # a spring of no length has no direction, and pulls with nothing that depends on one
    inverse = np.where(length > 0, -1.0 / length, 0.0)
    free = torques_of_legs(geometry, pose, legs, by_rho * inverse, by_zeta * inverse).sum(axis=-1)
    return whole, free


@of_geometry
def spring_torques(geometry: Geometry, springs: Sequence[Spring], pose: ArrayLike) -> Array:
    """Return what actuators have to hold against springs, dV/dq, (..., 4) [N m, N].

    Add it to `static_torques`. NaN where the bars cannot close.

    Args:
        geometry: Lengths of the mechanism.
        springs: The springs; every leg has each of them.
        pose: (..., 4) [m, m, rad, m].

    Raises:
        InvalidInput: If a shape is another one, or a value is not real.
    """
    require_each(springs, "springs", Spring)
    pose = as_vectors(pose, "pose")
    total = np.zeros_like(pose)
    for spring in springs:
        whole, free = unit_spring_torques(geometry, spring, pose)
        total += spring.stiffness * (whole + spring.free_length * free)
    return total


# ------------------------------------------------------------ the best stiffnesses and free lengths


@dataclass(frozen=True)
class SpringFit:
    """The best springs.

    Attributes:
        springs: In the order of the places; a stiffness of zero means that it is not needed. All
            are zero where no springs in these places help.
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

    @property
    def helps(self) -> bool:
        """Whether the torque is lower with the springs."""
        return self.after < self.before


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
    before, after, state = function.value(np.zeros(size)), found.value, found.state
    if after >= (1 - ROUNDING) * before:  # as by ends that keep their distance
        after, state = before, np.zeros(size)
    lengths = [spring_lengths(design.geometry, place, pose[good]) for place in places]
    return SpringFit(
        springs=springs_of(places, state),
        before=before,
        after=after,
        lower_bound=found.bound,
        reach=tuple((float(d.min()), float(d.max())) for d in lengths),
        seconds=time.perf_counter() - began,
    )
