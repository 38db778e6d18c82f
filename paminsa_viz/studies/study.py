"""A study: which designs, measured over which poses; every row of its table by its number."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from functools import cached_property

import numpy as np

from paminsa_viz import __version__
from paminsa_viz.files.errors import printable
from paminsa_viz.model import backend
from paminsa_viz.model.balancing.changes import whole_mass
from paminsa_viz.model.balancing.requirements import resized
from paminsa_viz.model.design import Assembly, Design
from paminsa_viz.model.errors import InvalidDesign
from paminsa_viz.model.parameters import PARAMETER, PARAMETERS
from paminsa_viz.studies.metrics import METRICS, Region, measure_design
from paminsa_viz.studies.variations import DesignGrid, RandomDesigns

FORMAT = "paminsa_viz sweep 1"
"""Name and version of the table's layout."""

OK = "ok"


@dataclass(frozen=True)
class Study:
    """Many designs, each measured over a region of the workspace; can be sent to other processes.

    Attributes:
        design: Where the values come from that do not vary.
        variation: What varies.
        region: The poses that are looked at.
        assembly: Root of the knee.
        scale_bars: Whether bars gain mass and inertia with their length, see `resized`.
    """

    design: Design
    variation: DesignGrid | RandomDesigns
    region: Region
    assembly: Assembly = Assembly.PRINTED
    scale_bars: bool = False

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.variation.size

    @property
    def work(self) -> int:
        """Number of poses to be solved in all."""
        region = self.region
        return self.size * len(region.theta) * len(region.z) * region.cells**2

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the table's columns."""
        return ("row", *map(column, self.variation.paths), "status", *(m.column for m in METRICS))

    def vary(self, values: tuple[float, ...]) -> Design:
        """Return the design with these values at the paths that vary.

        Raises:
            InvalidDesign: If there is no such robot.
        """
        changes = dict(zip(self.variation.paths, values, strict=True))
        lengths = {path: v for path, v in changes.items() if path.startswith("geometry.")}
        others = {path: v for path, v in changes.items() if path not in lengths}
        # The others come second, so that a mass that varies is not overruled by a length's.
        return resized(self.design, lengths, scale_bars=self.scale_bars).vary(others)

    def row(self, index: int) -> tuple[str, ...]:
        """Return the cells of one row: its number, the values, the status, the metrics.

        The status is ``ok``, ``not-reached`` or ``not-usable`` if no pose of the region is, or
        ``impossible`` with the design value that stands in the way. A number is written so that it
        reads back as the same one; where there is none the cell is empty.
        """
        # Compiled formulae differ from those on arrays in the last digit, and a row has to be the
        # same in every process.
        backend.compile_now()
        values = self.variation.values(index)
        try:
            design = self.vary(values)
        except InvalidDesign as error:
            status, found = f"impossible:{error.field}", (np.nan,) * len(METRICS)
        else:
            with np.errstate(all="ignore"):
                found = measure_design(
                    design, self.region, self.assembly, base_mass=self._base_mass
                )
            status = self._status(found)
        return (str(index), *map(repr, values), status, *map(_cell, found))

    def rows(self, part: range) -> list[tuple[str, ...]]:
        """Return some rows, see `row`."""
        return [self.row(index) for index in part]

    @cached_property
    def fingerprint(self) -> str:
        """What tells this study's table from any other: a hash of all that decides its rows."""
        told = {
            "format": FORMAT,
            "version": __version__,
            "design": {p.path: self.design.value(p.path) for p in PARAMETERS},
            "counterweights": [asdict(weight) for weight in self.design.counterweights],
            "kind": type(self.variation).__name__,
            "variation": asdict(self.variation),
            "region": asdict(self.region),
            "assembly": self.assembly.value,
            "scale_bars": self.scale_bars,
            "columns": self.columns,
        }
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:32]

    def provenance(self, command: str = "") -> dict[str, str]:
        """Return what the head of the table says: key and value, both on one line."""
        region, variation = self.region, self.variation
        seed = variation.seed if isinstance(variation, RandomDesigns) else None
        said = {
            "format": FORMAT,
            "made by": f"paminsa_viz {__version__}",
            "command": command,
            "study": self.fingerprint,
            "rows": str(self.size),
            "designs": "grid" if seed is None else f"random, seed {seed}",
            "design": self.design.name,
            "assembly": self.assembly.value,
            "scale bars": "yes" if self.scale_bars else "no",
            "region radius [m]": repr(region.radius),
            "region theta [rad]": " ".join(map(repr, region.theta)),
            "region z [m]": " ".join(map(repr, region.z)),
            "region cells": str(region.cells),
            "largest condition number": repr(region.max_condition),
        }
        said |= {m.column: m.meaning for m in METRICS}
        said |= {f"design {p.path}": repr(self.design.value(p.path)) for p in PARAMETERS}
        for number, weight in enumerate(self.design.counterweights):
            said[f"design counterweights.{number}"] = f"{weight.mass!r} kg on {weight.place}"
        return {key: printable(value) for key, value in said.items() if value}

    @cached_property
    def _base_mass(self) -> float:
        return whole_mass(self.design)

    @staticmethod
    def _status(found: tuple[float, ...]) -> str:
        names = [metric.column for metric in METRICS]
        if found[names.index("reached_share")] == 0:
            return "not-reached"
        return OK if found[names.index("usable_share")] else "not-usable"


def column(path: str) -> str:
    """Return the name of a design value's column: its path, with its unit, ``links.b3 [kg]``."""
    unit = PARAMETER[path].unit
    return f"{path} [{unit}]" if unit else path


def _cell(value: float) -> str:
    return "" if value != value else repr(float(value))
