"""The figure of a motion through singularities."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.palette import INK, LEG_COLORS
from paminsa_viz.plots.crossing_figure import crossing_svg, draw_crossing, residual_along
from paminsa_viz.plots.formats import drawing
from paminsa_viz.trajectory import MotionLimits, TimeOptimalPlan, straight_path, time_optimal


@pytest.fixture(scope="module")
def found() -> TimeOptimalPlan:
    turn = straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5])
    return time_optimal(APPENDIX_4, turn, MotionLimits(torque=10.0), 0.6)


@pytest.mark.slow
def test_residual_is_that_of_the_condition_at_the_crossing(found: TimeOptimalPlan) -> None:
    (item,) = found.crossings
    s, rate, growth = (np.array([value]) for value in (item.crossing.s, 2.0, 3.0))
    residual = residual_along(APPENDIX_4, found, s, rate, growth)
    assert residual[0] == pytest.approx(item.condition.residual(2.0, 3.0), rel=1e-12)


@pytest.mark.slow
def test_figure_shows_what_is_possible_and_the_limit_torques(found: TimeOptimalPlan) -> None:
    (item,) = found.crossings
    with drawing():
        page = draw_crossing(APPENDIX_4, found)
        page.draw_without_rendering()
    speed, residual, torque = page.axes
    planned = next(line for line in speed.lines if line.get_label() == "planned")
    s, rate = planned.get_xdata(), planned.get_ydata()
    low, high = (np.sqrt(np.maximum(z(s), 0.0)) for z in (found.slowest, found.fastest))
    assert (rate >= low - 1e-6).all()
    assert (rate <= high + 1e-6).all()
    here = next(line for line in residual.lines if line.get_label() == "planned")
    assert np.interp(item.crossing.s, here.get_xdata(), here.get_ydata()) == pytest.approx(
        0.0, abs=0.05
    )
    marks = [line for line in torque.lines if line.get_marker() == "o"]
    assert [line.get_ydata()[0] for line in marks] == list(item.torque[:3])
    assert [line.get_color() for line in marks] == list(LEG_COLORS)
    assert INK in {line.get_color() for line in speed.lines}


@pytest.mark.slow
def test_svg_can_be_shown_on_a_page(found: TimeOptimalPlan) -> None:
    text = crossing_svg(APPENDIX_4, found).decode()
    assert "<svg" in text
    assert len(text) < 200_000
