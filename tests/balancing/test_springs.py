"""Springs: torques are the slope of their energy, fits are optimal, one of them is exact."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import (
    Anchor,
    Spring,
    SpringPlace,
    at_joint,
    fit_springs,
    on_bar,
    on_guide,
    on_slider,
    spring_energy,
    spring_lengths,
    spring_torques,
)
from paminsa_viz.model import (
    APPENDIX_4,
    InvalidDesign,
    InvalidInput,
    KneeBranch,
    inverse_jacobian,
    inverse_kinematics,
    static_imbalance,
    static_torques,
)
from tests.balancing.robots import workspace
from tests.support import samples
from tests.support.cases import BOTH, Case, cases
from tests.support.samples import with_knee

ANCHORS = (
    at_joint(2), at_joint(3), at_joint(4), at_joint(5), at_joint(7), at_joint(8), at_joint(9),
    on_bar("b8", 8, 0.1), on_bar("b3", 7, -0.05), on_guide(0.0, 0.3), on_guide(-0.2, 0.1),
    on_slider(0.25),
)  # fmt: skip
PAIRS = st.lists(st.sampled_from(ANCHORS), min_size=2, max_size=2, unique=True)


@given(case=cases(), pair=PAIRS, free=st.sampled_from([0.0, 0.2]))
def test_torques_are_the_slope_of_the_energy(case: Case, pair: list[Anchor], free: float) -> None:
    """Power of the actuators against growth of the energy, in each direction of the pose."""
    g, pose = case.geometry, case.poses(4)
    spring = Spring(*pair, stiffness=120.0, free_length=free)
    if not (spring_lengths(g, spring, pose) > 0.01).all():
        return  # 3 of k and 8 of a short guide may meet: no direction there
    torque = spring_torques(g, [spring], pose)
    on_pose = np.einsum("nji,nj->ni", inverse_jacobian(g, pose), torque)
    h = 1e-6
    for i in range(4):
        ahead, behind = pose.copy(), pose.copy()
        ahead[:, i] += h
        behind[:, i] -= h
        slope = (spring_energy(g, spring, ahead) - spring_energy(g, spring, behind)) / (2 * h)
        np.testing.assert_allclose(on_pose[:, i], slope, rtol=1e-5, atol=1e-4)


@given(case=cases())
def test_lengths_are_distances_between_joints(case: Case) -> None:
    pose = case.poses(4)
    points = inverse_kinematics(case.geometry, pose).points
    for a, b in ((2, 9), (3, 4), (7, 5), (8, 9)):
        found = spring_lengths(case.geometry, Spring(at_joint(a), at_joint(b), 1.0), pose)
        np.testing.assert_allclose(
            found, np.linalg.norm(points[a] - points[b], axis=-1), rtol=1e-9, atol=1e-12
        )


@given(case=cases())
def test_posts_and_masts_are_where_their_numbers_say(case: Case) -> None:
    pose = case.poses(4)
    points = inverse_kinematics(case.geometry, pose).points
    toward = (points[5] - points[3]) * [1.0, 1.0, 0.0]
    toward /= np.linalg.norm(toward, axis=-1, keepdims=True)
    on_axis = points[3] * [1.0, 1.0, 0.0]
    up = np.array([0.0, 0.0, 1.0])
    for anchor, place in (
        (on_guide(-0.2, 0.1), on_axis - 0.2 * toward + 0.1 * up),
        (on_guide(0.3, -0.4), on_axis + 0.3 * toward - 0.4 * up),
        (on_slider(0.25), points[8] + 0.25 * up),
    ):
        for spring in (Spring(anchor, at_joint(9), 1.0), Spring(at_joint(9), anchor, 1.0)):
            found = spring_lengths(case.geometry, spring, pose)
            np.testing.assert_allclose(
                found, np.linalg.norm(place - points[9], axis=-1), rtol=1e-9, atol=1e-12
            )


@BOTH
def test_a_mast_on_the_slider_balances_exactly(knee: KneeBranch) -> None:
    """K h = M_p2 with a free length of zero, where the mast is and wherever the robot goes."""
    sign = knee.sign
    place = SpringPlace(on_slider(0.2), at_joint(9))
    fit = fit_springs(with_knee(APPENDIX_4, knee), [place], workspace(sign).poses())
    (spring,) = fit.springs
    assert spring.stiffness == pytest.approx(static_imbalance(APPENDIX_4) / 0.2, rel=1e-9)
    assert fit.after < 1e-8
    poses = samples.random_poses(np.random.default_rng(0), with_knee(APPENDIX_4, knee), 1000)
    exact = Spring(on_slider(0.2), at_joint(9), static_imbalance(APPENDIX_4) / 0.2)
    held = static_torques(with_knee(APPENDIX_4, knee), poses)
    left = held + spring_torques(with_knee(APPENDIX_4.geometry, knee), [exact], poses)
    assert np.abs(left[:, :3]).max() < 1e-12 * np.abs(held[:, :3]).max()
    assert np.ptp(left[:, 3]) < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("measure", ["peak", "rms"])
def test_fit_meets_its_bound_and_beats_random_springs(
    measure: str, capfd: pytest.CaptureFixture[str]
) -> None:
    poses = workspace().poses()
    places = [
        SpringPlace(on_guide(0.0, 0.3), at_joint(9), 200.0, 0.1, 0.5),
        SpringPlace(on_guide(-0.2, 0.2), at_joint(7), 300.0),
    ]
    began = time.perf_counter()
    fit = fit_springs(APPENDIX_4, places, poses, measure=measure)
    assert 0 < fit.seconds <= time.perf_counter() - began
    assert capfd.readouterr() == ("", "")  # a solver may say much
    g = APPENDIX_4.geometry
    gravity = static_torques(APPENDIX_4, poses)[..., :3]

    def of(torque: np.ndarray) -> float:
        return float(np.abs(torque).max() if measure == "peak" else np.sqrt(np.mean(torque**2)))

    left = gravity + spring_torques(g, fit.springs, poses)[..., :3]
    assert fit.before == pytest.approx(of(gravity), rel=1e-12)
    assert fit.after == pytest.approx(of(left), rel=1e-7)
    assert fit.after < 0.8 * fit.before
    assert fit.gap <= 1e-8 * fit.before
    rng = np.random.default_rng(0)
    best = np.inf
    for _ in range(60):
        springs = [
            replace(
                spring,
                stiffness=min(rng.uniform(0.8, 1.2) * spring.stiffness, place.max_stiffness),
                free_length=rng.uniform(place.min_free_length, place.max_free_length),
            )
            for spring, place in zip(fit.springs, places, strict=True)
        ]
        best = min(best, of(gravity + spring_torques(g, springs, poses)[..., :3]))
    assert best >= fit.lower_bound - 1e-12
    for (low, high), spring in zip(fit.reach, fit.springs, strict=True):
        lengths = spring_lengths(g, spring, poses)
        assert (low, high) == (lengths.min(), lengths.max())


@pytest.mark.parametrize(
    "make",
    [
        lambda: at_joint(6),
        lambda: Anchor("sky"),
        lambda: on_bar("b8", 7, 0.0),
        lambda: on_guide(np.nan, 0.0),
        lambda: SpringPlace(at_joint(8), at_joint(9), -1.0),
        lambda: SpringPlace(at_joint(8), at_joint(9), 1.0, 0.3, 0.2),
        lambda: fit_springs(APPENDIX_4, [], [[0.0, 0.0, 0.0, -0.5]], measure="mean"),
        lambda: spring_energy(APPENDIX_4, SpringPlace(at_joint(8), at_joint(9)), [0, 0, 0, -0.5]),
        lambda: fit_springs(APPENDIX_4, [], [[0.0, 0.0, 0.0, -5.0]]),
    ],
    ids=count(),
)
def test_impossible_springs_are_rejected(make) -> None:
    with pytest.raises((InvalidInput, InvalidDesign)):
        make()


def test_poses_out_of_reach_do_not_count_in_a_fit() -> None:
    place, poses = SpringPlace(on_slider(0.2), at_joint(9)), workspace().poses().reshape(-1, 4)
    wider = np.vstack([poses, [[0.0, 0.0, 0.0, -5.0], [9.0, 0.0, 0.0, -0.5]]])
    fits = [fit_springs(APPENDIX_4, [place], some, measure="rms") for some in (poses, wider)]
    assert replace(fits[1], seconds=fits[0].seconds) == fits[0]


def test_no_spring_changes_nothing() -> None:
    fit = fit_springs(APPENDIX_4, [], workspace().poses())
    assert fit.springs == ()
    assert fit.after == fit.before == pytest.approx(fit.lower_bound)


def test_springs_that_do_not_help_are_none() -> None:
    """One that pulls the wrong way, one whose ends keep their distance; and one that helps."""
    poses = workspace().poses()
    for measure in ("peak", "rms"):
        for first in (on_slider(-0.3), at_joint(8)):
            place = SpringPlace(first, at_joint(9), min_free_length=0.1, max_free_length=0.2)
            fit = fit_springs(APPENDIX_4, [place], poses, measure=measure)
            assert not fit.helps, (measure, first.name)
            assert (fit.springs[0].stiffness, fit.springs[0].free_length) == (0.0, 0.1)
            assert fit.after == fit.before == pytest.approx(fit.lower_bound, rel=1e-9)
        assert fit_springs(
            APPENDIX_4, [SpringPlace(on_slider(0.3), at_joint(9))], poses, measure=measure
        ).helps


def test_poses_of_any_shape_are_as_each_alone() -> None:
    spring = Spring(at_joint(3), at_joint(9), stiffness=120.0, free_length=0.2)
    poses = workspace().poses().reshape(-1, 4)[:6].reshape(2, 3, 4)
    for of in (spring_energy, spring_lengths):
        found = of(APPENDIX_4, spring, poses)
        for index in np.ndindex(2, 3):
            alone = of(APPENDIX_4, spring, poses[index])
            np.testing.assert_allclose(found[index], alone, rtol=1e-12)
    found = spring_torques(APPENDIX_4, [spring], poses)
    np.testing.assert_allclose(found[1, 2], spring_torques(APPENDIX_4, [spring], poses[1, 2]))
