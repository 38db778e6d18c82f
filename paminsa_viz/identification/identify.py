"""From a log to parameters with intervals, and to the word "unknown" where it does not say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.base_parameters import BASE_SYMBOLS, identity_row
from paminsa_viz.identification.columns import (
    FitModel,
    IdentificationSettings,
    fit_model,
)
from paminsa_viz.identification.estimate import (
    RESOLUTION,
    FitSolution,
    NormalBlocks,
    block_numbers,
    block_residuals,
    normal_blocks,
    solve,
)
from paminsa_viz.identification.filtering import (
    Signals,
    filter_log,
    pieces_of,
    position_cut_off,
    thinning_for,
)
from paminsa_viz.identification.log import InvalidLog, Log
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.results import (
    Estimate,
    Identification,
    Identity,
    order_problem,
    problem_of,
    units_problem,
)
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.units import counted

OTHER_CUT_OFFS = (1 / 1.5, 1.5)
"""Cut-offs that results are tried with, over the cut-off."""

MOST_MOVE = 2.0
"""How far a result may move with the cut-off before there is a warning, in standard errors."""

LEAST_MOVE = 0.05
"""Moves below this share of `FitParameter.most` are none, however narrow the interval is."""

DELAY_STEPS = 2
"""How often the torques are shifted by the delay that is found."""

MOST_LEFT = 10.0
"""What is left in a block over what is left in the others from which on a note names it."""

LEAST_LEFT = 0.01
"""Less than this share of the torque's standard deviation is no outlier, of a log without noise."""

FEW_SECONDS = 20.0
"""Shorter logs than this get a note [s]."""


def filtered(
    log: Log,
    design: Design,
    settings: IdentificationSettings,
    solved: tuple[Array, list[slice]],
    factor: float = 1.0,
) -> Signals:
    """Filter a log, its `log_poses` solved, at the cut-off times a factor; thinned as without."""
    return filter_log(
        log, design.geometry, *solved,
        cut_off=settings.cut_off * factor,
        transition_speed=design.friction.transition_speed,
        thinning=thinning_for(log.rate, settings.cut_off),
    )  # fmt: skip


@of_design
def identify(
    design: Design,
    log: Log,
    settings: IdentificationSettings | None = None,
    *,
    start: ArrayLike | None = None,
) -> Identification:
    """Return what a log says about a robot whose lengths are the design's.

    The masses of the design enter nothing but what is compared with them: the base parameters,
    friction and offsets are fitted from the log alone.

    Args:
        design: The robot as it was meant; its load and its drives' differences are taken as known.
        log: The log of `make_log` or `files.logs.read_log`.
        settings: What is fitted, and how; the defaults of `IdentificationSettings` without.
        start: Pose (4,) near the log's start, to choose the assembly; the home pose by default.

    Raises:
        InvalidLog: At the first row that cannot be used, or if the log is too short, the robot
            does not move, or a torque never changes.
        InvalidInput: If the cut-off or the block does not suit the sampling rate, or there is no
            gravity.
    """
    settings = IdentificationSettings() if settings is None else settings
    if not design.gravity > 0:
        raise InvalidInput("design", "identification needs gravity above 0: it weighs the robot")
    solved = log_poses(design.geometry, log, start)
    signals = filtered(log, design, settings, solved)
    require_motion(signals, log.name)
    model, blocks, solution, numbers, lag = _fit(design, signals, settings, log.name)
    quantile, error = solution.quantile, solution.deviation(model.report)
    values = model.report @ solution.x
    delays = [item.kind == "delay" for item in model.parameters]
    values[delays] += lag
    excited = solution.known(model.report)
    half = np.where(excited, quantile * error, np.inf)
    estimates = tuple(
        Estimate(item, float(value), float(width), bool(width <= item.most))
        for item, value, width in zip(model.parameters, values, half, strict=True)
    )
    notes = list(log.notes)
    fast = position_cut_off(log.rate, settings.cut_off)
    apart = "" if fast == settings.cut_off else f", positions at {fast:g} Hz"
    notes.append(
        f"Filtered forward and backward (Butterworth, half at {settings.cut_off:g} Hz{apart}), "
        f"{counted(len(signals.t), 'sample')} at {1 / signals.step:g} Hz, "
        f"{counted(solution.blocks, 'block')} of {settings.block_length:g} s"
    )
    if log.duration < 0.99 * FEW_SECONDS:
        notes.append(f"the log is {log.duration:.3g} s long; {FEW_SECONDS:g} s or more are advised")
    notes += _outliers(signals, blocks, solution, numbers)
    problem = units_problem(model) or order_problem(model) or problem_of(estimates)
    if problem:
        notes.append(problem)
    if settings.robustness:
        notes += _moves(log, solved, design, settings, estimates, values, error)
    return Identification(
        design, log, settings,
        None if start is None else tuple(np.asarray(start, np.float64).tolist()),
        estimates, _identity(design, model, solution, settings, estimates),
        signals, model.columns @ solution.x + model.known, solution.noise, tuple(notes),
        model, solution, blocks, numbers, lag, problem,
    )  # fmt: skip


def _fit(
    design: Design, signals: Signals, settings: IdentificationSettings, log: str = ""
) -> tuple[FitModel, NormalBlocks, FitSolution, NDArray[np.int64], float]:
    """Fit; with a delay, shift the torques by it and fit what is left of it (Gauss-Newton)."""
    numbers = block_numbers(signals.t, signals.segment, settings.block_length, log)
    model, blocks, solution = _fitted(design, signals, settings, numbers)
    lag = 0.0
    for _ in range(DELAY_STEPS if settings.delay else 0):
        place = [item.kind == "delay" for item in model.parameters].index(True)
        lag += float(model.report[place] @ solution.x)
        model, blocks, solution = _fitted(design, shifted(signals, lag), settings, numbers)
    return model, blocks, solution, numbers, lag


def _fitted(
    design: Design, signals: Signals, settings: IdentificationSettings, numbers: NDArray[np.int64]
) -> tuple[FitModel, NormalBlocks, FitSolution]:
    model = fit_model(design, signals, settings)
    blocks = normal_blocks(model.columns, model.torque, numbers)
    return model, blocks, solve(blocks)


def shifted(signals: Signals, lag: float) -> Signals:
    """Return the signals with torques from a time later, as a second-order series."""
    curve = np.empty_like(signals.torque)
    for part in pieces_of(signals.segment):
        curve[part] = np.gradient(signals.torque_rate[part], signals.step, axis=0)
    return replace(
        signals,
        torque=signals.torque + lag * signals.torque_rate + 0.5 * lag**2 * curve,
        torque_rate=signals.torque_rate + lag * curve,
    )


def require_motion(signals: Signals, log: str = "") -> None:
    """Refuse a log in which nothing moves, or an actuator's torque stays what it is.

    Args:
        signals: The filtered log.
        log: Its name, for messages: there may be several.

    Raises:
        InvalidLog: If the robot hardly moves, or a torque never changes.
    """
    travel = np.ptp(signals.samples.position, axis=0)
    if travel[:3].max() < 0.01 and travel[3] < 1e-3:
        raise InvalidLog(
            "the robot hardly moves in this log (below 0.01 rad and 1 mm); record a motion that "
            "excites it, such as that of `paminsa-viz excite`",
            log=log,
        )
    for name, spread in zip(ACTUATORS, np.ptp(signals.torque, axis=0), strict=True):
        if spread <= RESOLUTION * np.abs(signals.torque).max():
            problem = f"the torque of {name} never changes; check its sensor or column"
            raise InvalidLog(problem, log=log)


def _outliers(
    signals: Signals, blocks: NormalBlocks, solution: FitSolution, numbers: NDArray[np.int64]
) -> list[str]:
    """Return a note on the block in which far more is left than in the others, if there is one."""
    left = block_residuals(blocks, solution.x)
    spread = signals.torque.std(axis=0)
    usual = np.maximum(np.median(left, axis=0), RESOLUTION * spread)
    times = np.where(left > LEAST_LEFT * spread, left / usual, 0.0)
    block, place = np.unravel_index(int(times.argmax()), times.shape)
    if times[block, place] <= MOST_LEFT:
        return []
    t = signals.t[numbers == block]
    return [
        f"from {t[0]:.4g} s to {t[-1]:.4g} s the torque of {ACTUATORS[place]} is off by "
        f"{times[block, place]:.2g} times as much as elsewhere: an outlier or a contact there "
        "widens intervals; leave its rows out and split the log at the gap"
    ]


def _moves(
    log: Log, solved: tuple[Array, list[slice]], design: Design, settings: IdentificationSettings,
    estimates: tuple[Estimate, ...], values: Array, error: Array,
) -> list[str]:  # fmt: skip
    """Return warnings about known numbers that move with the cut-off."""
    worst = np.zeros(len(values))
    seen = LEAST_MOVE * np.array([item.parameter.most for item in estimates])
    for factor in OTHER_CUT_OFFS:
        try:
            signals = filtered(log, design, settings, solved, factor)
            model, _, solution, _, lag = _fit(design, signals, settings)
        except (InvalidLog, InvalidInput):
            return [f"the log does not allow {factor * settings.cut_off:.3g} Hz for comparison"]
        other = model.report @ solution.x
        other[[item.kind == "delay" for item in model.parameters]] += lag
        move = np.abs(other - values)
        worst = np.maximum(worst, np.where(move > seen, move, 0.0) / np.maximum(error, 1e-300))
    moved = [
        f"{item.symbol} ({size:.2g})"
        for item, size in zip(estimates, worst, strict=True)
        if item.known and size > MOST_MOVE
    ]
    if not moved:
        return []
    low, high = (settings.cut_off * factor for factor in OTHER_CUT_OFFS)
    return [
        f"between {low:.3g} Hz and {high:.3g} Hz results move by more than {MOST_MOVE:g} standard "
        f"errors: {', '.join(moved)}; try another cut-off, or look for what the model lacks"
    ]


def _identity(
    design: Design, model: FitModel, solution: FitSolution, settings: IdentificationSettings,
    estimates: tuple[Estimate, ...],
) -> Identity:  # fmt: skip
    row = identity_row(design.geometry, design.gravity) @ model.report[: len(BASE_SYMBOLS)]
    error = float(solution.deviation(row[None])[0])
    value = float(row @ solution.x)
    told = bool(solution.known(row[None])[0]) and not settings.constrain and error > 0
    # A poor motion leaves tens of newtons open, and an interval of few blocks is not that exact.
    told = told and all(item.known for item in estimates[1:5])
    return Identity(
        value if told else np.nan,
        solution.quantile * error if told else np.inf,
        value / error if told else np.nan,
    )
