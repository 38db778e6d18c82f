"""Feasible ratios of a motor in closed form.

Both kinds of limits are a quadratic in the ratio N. With the load's signals phi and the motor's own
part u = J w' + b w,

    RMS:      <T_e^2> + 2 <T_e u> N^2 + <u^2> N^4 <= rated^2 N^2
    a sample: s (T_e + u N^2) + k |w| N^2 <= a N,    s = 1 and -1,

for every line tau <= a - k |N w| of a concave envelope; peak torque is the line with k = 0. T_e has
what a screw or belt behind the gear takes, as far as the gear is not chosen yet. Each of
them allows one interval of N, so all together do. Which sample ends it is not known beforehand: an
interval is cut by the samples that break it most at its ends until none does, which is exact, as a
sample that allows both ends allows everything between.

Coulomb friction leaves the samples' limits quadratic, but not the RMS; an envelope that is not
concave has no lines. These are scanned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.actuation.catalog import Catalog
from paminsa_viz.actuation.drive_table import DriveTable, drive_table
from paminsa_viz.actuation.duty import ActuatorLoad, DutyCycle, Signal
from paminsa_viz.actuation.sizing import envelope_share, rms_torque
from paminsa_viz.checks import kinds_checked, require_positive
from paminsa_viz.model.arrays import Array

FIRST_SAMPLES = 64
"""Samples, evenly spaced, that an interval is cut by before it is looked at at its ends."""

MOST_CUTS = 200
"""Rounds after which a search for the binding sample is given up; a few are usual."""

TOUCHING = 1e-12
"""Share by which a limit may be exceeded at an end of an interval: rounding."""

SCANNED = 1000
"""Ratios of a scan, in equal steps of their logarithm."""

WIDEST = 1e6
"""Ratio of the ends of a scan that no limit ends."""


@dataclass(frozen=True, eq=False)
class RatioIntervals:
    """Ratios N of each motor with which it can drive a load [rad/rad, rad/m].

    Attributes:
        low, high: (n,) ends; low > high, or NaN, where there is none.
        scanned: Where Coulomb friction or an envelope that is not concave made a scan necessary.
        gaps: Where a scan found ratios between the ends that are not feasible.
    """

    low: Array
    high: Array
    scanned: NDArray[np.bool_]
    gaps: NDArray[np.bool_]

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Where there are any."""
        return self.low <= self.high


@dataclass(frozen=True)
class GearRatios:
    """Gear ratios with which a motor of a catalog can drive an actuator.

    Attributes:
        actuator: Its name.
        motor: The motor, for M4 with the screw or belt behind its gear.
        low, high: Ends of the ratios; None where there is none.
        scanned: Whether they were found by a scan.
        gaps: Whether ratios between the ends are not feasible.
    """

    actuator: str
    motor: str
    low: float | None
    high: float | None
    scanned: bool
    gaps: bool


@kinds_checked
def ratio_intervals(
    load: ActuatorLoad, table: DriveTable, *, inertia_ratio: float = np.inf
) -> RatioIntervals:
    """Return the feasible ratios of each drive's motor; the table's own ratio does not matter.

    Inertia, friction and efficiency are the table's, whatever the ratio.

    Args:
        load: What the actuator has to do.
        table: The drives.
        inertia_ratio: Largest inertia of the robot over that of the motor, at the motor's shaft.

    Raises:
        InvalidInput: If the ratio of inertias is not positive.
    """
    require_positive(inertia_ratio, "inertia_ratio", finite=False)
    low, high = np.zeros(len(table)), np.full(len(table), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        top, mean = load.top_speed, load.mean_speed
        high = np.minimum(high, np.where(top > 0, table.top_speed / top, np.inf))
        high = np.minimum(high, np.where(mean > 0, table.rated_speed / mean, np.inf))
        if np.isfinite(inertia_ratio):
            missing = np.maximum(load.inertia / inertia_ratio - table.output_inertia, 0.0)
            low = np.maximum(low, np.sqrt(missing / table.inertia))
        held = np.where(table.holds, 0.0, load.held / table.corner_torque[:, 0])
        low = np.maximum(low, held)
        low[(load.peak > table.gear_peak) | (load.rms > table.gear_rated)] = np.nan
        rubs, bent = table.coulomb > 0, ~table.concave
        smooth = np.flatnonzero(~rubs)
        first, last = _rms_interval(load, table[smooth])
        low[smooth] = np.maximum(low[smooth], first)
        high[smooth] = np.minimum(high[smooth], last)
        _cut(load, table, np.flatnonzero(~bent & (low <= high)), low, high)
        scanned = rubs | bent
        gaps = _scan(load, table, np.flatnonzero(scanned & (low <= high)), low, high)
    return RatioIntervals(low, high, scanned, gaps)


def figure_of_merit(load: ActuatorLoad, table: DriveTable) -> tuple[Array, Array]:
    """Return alpha = rated^2/J of each motor, and what the load asks of it, (n,) each [W/s].

    With a = w' + (b/J) w it is 2 (a_rms T_e,rms + mean a T_e): below it no ratio keeps the rated
    torque, and with Coulomb friction not even above it is one sure to.
    """
    torque, mixed, own = _coefficients(load, table)
    with np.errstate(divide="ignore", invalid="ignore"):
        asked = 2 * (np.sqrt(np.maximum(torque * own, 0.0)) + mixed) / table.inertia
        return table.rated_torque**2 / table.inertia, asked


def _coefficients(load: ActuatorLoad, table: DriveTable) -> tuple[Array, Array, Array]:
    """Return <T_e^2>, <T_e u> and <u^2> of each drive, (n,) each."""
    torque, own, means = table.geared_down, table.geared_up, load.means
    held = np.where(table.holds, 0.0, load.held_square)
    return (
        np.einsum("pi,ij,pj->p", torque, means, torque) + held,
        np.einsum("pi,ij,pj->p", torque, means, own),
        np.einsum("pi,ij,pj->p", own, means, own),
    )


def _interval(square: Array, limit: Array, constant: Array | float) -> tuple[Array, Array]:
    """Return the x > 0 with square x^2 - limit x + constant <= 0, as ends.

    Where there are none, low > high or high < 0, or both are NaN. With constant > 0 and square < 0
    this is a half line, and so on: one interval, but where the limit is negative and neither of the
    others positive.
    """
    root = np.sqrt(limit**2 - 4 * square * constant)
    high = np.where(square > 0, (limit + root) / (2 * square), np.inf)
    low = np.where(constant > 0, 2 * constant / (limit + root), 0.0)
    return low, high


def _rms_interval(load: ActuatorLoad, table: DriveTable) -> tuple[Array, Array]:
    torque, mixed, own = _coefficients(load, table)
    low, high = _interval(np.maximum(own, 0.0), table.rated_torque**2 - 2 * mixed, torque)
    unlimited = np.isinf(table.rated_torque)
    return np.where(unlimited, 0.0, np.sqrt(low)), np.where(unlimited, np.inf, np.sqrt(high))


def _cut(
    load: ActuatorLoad, table: DriveTable, rows: NDArray[np.intp], low: Array, high: Array
) -> None:
    """Cut the intervals of some drives by the samples' limits, in place."""
    count = load.signals.shape[1]
    even = np.linspace(0, count - 1, min(FIRST_SAMPLES, count)).astype(int)
    # where a signal is nearly always zero, its one sample ends what is 0 or infinite by the others
    extreme = np.abs(load.signals).argmax(axis=1)
    _cut_by(load, table, rows, np.concatenate([even, extreme])[None], low, high)
    open_low = open_high = rows[low[rows] <= high[rows]]
    for _ in range(MOST_CUTS):
        open_low = _cut_end(load, table, open_low, low, low, high)
        open_high = _cut_end(load, table, open_high, high, low, high)
        if not (len(open_low) or len(open_high)):
            return


def _cut_end(
    load: ActuatorLoad, table: DriveTable, rows: NDArray[np.intp], end: Array, low: Array,
    high: Array,
) -> NDArray[np.intp]:  # fmt: skip
    """Cut intervals by the sample that breaks one of their ends most; return those that were."""
    usable = (low[rows] <= high[rows]) & (end[rows] > 0) & np.isfinite(end[rows])
    rows = rows[usable]
    if not len(rows):
        return rows
    share, worst = envelope_share(load, table[rows], end[rows])
    broken = share > 1 + TOUCHING
    rows = rows[broken]
    _cut_by(load, table, rows, worst[broken, None], low, high)
    return rows


def _cut_by(
    load: ActuatorLoad, table: DriveTable, rows: NDArray[np.intp], sample: NDArray[np.intp],
    low: Array, high: Array,
) -> None:  # fmt: skip
    """Cut the intervals of n drives by their lines at some samples (n or 1, m), in place."""
    part = table[rows]
    phi = load.signals[:, sample]
    down, up = part.geared_down[..., None], part.geared_up[..., None]
    torque = sum(down[:, i] * phi[i] for i in Signal)
    own = sum(up[:, i] * phi[i] for i in (Signal.ACCELERATION, Signal.SPEED))
    drag = part.coulomb[:, None] * phi[Signal.SIGN]
    speed = np.abs(phi[Signal.SPEED])
    for a, k in zip(*(column.T[..., None] for column in part.lines), strict=True):
        free = np.isinf(a[:, 0])
        for sign in (1.0, -1.0):
            first, last = _interval(sign * own + k * speed, a - sign * drag, sign * torque)
            first, last = first.max(axis=1), last.min(axis=1)
            low[rows] = np.where(free, low[rows], np.maximum(low[rows], first))
            high[rows] = np.where(free, high[rows], np.minimum(high[rows], last))


def _scan(
    load: ActuatorLoad, table: DriveTable, rows: NDArray[np.intp], low: Array, high: Array
) -> NDArray[np.bool_]:
    """Narrow intervals to the feasible ratios of a scan, in place; return where it has gaps."""
    gaps = np.zeros(len(table), bool)
    for row in rows:
        part = table[row : row + 1]
        end = high[row] if np.isfinite(high[row]) else WIDEST * max(low[row], 1.0)
        start = max(low[row], end / WIDEST**2)
        ratios = np.geomspace(start, end, SCANNED)
        good = _keeps(load, part, ratios)
        if not good.any():
            low[row], high[row] = np.nan, np.nan
            continue
        found = np.flatnonzero(good)
        gaps[row] = (np.diff(found) > 1).any()
        if found[0] > 0:
            low[row] = _edge(load, part, *ratios[[found[0], found[0] - 1]].tolist())
        if found[-1] < SCANNED - 1:
            high[row] = _edge(load, part, *ratios[[found[-1], found[-1] + 1]].tolist())
    return gaps


def _keeps(load: ActuatorLoad, part: DriveTable, ratios: Array) -> NDArray[np.bool_]:
    """Whether one drive keeps its rated torque and its envelope with ratios."""
    many = part[np.zeros(len(ratios), int)]
    good = rms_torque(load, many, ratios) <= many.rated_torque
    if part.concave[0]:  # its envelope is kept between the ends
        return good
    good[good] = envelope_share(load, many[good], ratios[good])[0] <= 1
    return good


def _edge(load: ActuatorLoad, part: DriveTable, good: float, bad: float) -> float:
    """Return where a drive begins to be feasible, between two ratios, by bisection."""
    for _ in range(50):
        middle = 0.5 * (good + bad)
        if _keeps(load, part, np.array([middle]))[0]:
            good = middle
        else:
            bad = middle
    return good


def catalog_ratios(
    cycle: DutyCycle, catalog: Catalog, *, inertia_ratio: float = np.inf
) -> list[GearRatios]:
    """Return the gear ratios of every motor for every actuator, for a gear without inertia.

    Args:
        cycle: What the actuators have to do.
        catalog: The motors, and the screws and belts of M4 with their inertia and friction.
        inertia_ratio: Largest inertia of the robot over that of the motor, at the motor's shaft.

    Raises:
        CatalogError: If the catalog has no motor, or no screw or belt.
        InvalidInput: If the ratio of inertias is not positive.
    """
    catalog.pairs(3)  # says what the catalog lacks
    screws = catalog.transmissions
    found: list[GearRatios] = []
    for j, load in enumerate(cycle.loads):
        bare = catalog.motors if j < 3 else catalog.motors * len(screws)
        leads = [1.0] * len(bare)
        names = [motor.name for motor in bare]
        table = drive_table(bare)
        if j == 3:
            each = [screw for screw in screws for _ in catalog.motors]
            leads = [2 * np.pi / screw.lead for screw in each if screw.lead is not None]
            names = [f"{a}, {b.name}" for a, b in zip(names, each, strict=True)]
            table.efficiency[:] = [screw.lead_efficiency for screw in each]
            table.holds[:] |= [screw.holds for screw in each]
            table.output_inertia[:] = [screw.reflected_inertia for screw in each]
            viscous, coulomb = zip(*(screw.reflected_friction for screw in each), strict=True)
            table.output_viscous[:], table.output_coulomb[:] = viscous, coulomb
        ends = ratio_intervals(load, table, inertia_ratio=inertia_ratio)
        for i, (name, lead) in enumerate(zip(names, leads, strict=True)):
            low, high = (
                float(end[i]) / lead if ends.feasible[i] else None for end in (ends.low, ends.high)
            )
            scanned, gaps = bool(ends.scanned[i]), bool(ends.gaps[i])
            found.append(GearRatios(load.name, name, low, high, scanned, gaps))
    return found
