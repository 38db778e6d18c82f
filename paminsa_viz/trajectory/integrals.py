"""Integrals over samples, also as weighted sums of them."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array


def running_integral(t: Array, values: Array) -> Array:
    """Return the integral of values (n, ...) over t (n,) from the first sample to each.

    Over a step it is the mean of the two parabolas through the step's ends and one neighbor. The
    error falls with the fourth power of the step where values are smooth, with the first where
    they jump.
    """
    total = np.zeros_like(values)
    if len(t) < 2:
        return total
    h = np.diff(t).reshape(-1, *[1] * (values.ndim - 1))
    if len(t) == 2:
        total[1] = 0.5 * h[0] * (values[0] + values[1])
        return total
    ahead = _first_step(h[:-1], h[1:], values[:-2], values[1:-1], values[2:])
    behind = _first_step(h[1:], h[:-1], values[2:], values[1:-1], values[:-2])
    steps = np.concatenate([ahead[:1], 0.5 * (ahead[1:] + behind[:-1]), behind[-1:]])
    np.cumsum(steps, axis=0, out=total[1:])
    return total


def _first_step(h1: Array, h2: Array, f1: Array, f2: Array, f3: Array) -> Array:
    """Return the integral over the first of two steps of the parabola through three values."""
    share = h1 / (h1 + h2)
    bend = share * h1 / h2
    return h1 / 6.0 * ((3.0 - share) * f1 + (3.0 + bend + share) * f2 - bend * f3)


def rms(t: Array, values: Array) -> Array:
    """Return the root mean square over time of values (n, ...)."""
    if len(t) < 2:
        return np.abs(values[0])
    return np.sqrt(np.maximum(running_integral(t, values**2)[-1] / (t[-1] - t[0]), 0.0))


def time_weights(t: Array) -> Array:
    """Return the weights (n,) with which samples at times t add up to an integral [s].

    Those of `running_integral` unless a very uneven step makes one negative, which would not be
    convex; then those of trapezia.
    """
    step = np.diff(t)
    weights = np.zeros(len(t))
    weights[:-1] += 0.5 * step
    weights[1:] += 0.5 * step
    if len(t) > 2:
        # a step's parabolas reach four samples, so samples six apart can share a run
        fine = np.empty(len(t))
        for first in range(6):
            comb = np.zeros(len(t))
            comb[first::6] = 1.0
            total = running_integral(t, comb)
            for i in range(first, len(t), 6):
                fine[i] = total[min(i + 2, len(t) - 1)] - total[max(i - 3, 0)]
        if (fine >= 0).all():
            return fine
    return weights
