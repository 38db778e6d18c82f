"""What is fitted: the columns of a log's regressor, and the parameters they stand for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from paminsa_viz.checks import require_positive
from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.base_parameters import (
    BASE_PARAMETERS,
    LEG_PARAMETERS,
    base_parameters,
    base_regressor,
    identity_row,
    leg_base_regressor,
)
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.statics import load_torques

LARGE_SHARE = 0.1
"""Half width above which a base parameter is unknown, over its size of `base_scale` (which is not
zero by cancellation, as a balanced robot's M_p2 is)."""

OF_NONE = 0.03
"""Size of a base parameter that the design has none of, as a share of what b_1 carries."""

LARGE_TORQUE = 0.1
"""Half width above which friction or an offset is unknown, as torque over the standard deviation
of the actuator's."""

LARGE_DELAY = 2e-3
"""Half width above which a delay is unknown [s]."""

BLOCK_PERIODS = 2.0
"""Fewest periods of the cut-off in a block of the jackknife: filtered residuals are correlated over
about one, and intervals from blocks as short are a tenth too narrow."""

NOTHING = 1e-10
"""Share of the largest torque, or speed [rad/s, m/s], below which a column is rounding."""


@dataclass(frozen=True)
class IdentificationSettings:
    """How a log is identified.

    Attributes:
        cut_off: Where the filter halves [Hz]; positions as `position_cut_off` says.
        block: Shortest block of the jackknife [s], see `block_length`; longer than the noise
            remembers.
        viscous, coulomb: Fit friction of each actuator.
        offsets: Fit the torque offsets of M1..M3. That of F_4 cannot be told from the weight.
        delay: Fit a delay of the torques after the positions.
        rotors: Fit how the rotors' inertias of M1..M3 differ.
        legs: Fit how the legs' own base parameters differ.
        constrain: Hold the identity of the masses (`identity_row`); right without springs.
        robustness: Fit with two other cut-offs too, and warn where results move.

    Raises:
        InvalidInput: If a time or frequency is not above 0.
    """

    cut_off: float = 10.0
    block: float = 0.5
    viscous: bool = True
    coulomb: bool = True
    offsets: bool = True
    delay: bool = False
    rotors: bool = False
    legs: bool = False
    constrain: bool = False
    robustness: bool = True

    def __post_init__(self) -> None:
        for name in ("cut_off", "block"):
            require_positive(getattr(self, name), name, "a finite number above 0")

    @property
    def block_length(self) -> float:
        """Length of a block of the jackknife [s]: longer than what the filter correlates."""
        return max(self.block, BLOCK_PERIODS / self.cut_off)


class FitParameter(NamedTuple):
    """A number that is fitted or follows from fitted ones.

    Attributes:
        symbol, unit, label: As in `BaseParameter`.
        kind: ``"base"``, ``"viscous"``, ``"coulomb"``, ``"offset"``, ``"rotor"``, ``"leg"`` or
            ``"delay"``.
        design: The design's value.
        most: Half width above which it counts as unknown; see `LARGE_SHARE` and its neighbors.
        motion: What motion would tell it, in words.
    """

    symbol: str
    unit: str
    label: str
    kind: str
    design: float
    most: float
    motion: str


@dataclass(frozen=True, eq=False)
class FitModel:
    """The linear model torque = columns x, with reported numbers p = report x + shift.

    Attributes:
        columns: (m, 4, n) for the n fitted numbers x.
        torque: (m, 4) measured, less what is known: the external load, and differences of rotors.
        known: (m, 4) what was taken off [N m, N].
        parameters: The r reported numbers.
        report: (r, n).
    """

    columns: Array
    torque: Array
    known: Array
    parameters: tuple[FitParameter, ...]
    report: Array


_MOTION = (
    "any motion",
    "positions away from the center and turns of the platform",
    "fast motion to the sides at different heights",
    "fast motion to the sides at different heights",
    "vertical accelerations together with motion to the sides",
    "horizontal accelerations",
    "vertical accelerations",
    "accelerations of M1..M3 near the center and away from it",
    "fast turns of the legs at very different heights",
    "fast turns of the legs at very different heights",
    "fast turns of the platform",
)


@dataclass
class _Builder:
    """Collects columns and the parameters they stand for."""

    columns: list[Array] = field(default_factory=list)
    parameters: list[FitParameter] = field(default_factory=list)

    def add(self, columns: Array, *parameters: FitParameter) -> None:
        self.columns.append(columns)
        self.parameters += parameters


def fit_model(design: Design, signals: Signals, settings: IdentificationSettings) -> FitModel:
    """Return the columns for a log's signals and what they stand for.

    Raises:
        InvalidInput: If the design has next to no masses, which the log's are compared with.
    """
    geometry = design.geometry
    samples = signals.samples
    motion = samples.pose, samples.velocity, samples.acceleration
    x = signals.smooth(base_regressor(geometry, *motion))
    value, scale = base_parameters(design), base_scale(design)
    x = np.where(np.abs(x * scale).max(axis=0) > NOTHING * np.abs(signals.torque).max(), x, 0.0)
    if not x.any():
        raise InvalidInput(
            "design",
            "its masses are next to nothing beside the log's torques: "
            "set those that the robot was meant to have",
        )
    base = tuple(
        FitParameter(*item, "base", float(value[i]), float(LARGE_SHARE * scale[i]), _MOTION[i])
        for i, item in enumerate(BASE_PARAMETERS)
    )
    builder = _Builder()
    builder.add(x, *base)
    spread = signals.torque.std(axis=0)
    friction = design.actuator_friction
    if settings.viscous:
        _add_diagonal(builder, signals.smooth(samples.speed), "viscous", friction.viscous, spread)
    if settings.coulomb:
        _add_diagonal(builder, signals.smooth(samples.sign), "coulomb", friction.coulomb, spread)
    if settings.offsets:
        ones = np.ones_like(signals.torque)
        _add_diagonal(builder, ones, "offset", (0.0, 0.0, 0.0), spread)
    known = np.zeros_like(signals.torque)
    inertia = np.array(design.drive_inertia)
    growth = signals.smooth(samples.growth)
    if settings.rotors:
        _add_rotors(builder, growth, inertia, float(LARGE_SHARE * scale[7]))
    else:
        known[:, :3] += (inertia[:3] - inertia[:3].mean()) * growth[:, :3]
    if design.load.acts:
        known += signals.smooth(load_torques(geometry, design.load, samples.pose, None))
    if settings.delay:
        delay = FitParameter(
            "delay", "s", "delay of the torques", "delay", 0.0, LARGE_DELAY, "faster motion"
        )
        builder.add(-signals.torque_rate[..., None], delay)
    columns = np.concatenate(builder.columns, axis=-1)
    report = np.eye(columns.shape[-1])
    if settings.constrain:
        columns, report = _constrained(columns, report, identity_row(geometry, design.gravity))
    if settings.legs:
        columns, report = _with_legs(
            builder, columns, report, signals.smooth(leg_base_regressor(geometry, *motion)), scale
        )
    return FitModel(columns, signals.torque - known, known, tuple(builder.parameters), report)


def base_scale(design: Design) -> Array:
    """Return a size for each base parameter that is not zero by cancellation, (11,).

    It depends on the masses through the base parameters alone, so that designs which no motion
    tells apart have the same. M_p2 has that of the identity's other side, products of inertia have
    that of the masses they couple, and b_11 at most that of the platform on its joints. Where the
    design has none, as of legs without inertias, the size follows from b_1, which is never zero.
    """
    geometry, b = design.geometry, np.abs(base_parameters(design))
    k = geometry.magnification
    scale = b.copy()
    scale[1] = 2 * design.gravity * max(b[2], (k - 1) / 2 * b[3], k / 2 * b[4])
    scale[3], scale[4] = np.sqrt(b[2] * b[5]), np.sqrt(b[2] * b[6])
    scale[10] = 6 * geometry.platform_radius**2 * b[5]
    mass = b[0] / design.gravity
    of_unit = {"N": b[0], "kg": mass, "kg m^2": mass * geometry.platform_radius**2}
    usual = np.array([OF_NONE * of_unit[item.unit] for item in BASE_PARAMETERS])
    return np.where(scale > 0, scale, usual)


def _add_diagonal(
    builder: _Builder, signal: Array, kind: str, values: tuple[float, ...], spread: Array
) -> None:
    """Add a column for each actuator that has a value: its own signal, nothing for the others."""
    symbols = {"viscous": "b_v", "coulomb": "c_", "offset": "offset "}
    labels = {
        "viscous": ("viscous friction of {}", "speeds of {} of different size"),
        "coulomb": ("Coulomb friction of {}", "speeds of {} in both directions"),
        "offset": ("torque offset of {}", "poses in which gravity loads {} differently"),
    }
    units = {
        "viscous": ("N m s/rad", "N s/m"), "coulomb": ("N m", "N"), "offset": ("N m", "N")
    }  # fmt: skip
    for place, value in enumerate(values):
        name = ACTUATORS[place]
        column = np.zeros((*signal.shape, 1))
        if np.abs(signal[:, place]).max() > NOTHING:
            column[:, place, 0] = signal[:, place]
        size = float(np.sqrt((signal[:, place] ** 2).mean()))
        most = LARGE_TORQUE * float(spread[place]) / size if size > 0 else 0.0
        label, motion = (text.format(name) for text in labels[kind])
        symbol = f"{symbols[kind]}{name if kind == 'offset' else place + 1}"
        unit = units[kind][place == 3]
        builder.add(column, FitParameter(symbol, unit, label, kind, value, most, motion))


def _add_rotors(builder: _Builder, growth: Array, inertia: Array, most: float) -> None:
    """Add the rotors of M1 and M2 against the mean of M1..M3."""
    for place in range(2):
        column = np.zeros((*growth.shape, 1))
        column[:, place, 0], column[:, 2, 0] = growth[:, place], -growth[:, 2]
        builder.add(
            column,
            FitParameter(
                f"ΔJ_{place + 1}", "kg m^2", f"rotor inertia of M{place + 1} less the mean",
                "rotor", float(inertia[place] - inertia[:3].mean()), most,
                "accelerations of M1..M3",
            ),
        )  # fmt: skip


def _constrained(columns: Array, report: Array, row: Array) -> tuple[Array, Array]:
    """Take out b_3, which the identity gives from the others."""
    expand = np.delete(np.eye(report.shape[1]), 2, axis=1)
    expand[2] = np.delete(np.append(row, np.zeros(report.shape[1] - row.size)), 2) / -row[2]
    return columns @ expand, report @ expand


def _with_legs(
    builder: _Builder, columns: Array, report: Array, legs: Array, scale: Array
) -> tuple[Array, Array]:
    """Add contrasts: how the parameters of legs 1 and 2 differ from the mean of all three."""
    contrasts = legs[:, :, :2] - legs[:, :, 2:]  # (m, 4, 2, 8)
    extra = contrasts.reshape(*columns.shape[:2], -1)
    count = contrasts.shape[-1]
    size = report.shape[1]
    rows = np.zeros((3 * count, 2 * count))
    for leg in range(3):
        for place, base in enumerate(LEG_PARAMETERS):
            item = BASE_PARAMETERS[base]
            row = rows[leg * count + place]
            if leg < 2:
                row[leg * count + place] = 1.0
            else:
                row[[place, count + place]] = -1.0
            builder.parameters.append(
                FitParameter(
                    f"Δ{item.symbol}, leg {leg + 1}", item.unit,
                    f"{item.label}, leg {leg + 1} less the mean", "leg", 0.0,
                    float(LARGE_SHARE * scale[base]), _MOTION[base],
                )
            )  # fmt: skip
    whole = np.zeros((report.shape[0] + rows.shape[0], size + rows.shape[1]))
    whole[: report.shape[0], :size] = report
    whole[report.shape[0] :, size:] = rows
    return np.concatenate([columns, extra], axis=-1), whole
