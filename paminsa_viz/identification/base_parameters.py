"""The base parameters: what a motion can show of the 18 lumped coefficients, in closed form.

Torques are Y c, but the columns of Y repeat each other for every motion:

* z_5, Z and the platform rise together, Z' = z'/k: three weights are one, and so are four masses;
* bars B4 and B8 are rigid, so that psi'^2 + theta_k'^2 cos^2 psi is |v_5 - v_9|^2 / l_B4^2, and
  phi'^2 + theta_k'^2 cos^2 phi is |v_9 - v_8|^2 / l_B8^2 with v_8 = -v_5/(k - 1) in the horizontal;
* sin^2 = 1 - cos^2, and M_c8 and M_c13 turn together;
* the joints 5 are at the corners of the platform: the sum of their squared horizontal velocities
  is 3 (x'^2 + y'^2 + R_pl^2 theta'^2).

Eleven numbers b = B c are left (`BASE_PARAMETERS`), with torques X b. For any masses and
counterweights ten of them decide over the eleventh,

    b_3 - (k - 1)/2 b_4 + k/2 b_5 = M_p2 / (2 g),

since for every point of the pantograph's bars r_9 - (k - 1) r_5 + k z_5 = 1 (`PointWeights`).
Springs break it. With masses of its own for each leg there are 27 base parameters: all but the
weight, the mass along z and the platform's inertia are then those of a leg (`LEG_PARAMETERS`).

The drives' inertias J (`Design.drive_inertia`) are part of b_8, J/2 of the mean of M1..M3, and of
b_7, J_4/(6 k^2). What sets a drive of M1..M3 apart from their mean is in no base parameter: its
torque (J_i - mean J) theta_i'' is not in X b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.model.arguments import of_design, of_geometry, require_gravity
from paminsa_viz.model.arrays import Array, together
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.lumped import (
    COEFFICIENTS,
    lumped_coefficients,
    lumped_matrix,
    mass_vector,
    term_matrix,
)
from paminsa_viz.model.regressor import BLOCK, leg_unit_terms, torque_regressor


class BaseParameter(NamedTuple):
    """One base parameter: its symbol, SI unit and plain name."""

    symbol: str
    unit: str
    label: str


BASE_PARAMETERS: tuple[BaseParameter, ...] = (
    BaseParameter("b_1", "N", "weight a leg: M_p1 + M_p3/k + m_pl g/3"),
    BaseParameter("M_p2", "N", "static imbalance M_p2"),
    BaseParameter("b_3", "kg", "mass at joint 9"),
    BaseParameter("b_4", "kg", "horizontal coupling of joints 5 and 9"),
    BaseParameter("b_5", "kg", "vertical coupling of joints 5 and 9"),
    BaseParameter("b_6", "kg", "horizontal mass at joint 5"),
    BaseParameter("b_7", "kg", "vertical mass at joint 5"),
    BaseParameter("b_8", "kg m^2", "spin inertia of a leg, bars upright"),
    BaseParameter("b_9", "kg m^2", "spin inertia, cos² ψ term"),
    BaseParameter("b_10", "kg m^2", "spin inertia, cos² φ term"),
    BaseParameter("b_11", "kg m^2", "platform inertia I_pl − m_pl R_pl²"),
)
"""The base parameters in their order."""

BASE_SYMBOLS: tuple[str, ...] = tuple(item.symbol for item in BASE_PARAMETERS)
"""Symbols of the base parameters, in their order."""

LEG_PARAMETERS: tuple[int, ...] = (1, 2, 3, 4, 5, 7, 8, 9)
"""Places of the base parameters that each leg may have its own of."""

_PLACE = {name: place for place, name in enumerate(COEFFICIENTS)}


@of_geometry
def base_matrix(geometry: Geometry, gravity: float) -> Array:
    """Return B, (11, 18): b = B c, without drives, with c as `lumped.COEFFICIENTS` orders it.

    Raises:
        InvalidInput: If the gravity is none that a design has.
    """
    require_gravity(gravity)
    k, per_b4, per_b8 = (
        geometry.magnification,
        1 / geometry.coupler_length**2,
        1 / geometry.crank_length**2,
    )
    rows: tuple[dict[str, float], ...] = (
        {"Mp1": 1, "Mp3": 1 / k, "m_pl": gravity / 3},
        {"Mp2": 1},
        {"Mc3": 1, "Mc9": per_b4, "Mc11": per_b8},
        {"Mc4": 1, "Mc9": -2 * per_b4, "Mc11": 2 * per_b8 / (k - 1)},
        {"Mc5": 1, "Mc9": -2 * per_b4},
        {"Mc1": 1, "Mc9": per_b4, "Mc11": per_b8 / (k - 1) ** 2, "m_pl": 1 / 6},
        {"Mc2": 1, "Mc6": 1 / k**2, "Mc7": 1 / k, "Mc9": per_b4, "m_pl": 1 / 6},
        {"Mc8": 1, "Mc10": 1, "Mc12": 1, "Mc13": 1},
        {"Mc10": 1},
        {"Mc12": 1},
        {"I_pl": 1, "m_pl": -(geometry.platform_radius**2)},
    )
    matrix = np.zeros((len(rows), len(COEFFICIENTS)))
    for row, entries in zip(matrix, rows, strict=True):
        for name, value in entries.items():
            row[_PLACE[name]] = value
    return matrix


def _selection() -> Array:
    """Return S, (18, 11), with X = Y S: a right inverse of B that no length enters."""
    names = ("Mp1", "Mp2", "Mc3", "Mc4", "Mc5", "Mc1", "Mc2", "Mc13", "Mc10", "Mc12", "I_pl")
    selection = np.zeros((len(COEFFICIENTS), len(names)))
    for column, name in enumerate(names):
        selection[_PLACE[name], column] = 1.0
    selection[_PLACE["Mc13"], 8:10] = -1.0  # the sum b_8 stays when b_9 or b_10 changes
    selection.setflags(write=False)
    return selection


SELECTION: Array = _selection()
"""S, (18, 11): base regressor X = Y S. The torques are Y c = X B c for every motion."""


@of_design
def base_parameters(design: Design) -> Array:
    """Return b of a design, (11,) in the order of `BASE_PARAMETERS` [N, kg, kg m^2].

    It is B c (`base_matrix`), and the drives' inertias in b_7 and b_8: that of M4, and the mean of
    those of M1..M3 (see `base_regressor` where they differ).
    """
    b = base_matrix(design.geometry, design.gravity) @ lumped_coefficients(design)
    j1, j2, j3, j4 = design.drive_inertia
    b[7] += (j1 + j2 + j3) / 6
    b[6] += j4 / (6 * design.geometry.magnification**2)
    return b


def mass_columns(design: Design) -> tuple[Array, Array]:
    """Return D, (11, 28), and e, (11,): b = D m + e for masses m in the order of `MASS_PATHS`.

    What is in e are the counterweights and the drives.
    """
    matrix = lumped_matrix(design.geometry, design.gravity)
    columns = base_matrix(design.geometry, design.gravity) @ matrix
    return columns, base_parameters(design) - columns @ mass_vector(design)


@of_geometry
def base_regressor(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return X, (..., 4 actuators, 11 base parameters); X b are the torques if M1..M3 are alike.

    Friction and the external load are no part of it. Where the drives' inertias J of M1..M3 differ
    (`Design.drive_inertia`), neither is (J_i - mean J) theta_i'' of those actuators, which
    `identify` takes into account. NaN where the pose cannot be taken.

    Args:
        geometry: Lengths of the mechanism.
        pose: (..., 4) [m, m, rad, m].
        velocity: (..., 4) [m/s, m/s, rad/s, m/s].
        acceleration: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
    """
    y = torque_regressor(geometry, pose, velocity, acceleration)
    return y @ SELECTION


@of_geometry
@np.errstate(all="ignore")
def leg_base_regressor(
    geometry: Geometry, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the columns of each leg's own parameters, (..., 4 actuators, 3 legs, 8).

    The last axis is in the order of `LEG_PARAMETERS`; over the legs they add up to those columns
    of `base_regressor`. Arguments as there.
    """
    shape, motion = together(pose=pose, velocity=velocity, acceleration=acceleration)
    terms = (term_matrix() @ SELECTION)[:19, list(LEG_PARAMETERS)]
    found = np.empty((len(motion[0]), 4, 3, terms.shape[1]))
    for start in range(0, len(found), BLOCK):
        part = slice(start, start + BLOCK)
        found[part] = leg_unit_terms(geometry, *(values[part] for values in motion)) @ terms
    return found.reshape(*shape, *found.shape[1:])


@of_geometry
def identity_row(geometry: Geometry, gravity: float) -> Array:
    """Return a, (11,), with a b = 0 for any masses: M_p2 - 2 g (b_3 - (k-1)/2 b_4 + k/2 b_5) [N].

    A constant force that pulls joint 9 of every leg up without inertia makes it negative, by that
    force.

    Raises:
        InvalidInput: If the gravity is none that a design has.
    """
    require_gravity(gravity)
    k = geometry.magnification
    row = np.zeros(len(BASE_PARAMETERS))
    row[1:5] = 1.0, -2 * gravity, gravity * (k - 1), -gravity * k
    return row
