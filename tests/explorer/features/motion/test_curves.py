"""What is plotted: the model's numbers, few points, gaps where there is nothing; simulations."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import balance
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.clearance import motion_job
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.motion_results import MotionStore, split_path
from paminsa_viz.explorer.features.clearance.actions import find_along
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.motion import plots, simulation
from paminsa_viz.explorer.features.motion.layers import motion_path
from paminsa_viz.explorer.features.motion.plots import drawn_charts
from paminsa_viz.explorer.features.motion.simulation import run
from paminsa_viz.explorer.features.motion.tab import coordinates_html
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.state.motion import PLOTS, SIMULATED, Kind, PlotView, Timing
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.simulation import SimulationJob, SimulationSettings
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, InvalidInput, Misprint
from paminsa_viz.palette import COORDINATE_COLORS, MUTED
from paminsa_viz.plots import series_uplot
from paminsa_viz.plots.series import SeriesKind, Trace, runs, statistics
from paminsa_viz.plots.series_uplot import Chart
from paminsa_viz.trajectory import MotionLimits, analyze
from tests.explorer.features.motion.engine_motions import analyzed, caption
from tests.support.charts import shown_curve
from tests.support.samples import enlarged
from tests.support.tasks import delivered


@pytest.fixture
def state() -> State:
    """A heavier design with the paper's pinned, and the formulas as published shown."""
    state = actions.pin_reference(motions.choose_preset(initial_state(), "circle"))
    return actions.vary(state, {"links.b4": 2.0}).updated("plots", published=True)


@pytest.fixture
def failing() -> State:
    """A line out of the workspace and back."""
    state = motions.choose_kind(initial_state(), Kind.LINE)
    ends = {"start": (0.0, 0.0, 0.0, -0.55), "goal": (0.6, 0.0, 0.0, -0.55)}
    return motions.change(state, **ends, back=True)


def test_numbers_of_a_unit_have_as_many_decimals_as_its_largest(state: State) -> None:
    drawn = drawn_charts(state, analyzed(state))
    read = {trace: statistics(chart.t, trace) for chart in drawn for trace in chart.traces}
    text = plots.numbers_html(drawn, read, 0.0)
    found: dict[str, set[int]] = {}
    for row in re.findall(r"<tr><td>(.*?)</tr>", text, re.DOTALL):
        now, most, _, usual, unit = re.findall(r"<td>(?:<b>)?([^<]*)", row)
        places = {len(one.partition(".")[2]) for one in (now, most, usual)}
        found[unit] = found.get(unit, set()) | places
    assert found == {"N·m": {3}, "N": {1}}  # of some N m and some 100 N


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plot", "titles"),
    [("torques", []), ("loads", ["Force at joint 2", "Largest bending moment"])],
)
def test_curves_of_one_name_stand_below_the_titles_of_their_charts(
    plot: SeriesKind, titles: list[str], state: State
) -> None:
    state = replace(state, plots=PlotView(plot))
    drawn = drawn_charts(state, analyzed(state))
    read = {trace: statistics(chart.t, trace) for chart in drawn for trace in chart.traces}
    text = plots.numbers_html(drawn, read, 0.0)
    assert re.findall(r'<tr class="pv-group"><td colspan="6">([^<]*)', text) == titles
    groups = [re.findall(r"([^<>]+)</td>\n<td><b>", part) for part in text.split("pv-group")]
    assert sum(map(len, groups)) == len(read)
    assert [len(set(names)) for names in groups] == [len(names) for names in groups]


@pytest.mark.slow
def test_caption_says_that_a_motion_is_refused_whose_curves_are_drawn_all_the_same() -> None:
    state = motions.choose_kind(initial_state(), Kind.LINE)
    weak = MotionLimits(torque=0.1)  # less than it takes at rest
    state = motions.change(state, timing=Timing.SHORTEST, limits=weak)
    problem = motions.planned(state).problem
    assert problem
    assert f"not possible</b>: {problem}" in caption(analyzed(state), state)
    state = motions.change(state, timing=Timing.GIVEN)
    assert "not possible" not in caption(analyzed(state), state)


def test_curves_are_the_models_torques_of_all_that_is_compared(state: State) -> None:
    found = analyzed(state)
    turning, lifting = drawn_charts(state, found)
    motion, design = found.analysis.trajectory, state.document.design
    assert state.document.reference is not None
    analyses = (
        analyze(design, motion),
        analyze(state.document.reference, motion),
        analyze(design, motion, misprints=Misprint.ALL),
    )
    torques = np.concatenate([analysis.torque[:, :3].T for analysis in analyses])
    np.testing.assert_allclose([trace.values for trace in turning.traces], torques, atol=1e-12)
    forces = [analysis.torque[:, 3] for analysis in analyses]
    np.testing.assert_allclose([trace.values for trace in lifting.traces], forces, atol=1e-10)
    own = (*turning.traces[:3], lifting.traces[0])
    for trace, summary in zip(own, found.analysis.summary, strict=True):
        peak, peak_t, mean = statistics(turning.t, trace)
        assert (peak, peak_t) == (summary.peak, summary.peak_t)
        assert mean == pytest.approx(summary.rms, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    "plot", [plot for plot in PLOTS.values() if plot not in (*SIMULATED, "differences")]
)
def test_every_plot_has_numbers(plot: SeriesKind, state: State) -> None:
    state = replace(state, plots=PlotView(plot, actuator=2, published=True))
    if plot == "clearance":  # which is found in the background
        job = motion_job(state, analyzed(state).analysis)
        state = state.updated("clearance", motion=solve(find_along, job))
    drawn = drawn_charts(state, analyzed(state))
    assert drawn
    for chart in drawn:
        for trace in chart.traces:
            assert trace.values.shape == chart.t.shape
            assert np.isfinite(trace.values).all()
            assert chart.value_at(trace, chart.t[7]) == trace.values[7]


def test_masses_reuse_the_solved_motion_and_the_reference(state: State) -> None:
    store = MotionStore()
    before, after = store.all(state), store.all(actions.vary(state, {"links.b4": 3.0}))
    assert before is not None
    assert after is not None
    assert after.analysis.solved is before.analysis.solved
    assert after.sources.reference is before.sources.reference
    assert np.abs(after.analysis.torque - before.analysis.torque).max() > 0.1


def test_drawn_points_are_few_and_keep_peaks_and_gaps(failing: State) -> None:
    for chart in drawn_charts(failing, analyzed(failing)):
        shape = series_uplot.chart_shape(chart)
        assert shape.pieces == 2
        series = series_uplot.uplot_data(chart, shape.pieces)
        assert len(series) == len(series_uplot.uplot_options(shape)["series"])
        assert series[0].size <= 1.1 * series_uplot.MOST_POINTS
        drawn = np.isin(chart.t, series[0])
        for number, trace in enumerate(chart.traces):
            curve = shown_curve(series, shape, number)
            np.testing.assert_array_equal(curve, trace.values[drawn])
            assert np.nanmax(curve) == np.nanmax(trace.values)
            assert np.nanmin(curve) == np.nanmin(trace.values)
        np.testing.assert_array_equal(series[2], chart.failing[drawn])
        assert series[2].any()


def test_numbers_of_a_failing_motion_are_of_all_that_is_drawn(failing: State) -> None:
    found = analyzed(failing)
    assert found.analysis.check.until < found.analysis.trajectory.size
    for chart in drawn_charts(failing, found):
        for trace in chart.traces:
            peak, at, mean = statistics(chart.t, trace)
            assert abs(peak) == np.nanmax(np.abs(trace.values))
            assert trace.values[np.searchsorted(chart.t, at)] == peak
            assert 0 < mean <= abs(peak)


def test_no_curve_is_drawn_over_a_gap() -> None:
    values = np.array([np.nan, 1.0, 2.0, np.nan, np.nan, 3.0, np.nan, 4.0])
    assert runs(values) == [slice(1, 3), slice(5, 6), slice(7, 8)]
    trace = Trace("c", values, "#000000")
    chart = Chart("a", "b", np.arange(8.0), (trace,), np.isnan(values))
    pieces = series_uplot.uplot_data(chart, 3)[3:]
    assert [int((~np.isnan(piece)).sum()) for piece in pieces] == [2, 1, 1]
    assert statistics(chart.t, trace)[:2] == (4.0, 7.0)
    # Pieces count by their time; a single sample takes none.
    line = Trace("d", np.array([3.0, 3.0, 3.0, np.nan, -4.0, -4.0]), "#000000")
    peak, at, mean = statistics(np.arange(6.0), line)
    assert (peak, at) == (-4.0, 4.0)
    assert mean == pytest.approx(np.sqrt((2 * 9 + 1 * 16) / 3))
    assert series_uplot.bounds(chart.traces) == (1.0, 4.0)


@pytest.mark.parametrize("values", [[np.nan] * 3, [0.0, 1e-15]], ids=["nothing", "tiny"])
def test_any_curve_has_a_range(values: list[float]) -> None:
    low, high = series_uplot.bounds((Trace("c", np.array(values), "#000000"),))
    assert low <= 0 < high


def test_path_is_split_where_it_fails(failing: State) -> None:
    analysis = MotionStore().analysis(failing)
    assert analysis is not None
    path = split_path(analysis)
    good = analysis.check.ok[path.samples]
    assert len(path.good) == 2
    assert all(good[part].all() for part in path.good)
    covered = np.zeros(good.size, dtype=bool)
    for part in (*path.good, *path.bad):
        covered[part] = True
    assert covered.all()
    assert path.bad[0].start == path.good[0].stop - 1


@pytest.mark.parametrize("pieces", [1, 3])
def test_any_piece_of_the_time_has_the_whole_range(state: State, pieces: int) -> None:
    for chart in drawn_charts(state, analyzed(state)):
        span = series_uplot.uplot_data(chart, pieces)[1]
        ends = np.sort(np.stack([span[:-1], span[1:]]), axis=0)
        assert (series_uplot.bounds(chart.traces) == ends.T).all()


def test_path_is_gray_but_for_the_piece_of_time_that_is_plotted(state: State) -> None:
    state = state.updated("", layers=state.layers | {"path"})
    gray = linear_colors(MUTED)[0]

    def colored(piece: tuple[float, float] | None) -> np.ndarray:
        way, *_ = motion_path(compute(motions.show_piece(state, piece)))
        return (way.live["colors"] != gray).any(axis=(1, 2))

    assert colored(None).all()
    motion = analyzed(state).analysis.trajectory
    start, end = 0.2 * motion.duration, 0.6 * motion.duration
    inside = colored((start, end))
    assert inside.mean() == pytest.approx(0.4, abs=0.02)
    assert np.flatnonzero(np.diff(inside.astype(int))).size == 2
    assert not colored((-2.0, -1.0)).any()


@pytest.mark.parametrize(
    "data", [None, 7, "x", {}, {"from": 1.0}, {"from": 2.0, "to": 1.0}, {"from": math.nan, "to": 1}]
)
def test_what_is_no_piece_of_time_is_none(data: Any) -> None:
    assert plots.piece_of(data) is None
    assert plots.piece_of({"from": 0.5, "to": 1}) == (0.5, 1.0)


def test_torques_of_a_small_robot_are_drawn_in_a_fraction_of_their_unit() -> None:
    """A chart's axis has three decimals; of a balanced robot there is nothing to enlarge."""
    tiny, small, large = (initial_state(enlarged(APPENDIX_4, share)) for share in (0.01, 0.1, 1.0))
    for start, unit, factor in (
        (tiny, "10⁻⁹ N·m", 1e9),
        (small, "10⁻⁶ N·m", 1e6),
        (large, "N·m", 1.0),
        (actions.load_design(large, balance(APPENDIX_4).after), "N·m", 1.0),
    ):
        found = analyzed(motions.choose_preset(start, "circle"))
        turning, _ = drawn_charts(start, found)
        assert turning.title == f"Torques [{unit}]"
        torque = factor * found.analysis.torque[:, 0]
        np.testing.assert_allclose(turning.traces[0].values, torque, atol=1e-12)


@pytest.mark.slow
def test_result_of_a_simulation_is_plotted_and_holds_for_its_design_only() -> None:
    state = simulation.simulate(initial_state())
    job = state.simulation.running
    assert job is not None
    outcome = solve(run, job)
    assert outcome.result is not None
    done = delivered(simulation.SIMULATION, state, outcome)
    assert done.simulation.running is None
    assert not simulation.SIMULATION.is_stale(done)
    heavier = actions.vary(done, {"links.b4": 3.0})
    assert simulation.SIMULATION.changes(heavier) == ("masses",)
    assert delivered(simulation.SIMULATION, done, outcome) is done
    assert exports.curves_table(done, "csv").content.startswith(b"# format: paminsa_viz simulation")
    with pytest.raises(InvalidInput, match="simulate the current motion first"):
        exports.curves_table(heavier, "csv")  # and not the motion in its place
    place, turn = drawn_charts(done, analyzed(done))
    assert "[mm]" in place.title
    x, y, theta, z = COORDINATE_COLORS
    colors = [[trace.color for trace in chart.traces] for chart in (place, turn)]
    assert colors == [[x, y, z], [theta]]
    named = re.findall(r"(--pv-\w+), #.*?<i>(.)</i>", coordinates_html(compute(done)))
    assert named == [(f"--pv-{color[1:].lower()}", name) for color, name in
                     zip(COORDINATE_COLORS, "xyθz", strict=True)]  # fmt: skip
    assert coordinates_html(compute(state)) == ""
    error = np.degrees(outcome.result.error[:, 2])
    np.testing.assert_allclose(turn.traces[0].values, error, rtol=1e-12)


def test_impossible_load_or_path_of_a_simulation_is_explained(failing: State) -> None:
    motion = motions.planned(initial_state()).trajectory
    design = initial_state().document.design
    assert motion is not None
    lighter = SimulationJob(design, motion, SimulationSettings(payload_mismatch=-1.0))
    needed = "Payload mismatch: at least 0 kg is needed: no payload is left then."
    assert solve(run, lighter).problem == needed
    loaded = design.vary({"payload.mass": 2.0})
    assert (
        "at least −2 kg"
        in solve(
            run, replace(lighter, design=loaded, settings=SimulationSettings(payload_mismatch=-3.0))
        ).problem
    )
    assert "cannot be run" in solve(run, simulation.wanted_job(failing)).problem
