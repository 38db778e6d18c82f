"""A robot enlarged with its bodies is drawn, checked and built as it was, in another size."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.clearance import clearance, kernels, pair_clearance, shapes_of
from paminsa_viz.dimensions.attached import disc_radius, payload_center, payload_offset, stub
from paminsa_viz.dimensions.body_scale import geometry_over_scale
from paminsa_viz.dimensions.layout import (
    layout,
    lift_motor_base,
    lift_motor_height,
    plinth_outline,
    plinth_radius,
)
from paminsa_viz.dimensions.needs import missing_room, needed_guide, needed_shaft
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.meshes.bodies import STANDING, body_glb, lengths_of, make_body
from paminsa_viz.meshes.loads import counterweight, payload_transform
from paminsa_viz.meshes.solids import plain_shapes
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design, KneeBranch, Payload
from tests.support.samples import enlarged, random_design, random_poses

TIMES = 0.1
WEIGHTS = (Counterweight("b8", 8, 0.03, 0.2), Counterweight("b4", 9, 0.01, 0.1))


def robots() -> list[Design]:
    """Return robots of both knees, with a payload and counterweights, of several sizes."""
    rng = np.random.default_rng(5)
    drawn = random_design(rng).vary({"geometry.body_scale": 0.7})
    loaded = replace(APPENDIX_4, payload=Payload(mass=2.0), counterweights=WEIGHTS)
    found = [loaded, replace(drawn, counterweights=WEIGHTS)]
    return [robot.with_knee(knee) for robot in found for knee in KneeBranch]


def each_of(designs: list[Design]) -> pytest.MarkDecorator:
    """Run a test with each of some robots."""
    names = [f"{one.geometry.knee.value} {one.geometry.body_scale}" for one in designs]
    return pytest.mark.parametrize("robot", designs, ids=names)


ROBOTS = each_of(robots())


def close(found: Any, wanted: Any) -> None:
    """Assert that lengths are those of the larger robot in another size."""
    np.testing.assert_allclose(found, TIMES * np.asarray(wanted), rtol=1e-9, atol=1e-12)


@ROBOTS
def test_frame_and_what_is_attached(robot: Design) -> None:
    small = enlarged(robot, TIMES)
    one, other = small.geometry, robot.geometry
    wanted = vars(layout(other))
    for name, length in vars(layout(one)).items():
        close(length, wanted[name])
    for function in (plinth_radius, plinth_outline, lift_motor_base, lift_motor_height):
        close(function(one), function(other))
    close(payload_offset(one), payload_offset(other))
    close(payload_center(one, small.payload.mass), payload_center(other, robot.payload.mass))
    for own, weight in zip(small.counterweights, robot.counterweights, strict=True):
        assert (stub(one, own) is None) == (stub(other, weight) is None)
        close(disc_radius(own.mass, one.body_scale), disc_radius(weight.mass, other.body_scale))


@ROBOTS
def test_needs(robot: Design) -> None:
    small = enlarged(robot, TIMES)
    k = np.array([robot.geometry.magnification])
    zeta, slider, diagonal = np.array([[0.03, 0.7]]), np.array([0.02]), np.array([[0.3, 0.9]])
    close(
        needed_guide(TIMES * slider, small.geometry.body_scale),
        needed_guide(slider, robot.geometry.body_scale),
    )
    close(needed_shaft(small, TIMES * zeta[:, 1], k), needed_shaft(robot, zeta[:, 1], k))
    both = [
        missing_room([each], times * slider, times * zeta, times * diagonal, times * 0.01)
        for each, times in ((small, TIMES), (robot, 1.0))
    ]
    assert (both[1] > 0).any()
    close(*both)


@pytest.mark.slow
@ROBOTS
def test_clearance(robot: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "least_distances", lambda _: kernels.compiled())
    small = enlarged(robot, TIMES)
    pose = random_poses(np.random.default_rng(1), robot, 40)
    near = pose * [TIMES, TIMES, 1.0, TIMES]
    found, wanted = clearance(small, near), clearance(robot, pose)
    assert found.pairs == wanted.pairs
    close(found.least, wanted.least)
    # Parallel bodies are nearest at many points.
    close(*(np.linalg.norm(np.diff(each.points, axis=1), axis=-1) for each in (found, wanted)))
    every = pair_clearance(robot, pose[:5])
    assert (every > 0).any()
    assert (every < 0).any()
    close(pair_clearance(small, near[:5]), every)
    # The three legs share their solids, of which capsules about bodies are made but once.
    legs = {body.name: body.solids for body in shapes_of(small).bodies}
    assert legs["B4 of leg 1"] is legs["B4 of leg 3"]


@pytest.mark.slow
@each_of(robots()[::3])
def test_meshes(robot: Design) -> None:
    """Of both robots, each with another knee: the plain ones of a page too, and the files of it."""
    small = enlarged(robot, TIMES)
    for body in (*STANDING, *BODIES[:10]):
        for fine in (True, False):
            with plain_shapes() if not fine else pytest.MonkeyPatch.context():
                one, other = make_body(small, body), make_body(robot, body)
            for a, b in zip(one.solids, other.solids, strict=True):
                assert a.material == b.material
                close(a.mesh.vertices, b.mesh.vertices)
                np.testing.assert_array_equal(a.mesh.faces, b.mesh.faces)
                np.testing.assert_allclose(a.mesh.vertex_normals, b.mesh.vertex_normals, atol=1e-6)
        small_glb, glb = (body_glb(each, body, fine=False) for each in (small, robot))
        assert abs(len(small_glb) - len(glb)) < 0.01 * len(glb)
        assert lengths_of(small, body) != lengths_of(robot, body)
    for own, weight in zip(small.counterweights, robot.counterweights, strict=True):
        close(
            counterweight(small.geometry, own).bounds(),
            counterweight(robot.geometry, weight).bounds(),
        )
    one, other = (
        payload_transform(each.geometry, each.payload.mass)[:3] for each in (small, robot)
    )
    close(one, other)


def test_bodies_of_lengths_that_stay_grow_about_their_joints() -> None:
    thin = APPENDIX_4.vary({"geometry.body_scale": 0.5}).geometry
    whole, half = (make_body(each, "leg1/b4").bounds() for each in (APPENDIX_4.geometry, thin))
    barrel = -whole[0, 0]
    assert half[0, 0] == pytest.approx(-barrel / 2)
    assert half[1, 0] == pytest.approx(thin.coupler_length + barrel / 2)
    assert half[1, 2] == pytest.approx(whole[1, 2] / 2)


def test_lengths_over_a_small_size_may_be_beyond_those_of_a_robot() -> None:
    tiny = APPENDIX_4.vary({"geometry.body_scale": 1e-4}).geometry
    assert geometry_over_scale(tiny).base_radius == pytest.approx(3500.0)
    assert layout(tiny).mast_radius > tiny.base_radius
    assert len(make_body(tiny, "ground").solids) < 600
    assert np.isfinite(make_body(tiny, "base").bounds()).all()
