"""Drives: their limits, and what their inertia and friction add to the robot's dynamics."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import Changes, MassRange, TrajectoryPeak, optimize
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.engines.pinocchio_model import PinocchioRobot
from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    actuator_acceleration,
    actuator_velocity,
    drive_regressor,
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    inverse_jacobian,
    kinetic_energy,
    lumped_coefficients,
    mass_matrix,
    platform_wrench,
    regressor_torques,
    torque_breakdown,
    torque_regressor,
)
from paminsa_viz.model.drive import NO_DRIVES, Drive
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    analyze,
    simulate,
    solve_trajectory,
)
from tests.support import samples
from tests.support.cases import Case, assert_close, cases

ROTARY = Drive("motor, gear", 4e-6, 1e-6, 100.0, 0.8, viscous=2e-6, coulomb=4e-3)
SCREW = Drive(
    "axis", 2e-5, 3e-6, 2.0, viscous=1e-5, coulomb=0.02, transmission="screw", lead=0.01,
    lead_efficiency=0.9,
)  # fmt: skip
DRIVES = (ROTARY, replace(ROTARY, gear_ratio=50.0), replace(ROTARY, rotor_inertia=1e-5), SCREW)


def driven(design: Design, *, rubs: bool = True) -> Design:
    found = replace(design, drives=DRIVES)
    return found if rubs else found.without_friction()


def test_a_screw_turns_its_lead_into_a_ratio() -> None:
    assert SCREW.ratio == pytest.approx(2.0 * 2 * math.pi / 0.01)
    assert SCREW.reflected_inertia == pytest.approx(2.3e-5 * SCREW.ratio**2)
    assert SCREW.total_efficiency == pytest.approx(0.9)
    assert ROTARY.reflected_inertia == pytest.approx(5e-6 * 1e4)


@pytest.mark.parametrize("drive", DRIVES, ids=["M1", "M2", "M3", "M4"])
def test_friction_takes_the_same_power_at_the_motor_and_at_the_actuator(drive: Drive) -> None:
    viscous, coulomb = drive.reflected_friction
    for speed in (0.02, 0.3):
        motor = drive.ratio * speed
        lost = (drive.viscous * motor + drive.coulomb) * motor
        assert (viscous * speed + coulomb) * speed == pytest.approx(lost, rel=1e-12)


@pytest.mark.slow
@given(case=cases())
def test_inertia_and_friction_of_the_drives_are_added(case: Case) -> None:
    pose, v, a = case.states()
    design = driven(case.design)
    growth = actuator_acceleration(design.geometry, pose, v, a)
    speed = actuator_velocity(design, pose, v)
    plain = inverse_dynamics(case.design, pose, v, a).torque
    full = inverse_dynamics(design, pose, v, a).torque
    own = np.array(design.drive_inertia) * growth
    for joint, drive, both in zip(
        case.design.actuator_friction.viscous, DRIVES, design.actuator_friction.viscous, strict=True
    ):
        assert both == pytest.approx(joint + drive.reflected_friction[0])
    assert_close(full, plain + own + friction_torque(design.actuator_friction, speed), 1e-12)
    y = torque_regressor(design.geometry, pose, v, a, gravity=design.gravity)
    columns = drive_regressor(design.geometry, pose, v, a) @ np.array(design.drive_inertia)
    linear = regressor_torques(y, lumped_coefficients(design)) + columns
    assert_close(linear, inverse_dynamics(design.without_friction(), pose, v, a).torque, 1e-10)
    parts = torque_breakdown(design, pose, v, a)
    assert_close(parts.total, full, 1e-10)


@pytest.mark.slow
@given(case=cases())
def test_mass_matrix_and_kinetic_energy_agree_with_the_drives(case: Case) -> None:
    pose, v, a = case.states()
    design = driven(case.design, rubs=False)
    g = inverse_jacobian(design.geometry, pose)
    added = np.einsum("nki,k,nkj->nij", g, np.array(design.drive_inertia), g)
    matrix = mass_matrix(design, pose)
    assert_close(matrix, mass_matrix(case.design, pose) + added, 1e-13)
    energy = 0.5 * np.einsum("ni,nij,nj->n", v, matrix, v)
    assert_close(kinetic_energy(design, pose, v)[:, None], energy[:, None], 1e-10)
    torque = inverse_dynamics(design, pose, v, a).torque
    assert_close(forward_dynamics(design, pose, v, torque), a, 1e-6)


def test_drives_add_what_each_of_them_adds_alone() -> None:
    states = samples.random_states(np.random.default_rng(0), APPENDIX_4, 5)
    calls: list[Callable[[Design], Any]] = [
        lambda design: mass_matrix(design, states[0]),
        lambda design: kinetic_energy(design, *states[:2]),
        lambda design: inverse_dynamics(design, *states).torque,
        lambda design: torque_breakdown(design, *states).total,
        lambda design: platform_wrench(design.without_friction(), *states),
        lambda design: np.array(design.actuator_friction[:2]),
    ]
    alone = [
        replace(APPENDIX_4, drives=tuple(d if i == j else None for j, d in enumerate(DRIVES)))
        for i in range(4)
    ]
    for call in calls:
        none = call(APPENDIX_4)
        added = [call(design) - none for design in alone]
        assert all(np.abs(part).max() > 0 for part in added)
        np.testing.assert_allclose(
            call(driven(APPENDIX_4)) - none, sum(added), rtol=1e-9, atol=1e-9
        )


def test_actuator_accelerations_are_the_rate_of_their_speeds() -> None:
    motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(2000)
    found = actuator_acceleration(
        APPENDIX_4.geometry, motion.pose, motion.velocity, motion.acceleration
    )
    speed = actuator_velocity(APPENDIX_4, motion.pose, motion.velocity)
    slope = np.gradient(speed, motion.t, axis=0)
    assert np.abs(slope - found)[1:-1].max() < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
@pytest.mark.parametrize("seed", [None, 3])
def test_engines_agree_on_reflected_inertia(engine: str, seed: int | None) -> None:
    pytest.importorskip(engine)
    rng = np.random.default_rng(seed)
    plain = APPENDIX_4 if seed is None else samples.random_design(rng)
    design = driven(plain, rubs=False)
    states = samples.random_states(rng, design, 60)
    robot: Any = MujocoRobot if engine == "mujoco" else PinocchioRobot
    found = robot(design).inverse_dynamics(*states)
    ours = inverse_dynamics(design, *states).torque
    assert (np.abs(found - ours).max(axis=0) / np.abs(ours).max(axis=0)).max() < 1e-10
    j = np.linalg.inv(inverse_jacobian(design.geometry, states[0]))
    inertia = np.einsum("nki,nkl,nlj->nij", j, mass_matrix(design, states[0]), j)
    own = robot(design).actuator_inertia(states[0])
    assert np.abs(own - inertia).max() < 1e-10 * np.abs(inertia).max()
    without = inverse_dynamics(plain, *states).torque
    assert np.abs(without - ours).max() > 1e-3 * np.abs(ours).max()


@pytest.mark.slow
def test_the_simulation_moves_a_driven_robot_and_balances_its_energy() -> None:
    design = driven(APPENDIX_4)
    motion = PRESET["quintic"].build(design.geometry).sample(200)
    found = simulate(design, motion, model=design, controller=Controller(ControlMode.PD))
    assert np.abs(found.error).max() < 1e-4
    assert np.abs(found.energy_drift).max() < 1e-4
    torque = analyze(design, motion)
    assert np.abs(torque.energy_residual).max() < 2e-3
    blind = simulate(design, motion, model=APPENDIX_4, controller=Controller(ControlMode.PD))
    assert np.abs(blind.error).max() > 10 * np.abs(found.error).max()


def test_the_envelope_in_force_ends_at_peak_torque_and_top_speed() -> None:
    points = ((0.0, 2.0), (300.0, 2.0), (600.0, 0.5))
    assert Drive(envelope=points).corners == points
    limited = Drive(envelope=points, peak_torque=1.25, top_speed=500.0).corners
    assert limited == ((0.0, 1.25), (300.0, 1.25), (450.0, 1.25), (500.0, 1.0))
    assert Drive(peak_torque=1.0, top_speed=9.0).corners == ((0.0, 1.0), (9.0, 1.0))
    assert Drive().output_limits == (math.inf, math.inf, math.inf)


@given(seed=st.integers(0, 10_000))
def test_the_envelope_in_force_is_the_least_of_its_limits_at_every_speed(seed: int) -> None:
    """And no line cuts into it; where it is concave the lines are the envelope itself."""
    rng = np.random.default_rng(seed)
    speeds = np.concatenate([[0.0], np.cumsum(rng.uniform(10.0, 100.0, rng.integers(1, 5)))])
    torques = rng.uniform(0.1, 3.0, len(speeds))
    if rng.uniform() < 0.5:
        torques = np.sort(torques)[::-1]
    peak = rng.choice([math.inf, rng.uniform(0.2, 3.0)])
    top = rng.choice([math.inf, rng.uniform(0.2, 1.2) * speeds[-1]])
    drive = Drive(
        envelope=tuple(zip(speeds.tolist(), torques.tolist(), strict=True)),
        peak_torque=None if math.isinf(peak) else float(peak),
        top_speed=None if math.isinf(top) else float(top),
    )
    at, most = np.transpose(drive.corners)
    assert (at[0], at[-1]) == (0.0, pytest.approx(min(top, speeds[-1])))
    assert (np.diff(at) > 0).all()
    w = np.linspace(0.0, at[-1], 400)
    expected = np.minimum(np.interp(w, speeds, torques), peak)
    np.testing.assert_allclose(np.interp(w, at, most), expected, rtol=1e-9)
    assert drive.output_limits.peak == pytest.approx(most.max())
    assert drive.output_limits.speed == at[-1]
    below = np.min([a - s * w for a, s in drive.lines], axis=0)
    assert (below <= expected * (1 + 1e-9)).all()
    assert below[0] == pytest.approx(expected[0])
    falls = -np.diff(most) / np.diff(at)
    if (np.diff(falls) >= 0).all():
        np.testing.assert_allclose(below, expected, rtol=1e-9)
    else:
        assert len(drive.lines) == 1
        assert np.isclose(below, np.interp(w, at, most), rtol=0.1)[1:].any()


def test_points_on_one_line_of_an_envelope_leave_it_concave() -> None:
    drive = Drive(envelope=((0.0, 3.0), (1.0, 2.7), (2.0, 2.4), (3.0, 1.4)))
    w = np.linspace(0.0, 3.0, 61)
    at, most = np.transpose(drive.corners)
    below = np.min([a - s * w for a, s in drive.lines], axis=0)
    np.testing.assert_allclose(below, np.interp(w, at, most), rtol=1e-12)


def test_a_drive_says_its_ratio_its_screw_and_whether_it_holds() -> None:
    assert ROTARY.summary == "motor, gear, 100:1"
    assert SCREW.summary == "axis, 2:1, screw 10 mm"
    assert Drive(gear_ratio=3.5).summary == "3.5:1"


def test_a_ratio_that_a_name_has_is_not_said_twice() -> None:
    assert Drive(name="servo, gear 80:1", gear_ratio=80.0).summary == "servo, gear 80:1"
    assert Drive(name="gear 80:1, sealed", gear_ratio=80.0).summary == "gear 80:1, sealed"
    assert Drive(name="gear 80:1", gear_ratio=8.0).summary == "gear 80:1, 8:1"
    assert Drive().lines == ((math.inf, 0.0),)
    assert Drive(peak_torque=2.0).lines == ((2.0, 0.0),)
    assert Drive(top_speed=9.0).lines == ((math.inf, 0.0),)
    assert not SCREW.holds
    assert replace(SCREW, brake=True).holds
    assert replace(SCREW, lead_efficiency=0.3).holds
    assert not replace(SCREW, lead_efficiency=0.3, transmission="belt").holds
    assert replace(ROTARY, encoder_counts=1000).resolution == pytest.approx(2 * math.pi / 1e5)
    assert ROTARY.resolution is None


def test_a_screw_locks_itself_below_half_of_the_efficiency() -> None:
    assert not replace(SCREW, lead_efficiency=0.5).holds
    assert replace(SCREW, lead_efficiency=math.nextafter(0.5, 0.0)).holds


def test_corners_of_an_envelope_that_meet_a_limit_count_once() -> None:
    drive = Drive(envelope=((0.0, 3.0), (1.0, 2.0), (2.0, 0.0)))
    assert drive.corners == drive.envelope
    assert replace(drive, top_speed=2.0, peak_torque=3.0).corners == drive.envelope
    assert replace(drive, top_speed=1.0).corners == ((0.0, 3.0), (1.0, 2.0))
    assert replace(drive, top_speed=1.5).corners == ((0.0, 3.0), (1.0, 2.0), (1.5, 1.0))
    assert replace(drive, peak_torque=2.0).corners == ((0.0, 2.0), (1.0, 2.0), (2.0, 0.0))
    peak = replace(drive, peak_torque=1.0).corners
    assert peak == ((0.0, 1.0), (1.0, 1.0), (1.5, 1.0), (2.0, 0.0))


def test_a_slope_that_rises_by_rounding_alone_leaves_an_envelope_concave() -> None:
    """By a share of 1e-12 of the slope before."""
    for rise, lines in ((0.9e-12, 2), (1.05e-12, 1)):
        drive = Drive(envelope=((0.0, 3.0), (1.0, 2.0), (2.0, 1.0 + rise)))
        assert len(drive.lines) == lines
    rising = Drive(envelope=((0.0, 1.0), (1.0, 2.0), (2.0, 3.0)))
    assert rising.lines == ((1.0, -1.0),) * 2


def test_envelopes_have_from_two_to_sixteen_points_of_real_size() -> None:
    for count, possible in ((1, False), (2, True), (16, True), (17, False)):
        points = tuple((float(n), 1.0) for n in range(count))
        if possible:
            assert Drive(envelope=points).envelope == points
        else:
            with pytest.raises(InvalidDesign, match="2 to 16 points"):
                Drive(envelope=points)
    with pytest.raises(InvalidDesign, match="torque at speed 0 has to be above 0"):
        Drive(envelope=((0.0, 0.0), (1.0, 1.0)))
    with pytest.raises(InvalidDesign, match="finite numbers"):
        Drive(envelope=((0.0, 1.0), (math.inf, 1.0)))


def test_numbers_of_a_drive_are_from_1e_12_to_1e9() -> None:
    for possible, beyond in ((1e-12, 0.0), (1e9, math.inf)):
        assert Drive(rated_torque=possible).rated_torque == possible
        with pytest.raises(InvalidDesign, match=r"drive\.rated_torque"):
            Drive(rated_torque=math.nextafter(possible, beyond))


def test_only_inertia_friction_mass_and_cost_of_a_drive_may_be_zero() -> None:
    numbers = [item.name for item in fields(Drive) if "unit" in item.metadata]
    screw = {"transmission": "screw", "lead": 0.01}
    possible = set()
    for name in numbers:
        with suppress(InvalidDesign):
            Drive(**screw | {name: 0.0})
            possible.add(name)
        with pytest.raises(InvalidDesign, match=rf"drive\.{name}"):
            Drive(**screw | {name: -1.0})
    assert len(numbers) == 19
    inertias = {"rotor_inertia", "gear_inertia"}
    assert possible == inertias | {"viscous", "coulomb", "mass", "cost"}


def test_a_drive_of_which_nothing_is_known_adds_and_limits_nothing() -> None:
    drive = Drive()
    assert (drive.ratio, drive.inertia, drive.total_efficiency) == (1.0, 0.0, 1.0)
    assert drive.reflected_friction == (0.0, 0.0)
    assert drive.output_limits == drive.gear_limits == (math.inf,) * 3
    assert (drive.mass, drive.cost, drive.lead, drive.resolution) == (None,) * 4
    assert (drive.holds, drive.brake, drive.envelope, drive.name) == (False, False, (), "")


def test_gear_limits_are_at_the_actuator() -> None:
    gear = replace(
        SCREW, gear_peak_torque=5.0, gear_rated_torque=2.0, gear_top_speed=100.0, rated_torque=9.0
    )
    lever = 2 * math.pi / 0.01 * 0.9  # force of a torque at the gear's output
    assert gear.gear_limits == pytest.approx((5 * lever, 2 * lever, 100.0 / gear.ratio))
    assert gear.output_limits == pytest.approx(gear.gear_limits)
    assert ROTARY.gear_limits == (math.inf,) * 3


def test_limits_at_the_actuator() -> None:
    drive = replace(SCREW, rated_torque=1.0, peak_torque=3.0, top_speed=300.0, gear_peak_torque=5.0)
    peak, rated, speed = drive.output_limits
    assert rated == pytest.approx(0.9 * drive.ratio)
    assert peak == pytest.approx(5.0 * 2 * math.pi / 0.01 * 0.9)  # the gear's, below the motor's
    assert speed == pytest.approx(300.0 / drive.ratio)


@pytest.mark.parametrize(
    ("field", "values"),
    {
        "inertia": ("rotor_inertia", {"rotor_inertia": -1e-6}),
        "efficiency": ("efficiency", {"efficiency": 1.01}),
        "no efficiency": ("efficiency", {"efficiency": 0.0}),
        "ratio": ("gear_ratio", {"gear_ratio": 0.0}),
        "speed twice": ("envelope", {"envelope": ((0, 1), (5, 1), (5, 0.5))}),
        "backward": ("envelope", {"envelope": ((0, 1), (5, 1), (4, 0.5))}),
        "late start": ("envelope", {"envelope": ((1, 1), (5, 1))}),
        "no pairs": ("envelope", {"envelope": (1, 2)}),
        "negative torque": ("envelope", {"envelope": ((0, 1), (5, -1))}),
        "lead alone": ("lead", {"lead": 0.01}),
        "transmission": ("transmission", {"transmission": "rope", "lead": 0.01}),
    }.values(),
    ids=lambda value: str(value) if isinstance(value, str) else "-".join(map(str, value.values())),
)
def test_impossible_drives_are_refused_by_field(field: str, values: dict[str, Any]) -> None:
    with pytest.raises(InvalidDesign) as caught:
        Drive(**values)
    assert caught.value.field == f"drive.{field}"


def test_a_design_has_four_drives_and_only_the_lift_a_screw() -> None:
    for drives, problem in (
        ((), "four drives"),
        ((None,) * 3, "four drives"),
        ((SCREW, None, None, None), r"M1\.lead .* only M4 moves along a line"),
        ((None, None, None, ROTARY), r"M4\.lead .* needs a screw or belt"),
    ):
        with pytest.raises(InvalidDesign, match=problem):
            replace(APPENDIX_4, drives=drives)
    assert APPENDIX_4.drives == NO_DRIVES
    design = driven(APPENDIX_4)
    assert design.value("drives.M4.lead") == 0.01
    assert design.vary({"drives.M2.gear_ratio": 7.0}).drives[1] == replace(DRIVES[1], gear_ratio=7)
    assert design != APPENDIX_4
    assert len({design, APPENDIX_4, driven(APPENDIX_4)}) == 2


def test_optimal_masses_count_the_drives() -> None:
    motion = PRESET["quintic"].build(APPENDIX_4.geometry).sample(100)
    paths = ("links.b3", "links.b8", "joints.j9")
    changes = Changes(tuple(MassRange(path, 0.1, 2.0) for path in paths))
    solved = solve_trajectory(APPENDIX_4.geometry, motion)
    for design in (APPENDIX_4, driven(APPENDIX_4)):
        found = optimize(design, changes, TrajectoryPeak(solved))
        for robot, value in (
            (design, found.values[0].before), (found.after, found.values[0].after)
        ):  # fmt: skip
            torque = analyze(robot, motion).torque[:, :3]
            assert value == pytest.approx(np.abs(torque).max(), rel=1e-9)
        assert found.after.drives == design.drives
