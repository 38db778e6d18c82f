"""Spread from tolerances: exact for masses, reproducible samples for lengths."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import Changes, balance, beyond, length_tolerance, mass_tolerance
from paminsa_viz.balancing.tolerance import LENGTH_PATHS
from paminsa_viz.model import APPENDIX_4, InvalidInput, backend, static_imbalance, static_torques
from paminsa_viz.model.lumped import MASS_PATHS
from tests import oracle
from tests.balancing.robots import workspace

POSES = workspace().poses()
BALANCED = balance(APPENDIX_4).after
WITH_WEIGHT = balance(APPENDIX_4, Changes((), (beyond("b3", 7, 0.15, 20.0),))).after
LEG = [path for path in MASS_PATHS if path.startswith(("joints.", "links."))]


def per_leg(designs: list, pose: np.ndarray) -> np.ndarray:
    """Static torques of a robot whose three legs are of three designs, by their energies."""
    size = 1e-5
    around = oracle.split(pose + size * np.concatenate([np.eye(4), -np.eye(4)]))
    energy = np.zeros(8)
    for index, design in enumerate(designs):
        for body in oracle.bodies(design, around):
            if body.name.startswith(f"leg {index + 1}:"):
                energy += design.gravity * body.mass * body.center[2]
    slope = (energy[:4] - energy[4:]) / (2 * size)
    return np.linalg.solve(oracle.actuator_jacobian(designs[0], pose).T, slope)


@pytest.mark.slow
def test_mass_spread_agrees_with_robots_of_three_different_legs() -> None:
    """Each leg drawn by itself, torques from first principles; worst case by its own signs."""
    pose = np.array([0.05, -0.04, 0.3, -0.5])
    found = mass_tolerance(BALANCED, 0.02, pose)
    rng = np.random.default_rng(0)
    drawn = []
    for _ in range(60):
        legs = [
            BALANCED.vary({p: BALANCED.value(p) * (1 + rng.uniform(-0.02, 0.02)) for p in LEG})
            for _ in range(3)
        ]
        drawn.append(per_leg(legs, pose)[:3])
    spread = np.std(drawn, axis=0)
    np.testing.assert_allclose(spread, found.torque_deviation, rtol=0.2)
    assert (np.abs(drawn).max(axis=0) < found.torque_worst).all()
    other = np.array([-0.05, 0.04, -0.3, -0.5])
    unbalanced = mass_tolerance(APPENDIX_4, 0.02, other)
    assert (unbalanced.torque < 0).any()  # the nominal torque counts by its amount
    added = unbalanced.torque_worst - np.abs(unbalanced.torque)
    scaled = [
        APPENDIX_4.vary({path: w * APPENDIX_4.value(path) for path in LEG}) for w in (0.98, 1.02)
    ]
    lighter, heavier = (np.abs(static_torques(design, other)[:3]) for design in scaled)
    assert (added > 0).all()
    assert (np.maximum(lighter, heavier) <= unbalanced.torque_worst * (1 + 1e-12)).all()
    # the worst case is reached: every mass of every leg at the end that pulls the same way
    shares = {p: static_imbalance(BALANCED.vary({p: BALANCED.value(p) + 1.0})) for p in LEG}
    ends = [
        BALANCED.vary({p: BALANCED.value(p) * (1 + 0.02 * s * np.sign(shares[p])) for p in LEG})
        for s in (1, -1)
    ]
    assert static_imbalance(ends[0]) == pytest.approx(found.worst, rel=1e-9)
    corners = [
        np.abs(per_leg([ends[a], ends[b], ends[c]], pose)[:3])
        for a in (0, 1) for b in (0, 1) for c in (0, 1)
    ]  # fmt: skip
    np.testing.assert_allclose(np.max(corners, axis=0), found.torque_worst, rtol=1e-5)


def test_mass_tolerance_has_the_standard_deviation_of_even_distributions() -> None:
    """An even distribution from -a to a has the deviation a / sqrt(3); variances add up."""
    tolerances = {"joints.j7": 0.1, "links.b8": 0.03}
    ends = [
        static_imbalance(APPENDIX_4.vary({path: (1 + part) * APPENDIX_4.value(path)}))
        - static_imbalance(APPENDIX_4)
        for path, part in tolerances.items()
    ]
    found = mass_tolerance(APPENDIX_4, tolerances, [0.05, -0.04, 0.3, -0.5])
    assert found.deviation == pytest.approx(np.hypot(*ends) / 3**0.5, rel=1e-12)
    assert found.worst == pytest.approx(np.abs(ends).sum(), rel=1e-12)


def test_shares_add_up_and_name_the_counterweight() -> None:
    found = mass_tolerance(WITH_WEIGHT, 0.01, POSES)
    assert sum(found.shares.values()) == pytest.approx(1.0)
    assert next(iter(found.shares)) == "counterweights.0.mass"
    only = mass_tolerance(WITH_WEIGHT, {"counterweights.0.mass": 0.01}, POSES)
    heavier = WITH_WEIGHT.vary({"counterweights.0.mass": 1.01 * WITH_WEIGHT.counterweights[0].mass})
    assert only.worst == pytest.approx(abs(static_imbalance(heavier)))
    assert list(only.shares) == ["counterweights.0.mass"]
    assert found.torque.shape == (*POSES.shape[:-1], 3)
    exact = mass_tolerance(BALANCED, 0.0, POSES)
    assert (exact.worst, exact.deviation, exact.shares) == (0.0, 0.0, {})
    np.testing.assert_array_equal(exact.torque_worst, np.abs(exact.torque))


@pytest.mark.slow
def test_lengths_are_sampled_with_a_seed() -> None:
    backend.compile_now()  # or the kernels could take over between two calls, with other rounding
    first, again, other = (
        length_tolerance(BALANCED, 0.01, POSES, samples=40, seed=seed) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.peaks, again.peaks)
    assert (first.peaks != other.peaks).any()
    assert first.nominal < 1e-12
    assert 0 < first.quantile(0.5) <= first.quantile(0.95) <= first.peaks.max()
    assert first.lost.max() == 0


def test_poses_out_of_reach_are_left_out_of_samples() -> None:
    reached, beyond_reach = [0.0, 0.0, 0.0, -0.5], [0.0, 0.0, 0.0, -5.0]
    alone = length_tolerance(BALANCED, 0.01, [reached], samples=5)
    among = length_tolerance(BALANCED, 0.01, [beyond_reach, reached], samples=5)
    np.testing.assert_allclose(among.peaks, alone.peaks, rtol=1e-9)


def test_only_the_magnification_unbalances_masses_at_joints() -> None:
    lengths = {path: 0.01 for path in LENGTH_PATHS if path != "geometry.magnification"}
    still = length_tolerance(BALANCED, lengths, POSES, samples=20)
    assert still.peaks.max() < 1e-12
    lever = length_tolerance(WITH_WEIGHT, {"counterweights.0.beyond": 0.05}, POSES, samples=50)
    assert lever.peaks.max() > 1e-3
    weight = WITH_WEIGHT.counterweights[0]
    moved = replace(weight, beyond=1.05 * weight.beyond)
    worst = np.abs(static_torques(replace(WITH_WEIGHT, counterweights=(moved,)), POSES)[..., :3])
    assert 0.8 * worst.max() < lever.peaks.max() <= worst.max() * (1 + 1e-9)


def test_a_draw_at_its_upper_end_is_the_longest_length(monkeypatch: pytest.MonkeyPatch) -> None:
    class Highest:
        def uniform(self, low: float, high: float, size: int) -> Any:
            return np.full(size, high)

    monkeypatch.setattr(np.random, "default_rng", lambda seed: Highest())
    pose = [0.02, 0.01, 0.1, -0.5]
    name = "geometry.platform_radius"
    found = length_tolerance(APPENDIX_4, {name: 0.05}, pose, samples=1)
    longest = APPENDIX_4.vary({name: 1.05 * APPENDIX_4.value(name)})
    torque = np.abs(static_torques(longest, pose)[:3]).max()
    assert found.peaks == pytest.approx([torque])
    assert found.nominal != pytest.approx(torque)


def test_drawn_lengths_are_even_about_their_values() -> None:
    """M_p2 is linear in the place of a counterweight, so that its samples show those drawn."""
    part = 0.5
    lever = {"counterweights.0.beyond": part}
    found = length_tolerance(WITH_WEIGHT, lever, [0.0, 0.0, 0.0, -0.5], samples=300)
    weight = WITH_WEIGHT.counterweights[0]
    ends = [
        static_imbalance(
            replace(WITH_WEIGHT, counterweights=(replace(weight, beyond=share * weight.beyond),))
        )
        for share in (1 - part, 1 + part)
    ]
    low, high = sorted(ends)
    share = (found.balance - low) / (high - low)  # 0 to 1
    assert -1e-9 <= share.min() < 0.02
    assert 0.98 < share.max() <= 1 + 1e-9
    assert share.mean() == pytest.approx(0.5, abs=4 / np.sqrt(12 * 300))
    assert share.std() == pytest.approx(1 / np.sqrt(12), rel=0.1)


@pytest.mark.parametrize(
    "make",
    [
        lambda: mass_tolerance(BALANCED, -0.1, POSES),
        lambda: mass_tolerance(BALANCED, {"joints.j7": 0.1, "links.b8": 1.0}, POSES),
        lambda: mass_tolerance(BALANCED, {"geometry.base_radius": 0.1}, POSES),
        lambda: length_tolerance(BALANCED, {"joints.j7": 0.1}, POSES),
        lambda: length_tolerance(BALANCED, 1.5, POSES),
        lambda: length_tolerance(BALANCED, 0.1, POSES, samples=0),
        lambda: length_tolerance(BALANCED, 0.1, [[0.0, 0.0, 0.0, -9.0]]),
    ],
    ids=count(),
)
def test_impossible_requests_are_rejected(make) -> None:
    with pytest.raises(InvalidInput):
        make()
