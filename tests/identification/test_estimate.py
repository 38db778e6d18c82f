"""Blocks and weighted least squares, against their definitions on random numbers."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.estimate import (
    BLOCKS_AT_ONCE,
    ITERATIONS,
    block_numbers,
    directions,
    jackknife,
    normal_blocks,
    solve,
)
from paminsa_viz.identification.log import InvalidLog

STEP = 0.01


def random_columns(seed: int, samples: int = 240, unknowns: int = 5) -> tuple[Any, Any, Any]:
    """Columns (m, 4, n), numbers x and blocks of the samples."""
    rng = np.random.default_rng(seed)
    columns = rng.standard_normal((samples, 4, unknowns)) * [1.0, 20.0, 1.0, 0.05, 300.0]
    numbers = np.sort(rng.integers(0, 12, samples))
    numbers[:12] = np.arange(12)
    return columns, rng.standard_normal(unknowns), np.sort(numbers)


@given(
    sizes=st.lists(st.integers(1, 900), min_size=1, max_size=4).filter(lambda s: sum(s) >= 1500),
    length=st.sampled_from([0.5, 0.73, 1.0]),
)
def test_blocks_are_whole_and_within_a_segment(sizes: list[int], length: float) -> None:
    """What is left over at a segment's end is less than a block, and belongs to its last one."""
    segment = np.repeat(np.arange(len(sizes)), sizes)
    t = np.concatenate([100.0 * i + STEP * np.arange(n) for i, n in enumerate(sizes)])
    numbers = block_numbers(t, segment, length)
    assert numbers[0] == 0
    assert set(np.diff(numbers)) <= {0, 1}
    for number in range(numbers[-1] + 1):
        inside = numbers == number
        assert len(set(segment[inside])) == 1
        lasts = STEP * np.count_nonzero(inside)
        assert lasts < 2 * length + STEP / 2
        if np.count_nonzero(segment == segment[inside][0]) * STEP >= length:
            assert lasts > length - 1.5 * STEP
        ends = inside.nonzero()[0][-1]
        if ends + 1 < len(t) and segment[ends + 1] == segment[ends]:  # not the last of its segment
            assert lasts == pytest.approx(length, abs=1.01 * STEP)


@pytest.mark.parametrize("count", [599, 600, 601, 699])
def test_blocks_begin_at_whole_numbers_of_their_length(count: int) -> None:
    """By counting: a hundred samples each, the last one has the rest; a single sample is one."""
    t = np.append(3.0 + STEP * np.arange(count), 20.0)
    segment = np.append(np.zeros(count, np.int64), 1)
    expected = np.minimum(np.arange(count) // 100, count // 100 - 1)
    numbers = block_numbers(t, segment, 1.0)
    assert numbers.tolist() == [*expected.tolist(), count // 100]


def test_too_few_blocks_are_refused() -> None:
    t = STEP * np.arange(500)
    everywhere = np.zeros(len(t), np.int64)
    assert block_numbers(t, everywhere, 1.0)[-1] == 4
    with pytest.raises(ValueError, match=r"^4 blocks of 1\.1 s are left .* intervals need 5"):
        block_numbers(t, everywhere, 1.1)
    with pytest.raises(ValueError, match=r"^1 block of 4 s is left "):
        block_numbers(t, everywhere, 4.0)


def test_normal_equations_of_many_blocks_are_those_of_each_in_little_memory() -> None:
    rng = np.random.default_rng(2)
    counts = rng.integers(4, 12, 6 * BLOCKS_AT_ONCE + 3)
    numbers = np.repeat(np.arange(len(counts)), counts)
    columns = rng.normal(size=(len(numbers), 4, 6))
    torque = rng.normal(size=(len(numbers), 4))
    tracemalloc.start()
    found = normal_blocks([columns[..., :4], columns[..., 4:]], torque, numbers)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # what is returned, and no padded copy of all rows
    assert found.matrix.base is not None
    assert most < found.matrix.base.nbytes + 0.8 * columns.nbytes
    assert found.samples.tolist() == counts.tolist()
    for number in range(0, len(counts), 7):
        x, y = columns[numbers == number], torque[numbers == number]
        for j in range(4):
            a = x[:, j]
            np.testing.assert_allclose(found.matrix[number, j], a.T @ a, atol=1e-12)
            np.testing.assert_allclose(found.right[number, j], a.T @ y[:, j], atol=1e-12)
            assert found.square[number, j] == pytest.approx(y[:, j] @ y[:, j])


def test_no_block_is_shorter_than_a_sample() -> None:
    t, segment = 5.0 + STEP * np.arange(400), np.repeat([0, 1], 200)
    assert block_numbers(t, segment, STEP).tolist() == list(range(400))
    with pytest.raises(InvalidInput, match=r"block: at least 0\.01 s, .* not 0\.009;"):
        block_numbers(t, segment, 0.009)


@pytest.mark.parametrize("seed", range(3))
def test_fit_without_a_block_is_that_of_the_other_samples(seed: int) -> None:
    columns, x, numbers = random_columns(seed)
    noise = np.array([0.1, 2.0, 0.5, 10.0])
    torque = columns @ x + noise * np.random.default_rng(seed + 9).standard_normal((240, 4))
    found = solve(normal_blocks(columns, torque, numbers))
    kept = [np.flatnonzero(numbers != number) for number in range(12)]
    # the weights are those of the last round but one, which differ little from these
    for part, expected in [(np.arange(240), found.x), *zip(kept, found.without, strict=True)]:
        rows = (columns[part] / found.noise[:, None]).reshape(-1, 5)
        fit = np.linalg.lstsq(rows, (torque[part] / found.noise).ravel())[0]
        np.testing.assert_allclose(expected, fit, rtol=1e-2, atol=1e-3)
    left = torque - columns @ found.x
    np.testing.assert_allclose(found.noise, np.sqrt((left**2).mean(axis=0)), rtol=1e-6)
    np.testing.assert_allclose(found.noise, noise, rtol=0.25)
    assert found.excited.shape == (5, 5)
    assert found.blocks == 12
    expected = np.sqrt(11 / 12 * ((found.without - found.without.mean(axis=0)) ** 2).sum(axis=0))
    np.testing.assert_allclose(found.deviation(np.eye(5)), expected)
    np.testing.assert_allclose(jackknife(found.without), expected)
    # 95 % to both sides, of Student's t with 11 degrees of freedom
    assert found.quantile == pytest.approx(2.200985, rel=1e-6)


def test_weights_are_those_of_the_residuals_of_the_round_before() -> None:
    """From the torques themselves on, so often as is said; the noise is that of the last fit."""
    columns, x, numbers = random_columns(5)
    scale = np.array([0.1, 2.0, 0.5, 10.0])
    torque = columns @ x + scale * np.random.default_rng(1).standard_normal((240, 4))
    noise = np.sqrt((torque**2).mean(axis=0))
    for _ in range(ITERATIONS):
        rows = (columns / noise[:, None]).reshape(-1, 5)
        fit = np.linalg.lstsq(rows, (torque / noise).ravel())[0]
        noise = np.sqrt(((torque - columns @ fit) ** 2).mean(axis=0))
    found = solve(normal_blocks(columns, torque, numbers))
    np.testing.assert_allclose(found.x, fit, rtol=1e-9)
    np.testing.assert_allclose(found.noise, noise, rtol=1e-6)  # a small rest of large sums
    # another round would change little
    again = (columns / noise[:, None]).reshape(-1, 5)
    fourth = np.linalg.lstsq(again, (torque / noise).ravel())[0]
    assert np.abs(fourth / fit - 1).max() < 1e-3


def test_an_actuator_without_residuals_has_the_least_noise_that_a_sensor_resolves() -> None:
    """A thousand-millionth of the largest torque: one silent actuator does not decide alone."""
    columns, x, numbers = random_columns(7)
    columns[:, 3] = 0.0
    torque = columns @ x + 0.1 * np.random.default_rng(0).standard_normal((240, 4))
    torque[:, 3] = 0.0
    found = solve(normal_blocks(columns, torque, numbers))
    largest = np.sqrt((torque**2).mean(axis=0).max())
    assert found.noise[3] == pytest.approx(1e-9 * largest, rel=1e-9)
    assert np.all(found.noise[:3] > 0.05)


def test_what_a_log_does_not_excite_is_hidden_and_not_known() -> None:
    """Two columns in proportion: their sum is known, each alone is not."""
    columns, x, numbers = random_columns(3)
    columns[..., 1] = 2.0 * columns[..., 0]
    torque = columns @ x + 0.1 * np.random.default_rng(0).standard_normal((240, 4))
    found = solve(normal_blocks(columns, torque, numbers))
    assert found.hidden.shape == (5, 1)
    alone, both = np.eye(5)[:2], np.array([[1.0, 2.0, 0.0, 0.0, 0.0]])
    assert found.known(np.eye(5)).tolist() == [False, False, True, True, True]
    assert found.known(both).all()
    assert not found.known(alone).any()
    assert (both @ found.x)[0] == pytest.approx(x[0] + 2 * x[1], abs=0.1)


@pytest.mark.parametrize("alike", [False, True])
def test_intervals_are_as_wide_as_least_squares_says_where_samples_are_not_correlated(
    alike: bool,
) -> None:
    """Also of columns that are nearly alike; of each sample four times over they are twice that."""
    columns, x, _ = random_columns(2, samples=1200)
    if alike:
        columns = columns[..., :1] + 0.05 * columns / np.array([1.0, 20.0, 1.0, 0.05, 300.0])
    torque = columns @ x + np.random.default_rng(4).standard_normal((1200, 4))
    numbers = np.arange(1200) // 20
    once = solve(normal_blocks(columns, torque, numbers))
    assert once.widening == pytest.approx(1.0, abs=0.15)
    rows = (columns / once.noise[:, None]).reshape(-1, 5)
    plain = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    assert np.median(once.deviation(np.eye(5)) / plain) == pytest.approx(once.widening, rel=0.2)
    four = [np.repeat(part, 4, axis=0) for part in (columns, torque, numbers)]
    assert solve(normal_blocks(*four)).widening == pytest.approx(2.0 * once.widening, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_what_is_told_and_known_does_not_depend_on_units(seed: int) -> None:
    """Of numbers in units a million times as large or small, one of which is not excited."""
    columns, x, numbers = random_columns(seed)
    columns[..., 1] = 2.0 * columns[..., 0]
    torque = columns @ x + 0.1 * np.random.default_rng(seed).standard_normal((240, 4))
    units = np.array([1e6, 1e6, 1e-6, 1e3, 1e-3])
    one, other = (
        solve(normal_blocks(columns * factor, torque, numbers)) for factor in (np.ones(5), units)
    )
    rows = np.array([[0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, 1], [1, 2, 0, 0, 0.0]])
    np.testing.assert_allclose(one.x[2:], (units * other.x)[2:], rtol=1e-6)
    np.testing.assert_allclose(one.noise, other.noise, rtol=1e-6)
    np.testing.assert_allclose(one.deviation(rows), other.deviation(rows * units), rtol=1e-5)
    for row, known in zip(np.eye(5), (False, False, True, True, True), strict=True):
        assert one.known(row[None]).tolist() == other.known((row * units)[None]).tolist() == [known]
    assert one.known(rows).all()
    assert other.known(rows * units).all()
    assert one.widening == pytest.approx(other.widening, rel=1e-4)


@pytest.mark.parametrize("scale", [1.0, 1e6])
@pytest.mark.parametrize(("share", "excited"), [(1.05e-11, 2), (0.95e-11, 1)])
def test_two_columns_are_told_apart_down_to_an_eigenvalue_of_a_hundred_thousand_millionth(
    share: float, excited: int, scale: float
) -> None:
    """Of correlation c, whatever their sizes: eigenvalues 1 - c and 1 + c, directions (1, -+1)."""
    c = (1.0 - share) / (1.0 + share)
    matrix, size = np.eye(4), np.array([1.0, scale, 3.0, scale])
    matrix[[0, 1], [1, 0]] = c  # two others go along with nothing
    found, hidden = directions(matrix * size * size[:, None])
    assert (found.shape, hidden.shape) == ((4, excited + 2), (4, 2 - excited))
    ways = np.concatenate([hidden, found], axis=1) * size[:, None]
    np.testing.assert_allclose(np.abs(ways[:2, [0, -1]]), np.sqrt(0.5), rtol=1e-5)
    assert ways[:2, 0].prod() < 0 < ways[:2, -1].prod()


def test_a_number_that_only_one_block_tells_is_nothing_without_it() -> None:
    """Though the equations are singular then; the others are those of the other samples."""
    columns, x, numbers = random_columns(4)
    columns[numbers != 3, :, 1] = 0.0
    torque = columns @ x + 0.1 * np.random.default_rng(0).standard_normal((240, 4))
    found = solve(normal_blocks(columns, torque, numbers))
    assert found.excited.shape == (5, 5)
    assert found.without[3, 1] == pytest.approx(0.0, abs=1e-6)
    assert found.x[1] == pytest.approx(x[1], abs=0.05)
    left = numbers != 3
    rows = (columns[left] / found.noise[:, None])[..., [0, 2, 3, 4]].reshape(-1, 4)
    fit = np.linalg.lstsq(rows, (torque[left] / found.noise).ravel())[0]
    np.testing.assert_allclose(found.without[3, [0, 2, 3, 4]], fit, rtol=1e-2, atol=1e-3)


def test_columns_of_zeros_are_hidden_and_nothing_else_is_refused() -> None:
    found, hidden = directions(np.diag([4.0, 0.0, 9.0]))
    np.testing.assert_allclose(np.sort(np.abs(found).sum(axis=1)), [0.0, 1 / 3, 1 / 2])
    np.testing.assert_allclose(np.abs(hidden[:, 0]), [0.0, 1.0, 0.0])
    with pytest.raises(InvalidLog, match="does not move"):
        directions(np.zeros((2, 2)))


@pytest.mark.parametrize(("share", "known"), [(0.95e-4, True), (1.05e-4, False)])
def test_a_sum_is_known_of_which_a_ten_thousandth_is_not_excited(share: float, known: bool) -> None:
    columns, x, numbers = random_columns(3)
    columns[..., 1] = 2.0 * columns[..., 0]
    torque = columns @ x + 0.1 * np.random.default_rng(0).standard_normal((240, 4))
    found = solve(normal_blocks(columns, torque, numbers))
    # by columns of one size the hidden direction is (1, -1) / sqrt(2)
    row = np.array([[1.0 + share, 1.0 - share, 0.0, 0.0, 0.0]])
    assert found.known(row * np.sqrt(np.diag(found.information))).tolist() == [known]
