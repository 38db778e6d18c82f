"""``paminsa-viz map``: torques and other quantities over the workspace, as figures and tables."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import numpy as np
import tyro
from numpy.typing import NDArray

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import ComparedDesignFlags, FilesFlags
from paminsa_viz.cli.output import print_error, print_json, print_table, print_written
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.columns import TORQUES as TORQUE_NAMES
from paminsa_viz.files.published_table import PublishedMap, read_published_map
from paminsa_viz.files.tables import table_bytes, table_endings
from paminsa_viz.model import Design, solve_field, static_torques, xy_grid
from paminsa_viz.model.reach import Limit, home_pose, status_words
from paminsa_viz.model.singular_limit import CONDITION_LIMIT, counting
from paminsa_viz.plots.map_table import map_table
from paminsa_viz.plots.map_values import (
    COARSE,
    FULL,
    MapData,
    difference,
    frame_half,
    map_data,
    workspace_field,
)
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales, usable_range
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import QUANTITIES, TORQUES, affordable_cells, selections
from paminsa_viz.units import MM, format_ascii, si_unit

DESCRIPTION = """\
Map what the actuators have to hold at rest, over all positions x, y at one angle and one height:
the paper's Fig. 3, and more.

  paminsa-viz map --out torques.pdf                       M1, M2 and M3 at 60 degrees, as in Fig. 3
  paminsa-viz map --z -450 --quantity max-torque --out map.png --out map.csv
  paminsa-viz map --design light.toml --reference heavy.toml --out difference.svg
  paminsa-viz map --quantity condition --log --range 1 1000 --out condition.png

The paper does not say the height of its Fig. 3; it is yours to choose. Figures and tables are those
of the explorer. The ending of --out says what is written: .png .svg .pdf for print, .csv .npz with
every cell.

Exit code: 0 done; 1 no position can be reached there; 2 a wrong argument or file."""


CELLS = (10, 2000)
"""Possible numbers of cells along a side."""

BUDGET = 30.0
"""Time that the cells of costly quantities may take [s]; beyond it there are fewer."""


if TYPE_CHECKING:
    Choice: TypeAlias = str
else:
    Choice = Literal[tuple(name.replace("_", "-") for name in selections())]


@dataclass(frozen=True, kw_only=True)
class Map(FilesFlags, ComparedDesignFlags):
    """Flags of the command."""

    quantity: Choice = "torques"
    """What to map; torques are those of M1, M2 and M3 side by side."""
    theta: Annotated[float, tyro.conf.arg(metavar="DEG")] = 60.0
    """Angle of the platform [°]."""
    z: Annotated[float | None, tyro.conf.arg(metavar="MM")] = None
    """Height of the platform [mm]; in the middle of the workspace if left out."""
    at: Annotated[tuple[float, float], tyro.conf.arg(metavar="X Y")] = (0.0, 0.0)
    """Position of the ring that marks a pose [mm]."""
    cells: int = FULL
    """Cells along each side."""
    max_condition: float = CONDITION_LIMIT
    """Largest condition number of a position that counts in the printed numbers: toward a
    singularity torques grow without bound."""

    range: Annotated[tuple[float, float] | None, tyro.conf.arg(metavar="LOW HIGH")] = None
    """Ends of the colors [N m, N, mm]; by default the ordinary values are seen best, and what
    explodes next to a singularity lies beyond."""
    full_range: bool = False
    """Let the colors span every value."""
    log: bool = False
    """Let the colors follow a logarithm to both sides of zero."""
    own_ranges: bool = False
    """Give each of the three torques colors of its own."""
    published: Annotated[Path | None, tyro.conf.arg(metavar="FILE.csv")] = None
    """Published or measured torques at rest, x_m,y_m with tau1_Nm, tau2_Nm, tau3_Nm, f4_N or some
    of them: drawn as points in the colors of their values, and by how much the computed ones are
    off."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """Keys of what is mapped."""
        return selections()[self.quantity.replace("-", "_")]

    def check(self) -> None:
        """Refuse what cannot be mapped.

        Raises:
            UsageError: Which flag, and what is allowed.
        """
        fewest, most = CELLS
        if not fewest <= self.cells <= most:
            raise UsageError(f"--cells: {fewest} to {most} are possible, not {self.cells}")
        for name in ("theta", "z", "at", "range"):
            value = getattr(self, name) or 0.0
            if not np.isfinite(value).all():
                raise UsageError(f"--{name}: finite numbers are needed, not {value}")
        if self.range is not None and self.full_range:
            raise UsageError("--range and --full-range exclude each other")
        if self.range is not None and not self.range[0] < self.range[1]:
            raise UsageError(f"--range: the first end has to be below the second, not {self.range}")
        if self.own_ranges and (self.range is not None or self.quantities != TORQUES):
            raise UsageError("--own-ranges is for the three torques, and excludes --range")
        if not self.max_condition >= 1:
            least = "1 is the least condition number there is"
            raise UsageError(f"--max-condition: {least}, not {self.max_condition}")
        if self.published is not None and self.reference is not None:
            raise UsageError("--published and --reference exclude each other")
        self.check_files()

    def run(self) -> int:
        """Compute the maps and write the files."""
        self.check()
        design = self.given_design()
        reference = self.given_reference(design)
        published = None if self.published is None else read_published_map(self.published)
        data = maps_of(self, design, reference, self.cells)
        for path in self.out:
            ending = path.suffix.lower()
            if ending in table_endings():
                content = table_bytes(map_table(data), ending[1:])
            else:
                from paminsa_viz.plots.map_figure import (
                    render_maps,  # late: matplotlib takes a second
                )

                scales = scales_of(self, data, maps_of(self, design, reference, COARSE))
                content = render_maps(
                    data, scales, ending[1:],
                    width_mm=self.width, dpi=self.dpi, published=published,
                )  # fmt: skip
            write_bytes(path, content)
        facts = _report(self, data)
        if published is not None:
            facts["published"] = off_published(design, data, published)
        if self.json:
            print_json(facts)
        else:
            _print(self, data, facts)
        if not (data.status == Limit.OK).any():
            z = format_ascii(data.z, "m", 6)
            problem = f"no position can be reached at {self.theta:g}° and z = {z}"
            print_error(PaminsaError(problem))
            return 1
        return 0


FLAGS = Map


def maps_of(flags: Map, design: Design, reference: Design | None, cells: int) -> MapData:
    """Return the maps of a design, or of its difference from a reference."""
    z = home_pose(design.geometry)[3] if flags.z is None else flags.z / MM
    pose = (flags.at[0] / MM, flags.at[1] / MM, math.radians(flags.theta), z)
    count = affordable_cells(flags.quantities, cells, BUDGET)
    half = frame_half(design.geometry, *pose[2:])

    def maps(shown: Design) -> MapData:
        field = workspace_field(shown.geometry, *pose[2:], count, half)
        return map_data(field, shown, pose, flags.quantities)

    return maps(design) if reference is None else difference(maps(design), maps(reference))


def scales_of(flags: Map, data: MapData, sample: MapData) -> tuple[Scale, ...]:
    """Return the color scales that the flags describe, as the explorer chooses them."""
    choice = ScaleChoice(
        shared=not flags.own_ranges,
        kind="symlog" if flags.log else "linear",
        full=flags.full_range,
    )
    unit = QUANTITIES[flags.quantities[0]].display
    ends = flags.range and usable_range(*map(unit.to_si, flags.range))
    if ends:
        choice = replace(choice, low=ends[0], high=ends[1])
    return choose_scales(data, choice, sample)


def _report(flags: Map, data: MapData) -> dict[str, Any]:
    """Return what the maps hold as data for JSON, in SI units."""
    reached = data.status == Limit.OK
    leg = np.full(data.status.shape, -1, np.int8) if data.leg is None else data.leg
    words, cells = np.unique(status_words(data.status, leg), return_counts=True)
    cell = float((data.x[1] - data.x[0]) * (data.y[1] - data.y[0]))
    names = list(flags.quantities)
    counts = _counting(data, flags.max_condition)
    return {
        "design": data.design.name,
        "reference": data.reference and data.reference.name,
        "knee": data.design.geometry.knee.value,
        "theta_rad": data.theta,
        "z_m": data.z,
        "cells": [data.x.size, data.y.size],
        "reached_area_m2": cell * int(reached.sum()),
        "singular_radius_m": data.singular_radius,
        "cells_by_status": dict(zip(words.tolist(), cells.tolist(), strict=True)),
        "unit": si_unit(data.unit),
        "max_condition": flags.max_condition,
        "counting_cells": int(counts.sum()),
        "maps": {
            name: _numbers(values, counts) for name, values in zip(names, data.values, strict=True)
        },
        "files": [os.fspath(path) for path in flags.out],
    }


def off_published(
    design: Design, data: MapData, published: PublishedMap
) -> dict[str, dict[str, float | int]]:
    """Return by how much computed torques are off published ones, by columns that have any.

    Largest and RMS differences over the positions that can be reached [N m, N].
    """
    rest = np.broadcast_to([data.theta, data.z], published.position.shape)
    off = static_torques(design, np.hstack([published.position, rest])) - published.torque
    found: dict[str, dict[str, float | int]] = {}
    for name, column in zip(TORQUE_NAMES, off.T, strict=True):
        known = column[np.isfinite(column)]
        if known.size:
            found[name] = {
                "positions": known.size,
                "largest_difference": float(np.abs(known).max()),
                "rms_difference": float(np.sqrt(np.mean(known**2))),
            }
    return found


def _counting(data: MapData, limit: float) -> NDArray[np.bool_]:
    """Return which cells are not too close to a singularity, for a difference of both designs."""
    grid = xy_grid(data.x, data.y, data.theta, data.z)
    designs = [data.design] if data.reference is None else [data.design, data.reference]
    return np.all([counting(solve_field(d.geometry, grid), limit) for d in designs], axis=0)


def _numbers(values: np.ndarray, counts: NDArray[np.bool_]) -> dict[str, float | None]:
    """Return extremes, and percentiles of the size, over the cells that count."""
    known = values[counts & np.isfinite(values)]
    if not known.size:
        return dict.fromkeys(("least", "largest", "median_size", "p90_size"))
    median, most = np.percentile(np.abs(known), (50, 90))
    return {
        "least": float(known.min()),
        "largest": float(known.max()),
        "median_size": float(median),
        "p90_size": float(most),
    }


def _print(flags: Map, data: MapData, facts: dict[str, Any]) -> None:
    design, reference = facts["design"], facts["reference"]
    minus = f' minus "{reference}"' if reference else ""
    print(f'design "{design}"{minus}, {data.design.geometry.knee.label}')
    factor, unit = data.display
    print(
        f"theta = {flags.theta:g}°, z = {format_ascii(data.z, 'm', 6)}, "
        f"{data.x.size} x {data.y.size} cells"
    )
    size = "|tau|" if flags.quantities == TORQUES else "size"
    rows = [
        (
            "" if not unit else f"[{unit}]",
            "least",
            "largest",
            f"median {size}",
            f"90 % of {size} below",
        ),
        *(
            (name, *("-" if v is None else f"{v * factor:.4g}" for v in found.values()))
            for name, found in facts["maps"].items()
        ),
    ]
    print_table(rows, words=1)
    counted, limit = facts["counting_cells"], f"{flags.max_condition:g}"
    print(
        f"over the {counted} cells that count: not too close to a singularity "
        f"(condition number at most {limit}, 10 mm to a stretched or folded leg)"
    )
    area, radius = facts["reached_area_m2"], facts["singular_radius_m"]
    print(f"reached: {area:.4g} m²; singular circle: radius {format_ascii(radius, 'm')}")
    for name, off in facts.get("published", {}).items():
        print(
            f"{name} - published: {off['largest_difference']:.4g} at most, "
            f"{off['rms_difference']:.4g} RMS over {off['positions']} positions"
        )
    print_written(flags.out)
