"""Parts of the program of masses: what cases refuse, motions at their samples, what is active."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import MassRange, SpringPlace, at_joint, on_slider
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, LoadCase, check_reach
from paminsa_viz.model.parameters import LARGEST
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singularity import singular_radius, singular_rotation
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor, check_inner, linear_bounds
from paminsa_viz.synthesis.masses.program import inner_contradiction, inner_program, solve_inner
from paminsa_viz.synthesis.masses.space import (
    InnerInfeasible,
    inner_space,
    limits_at_rest,
    sampled_solution,
    static_rows,
)
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.trajectory.planners import point_to_point
from tests.synthesis.inner_cases import MASSES, SPRING, WEIGHTS, case, motion, poses


def still(**changes: Any) -> InnerCase:
    return InnerCase(**{"goal": "moving_mass", "masses": MASSES} | changes)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: MassFactor("links.b3", -0.1, 1.0), "links.b3: factors 0 <= low <= high <= 10000"),
        (lambda: MassFactor("links.b3", 1.1, 1.0), "not 1.1 to 1.0"),
        (lambda: MassFactor("links.b3", 0.5, 10000.1), "0 <= low <= high <= 10000"),
        (lambda: still(goal="max_torque"), "choose peak_torque, energy, moving_mass"),
        (lambda: still(goal="rms_torque"), "M_p2 = 0"),
        (lambda: still(goal="static_torque", masses=()), "are known, not 'static_torque'"),
        (lambda: still(goal="energy"), "motions: the driving energy on the motions needs at least"),
        (lambda: still(most=(("peak_torque", 3.0),)), "motions: the peak torque of M1-M3"),
        (lambda: still(most=(("beauty", 3.0),)), "not 'beauty'"),
        (
            lambda: still(bounds=(Requirement("max_torque", low=0.5, high=1.0),)),
            "max_torque: a least value is no convex limit",
        ),
        (lambda: still(bounds=(Requirement("condition", low=1.0),)), "masses and springs decide"),
        (lambda: still(motions=(motion(),), motion_torque=-0.1), "motion_torque: a finite number"),
        (lambda: still(motions=(motion(),), motion_force=np.inf), "motion_force: a finite number"),
        (lambda: still(motion_torque=3.0), "motion_torque: there is no motion that it limits"),
        (lambda: still(masses=(*MASSES, MASSES[0])), "links.b3: this mass is free twice"),
        (lambda: check_inner(still(bounds=(Requirement("f_4", high=1.0),)), ()), "inner.bounds"),
        (lambda: check_inner(still(), ("footprint", "static_torque")), "M_p2 = 0"),
        (lambda: check_inner(None, ("footprint", "energy")), "needs at least one motion"),
        (lambda: check_inner(still(), ("peak_torque",)), "needs at least one motion"),
    ],
    ids=count(),
)  # fmt: skip
def test_what_makes_no_sense_of_masses_and_motions_is_refused(make: Any, words: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        make()
    assert words in str(caught.value)


def test_what_is_just_possible_is_taken() -> None:
    for low, high in ((0.0, 0.0), (0.3, 0.3), (0.0, LARGEST["kg"])):
        assert MassFactor("links.b3", low, high).high == high
    moving = still(motions=(motion(),), motion_torque=0.0, motion_force=0.0)
    assert moving.motion_force == 0.0
    kept = (Requirement("max_torque", low=0.0, high=1.0), Requirement("tau_1", low=0.5))
    assert still(bounds=kept).bounds == kept
    assert linear_bounds([*kept, Requirement("max_torque", low=0.0)]) == kept
    fixed = replace(still(), masses=())
    assert [one.free for one in (
        fixed, still(), replace(fixed, counterweights=WEIGHTS), replace(fixed, springs=(SPRING,))
    )] == [False, True, True, True]  # fmt: skip
    # nothing is free, or nothing is asked of motions
    check_inner(None, ("footprint", "static_torque", "moving_mass"))
    check_inner(fixed, ("static_torque",))
    check_inner(moving, ("peak_torque", "energy", "footprint"))


def test_masses_are_free_in_parts_of_the_design_or_in_kilograms() -> None:
    given = MassRange("joints.j9", 0.1, 0.2)
    design = APPENDIX_4.vary({"links.b3": 2.0})
    part = MassFactor("links.b3", 0.25, 3.0, inertia_follows=False)
    found = still(masses=(part, given), counterweights=WEIGHTS).changes(design)
    assert found.masses == (MassRange("links.b3", 0.5, 6.0, inertia_follows=False), given)
    assert found.counterweights == WEIGHTS
    assert MassFactor("links.b3", 0.5, 1.0).of(design).inertia_follows


def test_motions_about_a_center_go_where_it_is() -> None:
    moving = still(motions=(motion(),))
    center = np.array([0.1, -0.2, -0.4])
    assert moving.placed(center) is moving
    (placed,) = replace(moving, from_center=True).placed(center).motions
    shift = placed.pose - motion().pose
    assert np.abs(shift - [0.1, -0.2, 0.0, -0.4]).max() < 1e-12
    once = replace(moving, from_center=True).placed(center)
    assert once.placed(center) is once


# ---------------------------------------------------------------- motions at their samples


def line(start: Any, goal: Any, rate: float = 21) -> Trajectory:
    return point_to_point(start, goal, 1.0).sample(rate)


G = replace(APPENDIX_4.geometry, crank_length=0.9, coupler_length=0.9, guide_link_length=2.0)
TURN = float(singular_rotation(G))


@pytest.mark.parametrize(
    ("geometry", "path", "limit"),
    [
        (G, line((0.0, 0.0, 0.0, -0.8), (0.1, 0.05, 0.3, -0.9)), None),
        (G, line((0.0, 0.0, 0.0, -0.8), (0.0, 0.0, 0.0, -1.9)), Limit.STRETCHED),
        (G, line((0.0, 0.0, 0.0, -0.8), (0.5, 0.1, 0.1, -0.8)), Limit.SINGULAR),
        (G, line((0.5, 0.1, 0.1, -0.8), (0.0, 0.0, 0.0, -0.8)), Limit.SINGULAR),
        # at the second of three samples already
        (G, line((0.0, 0.0, 0.0, -0.5), (0.7, 0.0, 0.0, -0.5), 2), Limit.SINGULAR),
        (G, line((0.0, 0.0, 0.0, -0.5), (0.0, 0.0, 2.2 * TURN, -0.5), 2), Limit.SINGULAR),
        (G, line((0.0, 0.0, 0.0, -0.8), (0.0, 0.0, TURN + 0.2, -0.8)), Limit.SINGULAR),
        (G, line((0.0, 0.0, 0.0, -0.8), (0.0, 0.0, -TURN - 0.2, -0.8)), Limit.SINGULAR),
        # a whole turn further, as headings of a table may be
        (G, line((0.0, 0.0, 2 * np.pi, -0.8), (0.0, 0.0, 2 * np.pi - TURN - 0.2, -0.8)),
         Limit.SINGULAR),
        (
            replace(G, base_radius=0.1, platform_radius=0.35, arm_length=0.1),
            line((0.0, 0.0, -0.2, -0.8), (0.05, 0.0, 1.9, -0.8)), None,
        ),
    ],
)  # fmt: skip
def test_a_motion_is_judged_at_its_samples(
    geometry: Any, path: Trajectory, limit: Limit | None
) -> None:
    """Where joints reach, and on which side of the singular circle and turn it began."""
    found = sampled_solution(geometry, path, 9.0)
    reach = check_reach(geometry, path.pose)
    x, y, theta, _ = path.pose.T
    circle = singular_radius(geometry, theta) - np.hypot(x, y)
    inside = (circle > 0) == (circle[0] > 0)
    turn = singular_rotation(geometry)
    if np.isfinite(turn):
        before = np.cos(theta) > np.cos(turn)
        inside &= before == before[0]
    good = reach.ok & inside
    check = found.check
    assert (check.status == Limit.OK).tolist() == good.tolist()
    assert (check.first is None) == good.all() == (limit is None)
    least = reach.margins.reshape(len(path.t), -1).min(axis=1)
    at = int(np.argmin(least)) if limit is None else int(np.flatnonzero(~good)[0])
    assert at > 0
    assert check.until == (len(path.t) if limit is None else at)
    event = check.closest
    assert check.first in (None, event)
    assert (event.t, event.pose) == (path.t[at], pytest.approx(path.pose[at]))
    assert event.limit is (limit or Limit.OK)
    if limit is Limit.SINGULAR:
        assert event.leg == -1
        assert event.margin == pytest.approx(-abs(circle[at]))
    else:
        assert event.margin == pytest.approx(least[at])
        assert (event.margin < 0) == (limit is not None)
    if limit is not None:
        assert event.leg == reach.leg[at]
    assert check.side == (1.0 if circle[0] > 0 else -1.0, 1.0)
    assert np.isfinite(found.speed).all(axis=1).tolist() == good.tolist()
    assert np.isfinite(found.y).reshape(len(path.t), -1).all(axis=1).tolist() == good.tolist()
    assert found.gravity == 9.0


# ---------------------------------------------------------------- bounds at rest


@pytest.mark.parametrize("springs", [(), (SPRING,)])
@pytest.mark.parametrize("load", [LoadCase(), LoadCase(force_x=30.0, moment_z=-4.0)])
def test_a_bound_at_rest_is_the_extreme_of_all_its_poses(load: LoadCase, springs: Any) -> None:
    """Of any masses, out of balance to either side; where only that counts two poses are enough."""
    design = replace(APPENDIX_4, load=load)
    space = inner_space(design, still(counterweights=WEIGHTS).changes(design), springs)
    pose = poses()[::5]
    matrix, offset = static_rows(space, pose)
    assert (matrix.shape, offset.shape) == ((len(pose), 4, len(space.start)), (len(pose), 4))
    rng = np.random.default_rng(3)
    spread = np.where(np.arange(len(space.before)) < space.first_spring, 3.0, 3000.0)
    for _ in range(6):
        state = space.before + spread * rng.normal(size=len(spread))
        held = matrix @ state + offset
        for column, name in enumerate(("tau_1", "tau_2", "tau_3", "f_4")):
            high, low = limits_at_rest(space, Requirement(name, low=-1.0, high=2.0), pose)
            assert high.term.value(state) == pytest.approx(held[:, column].max())
            assert low.term.value(state) == pytest.approx(-held[:, column].min())
            (both,) = limits_at_rest(space, Requirement(name, low=-2.0, high=2.0), pose)
            assert both.term.value(state) == pytest.approx(np.abs(held[:, column]).max())
        (most,) = limits_at_rest(space, Requirement("max_torque", low=0.0, high=2.0), pose)
        assert most.term.value(state) == pytest.approx(np.abs(held[:, :3]).max())
    beyond = np.vstack([pose, [[0.0, 0.0, 0.0, -2.0]]])
    with pytest.raises(InnerInfeasible, match="out of reach"):
        limits_at_rest(space, Requirement("tau_1", high=1.0), beyond)


def test_the_largest_torque_on_motions_is_that_of_any_of_three_actuators() -> None:
    asked = still(motions=(motion(),), motion_torque=3.0, motion_force=200.0)
    program = inner_program(APPENDIX_4, asked, poses())
    torque, force = program.limits
    matrix, offset = program.motions[0][1:]
    rng, before = np.random.default_rng(5), program.space.before
    for actuator in range(4):  # its own part of the state's effect, and an offset of its own
        term = force.term if actuator == 3 else torque.term
        held = {tuple(row) for row in term.matrix.tolist()}
        assert held >= {tuple(row) for row in matrix[:, actuator].tolist()}
    for _ in range(4):
        state = before + 3.0 * rng.normal(size=len(before))
        size = np.abs(matrix @ state + offset).max(axis=0)
        assert torque.term.value(state) == pytest.approx(size[:3].max())
        assert force.term.value(state) == pytest.approx(size[3])


# ---------------------------------------------------------------- what an answer says


def test_what_is_active_has_its_unit_and_the_highest_price_comes_first() -> None:
    """Stiffness is no mass; limits with room have no price."""
    spring = SpringPlace(on_slider(0.3), at_joint(9), 50.0, 0.0, 0.2)
    asked = replace(case(springs=True), springs=(spring,))
    began = time.perf_counter()
    found = solve_inner(APPENDIX_4, asked, poses())
    assert 0.0 < found.seconds <= time.perf_counter() - began
    prices = [item.price for item in found.active]
    assert prices == sorted(prices, reverse=True)
    assert min(prices) > 0.0
    units = {item.name: item.unit for item in found.active}
    stiff = {v.name for v in found.program.space.variables[-1:]}
    assert stiff & units.keys()
    for name, unit in units.items():
        if name in stiff:
            assert unit == "N/m"
        elif name not in {item.label for item in found.program.limits}:
            assert unit in ("kg", "m")
    for item in found.program.limits:
        room = item.limit - item.term.value(found.solution.state)
        assert room > -1e-6
        if room > 1e-3 * abs(item.limit):
            assert item.label not in units
    assert found.value("peak_torque") == found.objective
    mass = found.value("moving_mass")
    assert mass == pytest.approx(solve_inner(found.design, still(masses=()), poses()).objective)
    assert replace(found, lower_bound=found.objective + 1e-9).gap == 0.0
    assert replace(found, lower_bound=found.objective - 0.25).gap == pytest.approx(0.25)


def test_the_nearest_value_of_a_least_one_and_of_what_does_not_help() -> None:
    low, high = Requirement("f_4", low=260.0), Requirement("f_4", high=240.0)
    bounds = (low, high, Requirement("max_torque", high=50.0))
    asked = still(bounds=bounds, counterweights=WEIGHTS)
    found = inner_contradiction(inner_program(APPENDIX_4, asked, poses()))
    assert found is not None
    assert [item.requirement for item in found.limits] == [low, high]
    down, up = found.relax
    assert down.bound is not None
    assert up.bound is not None
    assert down.bound < 260.0
    assert up.bound > 240.0
    for share, possible in ((1e-6, True), (-1e-4, False)):
        for moved in (
            (replace(low, low=down.bound * (1 - share)), high),
            (low, replace(high, high=up.bound * (1 + share))),
        ):
            again = inner_program(APPENDIX_4, replace(asked, bounds=moved), poses())
            assert (inner_contradiction(again) is None) is possible
    # each of two by itself is too much for all masses: no bound of the first helps
    more = replace(asked, bounds=(replace(high, high=150.0), replace(low, low=900.0)))
    found = inner_contradiction(inner_program(APPENDIX_4, more, poses()))
    assert found is not None
    assert [item.requirement for item in found.limits] == [more.bounds[0]]
    assert [(item.bound, item.gap) for item in found.relax] == [(None, 0.0)]
