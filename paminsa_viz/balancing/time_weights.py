"""Integrals over time as weighted sums of samples, for terms that are convex in each sample."""

from __future__ import annotations

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.trajectory.integrals import running_integral


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
        # a step's parabolas reach four samples, so that samples six apart can be asked at once
        fine = np.zeros(len(t))
        for first in range(6):
            comb = np.zeros(len(t))
            comb[first::6] = 1.0
            total = running_integral(t, comb)
            for i in range(first, len(t), 6):
                fine[i] = total[min(i + 2, len(t) - 1)] - total[max(i - 3, 0)]
        if (fine >= 0).all():
            return fine
    return weights
