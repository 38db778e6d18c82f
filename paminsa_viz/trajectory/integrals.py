"""Integrals over samples, also as weighted sums of them."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array

SHORTEST = 0.5
"""Length of a neighboring step, over a step's own, from which on a parabola is drawn through it.

With r the step over its neighbor, the instant beyond the neighbor counts as 2 + 3 r - r^3 at the
least, which is negative beyond r = 2.
"""


def running_integral(t: Array, values: Array) -> Array:
    """Return the integral of values (n, ...) over t (n,) from the first sample to each.

    Over a step it is the mean of the two parabolas through the step's ends and one neighbor,
    without those whose neighbor is nearer than `SHORTEST`, and a trapezium if both are: two
    instants close together may stand for a jump, which a parabola would carry on over the whole
    step. So no value counts negatively. The error falls with the fourth power of even steps where
    values are smooth, with the first where they jump.
    """
    total = np.zeros_like(values)
    if len(t) < 2:
        return total
    h = np.diff(t).reshape(-1, *[1] * (values.ndim - 1))
    parabolas, count = np.zeros_like(values[1:]), np.zeros_like(h)
    first, middle, last = values[:-2], values[1:-1], values[2:]
    before, after = slice(None, -1), slice(1, None)
    for own, next_, ends in (
        (before, after, (first, middle, last)),
        (after, before, (last, middle, first)),
    ):
        apart = h[next_] >= SHORTEST * h[own]
        parabolas[own] += np.where(apart, _first_step(h[own], h[next_], *ends), 0.0)
        count[own] += apart
    trapezia = 0.5 * h * (values[:-1] + values[1:])
    steps = np.where(count > 0, parabolas / np.maximum(count, 1), trapezia)
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

    Those of `running_integral`, at least 0.
    """
    sample = np.arange(len(t))
    run = sample % 6  # a step's parabolas reach four samples, so samples six apart can share a run
    total = running_integral(t, np.eye(6)[run])
    end, begin = np.minimum(sample + 2, len(t) - 1), np.maximum(sample - 3, 0)
    weights = total[end, run] - total[begin, run]
    return np.maximum(weights, 0.0)  # against rounding


def mean_weights(t: Array) -> Array:
    """Return the weights (n,) with which samples at times t add up to a mean over time."""
    return time_weights(t) / (t[-1] - t[0]) if len(t) > 1 else np.ones(1)
