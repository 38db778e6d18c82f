"""An engine's torques on the page: those of a verification, of what is shown, or why not."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.engines import verification
from paminsa_viz.engines.verification import TOLERANCE, verify
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.motion.engine import MOST_SAMPLES
from paminsa_viz.explorer.features.motion.plots import difference_html, drawn_charts
from paminsa_viz.explorer.state.motion import Kind
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import KneeBranch, Misprint
from paminsa_viz.plots.series_uplot import chart_shape, uplot_data
from paminsa_viz.units import power_of_ten
from tests.explorer.features.motion.engine_motions import (
    analyzed,
    answered,
    caption,
    engine_torques,
)
from tests.support.charts import shown_curve

needs_mujoco = pytest.mark.usefixtures("mujoco")


@pytest.mark.slow
@needs_mujoco
@pytest.mark.parametrize("knee", KneeBranch)
def test_numbers_are_those_of_a_verification(
    state: State, knee: KneeBranch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(verification, "STRAY_LIMIT", 0.0)  # ends the simulation at once
    found = analyzed(answered(actions.set_knee(state, knee)))
    torques = engine_torques(found)
    assert found.sources.published is not None
    motion = torques.thinned.trajectory
    assert motion.size == MOST_SAMPLES
    assert (motion.t[0], motion.t[-1]) == (0.0, found.analysis.trajectory.t[-1])
    known = verify(found.analysis.design, motion, poses=1, misprints=(Misprint.ALL,))
    np.testing.assert_array_equal(torques.engine.torque, known.engines[0].dynamic.reference)
    own, published = (
        torques.comparison(each) for each in (found.analysis, found.sources.published)
    )
    assert own.agrees(TOLERANCE)
    assert own.relative.max() < 1e-11
    np.testing.assert_allclose(own.scale, known.engines[0].dynamic.scale, rtol=1e-12)
    wanted = known.published[Misprint.ALL]
    np.testing.assert_allclose(published.largest, wanted.largest, rtol=1e-9)
    np.testing.assert_allclose(published.rms, wanted.rms, rtol=1e-9)


@needs_mujoco
def test_friction_is_no_difference_and_few_samples_are_all_computed(state: State) -> None:
    rubbing = {"friction.coulomb_rotary": 0.3, "friction.viscous_linear": 5.0}
    found = analyzed(answered(motions.change(actions.vary(state, rubbing), rate=50.0)))
    torques = engine_torques(found)
    assert torques.comparison(found.analysis).relative.max() < 1e-11
    assert torques.engine.samples.tolist() == list(range(found.analysis.trajectory.size))
    assert found.analysis.trajectory.size < MOST_SAMPLES


@pytest.mark.slow
@needs_mujoco
def test_answer_holds_for_its_design_and_motion_only(state: State) -> None:
    known = answered(state)
    assert analyzed(known).answer is known.engine_answer
    for other in (
        actions.vary(known, {"links.b3": 0.5}),
        actions.vary(known, {"geometry.crank_length": 0.44}),
        actions.vary(known, {"friction.coulomb_rotary": 0.1}),
        actions.set_knee(known, KneeBranch.UPPER),
        motions.choose_preset(known, "circle"),
    ):
        assert analyzed(other).answer is None
        for plot in ("torques", "differences"):
            shown = other.updated("plots", plot=plot)
            for chart in drawn_charts(shown, analyzed(shown)):
                marks = [t.values for t in chart.traces if t.marks or plot == "differences"]
                assert np.isnan(marks).all()
                assert marks
        assert "computing" in caption(analyzed(shown), shown)
    back = actions.vary(actions.vary(known, {"links.b3": 0.5}), {"links.b3": 0.406})
    assert analyzed(back).answer is known.engine_answer


@needs_mujoco
def test_marks_are_on_the_curves_and_do_not_change_the_chart(state: State) -> None:
    waiting, found = analyzed(state), analyzed(answered(state))
    for before, chart in zip(drawn_charts(state, waiting), drawn_charts(state, found), strict=True):
        assert chart_shape(before) == chart_shape(chart)
        marks = [number for number, trace in enumerate(chart.traces) if trace.marks]
        series = uplot_data(chart, 1)
        for own, number in zip(chart.traces, marks, strict=False):
            values = chart.traces[number].values
            seen = np.flatnonzero(np.isfinite(values))
            assert 25 <= seen.size <= 51
            np.testing.assert_allclose(values[seen], own.values[seen], atol=1e-9)
            shown = shown_curve(series, chart_shape(chart), number)
            assert np.isfinite(shown).sum() == seen.size


@pytest.mark.slow
@needs_mujoco
def test_difference_is_plotted_in_a_readable_unit_with_a_verdict(state: State) -> None:
    state = answered(state).updated("plots", plot="differences", published=False)
    found = analyzed(state)
    torques = engine_torques(found)
    turning, lifting = drawn_charts(state, found)
    wanted = (torques.engine.pick(found.analysis.torque) - torques.engine.torque)[:, 0]
    ratio = turning.traces[0].values[wanted != 0] / wanted[wanted != 0]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert turning.unit.startswith(power_of_ten(-round(np.log10(ratio[0]))))
    assert 1 <= max(np.abs(trace.values).max() for trace in turning.traces) < 1000
    table = difference_html((turning, lifting), found, 0.1)
    assert (table.count("PASS"), table.count("FAIL")) == (4, 0)
    assert "PASS" in caption(found, state)

    state = state.updated("plots", published=True)
    found = analyzed(state)
    drawn = drawn_charts(state, found)
    assert [chart.unit for chart in drawn] == ["N·m", "N"]
    table = difference_html(drawn, found, 0.1)
    assert (table.count("PASS"), table.count("FAIL")) == (4, 4)
    assert "misprints" in caption(found, state)
    figure = exports.motion_figure(state, "svg")
    assert "comparison" in figure.name
    assert b"Formulas as published and MuJoCo" in figure.content


@pytest.mark.slow
@needs_mujoco
def test_nothing_is_compared_where_the_motion_fails(state: State) -> None:
    def line(start: float, goal: float) -> State:
        chosen = motions.choose_kind(state, Kind.LINE)
        ends = {"start": (start, 0, 0, -0.55), "goal": (goal, 0, 0, -0.55)}
        return answered(motions.change(chosen, **ends)).updated("plots", plot="differences")

    failing = line(0.0, 0.6)
    found = analyzed(failing)
    torques = engine_torques(found)
    good = found.analysis.check.ok[torques.engine.samples]
    assert 0 < good.sum() < good.size
    comparison = torques.comparison(found.analysis)
    assert len(comparison.computed) == good.sum()
    assert comparison.agrees(TOLERANCE)
    (chart, _) = drawn_charts(failing, found)
    np.testing.assert_array_equal(np.isnan(chart.traces[0].values), ~good)
    np.testing.assert_array_equal(chart.failing, ~good)

    nowhere = line(0.9, 0.95)
    assert "cannot run any" in caption(analyzed(nowhere), nowhere)
