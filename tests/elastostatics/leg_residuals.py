"""Newton-Euler residuals of every body from first principles (`tests.oracle`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.elastostatics.joint_forces import JOINTS, JointForces
from paminsa_viz.model.design import Design
from paminsa_viz.model.parameters import BAR_ENDS
from tests import oracle

PINS = {2: "B2", 3: "B3", 4: "B4", 5: "B4", 7: "B7", 8: "slider 8", 9: "B8"}
PLACES = {"8_b8": 8, "8_b7": 8, "guide": 8, "9": 9, "4": 4, "7": 7, "3": 3, "2": 2, "5": 5}
LEG_BODIES = ("B2", "B3", "B4", "B7", "B8", "slider 8", "B10")


def _owner(name: str) -> str | None:
    """Return the body of the leg that a body of the oracle is part of."""
    label = name.partition(": ")[2]
    if label.startswith("joint "):
        return PINS[int(label.removeprefix("joint "))]
    return label if label in LEG_BODIES else None


def counterweights(design: Design, solved: oracle.Leg) -> list[tuple[str, oracle.Body]]:
    """Return the counterweights of a leg as bodies of jets, with the bars they are on."""
    found = []
    for weight in design.counterweights:
        start, end = BAR_ENDS[weight.bar]
        if weight.joint != start:
            start, end = end, start
        along = oracle.unit(oracle.add(solved.points[end], solved.points[start], -1.0))
        center = oracle.add(solved.points[start], along, -weight.beyond)
        found.append((weight.bar.upper(), oracle.Body("counterweight", weight.mass, center)))
    return found


def body_residuals(forces: JointForces, motion: tuple[Any, Any, Any]) -> Any:
    """Return what equilibrium of the legs' bodies in their planes misses, (7, n, 3 legs, 3).

    Radial and vertical force [N] and moment about joint 8's guide line [N m].
    """
    design = forces.design
    q = oracle.jets(*motion)
    residual = {body: np.zeros((len(motion[0]), 3, 3)) for body in LEG_BODIES}
    everything = oracle.bodies(design, q)
    for leg in range(3):
        solved = oracle.leg(design, q, leg)
        heading, normal = oracle.value(solved.heading), oracle.value(solved.normal)
        base = solved.points[3]
        foot = (base[0], base[1], 0.0)

        def plane(v: Any, heading: Any = heading) -> Any:
            return np.stack(np.broadcast_arrays(oracle.dot(v, heading), v[2]), -1)

        def add(body: str, force: Any, place: Any, couple: Any, leg: int = leg) -> None:
            residual[body][:, leg, :2] += force
            lever = place[..., 0] * force[..., 1] - place[..., 1] * force[..., 0]
            residual[body][:, leg, 2] += lever + couple

        def at(point: Any, foot: Any = foot, plane: Any = plane) -> Any:
            return plane(oracle.add(oracle.value(point), foot, -1.0))

        parts = [
            (_owner(body.name), body)
            for body in everything
            if body.name.startswith(f"leg {leg + 1}: ")
        ]
        for owner, body in [*parts, *counterweights(design, solved)]:
            if owner is None:
                continue
            linear = oracle.add(oracle.second(body.center), oracle.UP, design.gravity)
            w = oracle.turning(body)
            spin = oracle.add(
                oracle.rotated(body, oracle.turning(body, oracle.second)),
                oracle.cross(w, oracle.rotated(body, w)),
            )
            force = -body.mass * plane(linear)
            add(owner, force, at(body.center), oracle.dot(spin, normal))
        for index, joint in enumerate(JOINTS):
            force = forces.force[:, leg, index][:, [0, 2]]
            couple = forces.moment[:, leg, index]
            place = at(solved.points[PLACES[joint.key]]) if joint.key != "m" else 0.0 * force
            for body, sign in ((joint.on, 1.0), (joint.by, -1.0)):
                if body in residual:
                    add(body, sign * force, place, sign * couple)
    return np.stack([residual[body] for body in LEG_BODIES])
