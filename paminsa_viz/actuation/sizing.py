"""What drives have to give on a duty cycle, and how much of their limits that is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.actuation.drive_table import DriveTable
from paminsa_viz.actuation.duty import BLOCK_WIDTH, ActuatorLoad, DutyCycle, DutyMotion, Signal
from paminsa_viz.checks import kinds_checked, require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.progress import Progress, go_on, keep_on, of_part

# ------------------------------------------------------------- temperature of windings over a cycle
# A winding is one thermal mass: with the time constant t_th its rise over that at the rated torque
# follows t_th h' = (tau/rated)^2 - h. The heat is linear between samples, the solution exact; the
# cycle starts at the temperature that it ends with.

EVEN = 1e-9
"""Relative difference of time steps that counts as even."""

DRIVES_AT_A_TIME = 64
"""Drives whose temperatures are worked out together, to bound the memory."""


def thermal_share(load: ActuatorLoad, table: DriveTable, progress: Progress = go_on) -> Array:
    """Return the largest temperature rise over that at the rated torque, (n,).

    All drives need a time constant and a rated torque. A cycle that is short against the time
    constant gives the square of RMS over rated torque, any other one more. ``progress`` is called
    after some drives each.

    Raises:
        Canceled: If ``progress`` ends it.
    """
    shares = np.empty(len(table))
    for start in range(0, len(table), DRIVES_AT_A_TIME):
        rows = slice(start, start + DRIVES_AT_A_TIME)
        shares[rows] = _shares(load, table[rows])
        keep_on(progress, min(rows.stop, len(table)) / len(table))
    return shares


def _shares(load: ActuatorLoad, table: DriveTable) -> Array:
    factors, time = table.factors(), table.thermal_time[:, None]
    starts, parts = [], []
    # one cycle as affine maps of the temperature at its start: h -> decay h + gain
    decay, gain = np.ones(len(table)), np.zeros(len(table))
    for passage in load.passages:
        heat = (factors @ passage.signals / table.rated_torque[:, None]) ** 2
        rise = _rise(passage, heat, time)
        one = np.exp(-passage.t[-1] / time[:, 0])
        held = np.where(table.holds, 0.0, passage.held * factors[:, 2] / table.rated_torque) ** 2
        cooled = np.exp(-passage.dwell / time[:, 0])
        step_decay, step_gain = one * cooled, rise[:, -1] * cooled + held * (1 - cooled)
        many = step_decay ** (passage.repeats - 1)
        settled = step_gain / (1 - step_decay)
        starts.append((decay, gain, many, settled))
        parts.append((passage, rise))
        whole = many * step_decay
        decay, gain = decay * whole, gain * whole + settled * (1 - whole)
    base = gain / (1 - decay)
    hottest = np.zeros(len(table))
    for (before, offset, many, settled), (passage, rise) in zip(starts, parts, strict=True):
        # Repetitions approach one temperature from one side: the first or the last is hottest. The
        # end of a dwell is the start of what follows.
        first = before * base + offset
        last = many * first + settled * (1 - many)
        fade = np.exp(-passage.t / time)
        for start in (first, last):
            path = fade * start[:, None] + rise
            hottest = np.maximum(hottest, path.max(axis=1))
    return hottest


def _rise(passage: DutyMotion, heat: Array, time: Array) -> Array:
    """Return the temperature from zero at the start, under heat (n, m) linear between samples."""
    steps = np.diff(passage.t)
    fade, here, there = _weights(steps / time)
    rise = np.zeros_like(heat)
    rise[:, 1:] = here * heat[:, :-1] + there * heat[:, 1:]
    if np.ptp(steps) <= EVEN * steps.mean():
        from scipy.signal import lfilter  # late: it takes half a second to load

        for value in np.unique(time):
            rows = time[:, 0] == value
            decay = float(np.exp(-steps.mean() / value))
            rise[rows] = lfilter([1.0], [1.0, -decay], rise[rows], axis=1)
        return rise
    # steps of their own each: two maps h -> fade h + gain in a row are one, over 1, 2, 4, .. steps
    reach = 1
    while reach <= len(steps):
        rise[:, 1 + reach :] += fade[:, reach:] * rise[:, 1:-reach]
        fade[:, reach:] = fade[:, reach:] * fade[:, :-reach]
        reach *= 2
    return rise


def _weights(share: Array) -> tuple[Array, Array, Array]:
    """Return exp(-s) and the weights of the heat at both ends of a step of s time constants."""
    fade = np.exp(-share)
    mean = -np.expm1(-share) / share
    # near zero the exact form loses digits; its series does not
    there = np.where(share > 1e-4, 1 - mean, share / 2 - share**2 / 6 + share**3 / 24)
    return fade, 1 - fade - there, there


# ----------------------------------------------------------------------------- shares of all limits

BLOCK = 100_000
"""Blocks of samples of all drives, or samples, worked on at a time: they stay in the cache."""

ROUNDING = 1e-12
"""Relative rounding of a bound."""

LIMITS = (
    "RMS torque", "torque-speed envelope", "top speed", "mean speed", "inertia ratio",
    "winding temperature", "RMS torque of the gear", "peak torque of the gear",
)  # fmt: skip
"""What a drive is measured by, in the order of `Sizing.shares`."""

Order = Literal["mass", "cost", "margin"]


def rms_torque(load: ActuatorLoad, table: DriveTable, ratio: Array | None = None) -> Array:
    """Return the RMS motor torque over the cycle, (n,) [N m]."""
    factors = table.factors(ratio)
    square = np.einsum("pi,ij,pj->p", factors, load.means, factors)
    square += np.where(table.holds, 0.0, load.held_square * factors[:, Signal.REST] ** 2)
    return np.sqrt(np.maximum(square, 0.0))


def envelope_share(
    load: ActuatorLoad, table: DriveTable, ratio: Array | None = None, progress: Progress = go_on
) -> tuple[Array, NDArray[np.intp]]:
    """Return the largest share of the torque-speed envelope that is used, and at which sample.

    For a concave envelope it is the largest of (|tau| + k |speed|)/a over its lines, for another
    |tau| over the torque at that speed; at most 1 either way where the envelope is kept.
    ``progress`` is called after some drives each.

    Returns:
        (n,) share, infinite beyond the top speed of an envelope that is not concave, and (n,)
        index of the sample.

    Raises:
        Canceled: If ``progress`` ends it.
    """
    done = 0
    share, worst = np.zeros(len(table)), np.zeros(len(table), np.intp)
    factors = table.factors(ratio)
    n = table.ratio if ratio is None else ratio
    for concave in (True, False):
        chosen = np.flatnonzero(table.concave == concave)
        look = _largest_of_lines if concave else _largest
        size = len(load.blocks.speed) if concave else load.signals.shape[1]
        step = max(1, BLOCK // size)
        for start in range(0, len(chosen), step):
            rows = chosen[start : start + step]
            share[rows], worst[rows] = look(load, table[rows], factors[rows], n[rows])
            done += len(rows)
            keep_on(progress, done / len(table))
    return share, worst


def _torques(factors: Array, signals: Array) -> Array:
    """Return motor torques, (n, m); not a matrix product, whose threads wait for each other."""
    return np.einsum("ni,im->nm", factors, signals)


def _largest_of_lines(
    load: ActuatorLoad, table: DriveTable, factors: Array, n: Array
) -> tuple[Array, NDArray[np.intp]]:
    """Return the largest share of concave envelopes, looking only where it can be.

    A block of neighboring samples bounds its own share from above by the middles and half ranges
    of its signals; its middle sample bounds the largest share of all from below.
    """
    blocks = load.blocks
    a, k = table.lines
    k, inverse = k[:, :, None] * n[:, None, None], 1.0 / a[:, :, None]

    def share(torque: Array, speed: Array, rows: NDArray[np.intp] | slice = slice(None)) -> Array:
        torque = np.abs(torque)
        if not k.any():
            return torque * inverse[rows, 0]
        found = np.zeros_like(torque)
        for line in range(a.shape[1]):
            more = k[rows, line] * speed
            more += torque
            more *= inverse[rows, line]
            np.maximum(found, more, out=found)
        return found

    below = share(_torques(factors, blocks.sample), blocks.speed_sample).max(axis=1)
    middle, range_ = _torques(factors, blocks.middle), _torques(factors, blocks.half_range)
    above = share(np.abs(middle) + range_, blocks.speed_top)
    # a rising line falls with the speed: its bound is that at the least speed
    if (k < 0).any():
        above = np.maximum(above, share(np.abs(middle) + range_, blocks.speed_least))
    rows, places = np.nonzero(above >= (1 - ROUNDING) * below[:, None])
    torque = sum(
        factors[rows, i, None] * blocks.signals[i, places] for i in range(factors.shape[1])
    )
    exact = share(np.asarray(torque), blocks.speed[places], rows)
    within = exact.argmax(axis=1)
    best = exact[np.arange(len(rows)), within]
    starts = np.searchsorted(rows, np.arange(len(table)))
    largest = np.maximum.reduceat(best, starts)
    first = np.flatnonzero(best == largest[rows])
    _, picked = np.unique(rows[first], return_index=True)
    chosen = first[picked]
    sample = places[chosen] * BLOCK_WIDTH + within[chosen]
    return largest, np.minimum(sample, load.signals.shape[1] - 1)


def _largest(
    load: ActuatorLoad, table: DriveTable, factors: Array, n: Array
) -> tuple[Array, NDArray[np.intp]]:
    """Return the largest share of any envelopes, by looking at all samples."""
    torque = np.abs(_torques(factors, load.signals))
    turning = n[:, None] * np.abs(load.signals[Signal.SPEED])
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.nan_to_num(torque / _limit(table, turning), nan=0.0, posinf=np.inf)
    worst = shares.argmax(axis=1)
    return shares[np.arange(len(table)), worst], worst


def _limit(table: DriveTable, speed: Array) -> Array:
    """Return the torque of envelopes at motor speeds (n, m); 0 beyond their last corner."""
    limit = np.zeros_like(speed)
    slopes = table.slopes
    for place in range(slopes.shape[1]):
        first, last = table.corner_speed[:, place, None], table.corner_speed[:, place + 1, None]
        slope = np.nan_to_num(slopes[:, place, None])
        along = np.where(last > first, speed - np.where(last > first, first, 0.0), 0.0)
        # rounding may leave less than nothing at a corner without torque
        torque = np.maximum(table.corner_torque[:, place, None] + slope * along, 0.0)
        limit = np.where((speed >= first) & (speed <= last) & (last > first), torque, limit)
    return limit


@dataclass(frozen=True, eq=False)
class Sizing:
    """Drives measured on the load of an actuator.

    Attributes:
        load: The load.
        table: The drives.
        rms: RMS torque of the motor over the cycle (n,) [N m].
        envelope: Largest share of the torque-speed envelope (n,).
        inertia_ratio: The robot's inertia over the motor's, at the motor's shaft (n,).
        most_inertia: Largest inertia ratio that is taken.
        shares: Share of each limit that is used, (n, 8), in the order of `LIMITS`; at most 1 is
            kept. The winding's is exact where it is the largest and the RMS torque is kept;
            otherwise it is an upper bound, the mean heat times x/(1 - exp(-x)) with x the period in
            time constants.
    """

    load: ActuatorLoad
    table: DriveTable
    rms: Array
    envelope: Array
    inertia_ratio: Array
    most_inertia: float
    shares: Array

    @property
    def use(self) -> Array:
        """Largest share of any limit, (n,)."""
        return self.shares.max(axis=1)

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Which drives keep all limits, (n,)."""
        return np.asarray(self.use <= 1.0)

    def limit(self, index: int) -> str:
        """Return the limit that a drive uses most, one of `LIMITS`; empty if it uses none."""
        shares = self.shares[index]
        return LIMITS[int(shares.argmax())] if shares.any() else ""

    def ordered(self, order: Order = "mass") -> NDArray[np.intp]:
        """Return the feasible drives in an order, see `ordered`."""
        return ordered(self.table, self.use, order)

    @property
    def nearest(self) -> int:
        """Index of the drive that exceeds its limits least."""
        return int(self.use.argmin())


def ordered(table: DriveTable, use: Array, order: Order = "mass") -> NDArray[np.intp]:
    """Return the feasible drives: the lightest, the cheapest, or that with most margin first.

    Drives without mass or cost come last; equals are in the order of their margin.

    Args:
        table: The drives.
        use: The largest share of a limit that each uses (n,); at most 1 is feasible.
        order: What comes first.

    Raises:
        InvalidInput: If there is no such order.
    """
    if order not in ("mass", "cost", "margin"):
        raise InvalidInput("order", f"mass, cost or margin is needed, not {order!r}")
    rows = np.flatnonzero(use <= 1.0)
    if order == "margin":
        return rows[np.argsort(use[rows], kind="stable")]
    first = getattr(table, order)[rows]
    return rows[np.lexsort((use[rows], np.nan_to_num(first, nan=np.inf)))]


def _shares_of_limits(
    load: ActuatorLoad,
    table: DriveTable,
    rms: Array,
    envelope: Array,
    inertia: Array,
    progress: Progress,
) -> Array:
    """Return `Sizing.shares`; ``inertia`` is the share of that limit."""
    held = np.where(table.holds, 0.0, load.held / table.ratio / table.corner_torque[:, 0])
    shares = np.stack(
        [
            rms / table.rated_torque,
            np.maximum(envelope, held),
            table.ratio * load.top_speed / table.top_speed,
            table.ratio * load.mean_speed / table.rated_speed,
            inertia,
            np.zeros(len(table)),
            load.rms / table.gear_rated,
            load.peak / table.gear_peak,
        ],
        axis=1,
    )
    place = LIMITS.index("winding temperature")
    timed = np.isfinite(table.thermal_time) & np.isfinite(table.rated_torque)
    x = load.period / table.thermal_time[timed]
    shares[timed, place] = shares[timed, 0] ** 2 * x / -np.expm1(-x)
    rows = np.flatnonzero(timed & (shares.argmax(axis=1) == place) & (shares[:, 0] <= 1))
    shares[rows, place] = thermal_share(load, table[rows], progress)
    return shares


ENVELOPES = 0.5
"""Part of the work that envelopes are; temperatures of windings are the rest."""


@kinds_checked
def size_drives(
    load: ActuatorLoad,
    table: DriveTable,
    *,
    inertia_ratio: float = np.inf,
    progress: Progress = go_on,
) -> Sizing:
    """Measure drives on a load.

    Args:
        load: What the actuator has to do.
        table: The drives, with their ratios.
        inertia_ratio: Largest inertia of the robot over that of the motor, at the motor's shaft.
        progress: Called now and then.

    Raises:
        Canceled: If ``progress`` ends it.
        InvalidInput: If there is no drive, or the ratio of inertias is not positive.
    """
    if not len(table):
        raise InvalidInput("table", "at least one drive is needed")
    require_positive(inertia_ratio, "inertia_ratio", finite=False)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = load.inertia / (table.ratio**2 * table.inertia)
    envelope, _ = envelope_share(load, table, progress=of_part(progress, 0.0, ENVELOPES))
    rms = rms_torque(load, table)
    inertia = own / inertia_ratio if np.isfinite(inertia_ratio) else np.zeros(len(table))
    rest = of_part(progress, ENVELOPES, 1.0)
    shares = _shares_of_limits(load, table, rms, envelope, inertia, rest)
    return Sizing(load, table, rms, envelope, own, inertia_ratio, shares)


SLOWEST = 1e3
"""Largest factor on the time that is tried."""

LEFT = 0.9
"""Part of what is left that counts as left once a factor on the time has been tried."""

SMALL_STEP = 2.0**0.125
"""Ratio of two factors on the time where a slower motion may also ask more of a drive."""


def fitting_time(
    cycle: DutyCycle,
    actuator: int,
    table: DriveTable,
    *,
    inertia_ratio: float = np.inf,
    progress: Progress = go_on,
) -> float:
    """Return the least factor on the motions' durations with which some drive is feasible.

    It is found by bisection between 1 and `SLOWEST`; infinite if none is feasible even then:
    gravity alone asks too much. More time is better but for dwells: slower motions fill more of the
    cycle, so that a drive which rests in them may keep its rated torque in a range of factors
    alone. One that is narrower than `SMALL_STEP` may be missed. ``progress`` is called now and
    then; how many factors are tried shows in the end only.

    Raises:
        Canceled: If ``progress`` ends it.
    """
    left = 1.0

    def fits(slower: float) -> bool:
        nonlocal left
        load = cycle.stretched(slower * cycle.slower).loads[actuator]
        part = of_part(progress, 1.0 - left, 1.0 - LEFT * left)
        left *= LEFT
        sizing = size_drives(load, table, inertia_ratio=inertia_ratio, progress=part)
        return bool(sizing.feasible.any())

    if fits(1.0):
        return 1.0
    step = SMALL_STEP if any(duty.dwell > 0 for duty in cycle.duties) else 2.0
    bad, good = 1.0, step
    while not fits(good):
        if good >= SLOWEST:
            return float("inf")
        bad, good = good, min(step * good, SLOWEST)
    while good - bad > 1e-3 * good:
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    return good
