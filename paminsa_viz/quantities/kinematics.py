"""Quantities that the geometry alone decides: conditioning, reach, transmission."""

from __future__ import annotations

import numpy as np

from paminsa_viz.actuation.wrench_capability import TRANSMISSION
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import WRENCH_TORQUES, Field
from paminsa_viz.model.reach import LEAST_MARGIN, Limit
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import UNIT_TORQUES
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.quantities.quantity import Quantity, in_family, reached


def _transmission(leg: int) -> Quantity:
    return Quantity(
        f"transmission_{leg + 1}", f"TI{'₁₂₃'[leg]}", f"transmission index of leg {leg + 1}",
        f"Output transmission index of leg {leg + 1} (Wang, Wu and Liu 2010)", "1", TRANSMISSION,
        lambda field, _: reached(field, TRANSMISSION)[leg], bounded=True, color=LEG_COLORS[leg],
        cost=3e-7, flat=True,
    )  # fmt: skip


def _pressure(leg: int) -> Quantity:
    return Quantity(
        f"pressure_{leg + 1}", f"pressure{'₁₂₃'[leg]}", f"pressure angle of leg {leg + 1}",
        f"Angle between force and motion of joint 5 of leg {leg + 1}", "rad", TRANSMISSION,
        lambda field, _: np.arccos(np.minimum(reached(field, TRANSMISSION)[leg], 1.0)),
        bounded=True, color=LEG_COLORS[leg], cost=3e-7, flat=True,
    )  # fmt: skip


def _selective(axis: int) -> Quantity:
    name, unit, load = (("x", "1/m", "force along x"), ("y", "1/m", "force along y"),
                        ("θ", "1", "moment about z"))[axis]  # fmt: skip

    def value(field: Field, _: Design) -> Array:
        rows = reached(field, WRENCH_TORQUES)[3 * axis : 3 * axis + 3]
        return 1 / np.sqrt((rows**2).sum(axis=0))

    return Quantity(
        f"selective_{name.replace('θ', 'theta')}", f"DSI {name}", f"directional index of {name}",
        f"Direction-selective index of {name}: {load} for unit torques (Boschetti et al. 2011)",
        unit, WRENCH_TORQUES, value, bounded=axis == 2, cost=3e-7, flat=True,
    )  # fmt: skip


KINEMATICS = in_family(
    "kinematics",
    Quantity(
        "condition", "κ", "condition number κ", "Condition number", "1", DEXTERITY,
        lambda field, _: field.condition,
        cost=3e-7, flat=True,
    ),
    Quantity(
        "determinant", "det", "determinant", "Determinant, zero at a singularity", "m",
        DEXTERITY, signed=True, cost=3e-7, flat=True,
    ),
    Quantity(
        "reach_margin", "margin", "reach margin", "Distance to the nearest limit of reach", "m",
        LEAST_MARGIN,
    ),
    Quantity(
        "transmission", "TI", "transmission index",
        "Least transmission index of the three legs (Wang, Wu and Liu 2010)", "1",
        TRANSMISSION, lambda field, _: reached(field, TRANSMISSION).min(axis=0), bounded=True,
        cost=3e-7, flat=True,
    ),
    *(_transmission(leg) for leg in range(3)),
    *(_pressure(leg) for leg in range(3)),
    *(_selective(axis) for axis in range(3)),
    Quantity(
        "selective_z", "DSI z", "directional index of z",
        "Direction-selective index of z, 1/k: force along z for a unit force of M4", "1",
        UNIT_TORQUES,
        lambda field, _: np.where(
            field.status == Limit.OK, 1 / field.geometry.magnification, np.nan
        ),
    ),
    Quantity(
        "conditioning", "LCI", "local conditioning index",
        "Local conditioning index 1/κ, with R_pl as characteristic length", "1", DEXTERITY,
        lambda field, _: 1 / reached(field, DEXTERITY)[1], bounded=True, cost=3e-7, flat=True,
    ),
)  # fmt: skip
