"""Counterweights anywhere on a bar agree with first principles and independent engines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.engines.pinocchio_model import PinocchioRobot
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    InvalidDesign,
    KneeBranch,
    inverse_dynamics,
    kinetic_energy,
    lumped_coefficients,
    potential_energy,
    regressor_torques,
    static_breakdown,
    static_torques,
    torque_regressor,
)
from tests import oracle
from tests.balancing.weighted import on_the_bars, random_weights
from tests.support.cases import BOTH, Case, assert_close, cases
from tests.support.samples import with_knee

pytestmark = pytest.mark.slow


def weighted(case: Case) -> Design:
    """The case's robot with random counterweights."""
    weights = random_weights(np.random.default_rng(case.seed))
    return replace(case.design, counterweights=weights)


@given(case=cases())
def test_torques_and_energies_are_those_of_first_principles(case: Case) -> None:
    design = weighted(case)
    states = pose, velocity, _ = case.states()
    with on_the_bars():
        expected = oracle.inverse_dynamics(design, *states)
        kinetic, potential = oracle.kinetic(design, pose, velocity), oracle.potential(design, pose)
        static = oracle.static_torques(design, pose)
    assert_close(inverse_dynamics(design, *states).torque, expected, 1e-10)
    y = torque_regressor(design.geometry, *states, gravity=design.gravity)
    assert_close(regressor_torques(y, lumped_coefficients(design)), expected, 1e-10)
    np.testing.assert_allclose(kinetic_energy(design, pose, velocity), kinetic, rtol=1e-12)
    np.testing.assert_allclose(potential_energy(design, pose), potential, rtol=1e-12, atol=1e-11)
    parts = static_breakdown(design, pose)
    assert_close(static_torques(design, pose), static, 1e-10)
    assert_close(parts.total, static, 1e-10)
    weights = tuple(f"counterweights.{i}.mass" for i in range(len(design.counterweights)))
    assert parts.names[-len(weights) :] == weights


@BOTH
@pytest.mark.parametrize(
    ("engine", "library"), [(MujocoRobot, "mujoco"), (PinocchioRobot, "pinocchio")]
)
def test_torques_are_those_of_the_engines(engine, library: str, knee: KneeBranch) -> None:
    pytest.importorskip(library, reason=f"{library} comes with the extra 'verify'")
    for seed in range(3):
        case = Case(seed, knee)
        design = weighted(case)
        states = case.states()
        found = engine(with_knee(design, knee)).inverse_dynamics(*states)
        assert_close(found, inverse_dynamics(with_knee(design, knee), *states).torque, 1e-9)


def test_a_mass_at_a_joint_is_a_joint_mass() -> None:
    plain = APPENDIX_4.vary({"joints.j7": APPENDIX_4.joints.j7 + 1.5})
    for bar, joint, beyond in (("b3", 7, 0.0), ("b7", 7, 0.0), ("b3", 4, -0.42), ("b7", 8, -0.21)):
        weight = Counterweight(bar, joint, beyond, 1.5)
        design = replace(APPENDIX_4, counterweights=(weight,))
        np.testing.assert_allclose(
            lumped_coefficients(design), lumped_coefficients(plain), rtol=1e-13, atol=1e-13
        )


def test_values_by_path() -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.0), Counterweight("b3", 7, -0.05, 2.0))
    design = replace(APPENDIX_4, counterweights=weights)
    assert design.value("counterweights.1.beyond") == -0.05
    changed = design.vary({"counterweights.0.mass": 3, "counterweights.1.mass": 4, "links.b3": 1})
    assert [weight.mass for weight in changed.counterweights] == [3.0, 4.0]
    assert changed.links.b3 == 1.0
    assert changed != design
    assert hash(changed) == hash(replace(changed))
    assert weights[1].other == 4
    assert weights[0].place == "B8, 100 mm beyond joint 8"
    assert weights[1].place == "B3, 50 mm before joint 7"


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Counterweight("b5", 8), "counterweight.bar"),
        (lambda: Counterweight("b8", 7), "counterweight.joint"),
        (lambda: Counterweight("b8", 8, 0.1, -1.0), "counterweight.mass"),
        (lambda: Counterweight("b8", 8, np.nan, 1.0), "counterweight.beyond"),
        (lambda: replace(APPENDIX_4, counterweights=(1.0,)), "counterweights.0"),
        (lambda: APPENDIX_4.vary({"counterweights.0.mass": 1.0}), "counterweights.0.mass"),
        (lambda: APPENDIX_4.vary({"counterweights": 1.0}), "counterweights"),
    ],
)
def test_impossible_counterweights_are_rejected(make, field: str) -> None:
    with pytest.raises(InvalidDesign) as caught:
        make()
    assert caught.value.field == field
