"""Results that are kept for who works with them, and no longer.

A page asks again and again for what follows from its design: shapes, plans, maps. `kept` is a
`functools.lru_cache` whose results belong to users, such as open pages: equal questions of several
are answered once, and what only one has asked for goes with it. All of them together hold at most
`MOST_BYTES`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, fields, is_dataclass
from functools import update_wrapper
from itertools import count
from sys import getsizeof
from types import FunctionType, MethodType, ModuleType
from typing import Any, Final, Generic, ParamSpec, TypeVar

import numpy as np

PROGRESS: Final = "progress"
"""Name of the argument by which a function that takes long tells how far it is."""

P = ParamSpec("P")
R = TypeVar("R")

MOST_BYTES: Final = 64 * 2**20
"""How much all results together may take [bytes]; the one unused for longest goes first."""

MOST_PARTS: Final = 20_000
"""How many parts of a result are looked at for its size."""

_lock = threading.RLock()
_ticks = count()
_users: set[User] = set()
_total = 0
_functions: list[Kept[Any, Any]] = []
_user: ContextVar[User | None] = ContextVar("user", default=None)


class User:
    """One who works with results, such as an open page, until it leaves.

    What is computed for nobody in particular stays until there is no room for it.
    """

    def __init__(self) -> None:
        with _lock:
            _users.add(self)

    @contextmanager
    def working(self) -> Iterator[None]:
        """Context in which results are this user's; threads started by `contextvars` go along."""
        token = _user.set(self)
        try:
            yield
        finally:
            _user.reset(token)

    def leave(self) -> None:
        """Give up all that no other user has asked for; what is still computed is not kept."""
        with _lock:
            _users.discard(self)
            for function in _functions:
                function.drop(self)


@dataclass(eq=False, slots=True)
class _Result:
    """A result: its value and size [bytes], who has asked for it, and when last."""

    value: Any
    size: int
    used: int
    users: set[User | None] = field(default_factory=set)


class Kept(Generic[P, R]):
    """A function whose last results are kept; see `kept`."""

    def __init__(self, function: Callable[P, R], most: int) -> None:
        self._function, self._most = function, most
        self._results: dict[Any, _Result] = {}
        update_wrapper(self, function)
        with _lock:
            _functions.append(self)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        user = _user.get()
        # who is told how far the work is changes no result
        named = tuple(sorted(item for item in kwargs.items() if item[0] != PROGRESS))
        key = (args, named) if named else args
        found = self._results.get(key)
        if found is None:
            value = self._function(*args, **kwargs)
            found = self._keep(key, _Result(value, size_of(value), 0), user)
        found.used = next(_ticks)
        if user not in found.users:
            with _lock:
                if user is None or user in _users:
                    found.users.add(user)
        return found.value

    def _keep(self, key: Any, result: _Result, user: User | None) -> _Result:
        global _total
        with _lock:
            if user is not None and user not in _users:
                return result  # of a page that has gone meanwhile
            if key in self._results:  # another thread was faster
                return self._results[key]
            result.used = next(_ticks)
            self._results[key] = result
            _total += result.size
            while len(self._results) > self._most * max(1, len(_users)):
                self._give_up(self._oldest())
            if _total > MOST_BYTES:
                _make_room()
        return result

    def _give_up(self, key: Any) -> None:
        global _total
        _total -= self._results.pop(key).size

    def _oldest(self) -> Any:
        return min(self._results, key=lambda key: self._results[key].used)

    def drop(self, user: User) -> None:
        """Give up what only a user has asked for."""
        for key, result in list(self._results.items()):
            if user in result.users:
                result.users.discard(user)
                if not result.users:
                    self._give_up(key)

    def cache_clear(self) -> None:
        """Give up all results, as that of `functools.lru_cache` does."""
        with _lock:
            for key in list(self._results):
                self._give_up(key)


def kept(most: int) -> Callable[[Callable[P, R]], Kept[P, R]]:
    """Keep the last results of a function of hashable arguments, which must not be changed.

    A `progress` is no part of the question; it has to be given by name.

    Args:
        most: How many are kept for each user.
    """
    return lambda function: Kept(function, most)


def kept_bytes() -> int:
    """Return how much all results that are kept take [bytes]."""
    return _total


def _make_room() -> None:
    """Give up results until the others have room, those unused for longest first."""
    found = [
        (result.used, function, key)
        for function in _functions
        for key, result in function._results.items()
    ]
    for _, function, key in sorted(found, key=lambda each: each[0]):
        if _total <= MOST_BYTES:
            return
        function._give_up(key)


_SHARED = (type, ModuleType, FunctionType, MethodType)
_CONTAINERS = (tuple, list, set, frozenset)
_ATOMS = frozenset((int, float, bool, str, bytes, type(None)))
"""Kinds of which most parts are; named once, as results have many thousands of parts."""


def size_of(value: Any) -> int:
    """Return about how much memory a result takes [bytes]: its arrays, texts and containers."""
    total, seen, waiting = 0, set[int](), [value]
    while waiting and len(seen) < MOST_PARTS:
        part = waiting.pop()
        if id(part) in seen or isinstance(part, _SHARED):
            continue
        seen.add(id(part))
        if isinstance(part, np.ndarray):
            total += part.nbytes
            continue
        total += getsizeof(part)
        if type(part) in _ATOMS:
            continue
        if isinstance(part, dict):
            waiting += [*part.keys(), *part.values()]
        elif isinstance(part, _CONTAINERS):
            waiting += part
        elif is_dataclass(part):
            waiting += [getattr(part, each.name, None) for each in fields(part)]
        elif hasattr(part, "__dict__"):
            waiting += vars(part).values()
    return total
