"""Where a motion is in its playing, as pure functions of the time that has passed."""

from __future__ import annotations

from dataclasses import dataclass, replace

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)
"""How many times as fast as true time a motion can be played."""


@dataclass(frozen=True)
class Playback:
    """The instant that is shown, and whether it moves on.

    Attributes:
        time: Since the motion's start [s].
        playing: Whether it moves on.
        following: Whether the robot stands where the motion is at ``time``; it does not once a
            person has moved it, until the motion is played or scrubbed again.
        speed: Times as fast as true time.
        loop: Whether the motion starts again at its end.
    """

    time: float = 0.0
    playing: bool = False
    following: bool = False
    speed: float = 1.0
    loop: bool = False


def advanced(playback: Playback, passed: float, duration: float) -> Playback:
    """Return a playback after some time has passed.

    Args:
        playback: A playback.
        passed: True time [s].
        duration: Of the motion [s]; without a loop, it stops there.
    """
    if not playback.playing:
        return playback
    time = playback.time + passed * playback.speed
    if time < duration:
        return replace(playback, time=time)
    if playback.loop and duration > 0:
        return replace(playback, time=time % duration)
    return replace(playback, time=duration, playing=False)


def begun(playback: Playback, duration: float) -> Playback:
    """Return a playback that runs: from where it is, or from the start if it is at the end."""
    time = playback.time if playback.time < duration else 0.0
    return replace(playback, time=time, playing=True, following=True)
