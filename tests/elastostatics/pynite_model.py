"""The robot as a frame in PyNite, an engine that is not ours: members, end releases, supports.

PyNite's Y is up: (x, y, z) here is (x, z, -y) there. Bars are members that share nodes at the
joints, and a joint releases the end of one of them; carriage and platform are members of a huge
section, huge for the robot's bars and length, as one that is stiffer than it need be costs digits.
PyNite cuts a member wherever a node lies on it. Hanging, the shaft passes the root of B10, so that
the two would be welded together; the root is moved aside by a nanometer.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from scipy.linalg import eigh

from paminsa_viz.elastostatics.vibration import platform_mass
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import LEG_AXES, inverse_kinematics

ASIDE = 1e-9
"""How far the root of B10 is moved off the leg axis [m]."""

AXES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Rows: PyNite's X, Y, Z in base axes."""


def robot_frame(design: Design, pose: Any, aside: float = ASIDE, *, rigid: float = 1e4) -> Any:
    """Return the robot with rigid joints as a model.

    The huge section has ``rigid`` times the second moment of the stiffest bar.
    """
    from Pynite import FEModel3D

    model = FEModel3D()
    elastic = design.elastic
    young, rigidity = elastic.young_modulus, elastic.shear_modulus
    model.add_material("alloy", young, rigidity, elastic.poisson, 0.0)
    sections = {bar: elastic.section(bar) for bar in ("b1", "b2", "b3", "b4", "b7", "b8", "b10")}
    second = rigid * max(max(s.inertia_in, s.inertia_out, s.torsion) for s in sections.values())
    area = max(second / design.geometry.base_radius**2, *(s.area for s in sections.values()))
    model.add_section("rigid", area, *[second] * 3)
    for bar, s in sections.items():
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

        def member(bar: str, first: str, second: str, rotation: float = 0.0, **ends: bool):
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
    return model


def compliance(design: Design, pose: Any, *, aside: float = ASIDE) -> Any:
    """Return the compliance at P, (6, 6), in base axes."""
    model = robot_frame(design, pose, aside)
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


# ------------------------------------------------------------------------- natural frequencies
# Masses are points: those of a bar at three Gauss points between two joints, which give a bar that
# moves as a polynomial of degree 2 its exact energy. B10 ends at the slider, which slides along it,
# and goes on as a member of the huge section; so the slider's node moves as that end of B10 does,
# but for its way along it.

BARS = {"b8": (8, 9), "b7": (8, 7), "b4": (9, 4, 5), "b3": (7, 3, 4), "b2": (3, 2), "b1": (1, 2)}
"""Joints along each bar, but for B10."""

RIGID = 2e3
"""Of the huge section: a larger one costs the lowest frequencies their digits."""


def frequencies(design: Design, pose: Any, count: int = 6) -> Any:
    """Return the lowest natural frequencies of slender bars, without weight and load, (count,)."""
    from Pynite.Analysis import _prepare_model

    model = robot_frame(design, pose, rigid=RIGID)
    found = inverse_kinematics(design.geometry, pose)
    masses: dict[str, float] = {}

    def node(name: str, place: Any, mass: float) -> None:
        model.add_node(name, *(float(value) for value in AXES @ place))
        masses[name] = mass

    def spread(name: str, first: Any, last: Any, mass: float) -> None:
        shares, weights = np.polynomial.legendre.leggauss(3)
        for part, (share, weight) in enumerate(zip(shares, weights, strict=True)):
            node(f"{name}/{part}", first + 0.5 * (1 + share) * (last - first), 0.5 * weight * mass)

    for leg in range(3):
        u = np.array([np.cos(found.beta[leg]), np.sin(found.beta[leg]), 0.0])
        axis = np.array([*LEG_AXES[leg], 0.0])
        root = design.geometry.base_radius * axis
        joints = {joint: place[leg] for joint, place in found.points.items()}
        joints[1] = joints[2] - design.geometry.arm_length * axis
        for joint in (2, 3, 4, 5, 7, 8, 9):
            masses[f"{joint}/{leg}"] = getattr(design.joints, f"j{joint}")
        for bar, along in BARS.items():
            lengths = [np.linalg.norm(joints[b] - joints[a]) for a, b in pairwise(along)]
            for (a, b), length in zip(pairwise(along), lengths, strict=True):
                mass = getattr(design.links, bar) * length / sum(lengths)
                spread(f"{bar} {a}-{b}/{leg}", joints[a], joints[b], mass)
        model.members.pop(f"b10 0/{leg}-8/{leg}")
        length = design.geometry.guide_link_length
        share = float(np.linalg.norm(joints[8] - root)) / length
        node(f"end/{leg}", joints[8], 0.0)
        node(f"tip/{leg}", root - length * u, 0.0)
        model.add_member(f"b10/{leg}", f"0/{leg}", f"end/{leg}", "alloy", "b10")
        model.add_member(f"b10 rest/{leg}", f"end/{leg}", f"tip/{leg}", "alloy", "rigid")
        start = root - ASIDE * u
        spread(f"b10/{leg}", start, joints[8], design.links.b10 * share)
        spread(f"b10 rest/{leg}", joints[8], root - length * u, design.links.b10 * (1 - share))

    model.add_load_combo("none", {"none": 1.0})
    _prepare_model(model)
    stiffness = model.Ke("none", check_stability=False).toarray()
    mass = np.zeros_like(stiffness)
    number = {name: 6 * item.ID for name, item in model.nodes.items()}
    for name, value in masses.items():
        places = number[name] + np.arange(3)
        mass[places, places] += value
    both, at = np.kron(np.eye(2), AXES), number["P"] + np.arange(6)
    mass[np.ix_(at, at)] += both @ platform_mass(design) @ both.T

    moves, held = np.eye(len(mass)), set()
    for name, item in model.nodes.items():
        for freedom, key in enumerate(("DX", "DY", "DZ", "RX", "RY", "RZ")):
            if getattr(item, f"support_{key}"):
                held.add(number[name] + freedom)
    for leg in range(3):
        slider, end = number[f"8/{leg}"], number[f"end/{leg}"]
        moves[slider : slider + 6] = 0.0
        moves[slider : slider + 6, end : end + 6] = np.eye(6)
        moves[slider : slider + 3, slider] = AXES @ [
            np.cos(found.beta[leg]), np.sin(found.beta[leg]), 0.0
        ]  # fmt: skip
        held |= set(range(slider + 1, slider + 6))
    moves = moves[:, sorted(set(range(len(mass))) - held)]
    inverse = eigh(moves.T @ mass @ moves, moves.T @ stiffness @ moves, eigvals_only=True)
    return 1 / (2 * np.pi * np.sqrt(inverse[: -count - 1 : -1]))
