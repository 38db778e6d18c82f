"""Spread of the static torques of M1..M3 under tolerances.

Each value lies within plus or minus its tolerance of its nominal value, evenly distributed and
independent of the others; its standard deviation is the tolerance over sqrt(3).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import require_seed, require_share
from paminsa_viz.errors import InvalidDesign, InvalidInput, name_hint
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_numbers, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.lumped import MASS_PATHS, lumped_matrix, point_mass_column
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.statics import (
    BODIES,
    static_imbalance,
    static_torques,
    unit_torques_by_leg,
)

RelativeTolerances = float | Mapping[str, float]
"""One relative tolerance for all values, or one for each path; what is not named is exact."""


@dataclass(frozen=True, eq=False)
class MassTolerance:
    """Spread from masses; exact, as torques are linear in them. Every leg has errors of its own.

    Attributes:
        nominal: M_p2 of the design [N].
        deviation: Standard deviation of M_p2 of one leg [N].
        worst: Largest departure of M_p2 of one leg from the nominal one [N].
        torque: (..., 3) static torques of M1..M3 without errors [N m].
        torque_deviation: (..., 3) their standard deviations [N m].
        torque_worst: (..., 3) the largest size that they can take [N m].
        shares: By path, the part of the variance of M_p2 that comes from it, the largest first.
    """

    nominal: float
    deviation: float
    worst: float
    torque: Array
    torque_deviation: Array
    torque_worst: Array
    shares: dict[str, float]


def _relative(tolerances: RelativeTolerances, paths: list[str]) -> Array:
    if isinstance(tolerances, Mapping):
        for path in tolerances:
            if path not in paths:
                hint = name_hint(path, paths, there="tolerances can be given for")
                raise InvalidInput(path, hint)
        given = [tolerances.get(path, 0.0) for path in paths]
    else:
        if as_numbers(tolerances, "tolerances").ndim:
            raise InvalidInput("tolerances", "one number, or one for each path, is needed")
        given = [tolerances] * len(paths)
    values = as_numbers(given, "tolerances")
    if not ((values >= 0) & (values < 1)).all():
        raise InvalidInput("tolerances", "relative tolerances of at least 0 and below 1 are needed")
    return values


@of_design
def mass_tolerance(
    design: Design, tolerances: RelativeTolerances, pose: ArrayLike
) -> MassTolerance:
    """Return the spread of M_p2 and of the static torques of M1..M3 from masses.

    Args:
        design: The robot.
        tolerances: Relative, 0.01 for 1 % to either side: one number for all, or by path those of
            joint and link masses, and of ``"counterweights.0.mass"`` and so on.
        pose: (..., 4) where [m, m, rad, m].

    Raises:
        InvalidInput: If a tolerance is no part below 1, or for a path that is no mass of a leg.
    """
    pose = as_vectors(pose, "pose")
    geometry = design.geometry
    paths = list(BODIES)
    matrix = lumped_matrix(geometry, design.gravity)
    effects = [matrix[1, MASS_PATHS.index(path)] * design.value(path) for path in paths]
    for number, weight in enumerate(design.counterweights):
        column = point_mass_column(counterweight_point(geometry, weight), design.gravity)
        paths.append(f"counterweights.{number}.mass")
        effects.append(column[1] * weight.mass)
    reach = np.array(effects) * _relative(tolerances, paths)
    deviation = float(np.linalg.norm(reach)) / np.sqrt(3.0)
    worst = float(np.abs(reach).sum())
    torque = static_torques(design, pose)[..., :3]
    by_leg = unit_torques_by_leg(geometry, pose)[..., :3, :]
    by_leg = np.where(np.isfinite(torque)[..., None], by_leg, np.nan)
    variance = reach**2
    order = np.argsort(-variance, kind="stable")
    shares = {paths[i]: float(variance[i] / variance.sum()) for i in order if variance[i] > 0}
    return MassTolerance(
        nominal=static_imbalance(design),
        deviation=float(deviation),
        worst=worst,
        torque=torque,
        torque_deviation=deviation * np.sqrt((by_leg**2).sum(axis=-1)),
        torque_worst=np.abs(torque) + worst * np.abs(by_leg).sum(axis=-1),
        shares=shares,
    )


@dataclass(frozen=True, eq=False)
class LengthTolerance:
    """Spread from lengths, sampled; the three legs of a sample are alike.

    Attributes:
        nominal: Peak of the static torques of M1..M3 over the poses, without errors [N m].
        peaks: (samples,) the same with errors, over the poses that the sample can take [N m].
        balance: (samples,) M_p2 [N].
        lost: (samples,) poses that a sample cannot take though the nominal robot can.
        impossible: Samples that were no robots and were drawn again.
    """

    nominal: float
    peaks: Array
    balance: Array
    lost: Array
    impossible: int

    def quantile(self, part: float) -> float:
        """Return the peak torque that a part of the samples does not exceed [N m].

        Raises:
            InvalidInput: If the part is not from 0 to 1.
        """
        require_share(part, "part")
        return float(np.quantile(self.peaks, part))


LENGTH_PATHS = (
    "geometry.magnification", "geometry.base_radius", "geometry.platform_radius",
    "geometry.crank_length", "geometry.coupler_length", "geometry.platform_joint_height",
)  # fmt: skip
"""Lengths that static torques depend on."""


@of_design
def length_tolerance(
    design: Design,
    tolerances: RelativeTolerances,
    pose: ArrayLike,
    *,
    samples: int = 200,
    seed: int = 0,
) -> LengthTolerance:
    """Return the spread of the peak static torque from lengths.

    B7 keeps its length of l_B4/k, as the legs would be no parallelograms otherwise.

    Args:
        design: The robot; its masses are as they should be.
        tolerances: Relative, 0.01 for 1 % to either side: one number for all, or by path those of
            `LENGTH_PATHS`, and of ``"counterweights.0.beyond"`` and so on. `Design.tolerances` are
            others, of single legs [m, rad]; see `precision.tolerance_errors`.
        pose: (..., 4) the workspace [m, m, rad, m].
        samples: Number of robots to draw.
        seed: The same seed gives the same robots.

    Raises:
        InvalidInput: If a tolerance is no part below 1, or for a path that is no such length; if
            there are no samples, the seed is not possible, or no pose can be taken; or if hardly
            any sample is a robot.
    """
    pose = as_vectors(pose, "pose").reshape(-1, 4)
    weights = [f"counterweights.{i}.beyond" for i in range(len(design.counterweights))]
    paths = [*LENGTH_PATHS, *weights]
    relative = _relative(tolerances, paths)
    reached = check_reach(design.geometry, pose).ok
    if samples < 1:
        raise InvalidInput("samples", f"at least one sample is needed, not {samples!r}")
    require_seed(seed)
    if not reached.any():
        raise InvalidInput("pose", "the robot cannot take a single one of the poses")
    pose = pose[reached]
    values = np.array([design.value(path) for path in paths])
    rng = np.random.default_rng(seed)
    found: list[tuple[float, float, int]] = []
    impossible = 0
    while len(found) < samples:
        drawn = values * (1 + relative * rng.uniform(-1.0, 1.0, len(values)))
        try:
            other = design.vary(dict(zip(paths, map(float, drawn), strict=True)))
        except InvalidDesign:
            impossible += 1
            if impossible > 10 * samples:
                raise InvalidInput(
                    "tolerances", "they are so wide that hardly any sample is a robot"
                ) from None
            continue
        peak, lost = _peak(other, pose)
        found.append((peak, static_imbalance(other), lost))
    peaks, balances, lost = (np.array(column) for column in zip(*found, strict=True))
    return LengthTolerance(_peak(design, pose)[0], peaks, balances, lost, impossible)


def _peak(design: Design, pose: Array) -> tuple[float, int]:
    torque = np.abs(static_torques(design, pose)[:, :3])
    good = np.isfinite(torque).all(axis=1)
    return (float(torque[good].max()) if good.any() else 0.0), int((~good).sum())
