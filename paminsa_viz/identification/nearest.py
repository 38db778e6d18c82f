"""Masses nearest to the design that explain a log, and the design with them.

A log tells ten combinations of the masses; the other directions are the design's. What is found is
the most likely design if the designer's numbers are off by some 30 %: bounded least squares, with
no mass below zero and no bar with more axial inertia than twice its transverse one (Sousa and
Cortesao 2014). A single mass has an interval only given the design, and none at all where the log
adds nothing to the designer's word.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from paminsa_viz.checks import kinds_checked, require_positive
from paminsa_viz.identification.base_parameters import BASE_SYMBOLS, mass_columns
from paminsa_viz.identification.estimate import SMALLEST_EIGENVALUE, unit_scale
from paminsa_viz.identification.results import Identification
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import PARAMETER, Design
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import PANTOGRAPH, Friction, Parameter

SPREAD = 0.3
"""How far the designer's masses are believed to be off, as a share (one standard deviation)."""

SMALL = 0.1
"""A mass that the design has none of may be that share of its group's median, times `SPREAD`."""

UNTOLD = 0.9
"""Posterior over prior deviation from which on the log says nothing of a mass."""

TINY = 1e-9
"""Share of how far a mass is believed to be off below which it is zero."""

LIGHTEST = 1e-6
"""Least share of the design's number that is left of a mass which cannot be zero."""


@dataclass(frozen=True)
class MassEstimate:
    """One mass or inertia, given the design.

    Attributes:
        parameter: Which one.
        prior: The design's number.
        prior_deviation: How far it is believed to be off.
        value: The nearest number that explains the log.
        deviation: Standard deviation of it, given that the design is right to `SPREAD`.
    """

    parameter: Parameter
    prior: float
    prior_deviation: float
    value: float
    deviation: float

    @property
    def told(self) -> bool:
        """Whether the log says anything of it."""
        return self.deviation <= UNTOLD * self.prior_deviation


@dataclass(frozen=True, eq=False)
class NearestMasses:
    """The design nearest to the given one that explains a log.

    Attributes:
        design: The design, with the masses, friction of the actuators, and differences of rotors.
        masses: The masses and inertias but the payload's, which stays.
        misfit: How far its base parameters are from the estimates, in standard deviations, as root
            mean square; some 1 or below where masses explain the log.
    """

    design: Design
    masses: tuple[MassEstimate, ...]
    misfit: float


@kinds_checked
def nearest_masses(identification: Identification, spread: float = SPREAD) -> NearestMasses:
    """Return the design nearest to the identified robot's that explains the log.

    Args:
        identification: What the log says.
        spread: How far the designer's masses are believed to be off, as a share.

    Raises:
        InvalidInput: If the spread is not a finite number above 0.
    """
    from scipy.optimize import lsq_linear  # takes a while to load

    require_positive(spread, "spread", "a finite number above 0")
    design = _with_actuators(identification)
    columns, fixed = mass_columns(design)
    free = [i for i, path in enumerate(MASS_PATHS) if not path.startswith("payload.")]
    paths = [MASS_PATHS[i] for i in free]
    prior = np.array([design.value(path) for path in paths])
    payload = [design.value(path) for path in MASS_PATHS if path.startswith("payload.")]
    fixed = fixed + np.delete(columns, free, axis=1) @ np.array(payload)
    columns = columns[:, free]
    deviation = _prior_deviation(paths, prior, spread)
    root, target = _told(identification)
    steps = _bounded(paths)  # masses = steps @ v with v at least 0, or what is refused as 0
    least = LIGHTEST * np.array([PARAMETER[path].positive for path in paths]) * prior
    inverse = np.diag(1 / deviation)
    left = np.concatenate([root @ columns @ steps, inverse @ steps]) * deviation
    right = np.concatenate([target - root @ fixed, prior / deviation])
    limits = (least / deviation, np.full(len(paths), np.inf))
    found = lsq_linear(left, right, limits, method="bvls", tol=1e-14)
    masses = steps @ (found.x * deviation)
    masses = np.where(masses < TINY * deviation, least, masses)
    posterior = deviation * _remaining(root @ columns * deviation)
    misfit = root @ (columns @ masses + fixed) - target
    return NearestMasses(
        design.vary(dict(zip(paths, masses.tolist(), strict=True))),
        tuple(
            MassEstimate(PARAMETER[path], *map(float, numbers))
            for path, *numbers in zip(paths, prior, deviation, masses, posterior, strict=True)
        ),
        float(np.sqrt((misfit**2).mean())),
    )


def _told(identification: Identification) -> tuple[Array, Array]:
    """Return the square root S of what the log says of b, and S b: (q, 11) and (q,).

    Friction, offsets and all else are eliminated; what the motion does not excite has no row.
    """
    solution = identification.solution
    constrained = identification.settings.constrain
    inside = len(BASE_SYMBOLS) - (1 if constrained else 0)
    whole = solution.information / solution.widening**2
    scale = unit_scale(whole)
    scaled = whole * scale * scale[:, None]
    cross, other = scaled[:inside, inside:], scaled[inside:, inside:]
    inner = np.linalg.pinv(other, rcond=SMALLEST_EIGENVALUE, hermitian=True)
    values, vectors = np.linalg.eigh(scaled[:inside, :inside] - cross @ inner @ cross.T)
    kept = values > SMALLEST_EIGENVALUE * values[-1]
    root = (np.sqrt(values[kept]) * vectors[:, kept]).T / scale[:inside]
    target = root @ solution.x[:inside]
    if constrained:  # without b_3
        root = np.insert(root, 2, 0.0, axis=1)
    return root, target


def _remaining(told: Array) -> Array:
    """Return posterior over prior deviations, (n,), for rows (q, n) of unit noise on a unit prior.

    From singular values: a log without noise tells 1e16 times what the prior does, and the sum of
    both has no inverse then.
    """
    _, values, directions = np.linalg.svd(told)
    left = np.ones(len(directions))
    left[: len(values)] = 1 / np.hypot(1.0, values)
    return np.asarray(np.linalg.norm(left[:, None] * directions, axis=0))


def _prior_deviation(paths: list[str], prior: Array, spread: float) -> Array:
    groups = np.array([path.rpartition(".")[0] for path in paths])
    units = np.array([PARAMETER[path].unit for path in paths])
    least = np.empty_like(prior)
    for place in range(len(paths)):
        alike = prior[(groups == groups[place]) & (units == units[place])]
        positive = alike[alike > 0]
        typical = float(np.median(positive)) if positive.size else float(prior.max())
        least[place] = SMALL * typical
    return spread * np.maximum(prior, least)


def _bounded(paths: list[str]) -> Array:
    """Return T with masses = T v: a bar's transverse inertia is half the axial one plus v >= 0."""
    steps = np.eye(len(paths))
    for bar in PANTOGRAPH:
        across, along = (paths.index(f"inertias.{bar}_{kind}") for kind in ("transverse", "axial"))
        steps[across, along] = 0.5
    return steps


def _with_actuators(identification: Identification) -> Design:
    """Return the design with the friction and the rotors' differences that the log tells.

    They go to the drives, which each actuator has its own of; friction of the joints, which M1..M3
    share, is then part of them. M1..M3 without a drive get one of ratio 1 without limits; the
    friction of M4 without a drive is that of its joint.
    """
    design = identification.design
    known = {item.symbol: item.value for item in identification.estimates if item.known}
    before = design.actuator_friction
    viscous = [known.get(f"b_v{i + 1}", before.viscous[i]) for i in range(4)]
    coulomb = [known.get(f"c_{i + 1}", before.coulomb[i]) for i in range(4)]
    inertia = list(design.drive_inertia)
    if "ΔJ_1" in known and "ΔJ_2" in known:
        first, second = known["ΔJ_1"], known["ΔJ_2"]
        mean = float(np.mean(inertia[:3]))
        rotors = np.array([first, second, -first - second]) + mean
        inertia[:3] = (rotors - min(float(rotors.min()), 0.0)).tolist()
    drives: Any = tuple(
        _drive(drive, viscous[i], coulomb[i], inertia[i], design.drive_inertia[i])
        if i < 3 or drive is not None
        else None
        for i, drive in enumerate(design.drives)
    )
    friction = Friction(transition_speed=design.friction.transition_speed)
    if drives[3] is None:
        linear = max(viscous[3], 0.0), max(coulomb[3], 0.0)
        friction = replace(friction, viscous_linear=linear[0], coulomb_linear=linear[1])
    return replace(design, friction=friction, drives=drives)


def _drive(
    drive: Drive | None, viscous: float, coulomb: float, inertia: float, before: float
) -> Drive | None:
    """Return a drive with other friction, and another rotor where the inertia changes."""
    new = {"viscous": max(viscous, 0.0), "coulomb": max(coulomb, 0.0)}
    if drive is None and not any(value > 0.0 for value in (*new.values(), inertia)):
        return None
    start = Drive(name="identified") if drive is None else drive
    new["viscous"] /= start.ratio**2
    new["coulomb"] /= start.ratio
    if inertia != before:
        new["rotor_inertia"] = max(inertia / start.ratio**2 - start.gear_inertia, 0.0)
    return replace(start, **new)
