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
from paminsa_viz.identification.causes import Cause, Causes, find_causes
from paminsa_viz.identification.columns import FitParameter, IdentificationSettings
from paminsa_viz.identification.excitation import Excitation, KeptLimit, optimize_excitation
from paminsa_viz.identification.excitation_search import ExcitationSettings, NoExcitation
from paminsa_viz.identification.identify import identify
from paminsa_viz.identification.information import ExcitationLimits
from paminsa_viz.identification.log import InvalidLog, Log, log_of_simulation, make_log
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.identification.multi_sine import MultiSine
from paminsa_viz.identification.nearest import MassEstimate, NearestMasses, nearest_masses
from paminsa_viz.identification.results import Estimate, Identification, Identity
from paminsa_viz.identification.validation import (
    PayloadEstimate,
    Validation,
    validate,
    weigh_payload,
)

__all__ = [
    "BASE_PARAMETERS",
    "BASE_SYMBOLS",
    "LEG_PARAMETERS",
    "BaseParameter",
    "Cause",
    "Causes",
    "Estimate",
    "Excitation",
    "ExcitationLimits",
    "ExcitationSettings",
    "FitParameter",
    "Identification",
    "IdentificationSettings",
    "Identity",
    "InvalidLog",
    "KeptLimit",
    "Log",
    "MassEstimate",
    "MultiSine",
    "NearestMasses",
    "NoExcitation",
    "PayloadEstimate",
    "Validation",
    "base_matrix",
    "base_parameters",
    "base_regressor",
    "find_causes",
    "identify",
    "identity_row",
    "leg_base_regressor",
    "log_of_simulation",
    "log_poses",
    "make_log",
    "nearest_masses",
    "optimize_excitation",
    "validate",
    "weigh_payload",
]
