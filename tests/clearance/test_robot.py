"""The robot's clearance against coal, which is given every solid where it is drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.clearance import Body, Primitive, pair_clearance, shapes_of
from paminsa_viz.clearance.nearest import CYLINDER
from paminsa_viz.clearance.solids import WORLD
from paminsa_viz.dimensions.placement import place_parts
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, KneeBranch, Payload
from paminsa_viz.model.kinematics import inverse_kinematics
from tests.clearance.coal_shapes import coal_request, coal_shape
from tests.clearance.pairs_of_solids import may_meet
from tests.support.samples import random_poses, with_knee

pytestmark = pytest.mark.slow

NEAR = 0.03
"""Pairs of bodies within this distance are compared [m]."""


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_distances_of_near_bodies_are_those_of_coal(knee: KneeBranch) -> None:
    coal: Any = pytest.importorskip("coal")
    weights = (Counterweight("b8", 8, 0.2, 2.0),)
    design = replace(with_knee(APPENDIX_4, knee), payload=Payload(mass=3.0), counterweights=weights)
    shapes, request = shapes_of(design), coal_request()
    made = {id(s): coal_shape(s) for body in shapes.bodies for s in body.solids}
    compared, wrong, of_cylinders = 0, 0, 0
    for pose in random_poses(np.random.default_rng(5), design, 2):
        places = place_parts(inverse_kinematics(design.geometry, pose))
        frames = {name: place.matrix for name, place in places.items()} | {WORLD: np.eye(4)}
        ours = pair_clearance(design, pose)

        def where(body: Body, solid: Primitive, frames: dict[str, Array] = frames) -> Any:
            frame = frames[body.frame]
            place = frame[:3, :3] @ solid.center + frame[:3, 3]
            return coal.Transform3s(frame[:3, :3] @ solid.rotation, place)

        for pair in np.nonzero(ours < NEAR)[0]:
            one, other = (shapes.bodies[i] for i in shapes.pairs[pair])
            found = [
                coal.distance(
                    made[id(a)], where(one, a), made[id(b)], where(other, b), request,
                    coal.DistanceResult(),
                )
                for a in one.solids
                for b in other.solids
                if may_meet(one, a, other, b)
            ]  # fmt: skip
            compared += 1
            if any(s.kind == CYLINDER for body in (one, other) for s in body.solids):
                of_cylinders += abs(min(found) - ours[pair]) > 1e-9 and ours[pair] > 0
                # Its depth of cylinders is exact, ours a bound; both say that they overlap.
                wrong += (min(found) > 1e-6) != (ours[pair] > 1e-6)
            else:
                wrong += abs(min(found) - ours[pair]) > 1e-9
    assert compared > 10
    assert wrong == 0
    assert of_cylinders < 0.1 * compared
