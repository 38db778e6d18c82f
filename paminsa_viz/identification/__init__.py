"""Identification: from a log of the built robot to its parameters, with intervals.

The base parameters, friction and offsets of a robot follow from measured positions and torques by
weighted least squares (Gautier and Khalil 1990; Swevers et al. 1997). What a log does not say is
reported as unknown.
"""

from __future__ import annotations

from paminsa_viz.identification.base_parameters import (
    BASE_PARAMETERS,
    BASE_SYMBOLS,
    LEG_PARAMETERS,
    BaseParameter,
    base_matrix,
    base_parameters,
    base_regressor,
    identity_row,
    leg_base_regressor,
)
from paminsa_viz.identification.excitation import (
    Excitation,
    ExcitationSettings,
    KeptLimit,
    NoExcitation,
    optimize_excitation,
)
from paminsa_viz.identification.information import ExcitationLimits
from paminsa_viz.identification.multi_sine import MultiSine

__all__ = [
    "BASE_PARAMETERS",
    "BASE_SYMBOLS",
    "LEG_PARAMETERS",
    "BaseParameter",
    "Excitation",
    "ExcitationLimits",
    "ExcitationSettings",
    "KeptLimit",
    "MultiSine",
    "NoExcitation",
    "base_matrix",
    "base_parameters",
    "base_regressor",
    "identity_row",
    "leg_base_regressor",
    "optimize_excitation",
]
