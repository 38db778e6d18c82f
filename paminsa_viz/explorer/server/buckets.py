"""A token bucket: how much at once, and how much in the long run."""

from __future__ import annotations


class Bucket:
    """A bucket that may go into debt: what was taken is paid back by waiting.

    Args:
        rate: Tokens that come back in a second [1/s].
        burst: Tokens that may be taken at once.
        now: Present time [s].
    """

    def __init__(self, rate: float, burst: float, now: float) -> None:
        self._rate, self._burst = rate, burst
        self._level, self._time = burst, now

    def level(self, now: float) -> float:
        """Return the tokens that are there at time ``now`` [s]; below zero is debt."""
        self._level = min(self._burst, self._level + (now - self._time) * self._rate)
        self._time = now
        return self._level

    def take(self, tokens: float, now: float) -> float:
        """Take ``tokens``, there or not; return how long until the debt is paid [s]."""
        self._level = self.level(now) - tokens
        return max(0.0, -self._level / self._rate)
