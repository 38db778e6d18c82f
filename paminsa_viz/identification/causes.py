"""What may be wrong with the model: causes tried one by one, named only when they are significant.

Each cause is one more column, its effect on the torques at the estimates. Its size comes from the
fit with that column added, its interval from the same block jackknife, so that correlated residuals
make nothing significant. A cause is named if its p value times the number of causes is below 0.1 %;
the others are then tried again with it in the model. What a cause would have to be to be named says
what the log cannot show.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import kinds_checked
from paminsa_viz.identification.base_parameters import (
    BASE_SYMBOLS,
    LEG_PARAMETERS,
    SELECTION,
    base_regressor,
    identity_row,
    leg_base_regressor,
    mass_columns,
)
from paminsa_viz.identification.columns import base_scale
from paminsa_viz.identification.estimate import NormalBlocks, directions, jackknife, normal_blocks
from paminsa_viz.identification.filtering import Signals, pieces_of
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Design, Geometry
from paminsa_viz.model.jacobians import inverse_jacobian_rate, jacobian
from paminsa_viz.model.kinematics import nearest_solution
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import PANTOGRAPH
from paminsa_viz.model.regressor import torque_regressor
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.units import format_value, percent

LENGTHS = {
    "base_radius": ("R_b", 5e-3),
    "platform_radius": ("R_pl", 5e-3),
    "coupler_length": ("l_B4", 2e-3),
    "crank_length": ("l_B8", 2e-3),
}
"""Lengths that may be wrong, with symbol and plausible error at Appendix 4's lengths [m]."""

SPRING = "upward force at joints 9 (spring)"
"""A weight compensation without inertia, which the identity of the masses shows."""

STEP = 1e-5
"""Step of differences by lengths, at Appendix 4's, and by angles [m, rad]."""


@dataclass(frozen=True, eq=False)
class PossibleCause:
    """A cause and its column.

    Attributes:
        label, unit, leg, plausible: As in `Cause`.
        column: (m, 4) change of the torques for a size of 1.
    """

    label: str
    unit: str
    leg: int
    plausible: float
    column: Array


def possible_causes(identification: Identification) -> list[PossibleCause]:
    """Return all causes that are tried, with their columns; none that is fitted already."""
    signals, design = identification.signals, identification.design
    fitted = {item.symbol: item.value for item in identification.estimates}
    b = np.array([fitted[symbol] for symbol in BASE_SYMBOLS])
    before = _torques(design.geometry, signals, b)
    return [
        *([] if identification.settings.legs else _bars(design, signals)),
        *_zeros(design.geometry, signals, b, before),
        *_actuators(identification),
        *_lengths(design.geometry, signals, b, before),
        *_springs(design, signals),
    ]


def _bars(design: Design, signals: Signals) -> list[PossibleCause]:
    """Bars of one leg that are heavier than those of the others, with their inertias."""
    legs = leg_base_regressor(design.geometry, signals.pose, signals.velocity, signals.acceleration)
    columns = mass_columns(design)[0][list(LEG_PARAMETERS)]
    found = []
    for bar in PANTOGRAPH:
        paths = (f"links.{bar}", f"inertias.{bar}_axial", f"inertias.{bar}_transverse")
        share = sum(columns[:, MASS_PATHS.index(path)] * design.value(path) for path in paths)
        found += [
            PossibleCause(
                f"leg {leg + 1}: {bar.upper()} heavier", "", leg + 1, 0.2, legs[:, :, leg] @ share
            )
            for leg in range(3)
            if design.value(paths[0]) > 0
        ]
    return found


def _zeros(geometry: Geometry, signals: Signals, b: Array, before: Array) -> list[PossibleCause]:
    """Encoders whose zero is off: the actuator is where they show, less that."""
    found, size = [], length_ratio(geometry)
    for place in range(4):
        step = STEP * size if place == 3 else STEP
        column = (_torques(geometry, signals, b, -step * np.eye(4)[place]) - before) / step
        unit, plausible = ("m", 5e-3 * size) if place == 3 else ("rad", np.radians(1.0))
        label = f"encoder zero of M{place + 1}"
        found.append(PossibleCause(label, unit, (place + 1) % 4, float(plausible), column))
    return found


def _lengths(geometry: Geometry, signals: Signals, b: Array, before: Array) -> list[PossibleCause]:
    """Lengths that are larger than the design's."""
    found, size = [], length_ratio(geometry)
    step = STEP * size
    for name, (symbol, plausible) in LENGTHS.items():
        longer = replace(geometry, **{name: getattr(geometry, name) + step})
        column = (_torques(longer, signals, b) - before) / step
        found.append(PossibleCause(f"{symbol} longer", "m", 0, plausible * size, column))
    return found


def _torques(geometry: Geometry, signals: Signals, b: Array, shift: ArrayLike = 0.0) -> Array:
    """Return X b, (m, 4), with actuators moved by a shift, or of other lengths."""
    samples = signals.samples
    pose = nearest_solution(geometry, samples.position + np.asarray(shift), samples.pose)
    j = jacobian(geometry, pose)
    turn = partial(np.einsum, "nij,nj->ni")
    velocity = turn(j, samples.speed)
    drift = turn(inverse_jacobian_rate(geometry, pose, velocity), velocity)
    y = torque_regressor(geometry, pose, velocity, turn(j, samples.growth - drift))
    return signals.smooth(y @ (SELECTION @ b))


def _actuators(identification: Identification) -> list[PossibleCause]:
    """A delay of all torques, and gains of single actuators."""
    signals, predicted = identification.signals, identification.predicted
    found = []
    if not identification.settings.delay:
        rate = np.empty_like(predicted)
        for part in pieces_of(signals.segment):
            rate[part] = np.gradient(predicted[part], signals.step, axis=0)
        found.append(PossibleCause("delay of the torques", "s", 0, 5e-3, -rate))
    for place in range(4):
        column = np.zeros_like(predicted)
        column[:, place] = predicted[:, place]
        found.append(PossibleCause(f"gain of M{place + 1}", "", (place + 1) % 4, 0.05, column))
    return found


def _springs(design: Design, signals: Signals) -> list[PossibleCause]:
    """Springs at the actuators, and a constant force up at the joints 9."""
    found, size = [], length_ratio(design.geometry)
    force = float(base_scale(design)[1])
    usual = force / float(base_scale(APPENDIX_4)[1])
    samples = signals.samples
    travel = signals.smooth(samples.position - samples.position.mean(axis=0))
    for place in range(4):
        column = np.zeros_like(signals.torque)
        column[:, place] = travel[:, place]
        unit, plausible = ("N/m", 100.0 / size) if place == 3 else ("N m/rad", 0.5 * size)
        label = f"spring at M{place + 1}"
        found.append(PossibleCause(label, unit, (place + 1) % 4, usual * plausible, column))
    motion = samples.pose, samples.velocity, samples.acceleration
    column = -signals.smooth(base_regressor(design.geometry, *motion)[..., 1])
    found.append(PossibleCause(SPRING, "N", 0, 0.3 * force, column))
    return found


SIGNIFICANCE = 1e-3
"""Chance of naming a cause in a log of a robot as the model has it."""

MOST_NAMED = 3
"""Most causes that are named one after the other."""

NEARLY = 0.6
"""Share of what a cause explains from which on another one explains nearly as much.

Of a bar that is heavier in mass alone, which no cause is exactly, the leg is found and another bar
may explain more; the right one had 0.68 of it or more wherever one was named.
"""

SPANNED = 1e-8
"""Share of a column's square that the model leaves, below which the cause cannot be seen at all."""

NEVER_SEEN = (
    "a common gain of all actuators (all masses and friction grow by it); a log with a known "
    "payload shows it",
    "an offset of F_4 (it is weight)",
)
"""What no log of a motion shows."""


@dataclass(frozen=True)
class Cause:
    """One way in which the robot may differ from its model.

    Attributes:
        label: What it is, as ``"leg 1: B4 heavier"``.
        unit: SI unit of its size; empty for a share.
        leg: The leg it is about, 1 to 3, or 0.
        value: Its size, if it alone were the reason.
        half_width: Half of the 95 % interval.
        p_value: Chance of a size like this in a log without it, times the number of causes tried.
        explains: Share of the weighted squared residuals that it explains.
        detectable: Size from which on it would be named in such a log.
        plausible: Size that one has to reckon with.
        named: Whether it is named as a reason, and as which: 1 for the first; 0 for not named.
        alike: Labels of others that explain nearly as much (`NEARLY`), the best first; of a cause
            that is named alone.
    """

    label: str
    unit: str
    leg: int
    value: float
    half_width: float
    p_value: float
    explains: float
    detectable: float
    plausible: float
    named: int = 0
    alike: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """What it is, and if others explain nearly as much, that it is only most like it."""
        if not self.alike:
            return self.label
        others = " and ".join(filter(None, [", ".join(self.alike[:-1]), self.alike[-1]]))
        nearly = f"{others} explain{'s' if len(self.alike) == 1 else ''} nearly as much"
        where = f"leg {self.leg}"
        if self.label.startswith(f"{where}: "):
            what = self.label.removeprefix(f"{where}: ")
            return f"{where}; most like {what} ({nearly.replace(f'{where}: ', '')})"
        return f"most like {self.label} ({nearly})"

    @property
    def significant(self) -> bool:
        """Whether the log contradicts a robot without it, or without something like it."""
        return self.p_value < SIGNIFICANCE

    @property
    def visible(self) -> bool:
        """Whether a plausible size of it would be named."""
        return self.detectable <= self.plausible


@dataclass(frozen=True)
class Causes:
    """Everything that was tried.

    Attributes:
        ranked: All causes, the one that explains most first.
        named: Those that are named, each with its size when those before are in the model.
        unseen: What the log cannot show, in words.
    """

    ranked: tuple[Cause, ...]
    named: tuple[Cause, ...]
    unseen: tuple[str, ...]


@kinds_checked
def find_causes(identification: Identification) -> Causes:
    """Return what may be wrong with the model of an identified robot, ranked."""
    candidates = possible_causes(identification)
    model = identification.model
    columns = [model.columns, *(item.column[..., None] for item in candidates)]
    blocks = normal_blocks(columns, model.torque, identification.numbers)
    base = list(range(model.columns.shape[-1]))
    places = {item.label: base[-1] + 1 + i for i, item in enumerate(candidates)}
    found = _tried(identification, blocks, base, places, candidates)
    ranked = sorted(found, key=lambda cause: -cause.explains)
    named: list[Cause] = []
    current = ranked
    # Beside a wrong unit or sign, causes only explain what that makes of the fit.
    most = 0 if identification.problem else MOST_NAMED
    while len(named) < most and (significant := [c for c in current if c.significant]):
        best = significant[0]
        near = [c for c in current if c is not best and c.explains >= NEARLY * best.explains]
        alike = tuple(cause.label for cause in near)
        first = replace(best, named=len(named) + 1, alike=alike)
        named.append(first)
        base.append(places.pop(first.label))
        left = [item for item in candidates if item.label in places]
        current = _tried(identification, blocks, base, places, left)
        current.sort(key=lambda cause: -cause.explains)
    order = {cause.label: cause.named for cause in named}
    unseen = [
        f"{cause.label}: below {_size(cause)}"
        for cause in sorted(found, key=lambda cause: cause.label)
        if not cause.visible and cause.label not in order
    ]
    return Causes(
        tuple(replace(cause, named=order.get(cause.label, 0)) for cause in ranked),
        tuple(named),
        (*NEVER_SEEN, *unseen),
    )


def _size(cause: Cause) -> str:
    if not np.isfinite(cause.detectable):
        return "any size"
    if not cause.unit:
        return percent(cause.detectable, digits=2)
    return format_value(cause.detectable, cause.unit, 2)


def _tried(
    identification: Identification,
    blocks: NormalBlocks,
    base: list[int],
    places: dict[str, int],
    candidates: list[PossibleCause],
) -> list[Cause]:
    """Fit each cause by itself on top of the columns in ``base``."""
    from scipy.stats import t as student  # takes a while to load

    tries = len(places)  # p values are multiplied by it (Bonferroni)
    solution = identification.solution
    weight = 1 / solution.noise**2
    matrix, right = blocks.weighted(weight)
    square = float((weight * blocks.square.sum(axis=0)).sum())
    # the whole log first, then without each block
    whole = np.concatenate([[matrix.sum(axis=0)], matrix.sum(axis=0) - matrix])
    force = np.concatenate([[right.sum(axis=0)], right.sum(axis=0) - right])
    tried = [places[item.label] for item in candidates]
    span, _ = directions(whole[0][np.ix_(base, base)])
    inner = span.T @ whole[:, base][:, :, base] @ span
    cross = span.T @ whole[:, base][:, :, tried]  # (B + 1, q, K)
    solved = np.linalg.solve(
        inner, np.concatenate([cross, (force[:, base] @ span)[..., None]], axis=-1)
    )
    own = np.einsum("bkk->bk", whole[:, tried][:, :, tried])
    left = own - np.einsum("bqk,bqk->bk", cross, solved[..., :-1])
    score = force[:, tried] - np.einsum("bqk,bq->bk", cross, solved[..., -1])
    visible = left[0] > SPANNED * own[0]
    size = np.divide(score, left, out=np.zeros_like(score), where=visible)
    count, error = len(size) - 1, jackknife(size[1:])
    residual = square - float(force[0, base] @ span @ solved[0, :, -1])
    residual = max(residual, 1e-12 * square)  # a log without noise
    explains = np.where(visible, size[0] * score[0], 0.0) / residual
    spring = places.get(SPRING)
    if spring is not None and not identification.settings.constrain:
        # M_p2 is free, so that a spring shows in the identity of the masses alone.
        i, row = tried.index(spring), np.zeros(len(base))
        design = identification.design
        row[:11] = -identity_row(design.geometry, design.gravity)
        row = row @ span
        size[:, i] = solved[..., -1] @ row
        error[i] = jackknife(size[1:, i : i + 1])[0]
        visible[i] = np.isfinite(identification.identity.z)
        explains[i] = size[0, i] ** 2 / float(row @ np.linalg.solve(inner[0], row)) / residual
    critical = float(student.isf(0.5 * SIGNIFICANCE / tries, count - 1))
    found = []
    for i, item in enumerate(candidates):
        seen = bool(visible[i]) and error[i] > 0
        ratio = abs(size[0, i]) / error[i] if seen else 0.0
        p_value = min(1.0, 2 * float(student.sf(ratio, count - 1)) * tries)
        found.append(
            Cause(
                item.label, item.unit, item.leg, float(size[0, i]) if seen else 0.0,
                solution.quantile * float(error[i]) if seen else np.inf,
                p_value, float(explains[i]), critical * float(error[i]) if seen else np.inf,
                item.plausible,
            )
        )  # fmt: skip
    return found
