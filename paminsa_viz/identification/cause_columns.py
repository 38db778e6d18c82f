"""What a cause would do to the torques: one column each, at the estimates of a log."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.identification.base_parameters import (
    BASE_SYMBOLS,
    LEG_PARAMETERS,
    SELECTION,
    base_regressor,
    leg_base_regressor,
    mass_columns,
)
from paminsa_viz.identification.columns import base_scale
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.jacobians import inverse_jacobian_rate, jacobian
from paminsa_viz.model.kinematics import nearest_solution
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.regressor import torque_regressor

BARS = ("b3", "b4", "b7", "b8")

LENGTHS = {
    "base_radius": ("R_b", 5e-3),
    "platform_radius": ("R_pl", 5e-3),
    "coupler_length": ("l_B4", 2e-3),
    "crank_length": ("l_B8", 2e-3),
}
"""Lengths that may be wrong, with symbol and plausible error [m]."""

SPRING = "upward force at joints 9 (spring)"
"""A weight compensation without inertia, which the identity of the masses shows."""

STEP = 1e-5
"""Step of differences by lengths and angles [m, rad]."""


@dataclass(frozen=True, eq=False)
class PossibleCause:
    """A cause and its column.

    Attributes:
        label, unit, leg, plausible: As in `causes.Cause`.
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
    return [
        *([] if identification.settings.legs else _bars(design, signals)),
        *_zeros(design.geometry, signals, b),
        *_actuators(identification),
        *_lengths(design.geometry, signals, b),
        *_springs(design, signals),
    ]


def _bars(design: Design, signals: Signals) -> list[PossibleCause]:
    """Bars of one leg that are heavier than those of the others, with their inertias."""
    legs = leg_base_regressor(design.geometry, signals.pose, signals.velocity, signals.acceleration)
    columns = mass_columns(design)[0][list(LEG_PARAMETERS)]
    found = []
    for bar in BARS:
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


def _zeros(geometry: Geometry, signals: Signals, b: Array) -> list[PossibleCause]:
    """Encoders whose zero is off: the actuator is where they show, less that."""
    found, before = [], _torques(geometry, signals, b)
    for place in range(4):
        column = (_torques(geometry, signals, b, -STEP * np.eye(4)[place]) - before) / STEP
        unit, plausible = ("m", 5e-3) if place == 3 else ("rad", np.radians(1.0))
        label = f"encoder zero of M{place + 1}"
        found.append(PossibleCause(label, unit, (place + 1) % 4, float(plausible), column))
    return found


def _lengths(geometry: Geometry, signals: Signals, b: Array) -> list[PossibleCause]:
    """Lengths that are larger than the design's."""
    found, before = [], _torques(geometry, signals, b)
    for name, (symbol, plausible) in LENGTHS.items():
        longer = replace(geometry, **{name: getattr(geometry, name) + STEP})
        column = (_torques(longer, signals, b) - before) / STEP
        found.append(PossibleCause(f"{symbol} longer", "m", 0, plausible, column))
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
        for number in np.unique(signals.segment):
            part = signals.segment == number
            rate[part] = np.gradient(predicted[part], signals.step, axis=0)
        found.append(PossibleCause("delay of the torques", "s", 0, 5e-3, -rate))
    for place in range(4):
        column = np.zeros_like(predicted)
        column[:, place] = predicted[:, place]
        found.append(PossibleCause(f"gain of M{place + 1}", "", (place + 1) % 4, 0.05, column))
    return found


def _springs(design: Design, signals: Signals) -> list[PossibleCause]:
    """Springs at the actuators, and a constant force up at the joints 9."""
    found = []
    samples = signals.samples
    travel = signals.smooth(samples.position - samples.position.mean(axis=0))
    for place in range(4):
        column = np.zeros_like(signals.torque)
        column[:, place] = travel[:, place]
        unit, plausible = ("N/m", 100.0) if place == 3 else ("N m/rad", 0.5)
        label = f"spring at M{place + 1}"
        found.append(PossibleCause(label, unit, (place + 1) % 4, plausible, column))
    motion = samples.pose, samples.velocity, samples.acceleration
    column = -signals.smooth(base_regressor(design.geometry, *motion)[..., 1])
    found.append(PossibleCause(SPRING, "N", 0, 0.3 * float(base_scale(design)[1]), column))
    return found
