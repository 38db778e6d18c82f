"""The tornado: what each number of the design does."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import OUTPUTS
from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.solving import middle
from paminsa_viz.explorer.frame import compute, near_singularity
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.panels.balance_charts import tornado_figure
from paminsa_viz.explorer.panels.balance_text import sensitivity_html
from paminsa_viz.explorer.state import State
from paminsa_viz.model import (
    APPENDIX_4,
    check_reach,
    measure_singularity,
    static_imbalance,
)
from tests.explorer.balancing.balanced import solved


def text(state: State) -> str:
    """Return what the page says of the sensitivity."""
    return sensitivity_html(compute(state))


def test_the_tornado_has_the_longest_bar_on_top(start: State) -> None:
    loaded = balancing.add_counterweight(balancing.add_counterweight(start, "b8", 8), "b3", 7)
    after = solved(loaded, Task.SENSITIVITY)
    outcome = after.balancing.tornado
    assert outcome is not None
    assert outcome.tornado is not None
    for output in range(len(OUTPUTS)):
        tree = tornado_figure(after.updated("balancing", output=output))
        lengths = np.abs([trace["x"] for trace in tree["data"]]).max(axis=0)
        assert len(lengths) > 5
        assert (np.diff(lengths) <= 1e-12).all()
        names = tree["data"][0]["y"]
        assert len(names) == len(set(names))
    assert "counterweight 2" in str(tornado_figure(after))
    # What it says of m_7 is what a design with another m_7 has.
    bar = next(bar for bar in outcome.tornado.bars if bar.path == "joints.j7")
    more = loaded.document.design.vary({"joints.j7": 1.05 * bar.value})
    assert bar.plus[0] == pytest.approx(static_imbalance(more))
    assert "Of an earlier design" in text(balancing.set_counterweights(after, ()))


def test_the_tornado_looks_at_clear_poses(start: State) -> None:
    job = balancing.make_job(start, Task.SENSITIVITY)
    poses = middle(job).poses()
    geometry = APPENDIX_4.geometry
    assert check_reach(geometry, poses).ok.all()
    assert not near_singularity(measure_singularity(geometry, poses)).any()
    far = solved(actions.move(start, z=-3.0), Task.SENSITIVITY)
    assert "no pose around the middle is clear" in text(far)


def test_without_a_motion_the_tornado_says_what_it_can(start: State) -> None:
    table = motions.choose_kind(start, motions.Kind.TABLE)
    after = solved(table, Task.SENSITIVITY)
    assert "Nothing to show" not in text(after)
    assert "Nothing to show" in text(after.updated("balancing", output=3))
