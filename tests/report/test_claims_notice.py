"""Each claim notices when one value of what it checks is off, to either side."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, check_reach
from paminsa_viz.report import claims
from paminsa_viz.report.claim import Claim, MeasuredClaim
from paminsa_viz.report.claims import CLAIMS
from tests.support.documentation import missing

Change = Callable[[Any, float], Any]

ROW = 17
"""The pose at which a value is off."""


def value(column: int, amount: float, field: str = "") -> Change:
    """One number of an array, or of the array that is a field of the result, is off."""

    def change(found: Any, sign: float) -> Any:
        array = np.array(getattr(found, field) if field else found, dtype=float)
        rows = array.reshape(-1, array.shape[-1])
        rows[min(ROW, len(rows) - 1), column] += sign * amount
        return SimpleNamespace(**{field: array}) if field else array

    return change


def scaled(share: float) -> Change:
    """The duration of a motion is off by a share."""

    def change(found: Any, sign: float) -> Any:
        duration = found.plan.duration * (1.0 + sign * share)
        return SimpleNamespace(plan=SimpleNamespace(duration=duration))

    return change


def added(amount: float) -> Change:
    return lambda found, sign: found + sign * amount


OFF: list[tuple[str, str, Change]] = [
    ("The inverse kinematics", "nearest_solution", value(2, 3e-12)),
    ("det J is zero where", "singular_rotation", added(3e-10)),
    ("det J is zero on a circle", "singular_radius", added(3e-10)),
    ("G t_s = 0", "escape_twist", value(1, 1e-11)),
    *(("Static torques are the gradient", "static_torques", value(j, size))
      for j, size in enumerate((2e-5, 2e-5, 2e-5, 2e-4))),
    ("Power of the actuators", "inverse_dynamics", value(3, 1.0, "torque")),
    *(("Torques are linear", "regressor_torques", value(j, size))
      for j, size in enumerate((1e-9, 1e-9, 1e-9, 1e-8))),
    *(("Turning x, y", "static_torques", value(j, 1e-9)) for j in range(3)),
    *(("Gravity torques", "static_torques", value(j, 1e-9)) for j in range(3)),
    *(("The balanced robot", "static_torques", value(j, 1e-6)) for j in range(3)),
    *(("Joint forces give", "joint_forces", value(j, size, "torque"))
      for j, size in enumerate((1e-7, 1e-7, 1e-7, 1e-6))),
    *(("Legs of nominal lengths", "solve_pose", value(j, 3e-9, "coordinates")) for j in range(4)),
    ("The time-optimal law", "shortest_motion", scaled(1e-3)),
    ("On a circle", "shortest_motion", scaled(2e-3)),
]  # fmt: skip


def starting(text: str) -> Claim:
    (found,) = (claim for claim in CLAIMS if claim.text.startswith(text))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("text", "name", "change"), OFF, ids=range(len(OFF)))
def test_a_claim_fails_where_one_value_is_off(
    text: str, name: str, change: Change, sign: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = getattr(claims, name)
    monkeypatch.setattr(claims, name, lambda *a, **k: change(right(*a, **k), sign))
    claim = starting(text)
    assert not MeasuredClaim(claim, claim.measure()).holds


def test_one_heading_of_the_circle_is_enough_to_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    right = claims.singular_radius
    for at in (-0.4, 0.0, 0.3, 0.9):
        monkeypatch.setattr(
            claims, "singular_radius", lambda g, t, at=at: right(g, t) + 3e-10 * (t == at)
        )
        claim = starting("det J is zero on a circle")
        assert not MeasuredClaim(claim, claim.measure()).holds


@pytest.mark.slow
def test_torques_beyond_the_limit_are_noticed_at_one_sample(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Off the crossing, on any of the three actuators, to either side."""
    right = claims.inverse_dynamics
    for column, sign in ((0, 1.0), (1, -1.0), (2, 1.0)):
        change = value(column, 30.0, "torque")
        monkeypatch.setattr(
            claims, "inverse_dynamics", lambda *a, c=change, s=sign: c(right(*a), s)
        )
        claim = starting("Torques keep 10 N·m")
        assert not MeasuredClaim(claim, claim.measure()).holds


def test_torques_between_samples_are_looked_at_ten_thousand_times_a_second(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Those of each actuator over its own limit, of either sign."""
    rates: list[float] = []
    motion = claims.PRESET["arch"].build(APPENDIX_4.geometry).sample(20.0)

    def sample(rate: float) -> Any:
        rates.append(rate)
        return motion

    found = SimpleNamespace(plan=SimpleNamespace(sample=sample))
    monkeypatch.setattr(claims, "shortest_motion", lambda *given: found)
    for column, torque, excess in ((0, -9.0, 0.5), (2, 7.5, 0.25), (3, -500.0, 0.25)):
        every = np.zeros((motion.size, 4))
        every[5, column] = torque
        monkeypatch.setattr(
            claims, "inverse_dynamics", lambda *given, every=every: SimpleNamespace(torque=every)
        )
        assert claims._between_samples() == pytest.approx(excess)
    assert rates == [pytest.approx(10_000.0, rel=0.01)] * 3


def test_a_claim_is_about_all_its_figures_and_their_own_sizes() -> None:
    def holds(found: Any, allowed: float, stated: Any = None) -> bool:
        claim = Claim("a.md", "text", "check", "m", allowed, lambda: 0.0, stated)
        return MeasuredClaim(claim, found).holds

    for sign in (1.0, -1.0):
        assert holds(sign * 0.5, 0.5)
        assert not holds(sign * 0.51, 0.5)
        assert holds(3.0 + sign * 0.25, 0.25, 3.0)
        assert not holds(3.0 + sign * 0.26, 0.25, 3.0)
        figures = np.array([10.0, -20.0])
        assert holds(figures * (1 + sign * 0.0625), 0.0625, (10.0, -20.0))
        for place in range(2):
            worse = figures.copy()
            worse[place] *= 1 + sign * 0.07
            assert not holds(worse, 0.0625, (10.0, -20.0))
    assert not holds(np.nan, 0.5)


def test_claims_are_checked_at_as_many_poses_as_they_say() -> None:
    """About the axis and the middle of the heights, all of them within reach."""
    poses, velocity, acceleration = claims._states()
    assert len(poses) == 200
    assert check_reach(APPENDIX_4.geometry, poses).ok.all()
    middle, half = np.array([0.0, 0.0, 0.0, -0.52]), np.array([0.12, 0.12, 0.5, 0.06])
    for found, center, size in (
        (poses, middle, half), (velocity, 0.0, 1.0), (acceleration, 0.0, 5.0),
    ):  # fmt: skip
        share = (found - center) / size
        assert found.shape == (200, 4)
        assert (np.abs(share) <= 1.0).all()
        assert (share.min(axis=0) < -0.95).all()
        assert (share.max(axis=0) > 0.95).all()
    counted = {int(word) for claim in CLAIMS[:12] for word in claim.check.split() if word.isdigit()}
    assert counted == {1, 4, 50, 200}


def test_differences_are_over_the_size_of_their_own_column() -> None:
    difference = np.array([[0.1, -0.2], [-0.3, 0.1]])
    size = np.array([[1.0, -4.0], [-3.0, 2.0]])
    assert claims._relative(difference, size) == pytest.approx(0.1)
    assert claims._relative(difference[:, ::-1], size) == pytest.approx(0.075)


def test_paths_and_limits_are_those_of_the_pages() -> None:
    start, end = claims.TURN
    assert missing("crossing", [f"straight_path({start}, {end})"]) == []
    x, y, theta, z = claims.LINE[1]
    assert z == claims.LINE[0][3] == start[3] == -0.5
    assert missing("crossing", [f"({x:g}, {y:g}) m, θ = {theta:g} rad"]) == []
    limits = claims._MOTION_LIMITS
    head = (
        f"{limits.speed:g} m/s, {limits.turn_speed:g} rad/s, {limits.acceleration:g} m/s², "
        f"{limits.turn_acceleration:g} rad/s² | those, {limits.torque:g} N·m, {limits.force:g} N |"
    )
    assert missing("motions", [head]) == []


def test_newton_begins_a_millimeter_away_at_fifty_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[np.ndarray] = []

    def solved(geometry: Any, lengths: Any, actuators: Any, near: Any) -> Any:
        asked.append(near)
        return SimpleNamespace(coordinates=np.zeros((len(near), 6)))

    monkeypatch.setattr(claims, "solve_pose", solved)
    claims._unequal_legs()
    assert asked[0].shape == (50, 4)
    np.testing.assert_allclose(np.abs(asked[0] - claims._poses()[:50]), 1e-3)


def test_power_is_looked_at_along_the_motion_and_off_by_its_share(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """But for its ends; torques that are larger by a part are off by that part of the largest."""
    right, times = claims.inverse_dynamics, []
    motion = claims.PRESET["arch"].build(APPENDIX_4.geometry)
    monkeypatch.setattr(
        claims, "inverse_dynamics",
        lambda *given: SimpleNamespace(torque=1.01 * right(*given).torque),
    )  # fmt: skip
    at = type(motion).at
    monkeypatch.setattr(type(motion), "at", lambda plan, t: times.append(t) or at(plan, t))
    assert claims._power() == pytest.approx(0.01, rel=1e-3)
    share = times[-1] / motion.duration
    assert (share.min(), share.max()) == pytest.approx((0.05, 0.95))
