"""The data behind every map: values over x-y at one theta and z, with what it takes to cite them.

Units are SI and angles are radians; figures convert to mm and degrees where a person reads them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import paminsa_viz
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import PARAMETERS, Design, Geometry, KneeBranch
from paminsa_viz.model.grids import Field, solve_field, xy_grid
from paminsa_viz.model.reach import Limit, workspace_radius
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.quantities import TORQUES, find
from paminsa_viz.units import DisplayUnit, display_unit

COARSE = 72
"""Cells along each side while something is dragged; the color range is found from them as well, so
that it stays when the fine map follows."""
FULL = 200
"""Cells along each side when idle, and in files."""


@dataclass(frozen=True)
class Provenance:
    """Where the numbers come from, as captions and file headers state it.

    Attributes:
        design: Name of the design.
        knee: Branch of its knees.
        version: Version of this package.
        numbers: Key numbers for the caption: (symbol, value, unit), SI.
        parameters: Every number of the design for files: (dotted path and unit, value), SI.
        reference: Name of the reference design of a difference map, otherwise empty.
        reference_parameters: The same for the reference design.
    """

    design: str
    knee: KneeBranch
    version: str
    numbers: tuple[tuple[str, float, str], ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()
    reference: str = ""
    reference_parameters: tuple[tuple[str, float], ...] = ()


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
        pose: Present pose (4,) (x, y, theta, z) [m, m, rad, m]. The map is at this theta and z.
        singular_radius: Radius of the singular circle about the origin [m], or None.
        provenance: Design, version and so on.
        title: What is shown, in words, for headings and captions.
        signed: True if zero is a natural center (torques, differences): diverging colors.
        margin: (ny, nx) signed distance to the nearest limit of reach [m], positive inside, for a
            smooth boundary; without it the boundary follows the cells.
        leg: (ny, nx) int8 index of the leg that stands in the way, -1 for none, or None.
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
    provenance: Provenance
    title: str = ""
    signed: bool = True
    margin: NDArray[np.float64] | None = None
    leg: NDArray[np.int8] | None = None

    def __post_init__(self) -> None:
        x, y = _axis("x", self.x), _axis("y", self.y)
        shape = (y.size, x.size)
        values = _numbers("values", self.values, (len(self.names), *shape))
        status = np.asarray(self.status)
        if status.shape != shape or status.dtype.kind not in "iub":
            raise InvalidInput("status", f"integer codes of shape {shape} are needed")
        if status.min() < 0 or status.max() > max(Limit):
            raise InvalidInput("status", "codes of paminsa_viz.model.reach.Limit are needed")
        if len(self.colors) != len(self.names):
            raise InvalidInput("colors", f"{len(self.names)} are needed, one a panel")
        pose = _numbers("pose", self.pose, (4,))
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
            "pose": pose,
        }
        if self.margin is not None:
            arrays["margin"] = _numbers("margin", self.margin, shape)
        if self.leg is not None:
            leg = np.asarray(self.leg)
            if leg.shape != shape or leg.dtype.kind != "i" or leg.min() < -1 or leg.max() > 2:
                raise InvalidInput("leg", f"indices from -1 to 2 of shape {shape} are needed")
            arrays["leg"] = leg.astype(np.int8, copy=False)
        for name, array in arrays.items():
            view = array.view()
            view.flags.writeable = False
            object.__setattr__(self, name, view)
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "colors", tuple(self.colors))

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
        """Outer edges of the cells (left, right, bottom, top) [m]."""
        half_x = (self.x[1] - self.x[0]) / 2
        half_y = (self.y[1] - self.y[0]) / 2
        return (
            float(self.x[0] - half_x),
            float(self.x[-1] + half_x),
            float(self.y[0] - half_y),
            float(self.y[-1] + half_y),
        )

    @property
    def display(self) -> DisplayUnit:
        """The unit that people read the values in."""
        return display_unit(self.unit)

    def panel(self, index: int) -> MapData:
        """Return one panel as a map of its own.

        Raises:
            InvalidInput: If there is no panel of this index.
        """
        if not 0 <= index < self.panels:
            raise InvalidInput("index", f"0 to {self.panels - 1} is needed, not {index}")
        return replace(
            self,
            values=self.values[index : index + 1],
            names=self.names[index : index + 1],
            colors=self.colors[index : index + 1],
        )

    def with_pose(self, pose: ArrayLike) -> MapData:
        """Return the same maps with the marker elsewhere; theta and z have to stay.

        Raises:
            InvalidInput: If theta or z differ, since the values would not belong to that pose.
        """
        new = _numbers("pose", pose, (4,))
        if not np.array_equal(new[2:], self.pose[2:]):
            raise InvalidInput("pose", "theta and z belong to the map and cannot change")
        return replace(self, pose=new)


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
    provenance = replace(
        current.provenance,
        reference=reference.provenance.design,
        reference_parameters=reference.provenance.parameters,
    )
    margin = current.margin
    if margin is not None and reference.margin is not None:
        margin = np.minimum(margin, reference.margin)
    with np.errstate(invalid="ignore"):  # inf - inf next to a singularity is NaN, and masked
        values = current.values - reference.values
    leg = None
    if current.leg is not None and reference.leg is not None:
        leg = np.where(current.status != 0, current.leg, reference.leg)
    return replace(
        current,
        values=values,
        status=np.where(current.status != 0, current.status, reference.status),
        leg=leg,
        names=tuple(f"Δ{name}" for name in current.names),
        provenance=provenance,
        title=f"{current.title}, difference" if current.title else "Difference",
        signed=True,
        margin=margin,
    )


LEAST_HALF_WIDTH = 0.1
"""Half width of a map of a robot that reaches next to nothing [m]."""


def half_width(geometry: Geometry) -> float:
    """Return half the side of the square that maps of a geometry cover [m].

    It holds every position within reach at any theta and z, so that a map stays where it is while
    they are dragged; rounded up to a centimeter.
    """
    radius = max(1.005 * workspace_radius(geometry), LEAST_HALF_WIDTH)
    return float(np.ceil(round(100 * radius, 6)) / 100)


def cell_centers(half: float, cells: int) -> Array:
    """Return the centers of ``cells`` equal cells from ``-half`` to ``half``, (cells,) [m]."""
    return half * ((2 * np.arange(cells) + 1) / cells - 1)


def workspace_field(
    geometry: Geometry, theta: float, z: float, cells: int, half: float | None = None
) -> Field:
    """Return a field over the square that maps cover, which solves what it is asked for.

    Args:
        geometry: What to solve.
        theta: Angle of the platform [rad].
        z: Its height [m].
        cells: Cells along each side.
        half: Half the side [m], or None for `half_width` of the geometry.
    """
    centers = cell_centers(half_width(geometry) if half is None else half, cells)
    return solve_field(geometry, xy_grid(centers, centers, theta, z))


def provenance(design: Design) -> Provenance:
    """Return what captions and file headers say of a design."""
    numbers = [("Mₚ₂", static_imbalance(design), "N")]
    if design.payload.mass:
        numbers.append(("payload", design.payload.mass, "kg"))
    return Provenance(
        design=design.name,
        knee=design.geometry.knee,
        version=paminsa_viz.__version__,
        numbers=tuple(numbers),
        parameters=tuple(
            (f"{p.path} [{p.unit}]" if p.unit else p.path, design.value(p.path)) for p in PARAMETERS
        ),
    )


def map_data(
    field: Field, design: Design, pose: ArrayLike, quantities: Sequence[str] = TORQUES
) -> MapData:
    """Return maps of some quantities over a solved x-y grid, for the masses of a design.

    Args:
        field: A solved grid made by `paminsa_viz.model.grids.xy_grid`.
        design: The design; its geometry has to be that of the field.
        pose: Present pose (4,) [m, m, rad, m], at the grid's theta and z.
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
    present = np.asarray(pose, dtype=np.float64)
    if present.shape != (4,) or not np.array_equal(present[2:], field.grid.fixed[2:]):
        raise InvalidInput("pose", "a pose (4,) at the theta and z of the field is needed")
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
        pose=present,
        singular_radius=float(singular_radius(design.geometry, present[2])),
        provenance=provenance(design),
        title=chosen[0].title if len(chosen) == 1 else "Static torques of the rotary actuators",
        signed=any(quantity.signed for quantity in chosen),
        margin=field.margin,
        leg=field.leg,
    )


def _axis(name: str, data: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(data, dtype=np.float64)
    if array.ndim != 1 or array.size < 2 or not np.isfinite(array).all():
        raise InvalidInput(name, "a row of at least 2 finite numbers is needed [m]")
    steps = np.diff(array)
    mean = (array[-1] - array[0]) / steps.size
    if mean <= 0 or np.abs(steps - mean).max() > 1e-6 * mean:
        raise InvalidInput(name, "cell centers rising in equal steps are needed [m]")
    return array


def _numbers(name: str, data: ArrayLike | Sequence[float], shape: tuple[int, ...]) -> NDArray[Any]:
    array = np.asarray(data, dtype=np.float64)
    if array.shape != shape:
        raise InvalidInput(name, f"shape {shape} is needed, not {array.shape}")
    return array
