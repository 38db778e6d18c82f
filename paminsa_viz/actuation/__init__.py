"""Forces and drives: what the platform can push, carry and reach in speed, and which motors do it.

`wrench_capability` and `transmission` measure a pose; the drives of a design give the limits.
"""

from __future__ import annotations

from paminsa_viz.actuation.catalog import Catalog, CatalogError
from paminsa_viz.actuation.duty import Duty, DutyCycle, duty_cycle
from paminsa_viz.actuation.payload import PayloadChange, payload_change, payload_time_scaling
from paminsa_viz.actuation.polytope import WrenchPolytope, wrench_polytope
from paminsa_viz.actuation.ratios import RatioIntervals, ratio_intervals
from paminsa_viz.actuation.selection import Selection, select_drives
from paminsa_viz.actuation.sizing import Sizing, size_drives
from paminsa_viz.actuation.wrench_capability import (
    DEFAULT_LIMITS,
    ActuatorLimits,
    Capability,
    actuator_limits,
    capability,
    field_capability,
)

__all__ = [
    "DEFAULT_LIMITS",
    "ActuatorLimits",
    "Capability",
    "Catalog",
    "CatalogError",
    "Duty",
    "DutyCycle",
    "PayloadChange",
    "RatioIntervals",
    "Selection",
    "Sizing",
    "WrenchPolytope",
    "actuator_limits",
    "capability",
    "duty_cycle",
    "field_capability",
    "payload_change",
    "payload_time_scaling",
    "ratio_intervals",
    "select_drives",
    "size_drives",
    "wrench_polytope",
]
