"""The front of two aims, point by point."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.solving import run, static_torque
from paminsa_viz.explorer.panels.balance_charts import clicked_point, front_figure
from paminsa_viz.explorer.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.trajectory import analyze


def test_the_front_is_gone_along_point_by_point(start: State) -> None:
    steps: list[float] = []
    started = balancing.start(start, Task.FRONT)
    job = started.balancing.running
    assert job is not None
    outcome = run(job, lambda done: bool(steps.append(done)))
    assert steps == sorted(steps)
    assert steps[-1] == 1
    after = balancing.receive_result(started, outcome)
    assert after.document == start.document
    front = outcome.front
    assert front is not None
    assert len(outcome.designs) == len(front.points) > 5
    assert balancing.chosen_point(after) is None
    for index in (0, 4, len(front.points) - 1):
        point = front.points[index]
        after = balancing.choose_point(after, index)
        assert balancing.chosen_point(after) == index
        assert after.document.reference == start.document.design
        torque = analyze(after.document.design, job.trajectory).torque[:, :3]  # type: ignore[arg-type]
        assert np.abs(torque).max() == pytest.approx(point.first, rel=1e-6)
        still = static_torque(job, after.document.design)[0]
        assert still == pytest.approx(point.second, rel=1e-6, abs=1e-7)
        assert clicked_point({"x": point.first, "y": point.second}, outcome) == index
        marks = front_figure(after)["data"][0]["marker"]["size"]
        assert marks.index(max(marks)) == index
    with pytest.raises(InvalidInput, match="no such point"):
        balancing.choose_point(after, len(front.points))
    assert clicked_point({"x": 1e6, "y": 0}, outcome) is None
    assert clicked_point({"x": "1", "y": 0}, outcome) is None
    assert clicked_point([1], outcome) is None


def test_a_front_that_is_stopped_stops(start: State) -> None:
    started = balancing.start(start, Task.FRONT)
    job = started.balancing.running
    assert job is not None
    outcome = run(job, lambda _: True)
    assert outcome.front is not None
    assert len(outcome.front.points) < 3
