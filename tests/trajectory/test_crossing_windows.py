"""Windows in which paths are changed along the escape twist, and which of them are tried."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from paminsa_viz.model import escape_twist
from paminsa_viz.trajectory import CrossingRefused, plan_deformed, time_optimal
from paminsa_viz.trajectory.crossing import crossings
from paminsa_viz.trajectory.time_optimal import (
    _EVEN,
    _ODD,
    DeformationWindow,
    DeformedPath,
    _deformed,
)
from tests.trajectory.crossings import BALANCED, LINE, TEN

MODULE = sys.modules[time_optimal.__module__]
(CROSSED,) = crossings(BALANCED.geometry, LINE)
PEAKS = {"odd": (8 / 9) ** 4 / 3, "even": 0.1 * 0.8**4}
"""Largest values of x (1 - x^2)^4 and x^2 (1 - x^2)^4 / 2: at x = 1/3 and x^2 = 1/5."""


def test_a_changed_path_is_the_path_and_its_windows_with_their_derivatives() -> None:
    shifts = np.array([[0.01, -0.02, 0.1, 0.0], [-0.03, 0.01, 0.2, 0.05]])
    first = DeformationWindow(0.3, 0.2, shifts[0], _ODD)
    path = DeformedPath(LINE, (first, DeformationWindow(0.45, 0.1, shifts[1], _EVEN)))
    s = np.array([0.05, 0.1, 0.25, 0.3, 0.37, 0.42, 0.45, 0.5, 0.55, 0.56, 0.9])
    x, y = (s - 0.3) / 0.2, (s - 0.45) / 0.1
    odd = np.where(np.abs(x) < 1, x * (1 - x**2) ** 4, 0.0)
    even = np.where(np.abs(y) < 1, 0.5 * y**2 * (1 - y**2) ** 4, 0.0)
    np.testing.assert_allclose(
        path(s), LINE(s) + odd[:, None] * shifts[0] + even[:, None] * shifts[1], atol=1e-15
    )
    for order in (1, 2, 3):
        slope = (path(s + 1e-6, order - 1) - path(s - 1e-6, order - 1)) / 2e-6
        np.testing.assert_allclose(path(s, order), slope, atol=1e-4 * np.abs(slope).max() + 1e-8)


@pytest.mark.parametrize("kind", PEAKS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("places", "halves"),
    [
        ([0.5], [0.25]), ([0.1], [0.1]), ([0.93], [0.07]), ([0.4, 0.6], [0.1, 0.1]),
        ([0.05, 0.2, 0.9], [0.05, 0.075, 0.1]),
    ],
    ids=["middle", "start", "end", "two", "three"],
)  # fmt: skip
def test_windows_reach_to_the_ends_and_half_way_to_each_other(
    places: list[float], halves: list[float], kind: str, sign: float
) -> None:
    """And the platform's center and joints 5 move by as much as the deviation at most."""
    met = tuple(replace(CROSSED, s=s) for s in places)
    shape = _ODD if kind == "odd" else _EVEN
    changed = _deformed(BALANCED, LINE, met, shape, sign * 4e-3)
    assert [window.at for window in changed.windows] == places
    assert [window.half for window in changed.windows] == pytest.approx(halves)
    twist = escape_twist(BALANCED.geometry, np.array(CROSSED.pose))
    radius = BALANCED.geometry.platform_radius
    for window in changed.windows:
        assert window.shape is shape
        np.testing.assert_allclose(window.shift, window.shift[2] * twist)
        assert np.sign(window.shift[2]) == sign
        far = np.hypot(*window.shift[:2]) + radius * abs(window.shift[2])
        assert far * PEAKS[kind] == pytest.approx(4e-3, rel=1e-6)


def test_the_first_of_a_rising_series_of_deviations_that_can_be_run_is_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From 1/32 of the largest on, twice as much each time; both shapes and signs."""
    tried: list[tuple[Any, float]] = []
    refusals = {"cause": "weak", "runs": 7}

    def fake(design: Any, path: Any, limits: Any, duration: Any, *, name: str) -> Any:
        assert (design, limits, duration, name) == (BALANCED, TEN, 3.0, "through")
        if path is LINE:
            raise CrossingRefused(str(refusals["cause"]), "no influence", 0.5)
        (window,) = path.windows
        tried.append((window.shape, float(window.shift[2])))
        if len(tried) == 3:  # it crosses another time: that is another path
            return SimpleNamespace(crossings=(1, 2))
        if len(tried) < int(refusals["runs"]):
            raise CrossingRefused("infeasible", "still not", 0.5)
        return SimpleNamespace(crossings=(1,))

    def run() -> Any:
        tried.clear()
        return plan_deformed(BALANCED, LINE, TEN, 3.0, most=0.032, name="through")

    monkeypatch.setattr(MODULE, "time_optimal", fake)
    found = run()
    assert found.deviation == pytest.approx(0.002)
    assert len(tried) == 7
    assert found.found.crossings == (1,)
    refusals["runs"] = 100
    with pytest.raises(CrossingRefused) as refused:
        run()
    assert str(refused.value) == "no influence; nor on a path up to 32 mm from it"
    assert (refused.value.cause, refused.value.s) == ("weak", 0.5)
    assert len(tried) == 6 * 4
    first = np.array([size for _, size in tried[:4]])
    assert [shape for shape, _ in tried] == [_ODD, _ODD, _EVEN, _EVEN] * 6
    assert (np.sign(first) == [1, -1, 1, -1]).all()
    np.testing.assert_array_equal(first[[0, 2]], -first[[1, 3]])
    for step in range(6):
        np.testing.assert_allclose([size for _, size in tried[4 * step :][:4]], first * 2.0**step)
    refusals["cause"] = "hold"
    with pytest.raises(CrossingRefused, match=r"^no influence$"):
        run()
    assert tried == []


def test_windows_leave_the_pose_and_all_outside_and_add_to_one_factor_alone() -> None:
    """By s - s*: an odd one has the slope 1 there, an even one the second derivative 1."""
    for shape, slope, bend in ((_ODD, 1.0, 0.0), (_EVEN, 0.0, 1.0)):
        middle = [float(shape.deriv(n)(0.0)) if n else float(shape(0.0)) for n in range(3)]
        assert middle == pytest.approx([0.0, slope, bend], abs=1e-15)
        for end in (-1.0, 1.0):
            ends = [float(shape.deriv(n)(end)) if n else float(shape(end)) for n in range(4)]
            assert ends == pytest.approx([0.0] * 4, abs=1e-12)
        x = np.linspace(-1.0, 1.0, 41)
        assert shape(-x) == pytest.approx((-1.0 if slope else 1.0) * shape(x), abs=1e-15)


class Program:
    """Stands for the program of a crossing: what is asked of it, and what it answers."""

    made: ClassVar[list[tuple[int, int]]] = []
    rounds: ClassVar[list[int]] = []
    refused: ClassVar[int] = 0
    needs: ClassVar[dict[int, tuple[str, float]]] = {}
    enough: ClassVar[int] = 1
    lowest: ClassVar[float] = 1.0

    def __init__(self, *arguments: Any) -> None:
        self.made.append(arguments[4:])
        self.number = len(self.made)
        self.rounds.append(0)

    def fastest(self) -> str:
        if self.number <= self.refused:
            needs = self.needs.get(self.number, ("", np.inf))
            problem = f"number {self.number}"
            raise CrossingRefused("infeasible", problem, to_raise=needs[0], factor=needs[1])
        return "fast"

    def slowest(self) -> str:
        return "slow"

    def tighten(self, *laws: str) -> bool:
        assert laws == ("fast", "slow")
        self.rounds[-1] += 1
        return self.rounds[-1] < self.enough

    def spline(self, law: str) -> Any:
        """A law of 8 that falls to a share of it at one place alone."""
        assert law == "fast"
        return lambda s: (
            8.0
            * np.where(
                (s < 0) | (s > 1), 0.0, np.minimum(1.0, self.lowest + 1e4 * np.abs(s - 0.5) ** 2)
            )
        )


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> type[Program]:
    fresh = type("Fresh", (Program,), {"made": [], "rounds": []})
    monkeypatch.setattr(MODULE, "CrossingProgram", fresh)
    monkeypatch.setattr(MODULE, "influence", lambda design, path, item, condition: item.s)
    monkeypatch.setattr(MODULE, "crossing_condition", lambda design, path, s: None)
    return fresh


@pytest.mark.parametrize(
    ("cosines", "expected"),
    [
        ([], [(0, 80)]), ([0.5], [(3, 80), (6, 80), (0, 80)]),
        ([0.5, 0.09], [(6, 160), (3, 160), (0, 160)]), ([0.101, 0.3], [(3, 80), (6, 80), (0, 80)]),
    ],
    ids=["none", "one", "steep", "flat"],
)  # fmt: skip
def test_pieces_are_refined_in_turn_and_finer_if_one_crossing_is_steep(
    asked: type[Program], cosines: list[float], expected: list[tuple[int, int]]
) -> None:
    """Until one has a law."""
    found = tuple(replace(CROSSED, s=s) for s in cosines)
    asked.refused = 9
    with pytest.raises(CrossingRefused, match=r"^number 1$"):
        MODULE._program(BALANCED, LINE, found, TEN)
    assert asked.made == expected
    if len(expected) > 1:
        asked.made.clear()
        asked.refused = 1
        program, *laws = MODULE._program(BALANCED, LINE, found, TEN)
        assert (program.number, laws, asked.made) == (2, ["fast", "slow"], expected[:2])


@pytest.mark.parametrize(
    ("needs", "refused", "told"),
    [
        ({1: ("torque", 1.3), 2: ("torque", 1.2), 3: ("torque", 1.4)}, 3, "number 2"),
        ({1: ("speed", 1.5), 2: ("", np.inf), 3: ("force", 1.4)}, 3, "number 3"),
        ({1: ("", np.inf), 2: ("turn_speed", 1.5), 3: ("speed", 1.2)}, 3, "number 3"),
        ({1: ("torque", 1.01), 2: ("torque", 1.01)}, 2, "stops at s = 0.5"),
    ],
    ids=["torques", "torques or speeds", "speeds", "none, but a stop"],
)
def test_of_several_refusals_the_one_that_needs_least_is_told(
    asked: type[Program], needs: dict[int, tuple[str, float]], refused: int, told: str
) -> None:
    """Other pieces would need more, which is not the least that limits have to be raised by."""
    asked.refused, asked.needs, asked.lowest = refused, needs, 0.0
    with pytest.raises(CrossingRefused, match=told):
        MODULE._program(BALANCED, LINE, (CROSSED,), TEN)


@pytest.mark.parametrize(("needed", "done"), [(1, 1), (2, 2), (4, 4), (9, 4)])
def test_points_are_added_until_limits_are_kept_or_four_times(
    asked: type[Program], needed: int, done: int
) -> None:
    asked.enough = needed
    MODULE._program(BALANCED, LINE, (), TEN)
    assert asked.rounds == [done]


@pytest.mark.parametrize(("lowest", "stands"), [(0.95e-9, True), (1.05e-9, False)])
def test_a_law_that_falls_to_a_billionth_of_its_largest_stands_still(
    asked: type[Program], lowest: float, stands: bool
) -> None:
    """And it is said where."""
    asked.lowest = lowest
    if not stands:
        MODULE._program(BALANCED, LINE, (CROSSED,), TEN)
        assert len(asked.made) == 1
        return
    with pytest.raises(CrossingRefused, match=r"a motion that stops at s = 0\.5;") as refused:
        MODULE._program(BALANCED, LINE, (CROSSED,), TEN)
    assert (refused.value.cause, refused.value.s, len(asked.made)) == ("weak", 0.5, 3)
