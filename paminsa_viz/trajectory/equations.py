"""The equations of motion as the solver takes them: compiled where the model is, else in Python.

The first compilation takes some five seconds, loading it from disk less than one; Python is fifty
times slower.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from threading import Lock
from typing import Any

import numpy as np

from paminsa_viz.interrupts import import_whole
from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg import Mechanism, mechanism
from paminsa_viz.model.lumped import EnergyTerms, term_factors
from paminsa_viz.model.reach import home_pose
from paminsa_viz.trajectory import plant
from paminsa_viz.trajectory.sampled import Trajectory

_LENGTHS, _TERMS = len(Mechanism._fields), len(EnergyTerms._fields)


to_fixed_tuple: Any = None
"""Numba's, from the first compilation on."""


# Not inside `_compiled`: a local function would be part of the cache key, another in each process.
def _unpack(robot):
    rest = robot[_LENGTHS + _TERMS :]
    return (
        Mechanism(*to_fixed_tuple(robot, _LENGTHS)),
        EnergyTerms(*to_fixed_tuple(robot[_LENGTHS:], _TERMS)),
        plant.Drivetrain(rest[0], rest[1], rest[2:6], rest[6:10], rest[10:14], rest[14:]),
    )


@cache
def _compiled() -> Callable[..., Array]:
    """Return `plant.derivative`, compiled or loaded from disk by a call."""
    global to_fixed_tuple
    import_whole("paminsa_viz.model.compiled")  # slow to load: Numba comes with it
    from numba.extending import register_jitable
    from numba.np.unsafe.ndarray import to_fixed_tuple

    from paminsa_viz.model.compiled import OPTIONS, kernel, register

    # A closure variable is part of Numba's cache key, so that changed formulas are compiled again.
    key = (register(plant.derivative, inline=False), _LENGTHS, _TERMS)
    register_jitable(_unpack)

    @kernel(**OPTIONS)
    def derivative(t, state, robot, model, gains, times, states, commanded):
        _ = key
        return plant.derivative(
            t, state, _unpack(robot), _unpack(model), gains, times, states, commanded
        )

    robot = _packed(robot_numbers(Design()))
    gains = plant.Gains(0.0, 0.0, 0.0, np.empty(4), np.empty(4))
    times, states = np.arange(2.0), np.zeros((2, 18))
    states[:, :4] = home_pose(Design().geometry)
    derivative(0.0, states[0, :10], robot, robot, gains, times, states, np.empty(4))
    return derivative


def _packed(robot: plant.Robot) -> Array:
    """Return a robot as one array: compiled functions take a tuple of many numbers slowly."""
    return np.hstack([value for part in robot for value in part])


_loading = Lock()


def load_kernel() -> None:
    """Compile the equations of motion, or load them from disk, and wait for it."""
    with backend.loading, _loading:
        _compiled()


def robot_numbers(design: Design) -> plant.Robot:
    """Return the numbers of a robot; the guides have no end, so that motions reach it smoothly."""
    m = mechanism(design.geometry)._replace(rho2_min=-np.inf, rho2_max=np.inf)
    e = term_factors(design)
    f = design.actuator_friction
    drivetrain = plant.Drivetrain(
        design.gravity,
        f.transition_speed,
        np.array(f.viscous),
        np.array(f.coulomb),
        np.array(design.drive_inertia),
        np.array([*design.load.wrench, *design.load.point, design.load.turns]),
    )
    return m, e, drivetrain


def equations(
    design: Design, model: Design, gains: plant.Gains, trajectory: Trajectory
) -> tuple[Callable[[float, Array], Array], Callable[[Array, Array], Array]]:
    """Return the equations of motion, and the commanded torques (n, 4) of states (n, 10 or 11)."""
    true: Any = robot_numbers(design)
    believed: Any = robot_numbers(model)
    load = np.zeros((trajectory.size, 6)) if trajectory.load is None else trajectory.load
    track = np.hstack([trajectory.pose, trajectory.velocity, trajectory.acceleration, load])
    wanted = (gains, np.array(trajectory.t), track)
    growth = plant.derivative
    if backend.compiles():
        load_kernel()
        growth = _compiled()
        true, believed = _packed(true), _packed(believed)

    def at(t: float, state: Array, commanded: Array) -> Array:
        # Out of reach or singular, Python raises, and compiled code returns what is not finite.
        with suppress(ValueError, ArithmeticError), np.errstate(all="ignore"):
            found = growth(t, state, true, believed, *wanted, commanded)
            if np.isfinite(found).all():
                return found
        return np.full(state.size, np.nan)

    def derivative(t: float, state: Array) -> Array:
        return at(t, state, np.empty(4))

    def torques(t: Array, states: Array) -> Array:
        found = np.full((len(t), 4), np.nan)
        for time, state, row in zip(t, states.copy(), found, strict=True):
            at(time, state, row)
        return found

    return derivative, torques
