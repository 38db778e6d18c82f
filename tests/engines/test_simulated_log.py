"""Logs of the MuJoCo robot: exact without defects and noise, each defect where it belongs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import (
    APPENDIX_4,
    Friction,
    KneeBranch,
    Payload,
    inverse_dynamics,
    inverse_kinematics,
    lumped_coefficients,
    torque_regressor,
)
from paminsa_viz.trajectory import PRESET

pytest.importorskip("mujoco")

from paminsa_viz.engines.simulated_log import (
    NO_DEFECTS,
    Defects,
    HeavierBar,
    LogNoise,
    _DefectiveRobot,
    correlated_noise,
    simulate_log,
)
from tests.support.documentation import missing

RATE = 40.0
ROBOT = replace(
    APPENDIX_4,
    friction=Friction(0.4, 0.6, 20.0, 8.0),
    payload=Payload(2.0, 0.01),
)
MOTION = PRESET["waypoints"].build(ROBOT.geometry).sample(RATE)


@pytest.fixture(scope="module")
def plain():
    return simulate_log(ROBOT, MOTION, rate=RATE)


@pytest.mark.parametrize("knee", KneeBranch)
def test_plain_log_is_what_the_model_computes(knee) -> None:
    robot = ROBOT.with_knee(knee)
    motion = PRESET["waypoints"].build(robot.geometry).sample(20.0)
    log = simulate_log(robot, motion, rate=20.0)
    expected = inverse_dynamics(robot, motion.pose, motion.velocity, motion.acceleration).torque
    np.testing.assert_allclose(log.torque, expected, rtol=0, atol=1e-8)
    actuators = inverse_kinematics(robot.geometry, motion.pose).actuators
    np.testing.assert_allclose(log.position, actuators, rtol=0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("bar", ["B3", "B4", "B10"])
def test_bar_heavier_in_every_leg_is_a_heavier_design(bar) -> None:
    name = bar.lower()
    changes = {f"links.{name}": 1.2 * ROBOT.value(f"links.{name}")}
    for kind in ("axial", "transverse", "vertical"):
        path = f"inertias.{name}_{kind}"
        if hasattr(ROBOT.inertias, f"{name}_{kind}"):
            changes[path] = 1.2 * ROBOT.value(path)
    wanted = simulate_log(ROBOT.vary(changes), MOTION, rate=RATE).torque
    bars = tuple(HeavierBar(leg, bar, 1.2) for leg in range(3))
    found = simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects(bars=bars)).torque
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_bar_heavier_in_one_leg_breaks_the_symmetry(plain) -> None:
    shares = [
        simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects((HeavierBar(leg, "B4", 1.2),)))
        .torque - plain.torque
        for leg in range(3)
    ]  # fmt: skip
    bars = tuple(HeavierBar(leg, "B4", 1.2) for leg in range(3))
    whole = simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects(bars)).torque
    np.testing.assert_allclose(sum(shares), whole - plain.torque, rtol=0, atol=1e-8)
    assert np.abs(shares[0] - shares[1]).max() > 0.1


@pytest.mark.slow
def test_spring_changes_the_second_weight_alone(plain) -> None:
    """V gets -F z_9 a leg, which is M_p2 less by F, and no inertia."""
    c = lumped_coefficients(ROBOT)
    force = 0.3 * c[1]
    change = np.zeros_like(c)
    change[1] = -force
    y = torque_regressor(ROBOT.geometry, MOTION.pose, MOTION.velocity, MOTION.acceleration)
    found = simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects(spring=float(force))).torque
    np.testing.assert_allclose(found - plain.torque, y @ change, rtol=0, atol=1e-8)
    assert np.abs(y @ change).max() > 0.5


def test_defects_of_the_sensors(plain) -> None:
    zero, gain, offset = (0.01, -0.02, 0.0, 0.001), (1.05, 1.0, 0.9, 1.0), (0.1, 0.0, -0.2, 3.0)
    log = simulate_log(
        ROBOT, MOTION, rate=RATE, defects=Defects(encoder_zero=zero, gain=gain, offset=offset)
    )
    np.testing.assert_allclose(log.position - plain.position, np.tile(zero, (log.t.size, 1)))
    np.testing.assert_allclose(log.torque, plain.torque * gain + offset)


def test_delayed_torque_is_that_of_an_earlier_moment(plain) -> None:
    late = simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects(delay=3 / RATE))
    np.testing.assert_allclose(late.torque[3:], plain.torque[:-3], rtol=0, atol=1e-7)
    np.testing.assert_array_equal(late.position, plain.position)


@pytest.mark.slow
def test_noise_has_its_size_its_correlation_and_its_seed(plain) -> None:
    noise = correlated_noise(200_000, 1e-3, 0.02, 3)
    np.testing.assert_allclose(noise.std(axis=0), 1.0, atol=0.05)
    lagged = (noise[:-20] * noise[20:]).mean(axis=0)
    np.testing.assert_allclose(lagged, np.exp(-1.0), atol=0.06)
    first, again, other = (
        simulate_log(ROBOT, MOTION, rate=RATE, noise=LogNoise(), seed=seed) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.torque, again.torque)
    assert np.all(first.torque != other.torque)
    rms = np.sqrt((plain.torque**2).mean(axis=0))
    np.testing.assert_allclose((first.torque - plain.torque).std(axis=0) / rms, 0.02, rtol=0.3)
    steps = first.position[:, :3] / LogNoise().angle
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    assert np.abs(first.position - plain.position)[:, 3].max() <= 0.5e-5 * (1 + 1e-9)


def test_a_bar_may_be_lighter_too(plain) -> None:
    """Torques are linear in its mass: what one of 80 % lacks, one of 120 % has more."""
    lighter, heavier = (
        simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects((HeavierBar(0, "B4", factor),)))
        for factor in (0.8, 1.2)
    )
    np.testing.assert_allclose(plain.torque - lighter.torque, heavier.torque - plain.torque,
                               rtol=0, atol=1e-8)  # fmt: skip


def test_noise_of_measured_logs_is_that_of_the_documentation() -> None:
    """Those of the example logs: see docs/identification.md."""
    noise = LogNoise()
    sentence = (
        f"torques with {100 * noise.torque:g} % noise that is correlated over "
        f"{1e3 * noise.correlation:g} ms, encoders of {np.degrees(noise.angle):g}° and "
        f"{1e6 * noise.travel:g} µm"
    )
    assert missing("identification", [sentence]) == []
    assert Defects((), (0.0,) * 4, 0.0, (1.0,) * 4, (0.0,) * 4, 0.0) == NO_DEFECTS


def test_noise_is_a_process_of_first_order_from_its_first_sample_on() -> None:
    """What is new in each sample is white, and so large that the deviation stays 1."""
    step, correlation = 1e-3, 2e-3
    white = np.random.default_rng(7).standard_normal((40, 4))
    noise = correlated_noise(40, step, correlation, 7)
    keep = np.exp(-step / correlation)
    expected = [white[0]]
    for new in white[1:]:
        expected.append(keep * expected[-1] + np.sqrt(1 - keep**2) * new)
    np.testing.assert_allclose(noise, expected, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(correlated_noise(40, step, 0.0, 7), white)


def test_a_log_may_start_at_any_time() -> None:
    """Its noise does not depend on what the clock shows."""
    first, later = (
        simulate_log(ROBOT, motion, rate=RATE, noise=LogNoise(), seed=5)
        for motion in (MOTION, replace(MOTION, t=MOTION.t + 7.0))
    )
    np.testing.assert_allclose(later.t, first.t + 7.0)
    np.testing.assert_allclose(later.torque, first.torque, atol=1e-9)
    np.testing.assert_allclose(later.position, first.position, atol=1e-12)


def test_one_torque_that_is_missing_is_enough_to_refuse_a_log(
    plain, monkeypatch: pytest.MonkeyPatch
) -> None:
    torque = np.ones((len(plain.t), 4))
    torque[7, 2] = torque[9] = np.nan
    monkeypatch.setattr(_DefectiveRobot, "inverse_dynamics", lambda _, *__: torque.copy())
    with pytest.raises(InvalidInput, match=f"there is no torque at {plain.t[7]:.6g} s: out of"):
        simulate_log(ROBOT, MOTION, rate=RATE)


def test_impossible_logs_are_refused() -> None:
    with pytest.raises(InvalidInput, match="leg 1 has no bar 'B9'"):
        simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects((HeavierBar(0, "B9", 1.2),)))
    with pytest.raises(InvalidInput, match="factor above 0"):
        simulate_log(ROBOT, MOTION, rate=RATE, defects=Defects((HeavierBar(0, "B4", 0.0),)))
    far = replace(MOTION, pose=MOTION.pose + np.array([0.4, 0.0, 0.0, 0.0]))
    with pytest.raises(InvalidInput, match="out of reach"):
        simulate_log(ROBOT, far, rate=RATE)
