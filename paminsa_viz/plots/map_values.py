"""The data behind every map: values over x-y at one theta and z, and the design they belong to.

Units are SI and angles are radians; figures convert to mm and degrees.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.checks import kinds_checked, require_count
from paminsa_viz.errors import InvalidInput
from paminsa_viz.kept import kept
from paminsa_viz.model.arguments import of_geometry
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.grids import Field, solve_field, xy_grid
from paminsa_viz.model.reach import Limit, check_reach, workspace_radius
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.plots.outside import Outside
from paminsa_viz.quantities import TORQUES, Missing, find
from paminsa_viz.quantities.accuracy import OF_OWN_LEGS
from paminsa_viz.units import DisplayUnit, display_unit

# ---------------------------------------------------------------------------------- arrays of a map


def equal_steps(name: str, data: ArrayLike) -> NDArray[np.float64]:
    """Return cell centers (n,) [m].

    Raises:
        InvalidInput: If they do not rise in equal steps.
    """
    array = np.asarray(data, dtype=np.float64)
    if array.ndim != 1 or array.size < 2 or not np.isfinite(array).all():
        raise InvalidInput(name, "a row of at least 2 finite numbers is needed [m]")
    steps = np.diff(array)
    mean = (array[-1] - array[0]) / steps.size
    if mean <= 0 or np.abs(steps - mean).max() > 1e-6 * mean:
        raise InvalidInput(name, "cell centers rising in equal steps are needed [m]")
    return array


def numbers_of_shape(
    name: str, data: ArrayLike | Sequence[float], shape: tuple[int, ...]
) -> NDArray[Any]:
    """Return numbers of a shape.

    Raises:
        InvalidInput: If they have another one.
    """
    array = np.asarray(data, dtype=np.float64)
    if array.shape != shape:
        raise InvalidInput(name, f"shape {shape} is needed, not {array.shape}")
    return array


def codes_of_shape(
    name: str, data: ArrayLike, shape: tuple[int, ...], least: int, most: int
) -> NDArray[Any]:
    """Return integers of a shape and range.

    Raises:
        InvalidInput: If they are something else.
    """
    array = np.asarray(data)
    integers = array.shape == shape and array.dtype.kind in "iub"
    if not integers or array.min() < least or array.max() > most:
        raise InvalidInput(name, f"integers from {least} to {most} of shape {shape} are needed")
    return array


# -------------------------------------------------------------------------------------------- a map

COARSE = 72
"""Cells along each side while something is dragged; the color range is found from them as well, so
that it stays when the fine map follows."""
FULL = 200
"""Cells along each side when idle, and in files."""
MOST_CELLS = 2000
"""Most cells along each side: with more a map does not fit into the memory."""


@dataclass(frozen=True, eq=False)
class MapData:
    """One or several maps (panels) on one grid. The arrays are read-only views.

    Attributes:
        x: Cell centers (nx,) [m], rising in equal steps.
        y: Cell centers (ny,) [m], rising in equal steps.
        values: (panels, ny, nx) in ``unit``; NaN where ``status`` is not 0.
        status: (ny, nx) uint8, `paminsa_viz.model.reach.Limit` codes, 0 where a value is good.
        names: One short name a panel, for example ``"τ₁"``.
        unit: Unit of the values, for example ``"N·m"``; empty for pure numbers.
        colors: One ``#rrggbb`` a panel, for its heading.
        pose: Current pose (4,) (x, y, theta, z) [m, m, rad, m]. The map is at this theta and z.
        singular_radius: Radius of the singular circle about the origin [m], or None.
        design: The design.
        reference: The reference design of a difference map, otherwise None.
        title: Title for headings and captions.
        signed: True if zero is a natural center (torques, differences): diverging colors.
        margin: (ny, nx) signed distance to the nearest limit of reach [m], positive inside, for a
            smooth boundary; without it the boundary follows the cells.
        leg: (ny, nx) int8 index of the leg that limits the reach, -1 for none, or None.
        missing: Where and why poses that can be taken have no value, or None.
        bounded: Whether colors span all values: none grows without bound near a singularity.
        outside: Which cells are outside a volume of poses, which are hatched, or None.
        own_legs: Whether values follow the deviations of the design's single legs; otherwise its
            legs are taken as equal.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    values: NDArray[np.float64]
    status: NDArray[np.uint8]
    names: tuple[str, ...]
    unit: str
    colors: tuple[str, ...]
    pose: NDArray[np.float64]
    singular_radius: float | None
    design: Design
    reference: Design | None = None
    title: str = ""
    signed: bool = True
    margin: NDArray[np.float64] | None = None
    leg: NDArray[np.int8] | None = None
    missing: Missing | None = None
    bounded: bool = False
    outside: Outside | None = None
    own_legs: bool = False

    def __post_init__(self) -> None:
        x, y = equal_steps("x", self.x), equal_steps("y", self.y)
        cells = (y.size, x.size)
        values = numbers_of_shape("values", self.values, (len(self.names), *cells))
        status = codes_of_shape("status", self.status, cells, 0, max(Limit))
        if len(self.colors) != len(self.names):
            raise InvalidInput("colors", f"{len(self.names)} are needed, one a panel")
        radius = self.singular_radius
        if radius is not None and not (math.isfinite(radius) and radius >= 0):
            raise InvalidInput("singular_radius", f"None or at least 0 m is needed, not {radius!r}")
        if np.isfinite(values[:, status != 0]).any():
            values = np.where(status != 0, np.nan, values)
        arrays: dict[str, NDArray[Any]] = {
            "x": x,
            "y": y,
            "values": values,
            "status": status.astype(np.uint8, copy=False),
            "pose": numbers_of_shape("pose", self.pose, (4,)),
        }
        if self.margin is not None:
            arrays["margin"] = numbers_of_shape("margin", self.margin, cells)
        if self.leg is not None:
            arrays["leg"] = codes_of_shape("leg", self.leg, cells, -1, 2).astype(
                np.int8, copy=False
            )
        for name, array in arrays.items():
            view = array.view()
            view.flags.writeable = False
            object.__setattr__(self, name, view)

    @property
    def panels(self) -> int:
        """Number of maps."""
        return len(self.names)

    @property
    def theta(self) -> float:
        """Platform angle of the map [rad]."""
        return float(self.pose[2])

    @property
    def z(self) -> float:
        """Platform height of the map [m]."""
        return float(self.pose[3])

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges of the cells (left, right, bottom, top) [m].

        They are rounded, so that maps of one area have the same edges with any number of cells, and
        are drawn on the same axes.
        """
        half_x = (self.x[1] - self.x[0]) / 2
        half_y = (self.y[1] - self.y[0]) / 2
        return (
            round(float(self.x[0] - half_x), 12),
            round(float(self.x[-1] + half_x), 12),
            round(float(self.y[0] - half_y), 12),
            round(float(self.y[-1] + half_y), 12),
        )

    @property
    def display(self) -> DisplayUnit:
        """The unit for display."""
        return display_unit(self.unit)

    @property
    def missing_word(self) -> str:
        """What is missing where poses that can be taken have no value: ``"no bound"``, or nothing.

        It is what the reasons have before their colon.
        """
        if self.missing is None:
            return ""
        codes = self.missing.code[(self.status == Limit.OK) & (self.missing.code != 0)]
        return self.missing.texts[int(codes[0])].partition(":")[0] if codes.size else ""

    def with_pose(self, pose: ArrayLike) -> MapData:
        """Return the same maps with the marker elsewhere; theta and z have to stay.

        Raises:
            InvalidInput: If theta or z differ, since the values would not belong to that pose.
        """
        new = numbers_of_shape("pose", pose, (4,))
        if not np.array_equal(new[2:], self.pose[2:]):
            raise InvalidInput("pose", "theta and z belong to the map and cannot change")
        return replace(self, pose=new)


@kinds_checked
def difference(current: MapData, reference: MapData) -> MapData:
    """Return current minus reference, panel by panel, masked where either is masked.

    Pose, colors and boundary are those of ``current``.

    Raises:
        InvalidInput: If grid, panels, unit, theta or z of the two differ.
    """
    same_grid = np.array_equal(current.x, reference.x) and np.array_equal(current.y, reference.y)
    if not same_grid:
        raise InvalidInput("reference", "its grid differs from the current one")
    if current.names != reference.names or current.unit != reference.unit:
        raise InvalidInput("reference", "it shows other quantities than the current maps")
    if not np.array_equal(current.pose[2:], reference.pose[2:]):
        raise InvalidInput("reference", "its theta or z differs from the current maps")
    margin = current.margin
    if margin is not None and reference.margin is not None:
        margin = np.minimum(margin, reference.margin)
    with np.errstate(invalid="ignore"):  # inf - inf next to a singularity is NaN, and masked
        values = current.values - reference.values
    missing, other = current.missing, reference.missing
    if missing is not None and other is not None:
        missing = missing._replace(code=np.where(missing.code != 0, missing.code, other.code))
    leg = None
    if current.leg is not None and reference.leg is not None:
        leg = np.where(current.status != 0, current.leg, reference.leg)
    return replace(
        current,
        values=values,
        status=np.where(current.status != 0, current.status, reference.status),
        leg=leg,
        missing=missing,
        names=tuple(f"Δ{name}" for name in current.names),
        reference=reference.design,
        title=f"{current.title}, difference" if current.title else "Difference",
        signed=True,
        margin=margin,
    )


LEAST_HALF_WIDTH = 0.28
"""Half width of a map of a robot that reaches next to nothing, as a share of R_b."""


FRAMES = 20
"""Sizes of frames up to that of all positions within reach at any theta and z."""

PROBES = 72
"""Positions along each side that a frame is found by."""


def half_width(geometry: Geometry) -> float:
    """Return half the side of the square that maps of a geometry cover [m].

    It holds every position within reach at any theta and z, so that a map stays where it is while
    they are dragged; rounded up to a centimeter, of a small robot in two digits.
    """
    radius = max(1.005 * workspace_radius(geometry), LEAST_HALF_WIDTH * geometry.base_radius)
    steps = 10.0 ** max(2, 1 - math.floor(math.log10(radius)))  # in a meter
    return float(np.ceil(round(steps * radius, 6)) / steps)


def cell_centers(half: float, cells: int) -> Array:
    """Return the centers of ``cells`` equal cells from ``-half`` to ``half``, (cells,) [m]."""
    return half * ((2 * np.arange(cells) + 1) / cells - 1)


@kept(16)
def frame_half(geometry: Geometry, theta: float, z: float) -> float:
    """Return half the side of the square that maps show at theta and z [m].

    It holds every position within reach there, and is one of a few sizes, so that a map mostly
    stays as it is while theta or z is dragged.
    """
    most = half_width(geometry)
    centers = cell_centers(most, PROBES)
    ok = check_reach(geometry, xy_grid(centers, centers, theta, z).poses()).ok
    if not ok.any():
        return most
    far = np.abs(centers[np.flatnonzero(ok.any(axis=0) | ok.any(axis=1))]).max()
    needed = (far + 2 * most / PROBES) / most
    return most * min(int(np.ceil(FRAMES * needed - 1e-9)), FRAMES) / FRAMES


@of_geometry
def workspace_field(
    geometry: Geometry, theta: float, z: float, cells: int, half: float | None = None
) -> Field:
    """Return a field over the square that maps cover, which solves formulas on request.

    Args:
        geometry: What to solve.
        theta: Angle of the platform [rad].
        z: Its height [m].
        cells: Cells along each side, 2 to `MOST_CELLS`.
        half: Half the side [m], or None for `half_width` of the geometry.

    Raises:
        InvalidInput: If there are fewer or more cells, or a number is not finite.
    """
    require_count(cells, "cells", MOST_CELLS, 2)
    centers = cell_centers(half_width(geometry) if half is None else half, cells)
    return solve_field(geometry, xy_grid(centers, centers, theta, z))


@kinds_checked
def map_data(
    field: Field, design: Design, pose: ArrayLike, quantities: Sequence[str] = TORQUES
) -> MapData:
    """Return maps of some quantities over a solved x-y grid, for the masses of a design.

    Args:
        field: A solved grid made by `paminsa_viz.model.grids.xy_grid`.
        design: The design; its geometry has to be that of the field.
        pose: Current pose (4,) [m, m, rad, m], at the grid's theta and z.
        quantities: Keys of what to show, one a panel, all in one unit.

    Raises:
        InvalidInput: If the grid is not over x and y, the geometry, theta or z of design and pose
            are not the field's, or the quantities differ in unit.
    """
    names = tuple(name for name, _ in field.grid.axes)
    if names != ("y", "x"):
        raise InvalidInput("field", f"a grid over y and x is needed, not {' and '.join(names)}")
    if field.geometry != design.geometry:
        raise InvalidInput("design", "its geometry is not the one that the field was solved for")
    current = np.asarray(pose, dtype=np.float64)
    if current.shape != (4,) or not np.array_equal(current[2:], field.grid.fixed[2:]):
        theta, z = field.grid.fixed[2:]
        problem = f"a pose (4,) at the field's theta {theta:g} rad and z {z:g} m is needed"
        raise InvalidInput("pose", problem)
    chosen = find(quantities)
    units = {quantity.unit for quantity in chosen}
    if len(units) != 1:
        raise InvalidInput("quantities", "one or several of one unit are needed")
    values = np.stack([quantity.over(field, design) for quantity in chosen])
    return MapData(
        x=field.grid.axes[1][1],
        y=field.grid.axes[0][1],
        values=np.where(field.status != 0, np.nan, values),
        status=field.status,
        names=tuple(quantity.symbol for quantity in chosen),
        unit=units.pop(),
        colors=tuple(quantity.color for quantity in chosen),
        pose=current,
        singular_radius=float(singular_radius(design.geometry, current[2])),
        design=design,
        title=chosen[0].title if len(chosen) == 1 else "Static torques of the rotary actuators",
        signed=any(quantity.signed for quantity in chosen),
        bounded=all(quantity.bounded for quantity in chosen),
        margin=field.margin,
        leg=field.leg,
        missing=None if (why := chosen[0].missing) is None else why(field, design),
        own_legs=not OF_OWN_LEGS.isdisjoint(quantities),
    )
