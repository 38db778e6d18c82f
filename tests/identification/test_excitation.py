"""Excitation: multi-sines at rest at their ends, exact slopes, limits kept, far above random."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import logsumexp, softmax

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification import (
    ExcitationLimits,
    ExcitationSettings,
    NoExcitation,
    excitation,
    optimize_excitation,
)
from paminsa_viz.identification.excitation import KeptLimit, amplitudes, kept_limits
from paminsa_viz.identification.excitation_search import CHUNK, random_motions
from paminsa_viz.identification.information import (
    COULOMB_SHARE,
    LIMITED,
    Information,
    _soft_least,
    natural_height,
)
from paminsa_viz.identification.multi_sine import MultiSineFamily
from paminsa_viz.model import (
    APPENDIX_4,
    Drive,
    Friction,
    KneeBranch,
    LoadCase,
    actuator_velocity,
    inverse_dynamics,
    static_torques,
)
from paminsa_viz.model.design import PARAMETERS
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.trajectory import Plan, preset_center
from paminsa_viz.trajectory.check import check_path
from tests.support.samples import random_design

ROBOT = replace(
    APPENDIX_4, friction=Friction(0.4, 0.6, 20.0, 8.0), load=LoadCase(force_x=6.0, force_z=-15.0)
)
PERIOD = 8.0


def limits_of(design) -> ExcitationLimits:
    found = actuator_limits(design)
    return ExcitationLimits(found.speed, found.rated)


def information(design=ROBOT, samples: int = 256) -> Information:
    family = MultiSineFamily(5, preset_center(design.geometry), np.array([0.1, 0.1, 0.4, 0.1]))
    return Information(design, limits_of(design), family, PERIOD, samples)


def some_motion(info: Information, seed: int = 1):
    rng = np.random.default_rng(seed)
    return 0.12 * rng.standard_normal(info.family.size)


def test_multi_sine_begins_and_ends_at_rest_with_exact_derivatives() -> None:
    info = information()
    curve = info.family.curve(some_motion(info), periods=3)
    for order in (1, 2):
        np.testing.assert_allclose(curve(np.array([0.0, 1.0]), order), 0.0, atol=1e-9)
    u = np.linspace(0.05, 0.95, 17)
    for order in range(3):
        slope = (curve(u + 1e-6, order) - curve(u - 1e-6, order)) / 2e-6
        np.testing.assert_allclose(curve(u, order + 1), slope, rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(curve(u), curve((u + 1 / 3) % 1.0), atol=1e-12)
    np.testing.assert_allclose(curve.breaks, [0, 1 / 3, 2 / 3, 1])
    before, behind = curve(curve.breaks[1:-1] - 1e-9, 2), curve(curve.breaks[1:-1] + 1e-9, 2)
    np.testing.assert_allclose(before, behind, atol=1e-3)
    assert curve.bounded_jerk  # no acceleration jumps, where periods meet either


def test_a_robot_twice_as_large_is_searched_over_motions_twice_as_large() -> None:
    g = APPENDIX_4.geometry
    lengths = {
        item.path: 2 * APPENDIX_4.value(item.path)
        for item in PARAMETERS
        if item.path.startswith("geometry.") and item.unit == "m"
    }
    small, large = (amplitudes(design) for design in (APPENDIX_4, APPENDIX_4.vary(lengths)))
    np.testing.assert_allclose(large, small * [2.0, 2.0, 1.0, 2.0], rtol=1e-9)
    assert np.all(small[[0, 1, 3]] < 0.5 * g.base_radius)


def test_states_of_the_search_are_those_of_the_plan() -> None:
    info = information()
    x = some_motion(info)
    states = info.states(x)
    plan = Plan(info.family.curve(x), PERIOD)
    wanted = np.concatenate(plan.at(np.arange(len(states)) * PERIOD / len(states)), axis=1)
    np.testing.assert_allclose(states, wanted, atol=1e-12)


def test_sizes_are_the_largest_values_of_a_first_harmonic() -> None:
    """Of pose, velocity and acceleration.

    Base columns have a mean square of 1 over 400 states within half of them, of a seed of 0.
    """
    info = information()
    u = np.linspace(0.0, PERIOD, 4001)
    w = 2 * np.pi / PERIOD
    waves = [np.sin(w * u), w * np.cos(w * u), -(w**2) * np.sin(w * u)]
    scale = info.family.scale
    sizes = [np.abs(wave).max() * scale for wave in waves]
    np.testing.assert_allclose(info._sizes, np.concatenate(sizes), rtol=1e-6)
    drawn = np.random.default_rng(0).uniform(-0.5, 0.5, (400, 12)) * info._sizes
    drawn[:, :4] += info.family.center
    regressor = info.at(drawn).regressor
    columns = (regressor[np.isfinite(regressor).all(axis=(1, 2))] @ info._base).reshape(-1, 11)
    np.testing.assert_allclose(np.sqrt((columns**2).mean(axis=0)), 1.0, rtol=1e-9)


@pytest.mark.slow
def test_slopes_are_those_of_differences() -> None:
    info = information()
    info.noise = np.array([0.1, 0.2, 0.1, 5.0])
    x = some_motion(info)
    found = info.evaluate(x, 50.0)
    assert found.value == pytest.approx(float(info.log_det(x)), abs=1e-9)
    assert found.worst == pytest.approx(float(info.worst_room(x)))
    np.testing.assert_allclose(
        found.room, _soft_least(info.at(info.states(x)).room, 50.0)[0], rtol=0, atol=1e-12
    )
    for index in (0, 3, 4, 13, 22, 35):
        step = 1e-5 * np.eye(info.family.size)[index]
        above, below = info.evaluate(x + step, 50.0), info.evaluate(x - step, 50.0)
        assert found.slope[index] == pytest.approx((above.value - below.value) / 2e-5, rel=1e-4)
        slope = (above.room - below.room) / 2e-5
        np.testing.assert_allclose(found.room_slope[:, index], slope, atol=1e-5)


def test_room_is_what_the_model_leaves_of_every_limit() -> None:
    info = information()
    info.sharp = True
    limits = info.limits
    states = info.states(some_motion(info))
    pose, velocity, acceleration = np.split(states, 3, axis=-1)
    speed = actuator_velocity(ROBOT, pose, velocity)
    torque = inverse_dynamics(ROBOT, pose, velocity, acceleration).torque
    reach = check_reach(ROBOT.geometry, pose).margins.min(axis=(-1, -2))
    wanted = [
        *(1 - np.abs(speed) / limits.speed).T,
        *(1 - np.abs(torque) / limits.torque).T,
        1 - measure_singularity(ROBOT.geometry, pose).condition / limits.condition,
        (-pose[:, 3] - ROBOT.geometry.platform_joint_height - limits.clearance)
        / ROBOT.geometry.base_radius,
        (reach - limits.clearance) / ROBOT.geometry.base_radius,
    ]
    room = info.at(states).room
    found = [*room[:, :10].T, room[:, 10:].min(axis=1)]
    np.testing.assert_allclose(found, wanted, atol=1e-9)
    assert len(wanted) == len(LIMITED)


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("own", [1e-4, 1.0], ids=["sharp", "soft"])
def test_torques_of_a_search_have_rotors_and_a_step_that_is_soft_enough(
    knee: KneeBranch, own: float
) -> None:
    """As soft as that of the slowest actuator's column, or as the design's own."""
    servo = Drive("servo", rotor_inertia=1e-4, gear_ratio=50.0)
    axis = Drive("axis", rotor_inertia=2e-5, transmission="screw", lead=0.01)
    friction = replace(ROBOT.friction, transition_speed=own)
    design = replace(ROBOT, drives=(servo, None, None, axis), friction=friction).with_knee(knee)
    info = information(design, samples=64)
    limits, states = info.limits, info.states(some_motion(info))
    pose, velocity, acceleration = np.split(states, 3, axis=-1)
    soft = replace(friction, transition_speed=max(own, COULOMB_SHARE * limits.speed.min()))
    torque = inverse_dynamics(replace(design, friction=soft), pose, velocity, acceleration).torque
    room = info.at(states).room
    np.testing.assert_allclose(room[:, 4:8], 1 - np.abs(torque) / limits.torque, atol=1e-9)
    away = knee.sign * (-pose[:, 3] - design.geometry.platform_joint_height)
    height = (away - limits.clearance) / design.geometry.base_radius
    np.testing.assert_allclose(room[:, 9], height, atol=1e-12)
    np.testing.assert_allclose(natural_height(design.geometry, pose), away, atol=1e-12)
    assert (away > 0).all()


def test_a_motion_out_of_reach_tells_nothing_and_keeps_no_limit() -> None:
    info = information(samples=64)
    part = 6.0 * some_motion(info)  # some of its samples only
    lost = np.isnan(info.at(info.states(part)).room).any(axis=-1)
    assert 0 < lost.sum() < 64
    still = np.zeros(info.family.size)  # shows no friction
    for motion in (part, still):
        assert info.evaluate(motion, 50.0).value == info.log_det(motion) == -np.inf
    far = 60.0 * some_motion(info)
    found = info.evaluate(far, 50.0)
    assert (found.value, found.worst) == (-np.inf, -np.inf)
    assert found.room.tolist() == [-1.0] * len(LIMITED)
    assert not found.slope.any()
    assert not found.room_slope.any()
    assert (found.slope.shape, found.room_slope.shape) == ((info.family.size,), (11, far.size))
    values = info.log_det(np.stack([far, some_motion(info)]))
    assert values[0] == -np.inf
    assert values[1] == pytest.approx(info.log_det(some_motion(info)))


def test_the_least_room_is_softened_limit_by_limit() -> None:
    """-log(sum e^(-s r))/s over the samples of each limit, reach over all of its twelve."""
    room = np.random.default_rng(2).uniform(-4.0, 4.0, (30, 22))
    for sharpness in (5.0, 300.0):
        soft, shares = _soft_least(room, sharpness)
        parts = [room[:, [i]] for i in range(10)] + [room[:, 10:]]
        wanted = [-logsumexp(-sharpness * part) / sharpness for part in parts]
        np.testing.assert_allclose(soft, wanted, rtol=1e-12)
        weights = np.concatenate([softmax(-sharpness * part) for part in parts], axis=1)
        np.testing.assert_allclose(shares, weights, atol=1e-14)


def test_information_is_that_of_measured_torques() -> None:
    """det M is that of the normal equations; halving the noise adds 2 log 2 a parameter."""
    info = information()
    x = some_motion(info)
    plain = float(info.log_det(x))
    info.noise = np.full(4, 0.5)
    assert float(info.log_det(x)) == pytest.approx(plain + 2 * np.log(2) * info.rank)
    assert info.rank == 22


def test_columns_are_the_torques_of_one_of_each_parameter_over_the_noise() -> None:
    info = information(samples=16)
    info.noise = np.array([0.1, 0.2, 0.5, 5.0])
    values = info.at(info.states(some_motion(info)))
    columns = info._columns(values) * info.noise[:, None]
    masses = columns[..., :11]
    fitted = np.linalg.lstsq(masses.reshape(-1, 11), (values.regressor @ info._c).ravel())[0]
    np.testing.assert_allclose(masses @ fitted, values.regressor @ info._c, atol=1e-9)
    for place, one in enumerate(np.eye(4)):
        expected = [values.speed * one, np.tanh(values.speed / info._coulomb_speed) * one]
        expected += [np.broadcast_to(one, values.speed.shape)] if place < 3 else []
        for kind, torque in enumerate(expected):
            np.testing.assert_allclose(columns[..., 11 + 4 * kind + place], torque, atol=1e-12)


@pytest.mark.parametrize("seed", [None, 3])
def test_random_motions_are_as_large_as_the_limits_allow(seed) -> None:
    design = ROBOT if seed is None else random_design(np.random.default_rng(seed))
    info = information(design)
    motions = random_motions(info, 12, 0)
    assert len(motions)
    room = info.worst_room(motions)
    assert np.all(room >= 0.0)
    assert not np.any(info.worst_room(1.01 * motions) > 0.0)


@pytest.mark.slow
def test_a_short_time_is_not_spent_on_random_motions_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = itertools.count(1.0)  # one passes between two looks
    ticking = type("", (), {"elapsed": property(lambda _: next(seconds))})
    monkeypatch.setattr(excitation, "WorkClock", ticking)
    settings = ExcitationSettings(period=PERIOD, seconds=12.0)
    found = optimize_excitation(ROBOT, limits_of(ROBOT), settings)
    assert 0 < found.random < settings.random / 2
    assert found.evaluations > 3
    assert random_motions(information(), 64, 0, lambda: False).shape[0] == CHUNK


@pytest.mark.slow
def test_best_motion_keeps_its_limits_and_beats_300_random_ones() -> None:
    """A small budget is enough for 8 of the 15; `benchmarks/excitation_speed.py` has the rest."""
    limits = limits_of(ROBOT)
    settings = ExcitationSettings(period=PERIOD, evaluations=160, seconds=1e4)
    found = optimize_excitation(ROBOT, limits, settings)
    assert found.random == 300
    assert found.gain > 8.0
    t = np.linspace(0.0, found.plan.duration, 5001)
    state = found.plan.at(t)
    speed = np.abs(actuator_velocity(ROBOT, state.pose, state.velocity)).max(axis=0)
    torque = np.abs(inverse_dynamics(ROBOT, *state).torque).max(axis=0)
    condition = measure_singularity(ROBOT.geometry, state.pose).condition.max()
    slack = 1.0 + 1e-3
    assert np.all(speed <= slack * limits.speed)
    assert np.all(torque <= slack * limits.torque)
    assert condition <= slack * limits.condition
    assert check_path(ROBOT.geometry, found.plan.sample(250.0)).possible
    assert np.all(state.pose[:, 3] < -ROBOT.geometry.platform_joint_height)
    assert all(row.kept for row in found.limits)
    assert max(speed / limits.speed) > 0.9 or condition > 0.9 * limits.condition


def test_what_a_motion_takes_of_its_limits_is_that_of_its_whole_period() -> None:
    info = information()
    plan = Plan(info.family.curve(some_motion(info), periods=2), 2 * PERIOD)
    rows = kept_limits(ROBOT, limits_of(ROBOT), plan, ExcitationSettings(period=PERIOD))
    assert [row.name for row in rows][:8] == list(LIMITED[:8])
    assert [row.name for row in rows if row.least] == [
        "distance from the guides", "distance to the limits of reach",
    ]  # fmt: skip
    t = np.linspace(0.0, PERIOD, 4001)
    pose, velocity, acceleration = plan.at(t)
    measured = [
        *np.abs(actuator_velocity(ROBOT, pose, velocity)).T,
        *np.abs(inverse_dynamics(ROBOT, pose, velocity, acceleration).torque).T,
        measure_singularity(ROBOT.geometry, pose).condition,
        -ROBOT.geometry.platform_joint_height - pose[:, 3],
        check_reach(ROBOT.geometry, pose).margins.min(axis=(-1, -2)),
    ]
    for row, values in zip(rows, measured, strict=True):
        extreme = values.min() if row.least else values.max()
        assert row.value == pytest.approx(extreme, rel=2e-2, abs=1e-6), row.name
        assert 0.0 <= row.t <= PERIOD
        assert np.interp(row.t, t, values) == pytest.approx(row.value, rel=1e-2, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("period", 0.5, 1000.0), ("periods", 1, 1000), ("samples", 250, 10_000),
        ("evaluations", 0, 1_000_000), ("seconds", 0.0, 1e5), ("random", 1, 10_000),
        ("seed", 0, 2_147_483_647),
    ],
)  # fmt: skip
def test_settings_are_possible_from_end_to_end(name: str, low: float, high: float) -> None:
    outside = [np.nextafter(low, -1), np.nextafter(high, np.inf), np.nan, np.inf]
    if isinstance(low, int):
        outside[:2] = [low - 1, high + 1]
    for value in (low, high):
        assert getattr(ExcitationSettings(**{name: value}), name) == value
    for value in outside:
        with pytest.raises(InvalidInput, match=f"{name}: {low:g} to {re.escape(f'{high:g}')} is"):
            ExcitationSettings(**{name: value})


def test_impossible_searches_are_refused() -> None:
    with pytest.raises(InvalidInput, match="harmonics: 3 to 20"):
        optimize_excitation(ROBOT, limits_of(ROBOT), ExcitationSettings(harmonics=2))
    weak = limits_of(ROBOT)._replace(torque=np.array([20.0, 20.0, 20.0, 50.0]))
    with pytest.raises(NoExcitation, match="force of M4 is beyond its limit"):
        optimize_excitation(ROBOT, weak, ExcitationSettings(random=12))
    # bars that just meet at the center: no other pose can be taken
    stretched = replace(APPENDIX_4, geometry=replace(APPENDIX_4.geometry, base_radius=0.8 - 1e-9))
    with pytest.raises(NoExcitation, match="no motion about home keeps the limits"):
        optimize_excitation(stretched, limits_of(ROBOT), ExcitationSettings(random=12))


def test_each_limit_that_home_exceeds_is_named() -> None:
    limits = limits_of(ROBOT)
    torque = limits.torque.copy()
    held = np.abs(static_torques(ROBOT, preset_center(ROBOT.geometry)))
    for actuator in np.flatnonzero(held > 1e-3):
        few = torque.copy()
        few[actuator] = 0.999 * held[actuator]
        with pytest.raises(NoExcitation, match=f"the {LIMITED[4 + actuator]} is beyond its limit"):
            optimize_excitation(
                ROBOT, limits._replace(torque=few), ExcitationSettings(random=2, period=PERIOD)
            )


def test_torque_rms_of_motions_is_over_their_own_samples() -> None:
    info = information()
    info.sharp = True
    motions = np.stack([some_motion(info, seed) for seed in (1, 2, 3)])
    found = info.torque_rms(motions)
    for motion, rms in zip(motions, found, strict=True):
        states = np.split(info.states(motion), 3, axis=-1)
        torque = inverse_dynamics(replace(ROBOT, friction=Friction(), load=LoadCase()), *states)
        np.testing.assert_allclose(rms, np.sqrt((torque.torque**2).mean(axis=0)), rtol=1e-9)


def test_periods_are_the_pieces_of_a_multi_sine() -> None:
    info = information()
    for periods in (1, 2, 5):
        breaks = info.family.curve(some_motion(info), periods=periods).breaks
        np.testing.assert_allclose(breaks * periods, np.arange(periods + 1), atol=1e-12)


def test_a_limit_that_is_just_reached_is_kept() -> None:
    for least in (False, True):
        for value, kept in ((1.0, True), (1.0 + 1e-12, least), (1.0 - 1e-12, not least)):
            assert KeptLimit("name", value, 1.0, "", 0.0, least).kept == kept
    assert KeptLimit("name", 0.5, 1.0, "", 0.0).kept  # one from above, unless it is said


def test_gain_is_of_log_det_and_narrows_intervals_by_its_root_for_each_parameter() -> None:
    settings = ExcitationSettings(period=PERIOD, evaluations=0, random=4)
    found = optimize_excitation(ROBOT, limits_of(ROBOT), settings)
    better = replace(found, log_det=found.random_log_det + 44.0, parameters=22)
    assert better.gain == pytest.approx(44.0)
    # det M grows by e^44, that is each of 22 by e^2, and a standard error falls with the root
    assert better.narrowing == pytest.approx(np.e)
    assert found.parameters == 22
