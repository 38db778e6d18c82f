"""A study: which designs, over which poses, on which motion; every row by its number."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from functools import cached_property

import numpy as np

from paminsa_viz.balancing.changes import whole_mass
from paminsa_viz.errors import InvalidDesign, printable
from paminsa_viz.files.trajectory_table import parameter_facts
from paminsa_viz.model import backend
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.design import (
    APPENDIX_4,
    OPTIONAL_GROUPS,
    PARAMETER,
    Design,
)
from paminsa_viz.model.resizing import BarLaw, resized
from paminsa_viz.quantities.accuracy import OF_OWN_LEGS
from paminsa_viz.studies.metrics import (
    METRICS,
    MOTION_METRICS,
    Metric,
    global_indices,
    measure_design,
    measure_motion,
    samples_hash,
)
from paminsa_viz.studies.region import Region
from paminsa_viz.studies.variations import DesignGrid, RandomDesigns
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.version import MADE_BY

FORMAT = "paminsa_viz sweep 1"
"""Name and version of the table's layout."""

OK = "ok"

SAMPLE_WORK = 4
"""Poses of a region that take as long as a sample of a motion."""


@dataclass(frozen=True)
class Study:
    """Many designs, each measured over a region of the workspace, and on a motion if there is one.

    It can be sent to other processes.

    Attributes:
        design: Where the values come from that do not vary.
        variation: What varies.
        region: The poses that are looked at.
        scale_bars: Whether bars gain mass and inertia with their length, see `resized`.
        trajectory: A motion, the same one for all designs, or None.
        indices: Keys of quantities whose global indices are measured as well, see `global_indices`.
    """

    design: Design
    variation: DesignGrid | RandomDesigns
    region: Region
    scale_bars: bool = False
    trajectory: Trajectory | None = None
    indices: tuple[str, ...] = ()

    @property
    def region_metrics(self) -> tuple[Metric, ...]:
        """What is measured over the region, in the order of the table's columns."""
        return METRICS + global_indices(self.indices)

    @property
    def own_legs(self) -> bool:
        """Whether indices follow the deviations of single legs; all else takes legs as equal."""
        return not OF_OWN_LEGS.isdisjoint(self.indices)

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.variation.size

    @property
    def work(self) -> int:
        """Number of poses to be solved in all, or of what takes as long."""
        region, motion = self.region, self.trajectory
        poses = len(region.theta) * len(region.z) * region.cells**2
        return self.size * (poses + (0 if motion is None else SAMPLE_WORK * motion.size))

    @property
    def metrics(self) -> tuple[Metric, ...]:
        """What is measured, in the order of the table's columns."""
        return self.region_metrics + (() if self.trajectory is None else MOTION_METRICS)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the table's columns."""
        first = ("row", *map(column, self.variation.paths), "status")
        columns = first + tuple(metric.column for metric in self.region_metrics)
        if self.trajectory is None:
            return columns
        return (*columns, "motion", "motion_fails_s", *(m.column for m in MOTION_METRICS))

    def vary(self, values: tuple[float, ...]) -> Design:
        """Return the design with these values at the paths that vary.

        Raises:
            InvalidDesign: If there is no such robot.
        """
        changes = dict(zip(self.variation.paths, values, strict=True))
        lengths = {path: v for path, v in changes.items() if path.startswith("geometry.")}
        others = {path: v for path, v in changes.items() if path not in lengths}
        # The others come second, so that a mass that varies is not overruled by a length's.
        return resized(self.design, lengths, BarLaw(self.scale_bars)).vary(others)

    def row(self, index: int) -> tuple[str, ...]:
        """Return the cells of one row: its number, the values, the status, the metrics.

        The status is ``ok``, ``not-reached`` or ``not-usable`` if no pose of the region is, or
        ``impossible`` with the design value that is impossible. The motion has a word of its
        own and a time, see `measure_motion`. A number is written so that it reads back as the same
        one; where there is none the cell is empty.
        """
        # Compiled formulas differ from those on arrays in the last digit, and a row has to be the
        # same in every process.
        backend.compile_now()
        values = self.variation.values(index)
        try:
            design = self.vary(values)
        except InvalidDesign as error:
            cells = (str(index), *map(repr, values), f"impossible:{error.field}")
            return cells + ("",) * (len(self.columns) - len(cells))
        with np.errstate(all="ignore"):
            found = measure_design(
                design, self.region, base_mass=self._base_mass, metrics=self.region_metrics
            )
            cells = (str(index), *map(repr, values), self._status(found), *map(_cell, found))
            if self.trajectory is None:
                return cells
            word, time, loads = measure_motion(design, self.trajectory)
        return (*cells, word, *map(_cell, (time, *loads)))

    def rows(self, part: range) -> list[tuple[str, ...]]:
        """Return some rows, see `row`."""
        return [self.row(index) for index in part]

    @cached_property
    def fingerprint(self) -> str:
        """Hash of all that the rows follow from."""
        facts = {
            "format": FORMAT,
            # Numbers that are Appendix 4's are left out: a later version may have more of them.
            "design": {
                path: value
                for path in PARAMETER
                if (value := self.design.value(path)) != APPENDIX_4.value(path)
            },
            "counterweights": [asdict(weight) for weight in self.design.counterweights],
            "kind": type(self.variation).__name__,
            "variation": asdict(self.variation),
            "region": asdict(self.region),
            "knee": self.design.geometry.knee.value,
            "scale_bars": self.scale_bars,
            "columns": self.columns,
            "motion": None if self.trajectory is None else samples_hash(self.trajectory),
        }
        if self._loaded:
            facts["load frame"] = self.design.load.frame.value
        if any(self.design.drives):
            facts["drives"] = [drive and asdict(drive) for drive in self.design.drives]
        for name in OPTIONAL_GROUPS:
            if (group := getattr(self.design, name)) != getattr(APPENDIX_4, name):
                facts[name] = asdict(group)
        return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:32]

    def provenance(self, command: str = "") -> dict[str, str]:
        """Return the head of the table: keys and values, each on one line.

        The rows follow from what is below the fingerprint.
        """
        region, variation = self.region, self.variation
        if isinstance(variation, RandomDesigns):
            designs, varied = f"random, seed {variation.seed}", variation.ranges
        else:
            designs, varied = "grid", variation.axes
        facts = {
            "format": FORMAT,
            "command": command,
            "design": self.design.name,
            "legs": "" if self.own_legs else equal_legs_note(self.design.deviations),
            "study": self.fingerprint,
            "made by": MADE_BY,
            "rows": str(self.size),
            "designs": designs,
            "knee": self.design.geometry.knee.value,
            "scale bars": "yes" if self.scale_bars else "no",
            "region radius [m]": repr(region.radius),
            "region theta [rad]": " ".join(map(repr, region.theta)),
            "region z [m]": " ".join(map(repr, region.z)),
            "region cells": str(region.cells),
            "largest condition number": repr(region.max_condition),
        }
        facts |= {f"vary {column(item.path)}": item.words for item in varied}
        if self.trajectory is not None:
            motion = self.trajectory
            facts["motion"] = f"{motion.name}, {motion.size} samples in {motion.duration:g} s"
            facts["hash of the motion's samples"] = samples_hash(motion)
        facts |= {m.column: m.meaning for m in self.metrics}
        facts |= parameter_facts(self.design)
        return {key: printable(value) for key, value in facts.items() if value}

    @property
    def _loaded(self) -> bool:
        """Whether a load acts on any design of it."""
        varies = any(path.startswith("load.") for path in self.variation.paths)
        return self.design.load.acts or varies

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
