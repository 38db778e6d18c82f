"""Masses and springs within the search: a trial has the best ones for its lengths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.balancing import CounterweightRange, SpringPlace, at_joint, on_slider
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import static_torques
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import Density
from paminsa_viz.synthesis.masses.case import InnerCase, MassFactor
from paminsa_viz.synthesis.search.case import UNLIMITED, ObjectiveLimit, Regime, SynthesisCase
from paminsa_viz.synthesis.search.evaluation import Evaluator
from paminsa_viz.synthesis.search.trial import Poses, Robots
from paminsa_viz.synthesis.search.trial_masses import trial_program
from paminsa_viz.trajectory import analyze, check_path
from paminsa_viz.trajectory.planners import arch, round_trip
from tests.synthesis.search_cases import CYLINDER, arch_case

NUMBERS = np.array([[0.31, 0.0801, 3.34, 0.37, 0.29, -0.235]])


def looser() -> SynthesisCase:
    """Return the arch with more force of M4, so that the masses have room."""
    case = arch_case()
    return replace(case, inner=replace(case.inner, motion_force=340.0))


def evaluated(case: SynthesisCase):
    """Evaluate the lengths of `NUMBERS`."""
    return Evaluator(case, Regime.SMALLER).evaluate(NUMBERS)[0]


def test_a_trial_has_the_best_masses_for_its_lengths():
    case = looser()
    found = evaluated(case)
    assert found.feasible
    trial = found.trial
    assert trial.inner.gap <= 1e-6 * found.objective
    # independent of the program: the motion at the workspace's center, analyzed with the design
    shift = np.array([0.0, 0.0, 0.0, -0.235])
    motion = replace(case.inner.motions[0], pose=case.inner.motions[0].pose + shift)
    torque = analyze(trial.design, motion).torque
    assert found.objective == pytest.approx(np.abs(torque[:, :3]).max(), rel=1e-6)
    assert np.abs(torque[:, 3]).max() <= 340.0 + 1e-6
    pose = trial.grid(case.requirements.theta, trial.heights())
    held = static_torques(trial.design, pose)[:, 3].max()
    assert found.worst[1] == pytest.approx(held, rel=1e-9)
    assert held <= 300.0
    # a mass that the program removed would not have helped
    assert trial.design.geometry == trial.geometry
    fixed = replace(case, inner=replace(case.inner, counterweights=()))
    assert evaluated(fixed).objective >= found.objective - 1e-9


def test_bounds_at_rest_are_those_of_the_requirements_and_can_be_tightened():
    case = looser()
    bounds = (Requirement("condition", high=10.0), Requirement("max_torque", high=1.5))
    case = replace(case, requirements=replace(case.requirements, bounds=bounds))
    found = evaluated(case)
    assert found.feasible
    assert found.worst[1] == pytest.approx(1.5, rel=1e-6)
    assert sum(w.mass for w in found.trial.design.counterweights) > 0.1
    tighter = Evaluator(case, Regime.SMALLER, tighter=(0.0, 0.5)).evaluate(NUMBERS)[0]
    assert tighter.worst[1] == pytest.approx(1.0, rel=1e-6)
    assert tighter.objective > found.objective
    tight = replace(case.requirements, bounds=(Requirement("f_4", high=100.0),))
    broken = evaluated(replace(case, requirements=tight))
    assert not broken.feasible
    assert 0.1 < broken.violation < 3.0


def test_the_program_of_a_trial_has_its_bounds_and_limits_a_little_tighter():
    """By what the solver rounds, at the heights and headings of each, the motion at its center."""
    part = Requirement("max_torque", high=1.5, z=(-0.2, 0.0), theta=(0.0, 0.1))
    bounds = (Requirement("condition", high=10.0), part, Requirement("f_4", high=400.0))
    limits = (
        ObjectiveLimit("moving_mass", 30.0), ObjectiveLimit("footprint", 0.9),
        ObjectiveLimit("energy", UNLIMITED),
    )  # fmt: skip
    case = replace(
        looser(), requirements=replace(looser().requirements, bounds=bounds), limits=limits
    )
    (trial,) = Robots.of(case, NUMBERS).trials(Poses(case), [0])
    for tighter in ((), (0.0, 0.1, 5.0), (0.0, 0.1, 5.0, 0.5, 0.01, 0.2)):
        program = trial_program(trial, tighter)
        by = [*tighter, *[0.0] * 6]
        expected = [1.5 - by[1], 400.0 - by[2], 340.0, 30.0 - by[3]]
        found = np.array([item.bound for item in program.limits])
        assert found == pytest.approx(expected, rel=1e-8)
        spare = np.array(expected) - found
        assert spare == pytest.approx([3e-9, 8e-7, 0.0, 6e-8], rel=1e-3, abs=1e-13)
    assert [item.label for item in program.limits[2:]] == [
        "force of M4 on the motions", "moving mass without payload"
    ]  # fmt: skip
    # the poses of the first are those within its part of the workspace, of the second all
    before = program.space.before
    first, second = (item.term.value(before) for item in program.limits[:2])
    held = static_torques(
        case.design(trial.geometry), trial.grid((0.0, 0.1), trial.heights((-0.2, 0.0)))
    )
    assert first == pytest.approx(np.abs(held[:, :3]).max())
    held = static_torques(
        case.design(trial.geometry), trial.grid(case.requirements.theta, trial.heights())
    )
    assert second == pytest.approx(held[:, 3].max())
    ((solved, _, _),) = program.motions
    shift = solved.trajectory.pose - case.inner.motions[0].pose
    assert np.abs(shift - [0.0, 0.0, 0.0, NUMBERS[0, -1]]).max() < 1e-12
    # what is relaxed is the goal, and no limit
    for index, place in ((1, 0), (2, 1), (3, 3)):
        relaxed = trial_program(trial, (), index)
        kept = [item.bound for i, item in enumerate(trial_program(trial).limits) if i != place]
        assert [item.bound for item in relaxed.limits] == kept
        expected = program.limits[place].term.value(before)
        assert relaxed.goal.value(before) == pytest.approx(expected)
    assert trial_program(trial, (), 0).key == "peak_torque"


def test_limits_on_other_goals_are_kept_by_the_masses():
    case = looser()
    bounds = (Requirement("max_torque", high=1.5),)
    # far out less mass does, near the joint it has less inertia
    weights = tuple(CounterweightRange("b8", 8, at, at, 9.0) for at in (0.1, 0.5))
    inner = replace(case.inner, counterweights=weights, motion_force=500.0)
    case = replace(case, requirements=replace(case.requirements, bounds=bounds), inner=inner)
    quick, light = evaluated(case), evaluated(replace(case, objective="moving_mass"))
    most = quick.trial.inner.value("moving_mass")
    assert most > light.objective + 0.1
    level = 0.5 * (most + light.objective)
    found = evaluated(
        replace(case, limits=(ObjectiveLimit("moving_mass", level), ObjectiveLimit("energy", 1e3)))
    )
    assert found.feasible
    assert quick.objective < found.objective < light.trial.inner.value("peak_torque")
    assert found.limits[0] == pytest.approx(level, rel=1e-6)
    assert found.limits[1] == pytest.approx(found.trial.inner.value("energy"))


@pytest.mark.slow
def test_a_bound_that_is_relaxed_is_minimized_by_the_masses():
    case = looser()
    bounds = (Requirement("max_torque", high=0.5), Requirement("f_4", high=500.0))
    requirements = replace(case.requirements, bounds=bounds)
    case = replace(case, inner=replace(case.inner, motion_force=None), requirements=requirements)
    light = evaluated(replace(case, objective="moving_mass")).objective
    short = replace(case, limits=(ObjectiveLimit("moving_mass", light - 0.5),))
    assert not evaluated(short).feasible
    found = Evaluator(short, Regime.SMALLER, relaxed=0).evaluate(NUMBERS)[0]
    assert found.feasible
    nearest = 0.5 + found.objective
    assert nearest == pytest.approx(found.worst[0])
    for factor, possible in ((1 + 1e-6, True), (1 - 1e-4, False)):
        moved = (replace(bounds[0], high=nearest * factor), bounds[1])
        again = replace(short, requirements=replace(requirements, bounds=moved))
        assert evaluated(again).feasible == possible
    found = Evaluator(short, Regime.SMALLER, relaxed=2).evaluate(NUMBERS)[0]
    assert light - 0.5 + found.objective == pytest.approx(light, rel=1e-6)
    limited = replace(case, requirements=replace(case.requirements, bounds=bounds[:1]))
    least = evaluated(limited).objective
    limited = replace(
        limited, objective="moving_mass", limits=(ObjectiveLimit("peak_torque", 0.1),)
    )
    found = Evaluator(limited, Regime.SMALLER, relaxed=1).evaluate(NUMBERS)[0]
    assert 0.1 + found.objective == pytest.approx(least, rel=1e-6)


def test_springs_count_in_bounds_at_rest():
    spring = SpringPlace(on_slider(0.2), at_joint(9), 2000.0, 0.0, 0.2)
    inner = InnerCase("moving_mass", (), springs=(spring,))
    bounds = (Requirement("max_torque", high=0.4), Requirement("f_4", high=400.0))
    case = replace(
        arch_case(), objective="footprint", inner=inner,
        requirements=replace(arch_case().requirements, bounds=bounds),
    )  # fmt: skip
    found = evaluated(case)
    assert found.feasible
    assert found.trial.inner.springs[0].stiffness > 1.0
    pose = found.trial.grid(case.requirements.theta, found.trial.heights())
    held = found.trial.inner.held(pose)
    assert found.worst[0] == pytest.approx(np.abs(held[:, :3]).max())
    assert found.worst[0] <= 0.4 + 1e-8
    assert np.abs(static_torques(found.trial.design, pose)[:, :3]).max() > 1.0
    assert found.objective == pytest.approx(found.trial.footprint)


def test_objectives_that_make_no_sense_are_refused():
    masses = (MassFactor("links.b8", 0.5, 2.0),)
    with pytest.raises(InvalidInput, match="M_p2 = 0"):
        replace(CYLINDER, objective="static_torque", inner=InnerCase("moving_mass", (), masses))
    with pytest.raises(InvalidInput, match="motion"):
        replace(CYLINDER, objective="peak_torque")
    with pytest.raises(InvalidInput, match="motion"):
        replace(CYLINDER, limits=(ObjectiveLimit("energy", 1.0),))
    bounded = InnerCase("moving_mass", (), masses, bounds=(Requirement("f_4", high=1.0),))
    with pytest.raises(InvalidInput, match="requirements"):
        replace(CYLINDER, inner=bounded)


ANSWER = {
    "geometry.base_radius": 0.30932129119695545,
    "geometry.platform_radius": 0.08000053704497243,
    "geometry.magnification": 3.4132757918120165,
    "geometry.crank_length": 0.3706458785491439,
    "geometry.coupler_length": 0.2782969084830305,
    "workspace.z": -0.2335830537890331,
}
"""What ``paminsa-viz synthesize arch`` finds with seed 0."""


@pytest.mark.slow
def test_the_answer_holds_and_no_robot_near_it_is_better():
    case = arch_case()
    best = np.array([ANSWER[path] for path in case.paths])
    found = Evaluator(case, Regime.SMALLER, Density().finer(2)).evaluate(best[None])[0]
    assert found.feasible
    assert found.objective == pytest.approx(2.8951, abs=1e-3)
    assert found.trial.inner.gap < 1e-6
    # at 1 kHz, analyzed with the design: between 200 samples a second there is hardly more
    turn, z = np.radians(30.0), ANSWER["workspace.z"]
    start, goal = (-0.15, 0.0, -turn, z - 0.05), (0.15, 0.0, turn, z - 0.05)
    motion = round_trip(arch(start, goal, 0.1, 1.0)).sample()
    design = found.trial.design
    assert check_path(design.geometry, motion).possible
    torque = np.abs(analyze(design, motion).torque)
    assert torque[:, :3].max() == pytest.approx(found.objective, rel=1e-3)
    assert torque[:, 3].max() < 300.0 * (1 + 2e-4)
    evaluator = Evaluator(case, Regime.SMALLER)
    steps = np.concatenate([np.diag(side * np.abs(best)) for side in (-0.01, 0.01, 0.003)])
    low, high = case.bounds.T
    near = evaluator.evaluate(np.clip(best + steps, low, high))
    values = [item.objective for item in near if item.feasible]
    assert len(values) >= 4
    assert min(values) > 0.99 * found.objective


def test_the_force_of_m4_on_the_motion_is_a_limit():
    case = arch_case()
    best = np.array([[ANSWER[path] for path in case.paths]])
    tight = replace(case, inner=replace(case.inner, motion_force=250.0))
    assert not Evaluator(tight, Regime.SMALLER).evaluate(best)[0].feasible
