"""What comes out of an identification: estimates, the identity of the masses, and the fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.columns import FitModel, FitParameter, IdentificationSettings
from paminsa_viz.identification.estimate import FitSolution, NormalBlocks
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.identification.log import Log
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS

IDENTITY_Z = 3.0
"""Size of the identity's z from which on the masses alone do not explain the log."""


NEGATIVE_WEIGHT = "the weight is negative: the sign of force4, or of its gain, is wrong"

OPPOSITE_TORQUES = (
    "the torques of M1 to M3 are opposite to those that go with force4: check their signs, or "
    "those of the gains"
)

WRONG_UNIT = 30.0
"""Factor between base parameters and the design's above which a unit or gain is suspected.

Units of torque that are taken for N m lie further off, as mN m, kN m, N mm and N cm do; a robot as
much heavier or lighter than its design is another one.
"""


@dataclass(frozen=True)
class Estimate:
    """One number of the robot with its 95 % interval.

    Attributes:
        parameter: What it is, with the design's value.
        value: The estimate.
        half_width: Half of the 95 % interval; infinite if the motion does not excite it.
        known: Whether the log says it: its half width is below `FitParameter.most`.
    """

    parameter: FitParameter
    value: float
    half_width: float
    known: bool

    @property
    def symbol(self) -> str:
        """Symbol of the number."""
        return self.parameter.symbol

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.value - self.half_width

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.value + self.half_width

    def reason(self) -> str:
        """Return why it is unknown and what motion would tell it, or an empty string."""
        if self.known:
            return ""
        motion = f"{self.parameter.motion} would tell it"
        if not np.isfinite(self.half_width):
            return f"the motion does not excite it; {motion}"
        return f"the interval is wider than ± {self.parameter.most:.3g}; {motion}"


def problem_of(estimates: Sequence[Estimate]) -> str:
    """Return why no robot has these numbers, however well they fit; empty if one may.

    Args:
        estimates: The base parameters first, with M_p2 as the first of all.
    """
    if estimates[0].high < 0:
        return NEGATIVE_WEIGHT
    base = [item for item in estimates if item.parameter.kind == "base"]
    most = np.array([item.parameter.most for item in base])
    design = np.array([item.parameter.design for item in base]) / most
    value = np.array([item.value for item in base]) / most
    width = np.array([item.half_width for item in base]) / most
    # least squares through the origin; what a motion does not excite has no weight in it
    lever = design / (1.0 + np.where(np.isfinite(width), width, np.inf)) ** 2
    total = float(lever @ design)
    if total <= 0:
        return ""
    gain = float(lever @ value) / total
    error = float(np.abs(lever) @ np.where(lever == 0, 0.0, width)) / total
    if gain + error >= 1 / WRONG_UNIT and gain - error <= WRONG_UNIT:
        return ""
    factor = float(f"{gain:.1g}")
    return (
        f"the masses come out at about {factor:g} times those of the design: check the units of "
        "the torques [N·m] and of force4 [N], or the gains"
    )


ALIKE = 0.5
"""Least part of the torques that the design's explain, so many times, where a unit is suspected."""


def units_problem(model: FitModel) -> str:
    """Return why torques of M1 to M3 and the force of M4 are of no one robot; empty if they may be.

    Of either it is fitted how many times they are the design's, beside friction and offsets, and
    beside M_p2, in which a balanced robot differs most from one that is not.
    """
    base = np.array([item.kind == "base" for item in model.parameters])
    wanted = np.array([item.design for item in model.parameters])[base]
    x = np.linalg.lstsq(model.report[base], wanted, rcond=None)[0]
    free = ~model.report[base].any(axis=0) | (model.report[1] != 0)
    gains = []
    for part in (slice(0, 3), slice(3, 4)):
        both = np.stack([model.columns[:, part] @ x, model.torque[:, part]], axis=2).reshape(-1, 2)
        columns = model.columns[:, part, free].reshape(len(both), -1)
        both = both - columns @ np.linalg.lstsq(columns, both, rcond=None)[0]
        (own, common), (_, whole) = both.T @ both
        if common**2 <= ALIKE * own * whole:
            return ""
        gains.append(float(common / own))
    factor = gains[0] / gains[1]
    if gains[0] < 0 < gains[1]:
        return OPPOSITE_TORQUES
    if factor < 0 or 1 / WRONG_UNIT <= factor <= WRONG_UNIT:
        return ""
    return (
        f"the torques of M1 to M3 are about {float(f'{factor:.1g}'):g} times those that go with "
        "force4: check the units of the torques [N·m] and of force4 [N], or the gains"
    )


SWAPPED = 0.1
"""Share of the squared residuals of M1 to M3 below which another order of their torques is right.

With the example log, the right one leaves a thousandth of what a wrong one does.
"""


def order_problem(model: FitModel) -> str:
    """Return that torques of M1 to M3 are in each other's columns; empty if they are not.

    Such a log tells next to nothing, so that no single cause would become significant.
    """
    columns = model.columns[:, :3].reshape(-1, model.columns.shape[-1])
    orders = list(permutations(range(3)))
    torques = np.stack([model.torque[:, order].ravel() for order in orders], axis=1)
    left = torques - columns @ np.linalg.lstsq(columns, torques, rcond=None)[0]
    squares = (left**2).sum(axis=0)
    best = int(squares.argmin())
    if squares[best] >= SWAPPED * squares[0]:
        return ""
    found = ", ".join(ACTUATORS[place] for place in orders[best])
    return f"the torques of M1, M2, M3 seem to stand in the columns of {found}: check their order"


@dataclass(frozen=True)
class Identity:
    """What is left of the identity of the masses, M_p2 - 2 g (b_3 - (k-1)/2 b_4 + k/2 b_5) = 0.

    Attributes:
        value: What is left [N]; a constant upward force at every joint 9 makes it negative. NaN if
            one of its base parameters is unknown, or it was held.
        half_width: Half of its 95 % interval [N]; infinite there.
        z: Value over standard error; NaN there.
    """

    value: float
    half_width: float
    z: float

    @property
    def holds(self) -> bool | None:
        """Whether masses alone explain the log; None if the log does not say."""
        return None if np.isnan(self.z) else abs(self.z) < IDENTITY_Z


@dataclass(frozen=True, eq=False)
class Identification:
    """What a log says about a robot.

    Attributes:
        design: The design it was compared with: its geometry, load and drives.
        log: The log.
        settings: How it was done.
        start: Pose that chose the assembly, or None for the home pose.
        estimates: Base parameters, friction, offsets and what else was asked for.
        identity: The check of the masses' identity.
        signals: The filtered signals.
        predicted: (m, 4) torques that the estimates give at ``signals.t`` [N m, N].
        noise: (4,) standard deviation of the filtered residuals [N m, N].
        notes: What was done to the log, and warnings, in words.
        model, solution, blocks: The fit itself.
        numbers: (m,) block of each sample.
        lag: By what the torques were shifted before the fit [s]; 0 unless a delay is fitted.
        problem: Why no robot has these numbers, however well they fit; empty if one may.
    """

    design: Design
    log: Log
    settings: IdentificationSettings
    start: tuple[float, ...] | None
    estimates: tuple[Estimate, ...]
    identity: Identity
    signals: Signals = field(repr=False)
    predicted: Array
    noise: Array
    notes: tuple[str, ...]
    model: FitModel = field(repr=False)
    solution: FitSolution = field(repr=False)
    blocks: NormalBlocks = field(repr=False)
    numbers: NDArray[np.int64] = field(repr=False)
    lag: float
    problem: str

    @property
    def measured(self) -> Array:
        """Filtered measured torques at ``signals.t``, (m, 4) [N m, N]."""
        return self.signals.torque

    @property
    def residual(self) -> Array:
        """Measured less predicted torques, (m, 4) [N m, N]."""
        return self.signals.torque - self.predicted

    @property
    def unknown(self) -> tuple[Estimate, ...]:
        """The estimates that the log does not tell."""
        return tuple(item for item in self.estimates if not item.known)

    @property
    def advice(self) -> str:
        """One line on what stays unknown and what motion would tell it; empty if nothing does."""
        motions: dict[str, list[str]] = {}
        for item in self.unknown:
            motions.setdefault(item.parameter.motion, []).append(item.symbol)
        parts = [f"{', '.join(symbols)} ({motion})" for motion, symbols in motions.items()]
        return f"unknown, with what would tell it: {'; '.join(parts)}" if parts else ""

    def estimate(self, symbol: str) -> Estimate:
        """Return the estimate with a symbol, for example ``"M_p2"``.

        Raises:
            InvalidInput: If there is none.
        """
        for item in self.estimates:
            if item.symbol == symbol:
                return item
        known = ", ".join(item.symbol for item in self.estimates)
        raise InvalidInput("symbol", f"there is no {symbol!r}; there are {known}")
