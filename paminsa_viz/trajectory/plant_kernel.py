"""The formulas of `plant.py` compiled; no mechanics of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numba.np.unsafe.ndarray import to_fixed_tuple

from paminsa_viz.model import leg
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.compiled import OPTIONS, register
from paminsa_viz.model.lumped import EnergyTerms
from paminsa_viz.trajectory import plant

_MECHANISM, _TERMS, _LOSSES = (
    len(kind._fields) for kind in (leg.Mechanism, EnergyTerms, plant.Losses)
)
_GAINS = len(plant.Gains._fields)
_ROBOT = _MECHANISM + _TERMS + _LOSSES


@register_jitable
def _robot(numbers):  # type: ignore[no-untyped-def]
    """Unpack a robot from a list of numbers: a tuple of named tuples is slow to hand over."""
    return (
        leg.Mechanism(*to_fixed_tuple(numbers, _MECHANISM)),  # type: ignore[call-arg]
        EnergyTerms(*to_fixed_tuple(numbers[_MECHANISM:], _TERMS)),
        plant.Losses(*to_fixed_tuple(numbers[_MECHANISM + _TERMS :], _LOSSES)),
    )


@register_jitable
def _gains(numbers):  # type: ignore[no-untyped-def]
    return plant.Gains(*to_fixed_tuple(numbers[2 * _ROBOT :], _GAINS))  # type: ignore[call-arg]


def pack(true: plant.Robot, believed: plant.Robot, gains: plant.Gains) -> Array:
    """Return the robot, what the controller believes of it, and its gains as one list."""
    numbers = [value for part in (*true, *believed, gains) for value in part]
    return np.array(numbers, dtype=np.float64)


def _kernels(digest: int) -> tuple[Any, Any]:
    """``digest`` is used for its being a closure variable, and so part of Numba's cache key."""

    @njit(**OPTIONS)
    def derivative(t, state, numbers, times, states, out):  # type: ignore[no-untyped-def]
        if digest < 0:
            return
        true, believed = _robot(numbers), _robot(numbers[_ROBOT:])
        plant.derivative(t, state, true, believed, _gains(numbers), times, states, out)

    @njit(**OPTIONS)
    def torques(t, state, numbers, times, states, out):  # type: ignore[no-untyped-def]
        """Commanded torques at times (n,) and states (n, 10 or 11)."""
        if digest < 0:
            return
        robot, k = _robot(numbers[_ROBOT:]), _gains(numbers)
        for i in range(t.size):
            q = plant.commanded(t[i], state[i], robot, k, times, states)
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = q

    return derivative, torques


# The model's formulas are registered, to be inlined, where its own kernels are.
derivative, torques = _kernels(register(plant.derivative, plant.commanded, inline=False))


def warm_up() -> None:
    """Compile the kernels, or load them from disk, by a call."""
    numbers = np.ones(2 * _ROBOT + _GAINS)
    times, states, state = np.arange(2.0), np.zeros((2, 12)), np.zeros(10)
    derivative(0.0, state, numbers, times, states, np.zeros(10))
    torques(times[:0], states[:0, :10], numbers, times, states, np.zeros((0, 4)))
