"""``paminsa-viz map``: torques and other quantities over the workspace, as figures and tables."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.blocks.maps import maps_blocks, maps_data
from paminsa_viz.cli.arguments import OneOf, OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import NEEDS_FIGURE, ComparedDesignFlags, FilesFlags
from paminsa_viz.cli.output import (
    print_blocks,
    print_error,
    print_json,
    print_left_out,
    print_written,
    status_line,
)
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.published_table import read_published_map
from paminsa_viz.files.tables import table_bytes, table_endings
from paminsa_viz.model import Design
from paminsa_viz.model.reach import Limit, home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.plots.map_table import map_table
from paminsa_viz.plots.map_values import (
    COARSE,
    FULL,
    MOST_CELLS,
    MapData,
    difference,
    frame_half,
    map_data,
    workspace_field,
)
from paminsa_viz.plots.ranges import ScaleChoice, choose_scales, usable_range
from paminsa_viz.plots.scale import Scale
from paminsa_viz.quantities import QUANTITIES, TORQUES, affordable_cells, selections
from paminsa_viz.units import MM, format_ascii

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


CELLS = (10, MOST_CELLS)
"""Possible numbers of cells along a side."""

BUDGET = 30.0
"""Time that the cells of costly quantities may take [s]; beyond it there are fewer."""

QUANTITY_WORDS = tuple(name.replace("_", "-") for name in selections())


@dataclass(frozen=True, kw_only=True)
class Map(FilesFlags, ComparedDesignFlags):
    """Flags of the command."""

    quantity: OneOf[str, QUANTITY_WORDS] = "torques"
    """What to map; torques are those of M1, M2 and M3 side by side."""
    theta: Annotated[float, tyro.conf.arg(metavar="DEG")] = 60.0
    """Angle of the platform [°]."""
    z: Annotated[OrNone[float], tyro.conf.arg(metavar="MM")] = None
    """Height of the platform [mm]; in the middle of the workspace if left out."""
    at: Annotated[tuple[float, float], tyro.conf.arg(metavar="X Y")] = (0.0, 0.0)
    """Position of the ring that marks a pose [mm]."""
    cells: int = FULL
    """Cells along each side."""
    max_condition: float = CONDITION_LIMIT
    """Largest condition number of a position that counts in the printed numbers: toward a
    singularity torques grow without bound."""

    range: Annotated[OrNone[tuple[float, float]], tyro.conf.arg(metavar="LOW HIGH")] = None
    """Ends of the colors, in the unit of the color bar; by default those of the ordinary values,
    so that those that grow without bound next to a singularity lie beyond."""
    full_range: bool = False
    """Let the colors span every value."""
    log: bool = False
    """Let the colors follow a logarithm to both sides of zero."""
    own_ranges: bool = False
    """Give each of the three torques colors of its own."""
    published: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.csv")] = None
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
        check_needs(self, self.draws, NEEDS_FIGURE, "range", "full_range", "log", "own_ranges")

    def run(self) -> int:
        """Compute the maps and write the files."""
        self.check()
        design = self.given_design()
        reference = self.given_reference(design)
        published = None if self.published is None else read_published_map(self.published)
        with status_line("computing the maps"):
            data = maps_of(self, design, reference, self.cells)
            sample = maps_of(self, design, reference, COARSE) if self.draws else data
        for path in self.out:
            ending = path.suffix.lower()
            if ending in table_endings():
                content = table_bytes(map_table(data), ending[1:])
            else:
                from paminsa_viz.plots.map_figure import (
                    render_maps,  # late: matplotlib takes a second
                )

                content = render_maps(
                    data, scales_of(self, data, sample), ending[1:],
                    width_mm=self.width, dpi=self.dpi, published=published,
                )  # fmt: skip
            write_bytes(path, content)
        facts = maps_data(data, self.quantities, self.max_condition, published)
        if self.json:
            print_json(facts | {"files": self.out})
        else:
            print_blocks(maps_blocks(data, facts))
            if not data.own_legs:
                print_left_out(design)
            print_written(self.out)
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
