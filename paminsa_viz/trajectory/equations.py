"""The equations of motion as the solver takes them: compiled where Numba is ready, else in Python.

The first compilation takes some fifteen seconds, loading it from disk one or two. A page calls
`load_kernel` in a thread; whatever is simulated meanwhile runs in Python, a hundred times slower.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from types import ModuleType

import numpy as np

from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.lumped import EnergyTerms, energy_terms, lumped_coefficients
from paminsa_viz.trajectory import plant
from paminsa_viz.trajectory.sampled import Trajectory

_WORK = 1_000_000
"""Poses that a simulation counts as when it is decided whether to load compiled kernels."""


class _Kernel:
    """Holds the module of the compiled equations once it is loaded."""

    def __init__(self) -> None:
        self.module: ModuleType | None = None
        self.lock = Lock()

    def load(self) -> None:
        """Load it; the lock is held by the caller."""
        if self.module is None:
            from paminsa_viz.trajectory import plant_kernel

            plant_kernel.warm_up()
            self.module = plant_kernel

    def get(self) -> ModuleType | None:
        """Return it if it is to be used; does not wait for another thread that loads it."""
        if not backend.worth_compiled(_WORK):
            return None
        if self.module is None and self.lock.acquire(blocking=False):
            try:
                self.load()
            finally:
                self.lock.release()
        return self.module


_kernel = _Kernel()


def load_kernel() -> None:
    """Compile the equations of motion, or load them from disk, and wait for it."""
    with _kernel.lock:
        _kernel.load()


def robot_numbers(design: Design) -> plant.Robot:
    """Return the numbers of a robot; the guides have no end, so that motions reach it smoothly."""
    m = mechanism(design.geometry)._replace(rho2_min=-np.inf, rho2_max=np.inf)
    e = EnergyTerms(*map(float, energy_terms(lumped_coefficients(design))))
    f, w = design.friction, design.load
    losses = plant.Losses(
        design.gravity, f.viscous_rotary, f.coulomb_rotary, f.viscous_linear, f.coulomb_linear,
        f.transition_speed, w.force_x, w.force_y, w.force_z, w.moment_z, w.point_x, w.point_y,
        w.turns,
    )  # fmt: skip
    return m, e, losses


def equations(
    design: Design,
    model: Design,
    gains: plant.Gains,
    trajectory: Trajectory,
) -> tuple[Callable[[float, Array], Array], Callable[[Array, Array], Array]]:
    """Return the equations of motion, and the commanded torques (n, 4) of states (n, 10 or 11)."""
    true, believed = robot_numbers(design), robot_numbers(model)
    times = np.array(trajectory.t)
    track = np.hstack([trajectory.pose, trajectory.velocity, trajectory.acceleration])
    if trajectory.load is not None:
        track = np.hstack([track, trajectory.load[:, [0, 1, 2, 5]]])
    kernel = _kernel.get()
    if kernel is not None:
        numbers = kernel.pack(true, believed, gains)

        def compiled(t: float, state: Array) -> Array:
            growth = np.empty(state.size)
            kernel.derivative(t, state, numbers, times, track, growth)
            return growth

        def compiled_torques(t: Array, states: Array) -> Array:
            torque = np.empty((len(t), 4))
            state = np.ascontiguousarray(states)
            kernel.torques(t, state, numbers, times, track, torque)
            return torque

        return compiled, compiled_torques

    def derivative(t: float, state: Array) -> Array:
        growth = np.full(state.size, np.nan)
        with suppress(ValueError, ArithmeticError), np.errstate(all="ignore"):
            plant.derivative(t, state, true, believed, gains, times, track, growth)
        return growth

    def torques(t: Array, states: Array) -> Array:
        rows = [
            plant.commanded(now, state, believed, gains, times, track)
            for now, state in zip(t, states, strict=True)
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 4)

    return derivative, torques
