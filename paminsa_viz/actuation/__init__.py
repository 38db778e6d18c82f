"""Forces and drives: what the platform can push, carry and reach in speed, and which motors do it.

`wrench_capability` and `transmission` measure a pose; the drives of a design give the limits.
"""

from __future__ import annotations

from paminsa_viz.actuation.polytope import WrenchPolytope, wrench_polytope
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
    "WrenchPolytope",
    "actuator_limits",
    "capability",
    "field_capability",
    "wrench_polytope",
]
