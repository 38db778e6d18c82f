"""Logs for tests of the identification: multi-sine motions, torques of formulas or of an engine."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from paminsa_viz.identification.base_parameters import mass_columns
from paminsa_viz.identification.log import Log, make_log
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Friction,
    check_reach,
    inverse_dynamics,
    inverse_kinematics,
    measure_singularity,
)
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.lumped import MASS_PATHS, mass_vector
from paminsa_viz.model.reach import Limit, home_pose

RUBBING = replace(APPENDIX_4, friction=Friction(0.3, 0.4, 20.0, 8.0))
"""A robot whose joints rub."""

PERIOD = 10.0
"""Period of the multi-sines [s]."""

HARMONICS = 14
"""Highest harmonic of a multi-sine."""


@dataclass(frozen=True, eq=False)
class RandomMotion:
    """A periodic motion with exact derivatives: times (n,) in, poses (n, 4) and rates out."""

    center: Array
    cosine: Array  # (4, HARMONICS)
    sine: Array

    def __call__(self, t: Array) -> tuple[Array, Array, Array]:
        w = 2 * np.pi / PERIOD * np.arange(1, HARMONICS + 1)
        c, s = np.cos(t[:, None] * w), np.sin(t[:, None] * w)
        return (
            self.center + c @ self.cosine.T + s @ self.sine.T,
            (c * w) @ self.sine.T - (s * w) @ self.cosine.T,
            -(c * w**2) @ self.cosine.T - (s * w**2) @ self.sine.T,
        )


@cache
def multi_sine(seed: int, design: Design = APPENDIX_4) -> RandomMotion:
    """Return a random motion off stretched legs, with a condition number of at most 5."""
    rng = np.random.default_rng(seed)
    weight = rng.standard_normal((2, 4, HARMONICS)) / np.arange(1, HARMONICS + 1) ** 0.7
    size = np.array([0.1, 0.1, 0.7, 0.14]) * design.geometry.base_radius / 0.35
    center = np.array(home_pose(design.geometry))
    t = np.linspace(0, PERIOD, 500)
    shape = RandomMotion(np.zeros(4), *weight)(t)[0]
    weight *= (size / np.abs(shape).max(axis=0))[:, None]
    for share in np.linspace(1.0, 0.1, 19):
        motion = RandomMotion(center, *(share * weight))
        poses = motion(t)[0]
        good = (check_reach(design.geometry, poses).status == Limit.OK).all()
        found = measure_singularity(design.geometry, poses)
        apart = found.serial_distance.min() > 0.05 * design.geometry.base_radius
        if good and apart and found.condition.max() <= 5:
            return motion
    raise AssertionError("no share of the motion fits")


def moved_unseen(design: Design, seed: int) -> Design:
    """Return a design with other masses that no motion tells from the first one's."""
    masses = mass_vector(design)
    shares = mass_columns(design)[0] * masses  # columns of relative changes
    null = np.linalg.svd(shares)[2][10:]
    step = null.T @ np.random.default_rng(seed).standard_normal(len(null))
    step[masses == 0.0] = 0.0
    changed = masses * (1 + 0.9 / np.abs(step).max() * step)
    return design.vary(dict(zip(MASS_PATHS, changed.tolist(), strict=True)))


def noisy(
    t: Array, position: Array, torque: Array, rng: np.random.Generator, noise: float = 0.02,
    jitter: float = 0.0,
) -> tuple[Array, Array]:  # fmt: skip
    """Add torque noise correlated over 20 ms and round positions to 0.01 degrees and 10 µm.

    With ``jitter`` positions are off by up to so many counts before they are rounded.
    """
    from scipy.signal import lfilter

    step = t[1] - t[0]
    keep = np.exp(-step / 0.02)
    white = rng.standard_normal((len(t) + 200, 4)) * np.sqrt(1 - keep**2)
    colored = np.asarray(lfilter([1.0], [1.0, -keep], white, axis=0))[200:]
    counts = np.array([np.pi / 18000] * 3 + [1e-5])
    scale = noise * np.sqrt((torque**2).mean(axis=0))
    count = position / counts
    if jitter:
        count = count + jitter * rng.uniform(-1.0, 1.0, count.shape)
    return counts * np.round(count), torque + scale * colored


@cache
def clean_signals(
    seed: int, design: Design = APPENDIX_4, duration: float = 20.0, rate: float = 1000.0
) -> tuple[Array, Array, Array]:
    """Times, positions and torques of the formulas for a random motion; do not write to them."""
    t = np.arange(round(duration * rate)) / rate
    motion = multi_sine(seed, design)(t)
    torque = inverse_dynamics(design, *motion).torque
    return t, inverse_kinematics(design.geometry, motion[0]).actuators, torque


def simulated(
    seed: int, design: Design = APPENDIX_4, *, noise_seed: int | None = 0, jitter: float = 0.0,
    **options: Any,
) -> Log:  # fmt: skip
    """Return a log of the formulas; with noise, see `noisy`, unless ``noise_seed`` is None."""
    t, position, torque = clean_signals(seed, design, **options)
    if noise_seed is not None:
        rng = np.random.default_rng(noise_seed)
        position, torque = noisy(t, position, torque, rng, jitter=jitter)
    return make_log(t, position, torque)
