"""What a study is over unless it says otherwise, and how its processes begin and end."""

from __future__ import annotations

import math
import multiprocessing
import signal
from types import SimpleNamespace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.model.grids import Grid
from paminsa_viz.studies import (
    METRICS,
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
    Region,
    Study,
    default_region,
    executors,
    measure_design,
)
from paminsa_viz.studies.region import RegionResults
from paminsa_viz.studies.running import StudySummary
from paminsa_viz.studies.sweeps import sweep, sweep_blocks

NARROW = Region(0.05, (0.0,), (-0.5,), cells=4)


def test_the_default_region_is_half_the_base_radius_at_two_headings() -> None:
    region = default_region(APPENDIX_4.vary({"geometry.base_radius": 0.5}))
    assert region.radius == 0.25
    assert region.theta == (0.0, pytest.approx(math.pi / 6))
    assert region.cells == Region(0.1, (0.0,), (0.0,)).cells == 40
    assert len(region.z) == 1


def test_positions_are_the_middles_of_cells_in_the_disc() -> None:
    region = Region(0.3, (0.1, 0.2), (-0.5, -0.6), cells=5)
    grid = region.grid()
    assert [name for name, _ in grid.axes] == ["theta", "z", "y", "x"]
    side = np.array([-0.24, -0.12, 0.0, 0.12, 0.24])
    for place in (2, 3):
        assert grid.axes[place][1] == pytest.approx(side)
    inside = region.inside(grid)
    np.testing.assert_array_equal(inside, np.hypot(*np.meshgrid(side, side)) <= 0.3)
    assert (~inside).sum() == 4


def test_a_range_about_a_value_is_a_share_of_it_to_either_side() -> None:
    mass = APPENDIX_4.value("links.b3")
    found = DesignRange.around(APPENDIX_4, "links.b3", 0.2)
    assert (found.low, found.high) == pytest.approx((0.8 * mass, 1.2 * mass))
    assert RandomDesigns((found,), 3).seed == 0
    pushed = DesignRange.around(APPENDIX_4.vary({"load.force_z": -20.0}), "load.force_z", 0.2)
    assert (pushed.low, pushed.high) == pytest.approx((-24.0, -16.0))
    with pytest.raises(InvalidInput, match="low < high"):
        DesignRange.around(APPENDIX_4, "links.b3", -0.2)


def test_what_is_not_said_of_a_study() -> None:
    study = Study(APPENDIX_4, DesignGrid((DesignAxis("links.b3", (0.4,)),)), NARROW)
    assert not study.scale_bars
    assert (study.trajectory, study.indices) == (None, ())
    assert len(study.fingerprint) == 32
    assert int(study.fingerprint, 16) >= 0
    names = [metric.column for metric in METRICS]
    found = dict(zip(names, measure_design(APPENDIX_4, NARROW), strict=True))
    assert found["added_mass_kg"] == found["mass_kg"]
    assert RegionResults(APPENDIX_4, NARROW).base_mass == 0.0
    summary = StudySummary(study)
    assert (summary.rows, summary.found) == (0, 0)


def test_a_sweep_is_of_the_largest_torque_in_one_block_unless_it_says_otherwise() -> None:
    grid = Grid.over((0.0, 0.0, 0.2, -0.5), x=np.linspace(-0.1, 0.1, 30))
    found = sweep(APPENDIX_4, grid)
    assert list(found.largest) == ["max_torque"]
    assert len(list(sweep_blocks(APPENDIX_4, grid, ("condition",)))) == 1


def test_a_process_ends_with_its_parent(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a thread that does not keep it alive; interrupts are left to the parent."""
    made: list[dict] = []
    monkeypatch.setattr(executors.signal, "signal", lambda *given: made.append({"signal": given}))

    class Thread:
        def __init__(self, **options: object) -> None:
            made.append(options)

        def start(self) -> None:
            made.append({"started": True})

    monkeypatch.setattr(executors.threading, "Thread", Thread)
    monkeypatch.setattr(executors.backend, "compile_now", lambda: made.append({"compiled": True}))
    executors._start_process()
    assert made == [
        {"signal": (signal.SIGINT, signal.SIG_IGN)},
        {"target": executors._end_with_parent, "daemon": True}, {"started": True},
        {"compiled": True},
    ]  # fmt: skip
    seen: list[object] = []
    monkeypatch.setattr(executors, "wait", lambda things: seen.append(things))
    monkeypatch.setattr(executors.os, "_exit", lambda code: seen.append(code))
    executors._end_with_parent()  # this one has none
    assert seen == []
    parent = SimpleNamespace(sentinel="there")
    monkeypatch.setattr(executors.multiprocessing, "parent_process", lambda: parent)
    executors._end_with_parent()
    assert seen == [["there"], 1]
    killed: list[str] = []
    children = [SimpleNamespace(kill=lambda name=name: killed.append(name)) for name in "ab"]
    monkeypatch.setattr(multiprocessing, "active_children", lambda: children)
    executors._end_processes()
    assert killed == ["a", "b"]
