"""Quantities of the forces at the joints and in the bars, at rest under the design's load."""

from __future__ import annotations

from collections.abc import Callable

from paminsa_viz.elastostatics.bar_loads import BAR_MEASURES, field_bar_loads, field_joint_forces
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, JOINTS, LegJoint
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.statics import UNIT_TORQUES
from paminsa_viz.quantities.quantity import Quantity, in_family

_PER_FORCE = 4e-6
_PER_BAR = 1.2e-5


def _force(index: int) -> Callable[[Field, Design], Array]:
    return lambda field, design: field_joint_forces(field, design)[index]


def _bar(name: str) -> Callable[[Field, Design], Array]:
    index = BAR_MEASURES.index(name)
    return lambda field, design: field_bar_loads(field, design)[index]


def _largest(field: Field, design: Design) -> Array:
    return field_joint_forces(field, design)[: len(JOINTS)].max(axis=0)


def _joint(joint: LegJoint) -> Quantity:
    key = {"m": "force_m", "guide": "guide_force"}.get(joint.key, f"force_{joint.key}")
    symbol = {"m": "F M", "guide": "F guide"}.get(joint.key, f"F {joint.label}")
    name = {"m": "bearing of M", "guide": "guide"}.get(joint.key, f"joint {joint.label}")
    where = "" if joint.key == "5" else ", in the leg's plane"
    return Quantity(
        key, symbol, f"force at {name}",
        f"Largest static force at {name} over the legs{where}", "N", UNIT_TORQUES,
        _force(JOINT_INDEX[joint.key]), cost=_PER_FORCE,
    )  # fmt: skip


JOINT_FORCES = in_family(
    "joint forces",
    Quantity(
        "joint_force", "max F", "largest joint force",
        "Largest static force at any joint: in the leg's plane, at joint 5 in space", "N",
        UNIT_TORQUES, _largest, cost=_PER_FORCE,
    ),
    *(_joint(joint) for joint in JOINTS),
    Quantity(
        "bearing_moment", "M bearing", "moment on the bearing of M",
        "Largest static tilting moment on the bearings of M1 to M3, in the leg's plane", "N m",
        UNIT_TORQUES, _force(len(JOINTS)), cost=_PER_FORCE,
    ),
    Quantity(
        "arm_moment", "M 2", "moment at joint 2",
        "Largest static moment of a shaft on its arm B1, in the leg's plane", "N m",
        UNIT_TORQUES, _force(len(JOINTS) + 1), cost=_PER_FORCE,
    ),
    Quantity(
        "bar_moment", "max M", "largest bending moment",
        "Largest static bending moment of any bar, in the leg's plane", "N m", UNIT_TORQUES,
        _bar("bending"), cost=_PER_BAR,
    ),
    Quantity(
        "bar_axial", "max N", "largest axial force",
        "Largest static tension or compression of any bar, in the leg's plane", "N", UNIT_TORQUES,
        _bar("axial"), cost=_PER_BAR,
    ),
    Quantity(
        "utilization", "σ/R_p", "utilization of the bars",
        "Largest static stress of any bar over the yield stress, in the leg's plane", "1",
        UNIT_TORQUES, _bar("utilization"), cost=_PER_BAR,
    ),
)  # fmt: skip
