"""N, V and M along the bars against sums of their loads by quadrature, and by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from paminsa_viz.elastostatics.bar_loads import (
    BAR_NAMES,
    PointLoad,
    all_bar_loads,
    arm_tip,
    bar_loads,
    largest_value,
    make_diagram,
    utilization,
)
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.dynamics import inverse_dynamics
from paminsa_viz.model.kinematics import LEG_AXES
from paminsa_viz.model.load import LoadCase
from paminsa_viz.model.parameters import BAR_ENDS
from paminsa_viz.model.reach import Limit, home_pose
from tests import oracle
from tests.elastostatics.test_joint_forces import EACH, loaded, states
from tests.support import samples

POSES = np.array([[0.05, -0.03, 0.2, -0.5], [0.0, 0.1, -0.1, -0.6]])
PANTOGRAPH = ("b3", "b4", "b7", "b8")
ON_BAR = {
    "b3": {"4": -1, "3": 1, "7": 1},
    "b4": {"9": 1, "4": 1, "5": -1},
    "b7": {"8_b7": 1, "7": -1},
    "b8": {"8_b8": 1, "9": -1},
}
PINS = {"b3": (3,), "b4": (4, 5), "b7": (7,), "b8": (9,)}


@EACH
def test_all_loads_of_a_bar_are_used_up_at_its_end(design: Design) -> None:
    forces = joint_forces(loaded(design), *states(design))
    largest = forces.magnitude.max()
    for loads in all_bar_loads(forces).values():
        assert np.abs(loads.residual).max() < 1e-12 * largest


def test_a_shaft_without_length_hangs_at_its_joint_with_its_mass() -> None:
    point = APPENDIX_4.vary({"geometry.shaft_length": 0.0})
    forces = joint_forces(point, home_pose(point.geometry), np.zeros(4), np.zeros(4))
    loads = bar_loads(forces, "b2")
    assert np.abs(loads.residual).max() < 1e-12 * forces.magnitude.max()
    assert np.abs(loads.extremes()).max() < 1e-12 * forces.magnitude.max()  # nothing within it
    whole = joint_forces(loaded(APPENDIX_4), home_pose(APPENDIX_4.geometry))
    for bar, other in all_bar_loads(whole).items():
        assert (np.diff(other.places) > 0).all(), bar  # no place is there twice
        np.testing.assert_allclose(other.places[..., [0, -1]], np.tile([0.0, other.length], (3, 1)))


@pytest.mark.parametrize("bar", PANTOGRAPH)
@EACH
def test_sections_against_quadrature(design: Design, bar: str) -> None:
    """Sum up everything before a cut: mass elements of a moving bar, pins and joint forces."""
    motion = states(design, 5)
    forces = joint_forces(design, *motion)
    q = oracle.jets(*motion)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    mass, inertias = getattr(design.links, bar), design.inertias
    across, axial = (getattr(inertias, f"{bar}_{name}") for name in ("transverse", "axial"))
    shares = np.array([0.2, 0.45, 0.9])
    loads = bar_loads(forces, bar)
    found = loads.at(shares * loads.length)
    for leg in range(3):
        solved = oracle.leg(design, q, leg)
        heading, normal = oracle.value(solved.heading), oracle.value(solved.normal)
        first, last = (solved.points[number] for number in BAR_ENDS[bar])
        axis = oracle.unit(oracle.add(last, first, -1.0))
        e = plane(oracle.value(axis), heading)
        n = np.stack([-e[:, 1], e[:, 0]], -1)
        # couple of the inertia beyond a thin bar's, by Euler's equations of that difference
        thin = mass * loads.length**2 / 12
        body = oracle.Body(
            bar, 0.0, first,
            (axis, solved.normal, oracle.cross(axis, solved.normal)),
            (axial, across - thin, across - thin),
        )  # fmt: skip
        w = oracle.turning(body)
        rate = oracle.rotated(body, oracle.turning(body, oracle.second))
        couple = oracle.dot(oracle.add(rate, oracle.cross(w, oracle.rotated(body, w))), normal)

        def force(mass: float, share: Any, first: Any = first, last: Any = last) -> Any:
            point = oracle.between(first, last, share)
            linear = oracle.add(oracle.second(point), oracle.UP, design.gravity)
            return -mass * plane(linear, heading)  # noqa: B023

        for index, share in enumerate(shares):
            total, moment = np.zeros_like(e), share * couple
            parts = [
                (
                    0.5 * share * (node + 1),
                    force(mass * 0.5 * share * weight, 0.5 * share * (node + 1)),
                )
                for node, weight in zip(nodes, weights, strict=True)
            ]
            places = {BAR_ENDS[bar][0]: 0.0, BAR_ENDS[bar][1]: 1.0}
            k = design.geometry.magnification
            places |= {"b3": {3: 1 - 1 / k}, "b4": {4: 1 / k}}.get(bar, {})
            for pin in PINS[bar]:
                parts.append((places[pin], force(getattr(design.joints, f"j{pin}"), places[pin])))
            for key, sign in ON_BAR[bar].items():
                at_joint = forces.force[:, leg, JOINT_INDEX[key]][:, [0, 2]]
                parts.append((places[int(key[0])], sign * at_joint))
            for place, part in parts:
                if place <= share:
                    total = total + part
                    moment = moment + (place - share) * loads.length * (part * n).sum(-1)
            expected = [-(total * e).sum(-1), (total * n).sum(-1), -moment]
            size = np.abs(forces.magnitude).max()
            np.testing.assert_allclose(
                found[:, leg, index], np.stack(expected, -1), rtol=0, atol=1e-12 * size
            )


def plane(vector: Any, heading: Any) -> Any:
    return np.stack(np.broadcast_arrays(oracle.dot(vector, heading), vector[2]), -1)


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_largest_value_of_any_polynomials_is_that_of_dense_samples(degree: int) -> None:
    rng = np.random.default_rng(degree)
    places = np.cumsum(rng.uniform(0.1, 1.0, (60, 4)), axis=1)
    coefficients = rng.standard_normal((60, 3, 4))
    coefficients[..., degree + 1 :] = 0.0
    value, place = largest_value(places, coefficients)
    for row in range(60):
        start, stop = places[row, :-1, None], places[row, 1:, None]
        x = np.linspace(0.0, 1.0, 5001) * (stop - start)
        dense = np.stack(
            [np.polyval(c[::-1], each) for c, each in zip(coefficients[row], x, strict=True)]
        )
        best = np.unravel_index(np.abs(dense).argmax(), dense.shape)
        assert value[row] == pytest.approx(dense[best], rel=1e-6)
        if degree:
            assert place[row] == pytest.approx((start + x)[best], abs=2e-3)


def test_rounding_chooses_none_of_two_shears_that_are_alike() -> None:
    """A bar between two pins, bent by its weight alone, has V of one size at both ends."""
    poses = samples.random_poses(np.random.default_rng(7), APPENDIX_4, 50)
    for bar in ("b7", "b8"):
        loads = bar_loads(joint_forces(APPENDIX_4, poses), bar)
        shear, place = (found[..., 0] for found in loads.largest((1,)))
        assert shear == pytest.approx(-loads.at([loads.length])[..., 0, 1], rel=1e-9)
        assert (place == 0).all()


@pytest.mark.slow
@EACH
def test_extremes_are_those_of_dense_samples(design: Design) -> None:
    forces = joint_forces(loaded(design), *states(design, 4))
    for loads in all_bar_loads(forces).values():
        s = np.linspace(0, loads.length, 2001)
        dense = np.abs(loads.at(s))
        value, place = loads.largest()
        size = np.abs(value).max(axis=(0, 1))
        assert (dense.max(axis=-2) <= np.abs(value) + 1e-12 * size).all()
        assert (np.abs(value) <= dense.max(axis=-2) + 2e-3 * size).all()
        assert ((place >= 0) & (place <= loads.length)).all()
        for index in range(3):
            s, each = place[..., index].ravel(), np.arange(12)
            sides = [loads.at(s - gap).reshape(12, 12, 3)[each, each, index] for gap in (0, 1e-9)]
            reached = np.abs(sides).max(axis=0)  # where it jumps, on one of both sides
            wanted = np.abs(value[..., index]).ravel()
            np.testing.assert_allclose(reached, wanted, rtol=0, atol=1e-6 * size[index])


def test_at_a_joint_the_load_is_the_one_beyond_it() -> None:
    forces = joint_forces(loaded(APPENDIX_4), *states(APPENDIX_4, 4))
    for bar in PANTOGRAPH:
        loads = bar_loads(forces, bar)
        for place in loads.places[0, 0, 1:-1]:
            before, at, beyond = np.moveaxis(loads.at(place + np.array([-1e-9, 0.0, 1e-9])), 2, 0)
            size = np.abs(at).max()
            np.testing.assert_allclose(at, beyond, atol=1e-6 * size)
            assert np.abs(at[..., :2] - before[..., :2]).max() > 1e-3 * size


def test_a_vertical_force_at_home_by_hand() -> None:
    """B2: tension, bending by the radial force; B10: a cantilever from the leg axis."""
    forces = joint_forces(APPENDIX_4, (0.0, 0.0, 0.0, -0.5))
    g, links = APPENDIX_4.geometry, APPENDIX_4.links
    radial, _, vertical = forces.of("3")[0]
    shaft = bar_loads(forces, "b2")
    top = shaft.at(np.array([0.0, g.shaft_length * (1 - 1e-12)]))[0]
    assert top[0, 0] == pytest.approx(vertical)
    assert top[1, 0] == pytest.approx(vertical + links.b2 * APPENDIX_4.gravity)
    # the radial force on B3 is +, on the shaft's lower end -: it bends hollow toward n = -r
    assert top[1, 2] == pytest.approx(radial * g.shaft_length)
    guide = forces.of("guide")[0, 2]
    reach = (g.base_radius - g.platform_radius) / (g.magnification - 1)
    root = bar_loads(forces, "b10").at(np.array([g.guide_link_length * (1 - 1e-12)]))[0, 0]
    weight = links.b10 * APPENDIX_4.gravity
    assert root[2] == pytest.approx(-guide * reach - weight * g.guide_link_length / 2)


@pytest.mark.parametrize("length", [0.3635, 0.1])
def test_guide_links_carry_the_slider_wherever_it_is(length: float) -> None:
    """A short one on an extension beyond its free end; their own weight and turning besides."""
    design = APPENDIX_4.vary(
        {"geometry.guide_link_length": length, "geometry.guide_stroke": 0.3635}
    )
    forces = joint_forces(design, *states(APPENDIX_4, 6))
    guide, bodies = forces.of("guide")[..., 2], forces.bodies
    slider = length - bodies.position.rho / (design.geometry.magnification - 1)
    assert (slider < 0).any() == (length < 0.3)
    mass, rate = design.links.b10 / length, bodies.motion.beta_rate
    s = np.linspace(0.0, length, 50)[1:-1]
    past = np.maximum(s - slider[..., None], 0.0)
    expected = [
        mass * rate[..., None] ** 2 * (length * s - s**2 / 2),
        -mass * design.gravity * s - guide[..., None] * (past > 0),
        -mass * design.gravity * s**2 / 2 - guide[..., None] * past,
    ]
    found = bar_loads(forces, "b10").at(s)
    np.testing.assert_allclose(found, np.stack(expected, -1), rtol=0, atol=1e-9)


def test_an_arm_without_length_hangs_at_the_carriage_with_its_mass() -> None:
    design = APPENDIX_4.vary({"geometry.arm_length": 0.0})
    forces = joint_forces(design, POSES)
    shear = bar_loads(forces, "b1").extremes()[..., 1]
    weight = design.links.b1 * design.gravity
    np.testing.assert_allclose(shear, arm_tip(forces).up - weight, rtol=1e-12)


def test_what_nothing_holds_is_left_behind_the_end() -> None:
    along, across, couple = np.random.default_rng(0).normal(size=(3, 2, 3))
    points = [PointLoad(0.25, along, across, couple)]
    loads = make_diagram((2, 3), "b4", 1.0, points, (0.0, 0.0, 0.0, 0.0), 0.0)
    expected = np.stack([-along, across, 0.75 * across - couple], -1)
    np.testing.assert_allclose(loads.residual, expected, rtol=1e-12)


def test_arms_carry_the_shafts_force_and_moment_at_home() -> None:
    """At home the leg's plane is the arm's: no sideways force, no torsion."""
    forces = joint_forces(replace(APPENDIX_4, load=LoadCase(force_z=-50.0)), (0.0, 0.0, 0.0, -0.5))
    tip = arm_tip(forces)
    np.testing.assert_allclose(tip.sideways, 0.0, atol=1e-12)
    np.testing.assert_allclose(tip.torsion, 0.0, atol=1e-12)
    radial, _, vertical = forces.of("2")[0]
    g, links = APPENDIX_4.geometry, APPENDIX_4.links
    weight = links.b1 * APPENDIX_4.gravity
    arm = bar_loads(forces, "b1").at(np.array([g.arm_length]))[0, 0]
    moment = forces.moment[0, JOINT_INDEX["2"]]
    assert arm[0] == pytest.approx(radial)
    assert arm[1] == pytest.approx(-vertical - weight)
    assert arm[2] == pytest.approx(moment - g.arm_length * vertical - weight * g.arm_length / 2)


@EACH
def test_the_load_on_an_arm_is_what_the_shaft_hands_on(design: Design) -> None:
    """The force and the moment of joint 2 in the leg's plane, split along the arm's own axes."""
    forces = joint_forces(loaded(design), *states(design))
    tip, two = arm_tip(forces), forces.of("2")
    moment = forces.moment[..., JOINT_INDEX["2"]]
    bodies = forces.bodies.position
    inward = -LEG_AXES
    across = np.stack([-inward[:, 1], inward[:, 0]], axis=-1)  # z x e
    plane = np.stack([bodies.ux, bodies.uy], axis=-1)  # of the leg, as r
    force = -two[..., 0, None] * plane
    np.testing.assert_allclose(tip.along, (force * inward).sum(axis=-1), atol=1e-9)
    np.testing.assert_allclose(tip.sideways, (force * across).sum(axis=-1), atol=1e-9)
    np.testing.assert_allclose(tip.up, -two[..., 2], atol=1e-9)
    # about the normal of the leg's plane, which is that of the arm's turned with it
    np.testing.assert_allclose(np.hypot(tip.bending, tip.torsion), np.abs(moment), atol=1e-9)
    np.testing.assert_allclose(tip.bending, -moment * (plane * inward).sum(axis=-1), atol=1e-9)
    np.testing.assert_allclose(tip.torsion, -moment * (plane * across).sum(axis=-1), atol=1e-9)


def test_unknown_bars_are_refused() -> None:
    forces = joint_forces(APPENDIX_4, (0.0, 0.0, 0.0, -0.5))
    assert set(all_bar_loads(forces)) == set(BAR_NAMES)
    with pytest.raises(InvalidInput, match="b4"):
        bar_loads(forces, "b5")


@pytest.mark.slow
@given(design=samples.possible_designs())
@settings(max_examples=10)
def test_any_possible_design_is_in_equilibrium_or_has_a_reason(design: Design) -> None:
    """Extreme masses and lengths, none at all among them: torques, used-up loads, utilization."""
    poses = home_pose(design.geometry) + np.array([[0.0, 0.0, 0.0, 0.0], [0.01, -0.02, 0.1, 0.01]])
    forces = joint_forces(design, poses)
    expected = inverse_dynamics(design, poses, np.zeros(4), np.zeros(4))
    np.testing.assert_array_equal(forces.status, expected.status)
    good = forces.status == Limit.OK
    assert np.isnan(forces.torque[~good]).all()
    if not good.any():
        return
    largest = forces.magnitude[good].max() * (1 + design.geometry.shaft_length)
    scale = largest + np.abs(expected.torque[good]).max()
    assert np.abs(forces.torque[good] - expected.torque[good]).max() <= 1e-9 * scale
    for loads in all_bar_loads(forces).values():
        assert np.abs(loads.residual[good]).max() <= 1e-9 * scale * max(1.0, loads.length)
    assert np.isfinite(utilization(forces)[good]).all()
