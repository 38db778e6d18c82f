"""Results that are kept for those who use them: how many, how large, and for how long."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz import kept as module
from paminsa_viz.explorer.core import threads
from paminsa_viz.kept import Kept, User, kept, kept_bytes, size_of


class Value:
    """A result that can be told from another."""

    def __init__(self, size: int) -> None:
        self.data = np.zeros(size, dtype=np.uint8)


@pytest.fixture
def make() -> Iterator[Kept[[int], Value]]:
    """A function of a size whose last four results are kept for each user, with room for them."""
    for function in module._functions:
        function.cache_clear()

    @kept(4)
    def make(size: int) -> Value:
        return Value(size)

    yield make
    make.cache_clear()
    module._functions.remove(make)


@pytest.fixture
def users() -> Iterator[tuple[User, User]]:
    """Two users; no others are there meanwhile."""
    others = set(module._users)
    module._users.clear()
    both = User(), User()
    yield both
    for user in both:
        user.leave()
    module._users.update(others)


@pytest.mark.slow
def test_results_go_with_the_last_who_asked(
    make: Kept[[int], Value], users: tuple[User, User]
) -> None:
    one, two = users
    before = kept_bytes()
    with one.working():
        own, shared = weakref.ref(make(1000)), weakref.ref(make(2000))
    with two.working():
        assert make(2000) is shared()
    assert kept_bytes() > before + 3000
    one.leave()
    gc.collect()
    assert own() is None
    assert shared() is not None
    two.leave()
    gc.collect()
    assert shared() is None
    assert kept_bytes() == before


def test_what_comes_after_its_user_has_left_is_not_kept(
    make: Kept[[int], Value], users: tuple[User, User]
) -> None:
    one, two = users
    before = kept_bytes()
    with one.working():
        one.leave()
        assert make(1000) is not make(1000)
        with two.working():
            shared = make(3000)
        assert make(3000) is shared
    two.leave()
    assert kept_bytes() == before


@given(st.lists(st.integers(0, 12), max_size=60))
def test_last_ones_are_the_same_and_there_are_no_more(sizes: list[int]) -> None:
    function = Kept(Value, 4)
    try:
        last: dict[int, Value] = {}
        for size in sizes:
            found = function(size)
            assert found.data.size == size
            if size in last:
                assert found is last.pop(size)
            last[size] = found
            last = dict(list(last.items())[-4:])
        assert len(function._results) <= 4 * max(1, len(module._users))
    finally:
        function.cache_clear()
        module._functions.remove(function)


def test_all_together_have_a_bound_and_the_oldest_go_first(
    make: Kept[[int], Value], users: tuple[User, User], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_functions", [make])  # older results of others would go first
    monkeypatch.setattr(module, "MOST_BYTES", kept_bytes() + 25_000)
    with users[0].working():
        first, second = make(10_000), make(10_001)
        assert make(10_000) is first
        third = make(10_002)
        assert kept_bytes() <= module.MOST_BYTES
        assert make(10_002) is third
        assert make(10_000) is first
        assert make(10_001) is not second
        make(40_000)  # larger than all that may be kept
        assert kept_bytes() <= module.MOST_BYTES


def test_a_thread_works_for_who_has_started_it(
    make: Kept[[int], Value], users: tuple[User, User]
) -> None:
    found: list[Value] = []
    with users[0].working():
        threads.start(lambda: found.append(make(500))).join(10)
    threads.start(lambda: None).join(10)
    assert make._results[(500,)].users == {users[0]}


def test_two_threads_get_one_result(make: Kept[[int], Value]) -> None:
    barrier, found = threading.Barrier(4), []

    def ask() -> None:
        barrier.wait(10)
        found.append(make(100_000))

    running = [threads.start(ask) for _ in range(4)]
    for each in running:
        each.join(10)
    assert len({id(each) for each in found}) == 1


@dataclass(frozen=True)
class Pair:
    """A result with parts."""

    array: np.ndarray
    others: tuple[bytes, dict[str, np.ndarray]]


def test_size_is_that_of_all_parts_once() -> None:
    array = np.zeros((50, 100))
    assert 40_000 <= size_of(Pair(array, (b"x" * 1000, {"same": array}))) - 1000 < 41_500
    assert size_of(Value(5000)) >= 5000
    assert size_of(np.zeros) < 1000
