"""Time laws: from rest at 0 to rest at 1, exact derivatives, limits used fully."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import Profile, TimeLaw, fit_law

SHARES = st.floats(0.02, 0.5)
laws = st.builds(TimeLaw, st.sampled_from(Profile), SHARES, SHARES)


def between(law: TimeLaw, count: int = 9) -> np.ndarray:
    share = (np.arange(count) + 0.5) / count
    return (law.breaks[:-1, None] + np.diff(law.breaks)[:, None] * share).ravel()


@given(laws)
def test_from_rest_at_zero_to_rest_at_one(law: TimeLaw) -> None:
    ends = np.array([0.0, 1.0])
    np.testing.assert_allclose(law(ends), ends, atol=1e-14)
    assert not law(ends, 1).any()
    if law.bounded_jerk:
        np.testing.assert_allclose(law(ends, 2), 0.0, atol=1e-10)
    assert (np.diff(law(np.linspace(0, 1, 500))) > 0).all()


@pytest.mark.parametrize("profile", Profile)
def test_at_both_ends_derivatives_are_those_inside_and_there_are_none_outside(
    profile: Profile,
) -> None:
    law = TimeLaw(profile, 0.3, 0.4)
    for order in (1, 2, 3):
        ends, inside = law(np.array([0.0, 1.0]), order), law(np.array([1e-12, 1 - 1e-12]), order)
        np.testing.assert_allclose(ends, inside, atol=1e-7)
        assert not law(np.array([-1e-12, 1 + 1e-12]), order).any()


@given(laws)
def test_derivatives(law: TimeLaw) -> None:
    u, h = between(law), 1e-6
    for order in (1, 2, 3):
        numeric = (law(u + h, order - 1) - law(u - h, order - 1)) / (2 * h)
        exact = law(u, order)
        assert np.abs(numeric - exact).max() <= 1e-5 * max(1.0, np.abs(law(u, 3)).max())


@given(laws)
def test_smoothness_is_as_declared(law: TimeLaw) -> None:
    inner, gap = law.breaks[1:-1], 1e-9
    for order in (0, 1, 2) if law.bounded_jerk else (0, 1):
        jump = law(inner + gap, order) - law(inner - gap, order)
        size = np.abs(law(between(law), order + 1)).max(initial=1.0)
        assert (np.abs(jump) <= 4 * gap * size).all()


@given(laws)
def test_law_is_at_rest_outside(law: TimeLaw) -> None:
    u = np.array([-0.5, -1e-9, 1 + 1e-9, 3.0])
    np.testing.assert_allclose(law(u), [0, 0, 1, 1], atol=1e-14)
    for order in (1, 2, 3):
        assert not law(u, order).any()


@given(SHARES)
def test_trapezoid_has_constant_acceleration_and_speed(ramp: float) -> None:
    law = TimeLaw(Profile.TRAPEZOID, ramp)
    u = between(law)
    top = 1 / (1 - ramp)
    np.testing.assert_allclose(law(u, 1)[(u > ramp) & (u < 1 - ramp)], top, rtol=1e-12)
    growth = np.where(u < ramp, top / ramp, np.where(u > 1 - ramp, -top / ramp, 0.0))
    np.testing.assert_allclose(law(u, 2), growth, rtol=1e-12, atol=1e-10)


@given(SHARES, SHARES)
def test_s_curve_has_one_jerk(ramp: float, blend: float) -> None:
    law = TimeLaw(Profile.S_CURVE, ramp, blend)
    jerk = np.abs(law(between(law), 3))
    size = 1 / ((1 - ramp) * ramp**2 * (1 - blend) * blend)
    np.testing.assert_allclose(jerk[jerk > 1e-6 * size], size, rtol=1e-9)


limits = st.floats(0.05, 50.0)


@pytest.mark.parametrize("profile", [Profile.TRAPEZOID, Profile.S_CURVE])
def test_a_fitted_law_uses_its_limits_fully(profile: Profile) -> None:
    """Time-optimal: the highest limit always reached, each lower one unless there is no time."""
    rng = np.random.default_rng(0)
    for given_limits in np.exp(rng.uniform(np.log(0.05), np.log(50.0), (100, 3))):
        assert_limits_are_used(profile, *given_limits.tolist())


def assert_limits_are_used(
    profile: Profile, speed: float, acceleration: float, jerk: float
) -> None:
    found = fit_law(TimeLaw(profile), speed, acceleration, jerk)
    assert found is not None
    law, duration = found
    u = np.concatenate([between(law), law.breaks + 1e-12, law.breaks - 1e-12])
    u = u[(u > 0) & (u < 1)]
    top = [np.abs(law(u, order)).max() / duration**order for order in (1, 2, 3)]
    if law.ramp <= 1e-3:  # the tops lie within rounding of the breaks
        return
    for order, (value, limit) in enumerate(zip(top, (speed, acceleration, jerk), strict=True)):
        if order < 2 or profile is Profile.S_CURVE:
            assert value <= limit * (1 + 1e-9)
    assert top[0] >= speed * (1 - 1e-6) or law.ramp == pytest.approx(0.5, abs=1e-9)
    if profile is Profile.TRAPEZOID:
        assert top[1] == pytest.approx(acceleration, rel=1e-6)
    else:
        assert top[2] == pytest.approx(jerk, rel=1e-6)
        assert top[1] >= acceleration * (1 - 1e-6) or law.blend == pytest.approx(0.5, abs=1e-9)


@given(limits, limits)
def test_an_s_curve_without_a_jerk_limit_keeps_its_blend(speed, acceleration) -> None:
    found = fit_law(TimeLaw(Profile.S_CURVE, blend=0.3), speed, acceleration)
    assert found is not None
    law, duration = found
    assume(law.ramp > 1e-3)
    u = np.append(between(law, 51), law.ramp / 2)
    assert law.blend == 0.3
    assert np.abs(law(u, 2)).max() / duration**2 == pytest.approx(acceleration, rel=1e-9)
    assert np.abs(law(np.array([0.5]), 1))[0] / duration <= speed * (1 + 1e-9)


def test_a_speed_that_is_hardly_reached_makes_ramps_of_half_the_time_each() -> None:
    """With an acceleration of 1 it is reached after half of the way if its square is 1."""
    for speed, ramp, wanted in (
        (1.02, 1.0, 2.0), (1.0, 1.0, 2.0), (0.98, 0.98, 1.0 / 0.98 + 0.98),
    ):  # fmt: skip
        found = fit_law(TimeLaw(Profile.TRAPEZOID), speed, 1.0)
        assert found is not None
        law, duration = found
        assert duration == pytest.approx(wanted)
        assert law.ramp == pytest.approx(ramp / wanted)


def test_ramps_that_reach_their_acceleration_at_their_middle_alone_blend_half_of_the_time() -> None:
    """Whatever rounding makes of it; a share of more than a half would be refused."""
    for acceleration, jerk in np.random.default_rng(1).uniform(0.1, 9.0, (200, 2)).tolist():
        found = fit_law(TimeLaw(Profile.S_CURVE), acceleration**2 / jerk, acceleration, jerk)
        assert found is not None
        assert found[0].blend == pytest.approx(0.5)


def test_coefficients_are_those_of_the_law_between_its_breaks() -> None:
    for profile in Profile:
        law = TimeLaw(profile)
        for begin, end, c in zip(law.breaks, law.breaks[1:], law.coefficients.T, strict=False):
            u = np.linspace(begin, end, 5)
            np.testing.assert_allclose(np.polyval(c, u - begin), law(u), atol=1e-14)


def test_limits_without_a_shape_give_none() -> None:
    assert fit_law(TimeLaw(), 1.0, 1.0, 1.0) is None
    assert fit_law(TimeLaw(Profile.TRAPEZOID), 1.0) is None
    assert fit_law(TimeLaw(Profile.S_CURVE), 1.0) is None


@pytest.mark.parametrize("share", [0.0, -0.1, 0.51, float("nan")])
@pytest.mark.parametrize("name", ["ramp", "blend"])
def test_impossible_shares(name: str, share: float) -> None:
    with pytest.raises(InvalidInput, match=name):
        TimeLaw(**{name: share})
