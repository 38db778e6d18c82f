"""Quantities of the forces at the joints and in the bars, at rest under the design's load."""

from __future__ import annotations

from paminsa_viz.elastostatics.bar_loads import BAR_MEASURES, field_bar_loads, field_joint_forces
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS, LegJoint
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.statics import UNIT_TORQUES
from paminsa_viz.quantities.quantity import Quantity, in_family

_PER_FORCE = 4e-6
_PER_BAR = 1.2e-5


def _force(key: str, symbol: str, label: str, title: str, unit: str, index: int) -> Quantity:
    """Return a row of the forces and moments at the joints as a quantity."""

    def value(field: Field, design: Design) -> Array:
        return field_joint_forces(field, design)[index]

    return Quantity(key, symbol, label, title, unit, UNIT_TORQUES, value, cost=_PER_FORCE)


def _bar(key: str, symbol: str, label: str, title: str, unit: str, measure: str) -> Quantity:
    """Return one of `BAR_MEASURES` as a quantity."""

    def value(field: Field, design: Design) -> Array:
        return field_bar_loads(field, design)[BAR_MEASURES.index(measure)]

    return Quantity(key, symbol, label, title, unit, UNIT_TORQUES, value, cost=_PER_BAR)


def _largest(field: Field, design: Design) -> Array:
    return field_joint_forces(field, design)[: len(JOINTS)].max(axis=0)


def _joint(joint: LegJoint) -> Quantity:
    key = {"m": "force_m", "guide": "guide_force"}.get(joint.key, f"force_{joint.key}")
    symbol = {"m": "F M", "guide": "F guide"}.get(joint.key, f"F {joint.label}")
    where = "" if joint.key == "5" else ", in the leg’s plane"
    title = f"Largest static force at {joint.name} over the legs{where}"
    return _force(key, symbol, f"force at {joint.name}", title, "N", JOINT_INDEX[joint.key])


JOINT_FORCES = in_family(
    "joint forces",
    Quantity("joint_force", "max F", "largest joint force",
             "Largest static force at any joint: in the leg’s plane, at joint 5 in space", "N",
             UNIT_TORQUES, _largest, cost=_PER_FORCE),
    *(_joint(joint) for joint in JOINTS),
    _force("bearing_moment", "M bearing", "moment on the bearing of M",
           "Largest static tilting moment on the bearings of M1 to M3, in the leg’s plane",
           "N m", len(JOINTS)),
    _force("arm_moment", "M 2", "moment at joint 2",
           "Largest static moment of a shaft on its arm B1, in the leg’s plane",
           "N m", len(JOINTS) + 1),
    _bar("bar_moment", "max M", "largest bending moment",
         "Largest static bending moment of any bar, in the leg’s plane", "N m", "bending"),
    _bar("bar_axial", "max N", "largest axial force",
         "Largest static tension or compression of any bar, in the leg’s plane", "N", "axial"),
    _bar("utilization", "σ/R_p", "utilization of the bars",
         "Largest static stress of any bar over the yield stress, in the leg’s plane", "1",
         "utilization"),
)  # fmt: skip
