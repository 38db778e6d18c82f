"""The search for an excitation: random motions, improved within a budget.

Random motions, each as large as the limits allow, are improved by sequential quadratic
programming, the best first; its steps are bounded, and bounds are tightened where steps leave the
workspace. What is left of the budget goes to motions near the best one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.identification.information import LIMITED, Evaluation, Information
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.backend import WorkClock
from paminsa_viz.progress import Canceled, Progress, keep_on
from paminsa_viz.units import rounded_to_side

LEAST_SAMPLES = 250
"""Fewest samples of a period at which limits are looked at."""

RANDOM_STARTS = 300
"""Most random motions that the search starts with."""

RANDOM_SHARE = 0.25
"""Share of the time after which no more of them are drawn, so that some is left to improve them."""

GROUP = 4
"""Motions that are improved at the same time."""

HOPS = 3
"""How many of a later group lie near the best motion."""

HOP = 0.05
"""How near: standard deviation of the variables."""

HOP_SIZE = 0.85
"""Their size over that of the best motion, which is at the limits."""

STAGES = ((20.0, 80, 2), (60.0, 80, 1), (300.0, 80, 1))
"""How sharply the limits are taken, most iterations, and how many of a group go on."""

TOLERANCE = 2e-3
"""Share by which limits may be exceeded on the way; the motion is shrunk by it at the end."""

ROUNDING = 1e-9
"""Share of a limit that a motion stays below it, so that other sums of it agree."""

MOST_OUTSIDE = 8
"""Most steps out of the workspace in a row: a line search shortens its steps as often."""

BEYOND = 1e3
"""How much worse than inside a motion counts that leaves the workspace."""

REACH = 3.0
"""Largest change of a variable in a stage, over its scale."""

LEAST_REACH = 0.02

LEAST_GAIN = 1e-4
"""Change of log det by which a stage ends."""

EVALUATIONS_A_REPORT = 4
"""Evaluations between two reports of how far the search is: a third of a second or so."""

CHUNK = 32
"""Motions looked at in one batch."""


@dataclass(frozen=True)
class ExcitationSettings:
    """What is searched, and for how long.

    Attributes:
        period: Of the motion [s].
        harmonics: Number of harmonics of each coordinate.
        periods: How often the motion is run.
        samples: Samples of a period at which information and limits are looked at.
        evaluations: Most evaluations of a motion with derivatives, of some 15 ms each; the search
            is reproducible where they end it and all random motions are drawn.
        seconds: Most time, without that of compiling [s]; random motions are drawn in
            `RANDOM_SHARE` of it.
        random: Most random motions that it starts with.
        seed: Of the random motions.

    Raises:
        InvalidInput: If a number is not possible.
    """

    period: float = 10.0
    harmonics: int = 5
    periods: int = 2
    samples: int = 256
    evaluations: int = 3000
    seconds: float = 60.0
    random: int = RANDOM_STARTS
    seed: int = 0

    def __post_init__(self) -> None:
        ranges = {
            "period": (0.5, 1000.0), "periods": (1, 1000), "samples": (LEAST_SAMPLES, 10_000),
            "evaluations": (0, 1_000_000), "seconds": (0.0, 1e5),
            "random": (1, 10_000), "seed": (0, 2**31 - 1),
        }  # fmt: skip
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not (np.isfinite(value) and low <= value <= high):
                raise InvalidInput(name, f"{low:g} to {high:g} is possible, not {value!r}")


class NoExcitation(PaminsaError):
    """No motion about the home pose keeps the limits."""


def random_motions(
    info: Information, count: int, seed: int, more: Callable[[], bool] = lambda: True
) -> Array:
    """Return random motions within the limits, each as large as they allow, (count, size).

    Args:
        info: What the limits are known from.
        count: How many are drawn; those that no size makes possible are left out.
        seed: Of the random numbers.
        more: Called after some `CHUNK` of them; says whether there is time for more.

    Raises:
        NoExcitation: If there is none among the first `CHUNK` or so.
    """
    rng = np.random.default_rng(seed)
    drawn = rng.standard_normal((count, info.family.size))
    drawn[:, :4] *= 0.3
    found: list[Array] = []
    for part in _chunks(drawn):
        low, high = np.zeros(len(part)), np.full(len(part), 4.0)
        for _ in range(12):
            middle = 0.5 * (low + high)
            good = info.worst_room(part * middle[:, None]) > 0.0
            low, high = np.where(good, middle, low), np.where(good, high, middle)
        possible = low > 0.0
        if possible.any():
            found.append(part[possible] * low[possible, None])
        elif not found:  # home has no room, or next to none, and so have all motions about it
            raise _refusal(info, part * high[:, None])
        if not more():
            break
    return np.concatenate(found)


def _refusal(info: Information, smallest: Array) -> NoExcitation:
    """Return which limit stands in the way of motions (n, size) that are as small as is tried."""
    with_rest = np.concatenate([np.zeros((1, info.family.size)), smallest])
    rooms = np.nan_to_num(info.at(info.states(with_rest)).room.min(axis=1), nan=-np.inf)
    worst = rooms.min(axis=1)
    motion = 0 if worst[0] < 0.0 else 1 + int(np.argmax(worst[1:]))
    place = int(np.argmin(rooms[motion]))
    when = "even in the smallest motions that were tried" if motion else "at rest there"
    # what is left of reach and height is a share of a length, of all others one of the limit
    times = 1.0 - rooms[motion, place] if place < len(LIMITED) - 2 else np.inf
    needed = rounded_to_side(float(times), 3, up=True)
    by = f", {needed:.3g} times as large" if np.isfinite(times) else ""
    remedy = "; raise it, or give the design a drive that has more" if place < 8 else ""
    name = LIMITED[min(place, len(LIMITED) - 1)]  # reach is the last one, of each leg
    return NoExcitation(
        f"no motion about home keeps the limits: the {name} is beyond its limit {when}{by}{remedy}"
    )


def _chunks(variables: Array) -> list[Array]:
    return np.array_split(variables, max(1, len(variables) // CHUNK))


def in_chunks(function: Callable[[Array], Array], variables: Array) -> Array:
    return np.concatenate([function(part) for part in _chunks(variables)])


def shrunk(info: Information, variables: Array) -> Array:
    """Return a motion, made smaller until it keeps the limits at all samples."""
    low, high = 0.0, 1.0
    if info.worst_room(variables) >= ROUNDING:
        return variables
    for _ in range(20):
        middle = 0.5 * (low + high)
        if info.worst_room(middle * variables) >= ROUNDING:
            low = middle
        else:
            high = middle
    return low * variables


class _Outside(Exception):
    """A step out of the workspace, where nothing has a derivative."""


class Search:
    """The improvement of motions within a budget."""

    def __init__(
        self, info: Information, settings: ExcitationSettings, clock: WorkClock, progress: Progress
    ) -> None:
        self._info, self._settings, self._clock, self._progress = info, settings, clock, progress
        self.evaluations, self.over = 0, settings.evaluations == 0
        self.best: Array = np.zeros(info.family.size)
        self.best_value = -np.inf
        self._kept: tuple[float, Array] = (-np.inf, self.best)
        self._last: tuple[bytes, Evaluation] | None = None
        self._outside, self._value = 0, 0.0
        self._inside = self.best  # where a stage has been last in the workspace

    def run(self, starts: Array) -> None:
        """Improve the first motions a little, the best of them more, until the budget is spent.

        What is left of it goes to further starts and to motions near the best one.
        """
        rng = np.random.default_rng(self._settings.seed)
        waiting = list(starts)
        group, waiting = waiting[:GROUP], waiting[GROUP:]
        try:
            while not self.over:
                for sharpness, iterations, kept in STAGES:
                    found = [self._improve(start, sharpness, iterations) for start in group]
                    group = [x for _, x in sorted(found, key=lambda one: -one[0])[:kept]]
                near = HOP_SIZE * self.best + HOP * rng.standard_normal((HOPS, self.best.size))
                group, waiting = [*near, *waiting[: GROUP - HOPS]], waiting[GROUP - HOPS :]
        except Canceled:
            self.over = True

    def _improve(self, start: Array, sharpness: float, iterations: int) -> tuple[float, Array]:
        """Return the best motion of a stage that starts at one, and its worth."""
        self._kept, reach = (-np.inf, start), REACH
        self._inside = start
        try:
            while reach > LEAST_REACH:
                try:
                    self._stage(self._kept[1], sharpness, iterations, reach)
                    break
                except _Outside:
                    reach *= 0.25
        finally:
            # A stage may end, or be ended, a little beyond the limits, and be far better there.
            made = shrunk(self._info, self._inside)
            self._keep(float(self._info.log_det(made)), made)
        return self._kept

    def _keep(self, value: float, variables: Array) -> None:
        """Keep a motion within the limits if it is better than what is kept of its stage."""
        if value > self._kept[0]:
            self._kept = value, variables
            if value > self.best_value:
                self.best_value, self.best = self._kept

    def _stage(self, start: Array, sharpness: float, iterations: int, reach: float) -> None:
        from scipy.optimize import minimize  # takes a while to load

        self._last, self._outside, self._value = None, 0, 0.0
        minimize(
            lambda x: self._evaluated(x, sharpness)[:2], start, jac=True, method="SLSQP",
            bounds=np.stack([start - reach, start + reach], axis=1),
            constraints=[{
                "type": "ineq",
                "fun": lambda x: self._evaluated(x, sharpness)[2],
                "jac": lambda x: self._evaluated(x, sharpness)[3],
            }],
            options={"maxiter": iterations, "ftol": LEAST_GAIN},
        )  # fmt: skip

    def _evaluated(self, x: Array, sharpness: float) -> tuple[Any, Array, Array, Array]:
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self._spend()
            self._last = key, self._info.evaluate(x, sharpness)
        found = self._last[1]
        if not np.isfinite(found.value):
            self._outside += 1
            if self._outside > MOST_OUTSIDE:
                raise _Outside
            return self._value + BEYOND, np.zeros_like(x), found.room, found.room_slope
        self._outside, self._value, self._inside = 0, -found.value, x.copy()
        if found.worst >= -TOLERANCE:
            self._keep(found.value, self._inside)
        return -found.value, -found.slope, found.room, found.room_slope

    def _spend(self) -> None:
        """Count an evaluation.

        Raises:
            Canceled: If none is left, the time is up, or the search is canceled.
        """
        settings = self._settings
        spent = self._clock.elapsed / max(settings.seconds, 1e-9)
        done = max(spent, self.evaluations / settings.evaluations)
        if self.evaluations % EVALUATIONS_A_REPORT == 0:
            keep_on(self._progress, min(done, 1.0))
        if done >= 1.0:
            raise Canceled
        self.evaluations += 1
