"""The terms of an optimum, worked out from what analyzes designs: of one, and of many at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.balancing import (
    LIFT,
    AddedMass,
    StaticLift,
    StaticPeak,
    StaticRms,
    Term,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    whole_mass,
)
from paminsa_viz.model import APPENDIX_4, Design, static_torques
from paminsa_viz.trajectory import analyze
from tests.balancing.robots import field, solved, trajectory, workspace

RANDOM = 10_000


def measured(design: Design) -> dict[str, float]:
    """Every term of a design, from the functions that analyze designs."""
    poses = workspace().poses()
    held = static_torques(design, poses).reshape(-1, 4)
    motion = analyze(design, trajectory())
    t = trajectory().t
    square = np.trapezoid(motion.torque**2, t, axis=0) / (t[-1] - t[0])
    return {
        "peak static torque": float(np.abs(held[:, :3]).max()),
        "RMS static torque": float(np.sqrt(np.mean(held[:, :3] ** 2))),
        "peak static force of M4": float(np.abs(held[:, 3]).max()),
        "peak torque of M1-M3 on the trajectory": max(abs(s.peak) for s in motion.summary[:3]),
        "RMS torque of M1-M3 on the trajectory": float(
            np.sqrt(np.mean([s.rms**2 for s in motion.summary[:3]]))
        ),
        "peak force of M4 on the trajectory": abs(motion.summary[3].peak),
        "RMS force of M4 on the trajectory": float(np.sqrt(square[3])),
        "driving energy on the trajectory": sum(s.driven for s in motion.summary),
        "added mass": whole_mass(design) - whole_mass(APPENDIX_4),
    }


def terms() -> list[Term]:
    """Return one term of every kind."""
    return [
        StaticPeak(field()), StaticRms(field()), StaticLift(field()),
        TrajectoryPeak(solved()), TrajectoryRms(solved()),
        TrajectoryPeak(solved(), LIFT), TrajectoryRms(solved(), LIFT),
        TrajectoryEnergy(solved()), AddedMass(),
    ]  # fmt: skip


def of_random(term: Term, c: Any, mass: Any) -> Any:
    """A term of many designs at once, (count,), from c and the torques Y c themselves."""
    s, f = solved(), field()
    if isinstance(term, AddedMass):
        return mass - whole_mass(APPENDIX_4)
    if isinstance(term, (StaticPeak, StaticRms)):
        gamma = f.gamma[:3][np.isfinite(f.gamma[:3])]
        size = np.abs(gamma).max() if isinstance(term, StaticPeak) else np.sqrt(np.mean(gamma**2))
        return np.abs(c[1]) * size
    if isinstance(term, StaticLift):
        constant = 3.0 * (c[16] * 9.81 + 3 * c[0]) + 3 * c[2]
        lift = f.gamma[3][np.isfinite(f.gamma[3])]
        return np.abs(np.outer(lift, c[1]) + constant).max(axis=0)
    everything = isinstance(term, TrajectoryEnergy)
    actuators = list(range(4)) if everything else list(term.actuators)  # type: ignore[attr-defined]
    found = []
    for part in np.array_split(np.arange(c.shape[1]), 20):
        torque = np.einsum("nji,ik->njk", s.y[:, actuators], c[:, part])
        t = s.trajectory.t
        if everything:
            power = torque * s.speed[:, :, None]
            found.append(np.trapezoid(np.maximum(power, 0), t, axis=0).sum(axis=0))
        elif isinstance(term, TrajectoryPeak):
            found.append(np.abs(torque).max(axis=(0, 1)))
        else:
            square = np.trapezoid(torque**2, t, axis=0).mean(axis=0) / (t[-1] - t[0])
            found.append(np.sqrt(square))
    return np.concatenate(found)
