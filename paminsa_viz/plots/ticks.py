"""Round numbers for axes, color bars and contours."""

from __future__ import annotations

import math

_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
_LIMITS = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
_PARTS = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
_SLACK = 1e-9  # so that 0.3 / 0.1 counts as 3


def nice_step(span: float, count: float) -> float:
    """Return a round step that divides ``span`` into at most ``count`` parts."""
    raw = span / max(count, 1.0)
    power = 10.0 ** math.floor(math.log10(raw))
    for step in _STEPS:
        if step * power >= raw * (1 - _SLACK):
            return clean(step * power)
    return clean(10.0 * power)


def nice_limit(value: float, nearest: bool = False) -> float:
    """Return the next round number at or above a positive ``value``, or the nearest one."""
    power = 10.0 ** math.floor(math.log10(value))
    if nearest:
        return clean(min((x * power for x in _LIMITS), key=lambda x: abs(math.log(x / value))))
    for limit in _LIMITS:
        if limit * power >= value * (1 - _SLACK):
            return clean(limit * power)
    return clean(10.0 * power)


def multiples(low: float, high: float, step: float) -> tuple[float, ...]:
    """Return the multiples of ``step`` in [low, high]."""
    first = math.ceil(low / step - _SLACK)
    last = math.floor(high / step + _SLACK)
    return tuple(clean(i * step) for i in range(first, last + 1))


def dividing_step(low: float, high: float, count: float) -> float | None:
    """Return a round step that divides [low, high] and hits zero and both ends, if there is one.

    It makes at most ``count`` parts and at least a third of that, two at the least.
    """
    span = high - low
    power = 10.0 ** math.floor(math.log10(span / max(count, 1.0)))
    for step in [part * scale for scale in (power, 10 * power) for part in _PARTS]:
        ends = (low / step, high / step)
        if any(abs(end - round(end)) > 1e-6 for end in ends):
            continue
        parts = span / step
        if max(2.0, count / 3) - 1e-6 <= parts <= count + 1e-6:
            return clean(step)
    return None


def clean(value: float) -> float:
    """Return a number without the rounding error of a multiplication."""
    return float(f"{value:.12g}")
