"""The choice of drives for a robot: each actuator's feasible ones in order, and what is lacking."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.drive_table import drive_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyCycle, Signal
from paminsa_viz.actuation.ratios import ratio_intervals
from paminsa_viz.actuation.sizing import (
    Order,
    Sizing,
    fitting_time,
    ordered,
    size_drives,
    thermal_share,
)
from paminsa_viz.checks import kinds_checked
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import Drive
from paminsa_viz.progress import Progress, go_on, of_part
from paminsa_viz.units import number

ROTARY = 3
"""Actuators M1..M3, which may have the same drive."""


@dataclass(frozen=True)
class DriveFigures:
    """A drive on a load.

    Attributes:
        drive: The drive.
        feasible: Whether it keeps all limits.
        use: Largest share of a limit; 1 less it is the margin.
        limit: That limit, one of `sizing.LIMITS`; empty if it uses none.
        rms, peak: Torque of the motor [N m].
        top_speed: Of the motor [rad/s].
        top_power: Largest mechanical power of the motor, in size [W].
        envelope: Share of the torque-speed envelope.
        inertia_ratio: The robot's inertia over the motor's.
        thermal: Largest temperature rise of the winding over that at the rated torque; NaN without
            a time constant.
        ratios: Least and largest gear ratio with which the motor could drive the load, the gear's
            inertia and efficiency unchanged; NaN where none can.
    """

    drive: Drive
    feasible: bool
    use: float
    limit: str
    rms: float
    peak: float
    top_speed: float
    top_power: float
    envelope: float
    inertia_ratio: float
    thermal: float
    ratios: tuple[float, float]


def cloud(load: ActuatorLoad, drive: Drive) -> tuple[Array, Array]:
    """Return speed [rad/s] and torque [N m] of a drive's motor at all samples of a load, (n,)."""
    torque = drive_table([drive]).factors()[0] @ load.signals
    return drive.ratio * load.signals[Signal.SPEED], torque


def figures(sizing: Sizing, index: int) -> DriveFigures:
    """Return the figures of one of the measured drives."""
    table, load = sizing.table, sizing.load
    drive = table.drive(index)
    speed, torque = cloud(load, drive)
    one = table[index : index + 1]
    found = ratio_intervals(load, one, inertia_ratio=sizing.most_inertia)
    ends = (found.low[0], found.high[0]) if found.feasible[0] else (np.nan, np.nan)
    lead = drive.ratio / drive.gear_ratio
    timed = np.isfinite(one.thermal_time[0]) and np.isfinite(one.rated_torque[0])
    return DriveFigures(
        drive=drive,
        feasible=bool(sizing.feasible[index]),
        use=float(sizing.use[index]),
        limit=sizing.limit(index),
        rms=float(sizing.rms[index]),
        peak=float(np.abs(torque).max()),
        top_speed=float(np.abs(speed).max()),
        top_power=float(np.abs(torque * speed).max()),
        envelope=float(sizing.envelope[index]),
        inertia_ratio=float(sizing.inertia_ratio[index]),
        thermal=float(thermal_share(load, one)[0]) if timed else float("nan"),
        ratios=(float(ends[0] / lead), float(ends[1] / lead)),
    )


@dataclass(frozen=True, eq=False)
class Selection:
    """Drives of a catalog for the four actuators.

    Attributes:
        cycle: The duty cycle.
        sizings: Every pair of the catalog, by actuator.
        rows: The feasible ones of each actuator in order, as indices.
        same: Whether M1..M3 have the same drive.
    """

    cycle: DutyCycle
    sizings: tuple[Sizing, ...] = field(repr=False)
    rows: tuple[NDArray[np.intp], ...]
    same: bool

    def figures(self, actuator: int, count: int) -> list[DriveFigures]:
        """Return the first feasible drives of an actuator."""
        return [figures(self.sizings[actuator], int(row)) for row in self.rows[actuator][:count]]

    @property
    def drives(self) -> tuple[Drive | None, ...]:
        """The first feasible drive of each actuator, None where there is none."""
        return tuple(
            sizing.table.drive(int(rows[0])) if len(rows) else None
            for sizing, rows in zip(self.sizings, self.rows, strict=True)
        )

    @property
    def feasible(self) -> bool:
        """Whether every actuator has a drive."""
        return all(len(rows) for rows in self.rows)

    def design(self, design: Design) -> Design:
        """Return a design with the first feasible drives, and its own where there is none."""
        drives: Any = tuple(
            own if found is None else found
            for own, found in zip(design.drives, self.drives, strict=True)
        )
        return replace(design, drives=drives)

    def advice(self, actuator: int, progress: Progress = go_on) -> str:
        """Return what would make an actuator's drive feasible, in words; empty if one is.

        Raises:
            Canceled: If ``progress``, which is called now and then, ends it.
        """
        if len(self.rows[actuator]):
            return ""
        sizing = self.sizings[actuator]
        nearest = figures(sizing, sizing.nearest)
        text = (
            f"no drive fits; the nearest is {nearest.drive.name}, whose {nearest.limit} is "
            f"{number(100 * nearest.use)} % of its limit"
        )
        factor = fitting_time(
            self.cycle, actuator, sizing.table, inertia_ratio=sizing.most_inertia, progress=progress
        )
        if not np.isfinite(factor):
            return f"{text}; no slower motion makes one fit"
        if factor == 1:  # each actuator has one, but not the same for all
            return f"{text}; M1, M2 and M3 have feasible drives, but none in common"
        enough = math.ceil(1e3 * factor) / 1e3  # rounded down it would be too little
        return f"{text}; motions {enough:.3f} times as long make one fit"


@kinds_checked
def select_drives(
    cycle: DutyCycle,
    catalog: Catalog,
    *,
    order: Order = "mass",
    inertia_ratio: float = np.inf,
    same: bool = False,
    progress: Progress = go_on,
) -> Selection:
    """Measure every pair of a catalog on a duty cycle and put the feasible ones in order.

    Args:
        cycle: The duty cycle.
        catalog: Motors, gears, screws and belts.
        order: What comes first.
        inertia_ratio: Largest inertia of the robot over that of the motor, at the motor's shaft.
        same: Whether M1..M3 have to have the same drive; they are listed by the worst of the three.
        progress: Called now and then.

    Raises:
        Canceled: If ``progress`` ends it.
        CatalogError: If the catalog lacks motors, gears, or screws and belts.
        InvalidInput: If the order or the ratio of inertias is not possible.
    """
    rotary, linear = catalog.pairs(0), catalog.pairs(ROTARY)
    tables = (rotary, rotary, rotary, linear)
    sizings = tuple(
        size_drives(
            load, table, inertia_ratio=inertia_ratio, progress=of_part(progress, j / 4, (j + 1) / 4)
        )
        for j, (load, table) in enumerate(zip(cycle.loads, tables, strict=True))
    )
    rows = [sizing.ordered(order) for sizing in sizings]
    if same:
        rows[:ROTARY] = [_common(sizings[:ROTARY], order)] * ROTARY
    return Selection(cycle, sizings, tuple(rows), same)


def _common(sizings: tuple[Sizing, ...], order: Order) -> NDArray[np.intp]:
    """Return the drives that are feasible on all of several loads, by the largest shares."""
    use = np.max([sizing.use for sizing in sizings], axis=0)
    return ordered(sizings[0].table, use, order)


def size_design(cycle: DutyCycle, design: Design) -> tuple[DriveFigures | None, ...]:
    """Return the figures of a design's own drives on a duty cycle, None where it has none."""
    found: list[DriveFigures | None] = []
    for load, drive in zip(cycle.loads, design.drives, strict=True):
        sized = None if drive is None else size_drives(load, drive_table([drive]))
        found.append(None if sized is None else figures(sized, 0))
    return tuple(found)
