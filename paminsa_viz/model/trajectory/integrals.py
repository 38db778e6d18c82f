"""Integrals over samples."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_simpson, simpson

from paminsa_viz.model.arrays import Array


def running_integral(t: Array, values: Array) -> Array:
    """Return the integral of values (n, ...) over t (n,) from the first sample to each.

    By parabolas through neighbouring samples: the error falls with the third power of the step
    where values are smooth, and with the first where they jump.
    """
    if len(t) < 2:
        return np.zeros_like(values)
    return cumulative_simpson(values, x=t, axis=0, initial=0.0)


def rms(t: Array, values: Array) -> Array:
    """Return the root mean square over time of values (n, ...)."""
    if len(t) < 2:
        return np.abs(values[0])
    mean = np.asarray(simpson(values**2, x=t, axis=0)) / (t[-1] - t[0])
    return np.sqrt(np.maximum(mean, 0.0))
