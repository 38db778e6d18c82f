"""The robot as a frame in PyNite, an engine that is not ours: members, end releases, supports.

PyNite's Y is up: (x, y, z) here is (x, z, -y) there. Bars are members that share nodes at the
joints, and a joint releases the end of one of them; carriage and platform are members of a huge
section. PyNite cuts a member wherever a node lies on it. Hanging, the shaft passes the root of B10,
so that the two would be welded together; the root is moved aside by a nanometer.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import LEG_AXES, inverse_kinematics

ASIDE = 1e-9
"""How far the root of B10 is moved off the leg axis [m]."""

AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Rows: PyNite's X, Y, Z in base axes."""


def compliance(design: Design, pose: Any, *, aside: float = ASIDE) -> Any:
    """Return the compliance at P, (6, 6), rigid joints, in base axes."""
    from Pynite import FEModel3D

    model = FEModel3D()
    elastic = design.elastic
    young, rigidity = elastic.young_modulus, elastic.shear_modulus
    model.add_material("alloy", young, rigidity, elastic.poisson, 0.0)
    model.add_section("rigid", 1.0, 1e-2, 1e-2, 1e-2)
    for bar in ("b1", "b2", "b3", "b4", "b7", "b8", "b10"):
        s = elastic.section(bar)
        model.add_section(bar, s.area, s.inertia_out, s.inertia_in, s.torsion)

    def node(name: str, place: Any) -> None:
        model.add_node(name, *(float(value) for value in AXES @ place))

    found = inverse_kinematics(design.geometry, pose)
    lift = found.actuators[3]
    node("P", np.array([pose[0], pose[1], pose[3]]))
    node("carriage", np.array([0.0, 0.0, lift]))
    model.def_support("carriage", True, False, True, True, True, True)
    model.def_support_spring("carriage", "DY", elastic.drive_linear)
    for leg in range(3):
        u = np.array([np.cos(found.beta[leg]), np.sin(found.beta[leg]), 0.0])
        w = np.array([-u[1], u[0], 0.0])
        axis = np.array([*LEG_AXES[leg], 0.0])
        root = design.geometry.base_radius * axis

        def name(joint: object, leg: int = leg) -> str:
            return f"{joint}/{leg}"

        def member(bar: str, first: object, second: object, rotation: float = 0.0, **ends: bool):
            title = f"{bar} {first}-{second}"
            model.add_member(title, first, second, "alloy", bar, rotation)
            model.def_releases(title, **ends)

        for joint, place in found.points.items():
            node(name(joint), place[leg])
        node(name(0), root - aside * u)
        node(name(1), found.points[2][leg] - design.geometry.arm_length * axis)
        model.def_support(name(0), True, True, True, True, False, True)
        model.def_support_spring(name(0), "RY", elastic.drive_rotary)
        member("b10", name(0), name(8), Dxj=True)
        member("b8", name(8), name(9), Rzi=True)
        member("b7", name(8), name(7), Rzi=True, Rzj=True)
        member("b4", name(9), name(4), Rzi=True)
        member("b4", name(4), name(5), Rxj=True, Ryj=True, Rzj=True)
        member("b3", name(3), name(4), Rzj=True)
        member("b3", name(3), name(7))
        along_w = np.degrees(np.arctan2(w[0], -w[1]))  # turns the shaft's local z into w
        member("b2", name(3), name(2), along_w, Rzi=True)
        member("b1", name(1), name(2), Ryj=True)
        member("rigid", "carriage", name(1))
        member("rigid", "P", name(5))
    cases = [f"{kind}{axis}" for kind in "FM" for axis in "XYZ"]
    for case in cases:
        model.add_node_load("P", case, 1.0, case)
        model.add_load_combo(case, {case: 1.0})
    model.analyze_linear(check_stability=False)
    p = model.nodes["P"]
    moved = np.array([[getattr(p, d)[case] for case in cases] for d in ("DX", "DY", "DZ", "RX",
                                                                        "RY", "RZ")])  # fmt: skip
    both = np.kron(np.eye(2), AXES)
    return both.T @ moved @ both
