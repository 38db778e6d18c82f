"""What the model takes as poses, and what it says of the rest."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from paminsa_viz.model import InvalidInput, PaminsaError
from paminsa_viz.model.arrays import aligned, as_numbers, as_vectors, in_blocks, together

NO_REAL_NUMBERS: list[Any] = [
    ["0", "0", "0", "-0.5"],
    [None, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 1j],
    [Fraction(1, 2)] * 4,
    [Decimal(1)] * 4,
    [10**400, 0, 0, 0],
    np.zeros(4, "M8[D]"),
    np.zeros(4, "m8[s]"),
    {"x": 0.0, "y": 0.0},
    "pose",
    None,
    object(),
]


@pytest.mark.parametrize("values", NO_REAL_NUMBERS, ids=range(len(NO_REAL_NUMBERS)))
def test_what_is_no_real_number_is_refused(values: Any) -> None:
    for check in (as_vectors, as_numbers):
        with pytest.raises(InvalidInput) as caught:
            check(values, "velocity")
        assert caught.value.argument == "velocity"
        assert caught.value.problem.startswith("real numbers are needed, not ")
        assert str(caught.value).startswith("velocity: real numbers are needed, not ")
        assert isinstance(caught.value, PaminsaError)


def test_what_a_masked_array_hides_is_no_number() -> None:
    """Below the mask stands what a missing value was read as."""
    for hidden in (
        np.ma.masked_equal([1, -999, 3, 4], -999),
        np.ma.masked_less([1.0, -9, 3, 4], 0),
    ):
        for check in (as_vectors, as_numbers):
            np.testing.assert_array_equal(check(hidden, "pose"), [1.0, np.nan, 3.0, 4.0])
    assert as_numbers(np.ma.arange(3.0), "t").tolist() == [0.0, 1.0, 2.0]


def test_rows_of_different_lengths_are_refused() -> None:
    for check in (as_vectors, as_numbers):
        with pytest.raises(InvalidInput, match="pose: the rows have different lengths"):
            check([[0.0, 0.0, 0.0, 0.0], [0.0]], "pose")


@pytest.mark.parametrize("shape", [(), (0,), (3,), (5,), (4, 3), (4, 1), (4, 0), (2, 4, 5)])
def test_the_last_axis_has_four_entries(shape: tuple[int, ...]) -> None:
    with pytest.raises(InvalidInput, match=re.escape(f"4 entries; the shape is {shape}")):
        as_vectors(np.zeros(shape), "pose")


@given(
    values=hnp.arrays(
        st.sampled_from([np.float64, np.float32, np.float16, np.int64, np.int8, np.uint16]),
        hnp.array_shapes(min_dims=0, max_dims=3, min_side=0).map(lambda shape: (*shape, 4)),
    )
)
def test_real_numbers_of_any_kind_become_float64_unchanged(values: Any) -> None:
    taken = as_vectors(values, "pose")
    assert taken.dtype == np.float64
    np.testing.assert_array_equal(taken, values.astype(np.float64))
    if values.size:
        np.testing.assert_array_equal(as_vectors(values.tolist(), "pose"), taken)
    np.testing.assert_array_equal(as_numbers(values, "pose"), taken)


SHAPES = hnp.mutually_broadcastable_shapes(num_shapes=3, min_dims=0, max_dims=3, min_side=0)


@given(shapes=SHAPES)
def test_vectors_broadcast_over_their_batch_axes(shapes: Any) -> None:
    rng = np.random.default_rng(0)
    a, b, c = (rng.normal(size=(*shape, 4)) for shape in shapes.input_shapes)
    expected = np.broadcast_arrays(a, b, c)
    for got, wanted in zip(aligned(a=a, b=b, c=c), expected, strict=True):
        np.testing.assert_array_equal(got, wanted)
    batch, flat = together(a=a, b=b, c=c)
    assert batch == shapes.result_shape
    for got, wanted in zip(flat, expected, strict=True):
        assert got.ndim == 2
        np.testing.assert_array_equal(got.reshape(*batch, 4), wanted)


def test_batches_that_do_not_fit_are_named() -> None:
    vectors = {"pose": np.zeros((3, 4)), "velocity": np.zeros((2, 4)), "torque": np.zeros(4)}
    for check in (aligned, together):
        with pytest.raises(InvalidInput) as caught:
            check(**vectors)
        assert caught.value.argument == "pose"
        assert "pose (3, 4), velocity (2, 4), torque (4,)" in caught.value.problem
        with pytest.raises(InvalidInput, match="torque: real numbers") as caught:
            check(pose=np.zeros(4), torque=["a"] * 4)
        assert caught.value.argument == "torque"


@pytest.mark.parametrize("shape", [(), (0,), (1,), (5,), (2, 3), (2, 0)])
@pytest.mark.parametrize("size", [1, 2, 5, 7])
def test_blocks_of_a_batch_are_of_a_size_at_most_and_make_the_whole(
    shape: tuple[int, ...], size: int
) -> None:
    rng = np.random.default_rng(0)
    vectors, seen = rng.normal(size=(*shape, 4)), []

    def function(block: Any) -> tuple[Any, Any]:
        seen.append(len(block))
        return block[:, :2] + 1.0, block.sum(axis=1)

    pairs, sums = in_blocks(function, vectors, size)
    np.testing.assert_array_equal(pairs, vectors[..., :2] + 1.0)
    np.testing.assert_array_equal(sums, vectors.reshape(-1, 4).sum(axis=1).reshape(shape))
    assert max(seen) <= size
    assert len(seen) == max(-(-int(np.prod(shape)) // size), 1)
