"""Which functions of the package a test calls, and the order of tests that this suggests.

Compiled loops are not seen, and what an earlier test has left in a cache is not called again: the
record only says which tests are the likeliest to fail, and none is left out because of it.
"""

from __future__ import annotations

import ast
import os
import resource
import sys
import threading
import time
from collections.abc import Generator, Iterable
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

_QUICK = 0.3
"""Tests that take less [s] come before others, whatever they are."""
_PATIENCE, _COMPILING = 5.0, 60.0
"""A test may take so many times as long with a change, and so much processor time more [s]."""

Place = tuple[str, int]
"""File, below the checkout, and first line of a function."""


@dataclass
class Record:
    """What the tests of a subpackage do.

    Attributes:
        calls: Functions that each test calls, by the test's name.
        times: How long each test takes [s].
    """

    calls: dict[str, set[Place]] = field(default_factory=dict)
    times: dict[str, float] = field(default_factory=dict)


class Recorder:
    """A plugin of pytest that fills a record."""

    def __init__(self, folder: Path, record: Record) -> None:
        self._root = f"{folder}/paminsa_viz/"
        self._folder = folder
        self._record = record
        self._seen: set[CodeType] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Note what a test calls, fixtures included."""
        self._seen = set()
        before = sys.gettrace()
        began = time.monotonic()
        threading.settrace(self._trace)
        sys.settrace(self._trace)
        try:
            return (yield)
        finally:
            sys.settrace(before)
            threading.settrace(before)
            self._record.times[item.nodeid] = time.monotonic() - began
            self._record.calls[item.nodeid] = {
                (Path(code.co_filename).relative_to(self._folder).as_posix(), code.co_firstlineno)
                for code in self._seen
                if code.co_filename.startswith(self._root)
            }

    def _trace(self, frame: FrameType, event: str, arg: Any) -> None:
        self._seen.add(frame.f_code)


class Order:
    """A plugin of pytest that puts the likeliest tests first.

    Args:
        record: Of the subpackage's tests without a change.
        place: The function that has the change; None if it stands in no function.
        first: Name of the module that has it.
        only: Whether tests that do not call the function are left out, where any does.
    """

    def __init__(self, record: Record, place: Place | None, first: str, only: bool = False) -> None:
        self._record = record
        self._only = only
        self._place = place
        self._first = first

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Sort the tests: those that call the function, quick ones, the module's own."""
        names = {path: self._first in path.read_text() for path in {item.path for item in items}}

        seen = any(self._place in calls for calls in self._record.calls.values())

        def rank(item: pytest.Item) -> tuple[bool, bool, bool]:
            calling = not seen or self._place in self._record.calls.get(item.nodeid, ())
            quick = self._record.times.get(item.nodeid, 0.0) < _QUICK
            return not calling, not quick, not (self._first in item.path.name or names[item.path])

        items.sort(key=rank)
        if self._only:
            items[:] = [item for item in items if not rank(item)[0]]

    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Limit the processor time of a test: a change may make a loop endless."""
        used = sum(os.times()[:2])
        most = used + _PATIENCE * self._record.times.get(item.nodeid, 0.0) + _COMPILING
        resource.setrlimit(resource.RLIMIT_CPU, (int(most), resource.RLIM_INFINITY))


def function_at(path: str, source: bytes, line: int) -> Place | None:
    """Return the function that has a line of a file: file and first line, or None."""
    found = None
    for node in _functions(ast.parse(source)):
        begin = min([node.lineno, *(one.lineno for one in node.decorator_list)])
        assert node.end_lineno is not None
        inside = node.body[0].lineno <= line <= node.end_lineno
        if inside and (found is None or begin > found):
            found = begin
    return None if found is None else (path, found)


def _functions(tree: ast.AST) -> Iterable[ast.FunctionDef | ast.AsyncFunctionDef]:
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node


def imported_of_others(folder: Path) -> list[str]:
    """Return names of modules that have been imported, without those of a folder and of pytest.

    Plugins of pytest have to be imported by it, which changes their asserts.
    """
    plugins = {one.value.split(".")[0].split(":")[0] for one in entry_points(group="pytest11")}
    left_out = {*plugins, "mutants", "hypothesis", "_hypothesis_globals", "_pytest"}
    found = []
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file and name.split(".")[0] not in left_out and not Path(file).is_relative_to(folder):
            found.append(name)
    return found
