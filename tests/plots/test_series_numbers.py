"""Figures over time: the numbers and words beside their curves."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.clearance import ALL_PAIRS, PairGroup, clearance, group_clearance
from paminsa_viz.elastostatics.motion_loads import motion_loads
from paminsa_viz.model import APPENDIX_4, InvalidInput, Misprint
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.series import (
    EngineTorques,
    SeriesSources,
    Trace,
    largest_size,
    statistics,
)
from paminsa_viz.plots.series_builders import (
    PLOTTED,
    SAMPLES,
    build_series,
    motion_clearance,
    unknown_clearance,
)
from paminsa_viz.plots.series_text import NAMED_FAILURES, caption, failures, summary
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    CrossingLoad,
    Locus,
    TrajectoryAnalysis,
    analyze,
    point_to_point,
    preset_center,
    simulate,
)
from paminsa_viz.trajectory.check import PathEvent
from paminsa_viz.units import format_value

RED = "#ff0000"


@pytest.fixture(scope="module")
def motion():
    return PRESET["paper-like"].build(APPENDIX_4.geometry).sample(60)


@pytest.fixture(scope="module")
def analysis(motion) -> TrajectoryAnalysis:
    return analyze(APPENDIX_4, motion)


@pytest.fixture(scope="module")
def light(motion) -> TrajectoryAnalysis:
    return analyze(replace(APPENDIX_4.vary({"links.b4": 0.2}), name="Light"), motion)


def failing(
    analysis: TrajectoryAnalysis, runs: list[tuple[int, int, Limit, int]], first: float
) -> TrajectoryAnalysis:
    """Return an analysis whose motion fails in runs of samples: start, stop, limit, leg."""
    check, t = analysis.check, analysis.trajectory.t
    status, leg = check.status.copy(), check.leg.copy()
    for start, stop, limit, which in runs:
        status[start:stop], leg[start:stop] = limit, which
    event = PathEvent(first, runs[0][2], runs[0][3], -1e-3, tuple(analysis.trajectory.pose[0]))
    until = int((t < first).sum())
    broken = replace(check, status=status, leg=leg, first=event, until=until)
    torque = np.where((status == 0)[:, None], analysis.torque, np.nan)
    return replace(analysis, solved=replace(analysis.solved, check=broken), torque=torque)


# ---------------------------------------------------------------------------------- statistics


@given(
    st.lists(st.tuples(st.floats(-9, 9), st.integers(1, 6)), min_size=1, max_size=5),
    st.floats(-5, 50),
)
def test_statistics_count_each_piece_by_the_time_it_takes(pieces, start) -> None:
    values = np.concatenate([[level] * count + [np.nan] for level, count in pieces])
    t = start + 0.25 * np.arange(values.size)
    found = statistics(t, Trace("x", values, RED))
    spans = [0.25 * (count - 1) for _, count in pieces]
    weights = spans if any(spans) else [1.0] * len(pieces)
    square = sum(w * level**2 for w, (level, _) in zip(weights, pieces, strict=True))
    np.testing.assert_allclose(found.rms, math.sqrt(square / sum(weights)), rtol=1e-9, atol=1e-12)
    largest = max(pieces, key=lambda piece: abs(piece[0]))[0]
    assert found.peak == largest
    assert found.peak_t == t[np.flatnonzero(np.abs(values) == abs(largest))[0]]


def test_statistics_end_where_the_trace_does() -> None:
    trace = Trace("x", np.array([1.0, -3.0, 2.0, np.nan]), RED)
    assert statistics(np.arange(4.0), trace)[:2] == (-3.0, 1.0)
    empty = Trace("y", np.array([np.nan]), RED)
    assert all(math.isnan(number) for number in statistics(np.arange(1.0), empty))
    assert largest_size([trace, Trace("y", np.array([np.nan, -20.0]), RED)]) == 20.0
    assert largest_size([empty]) == 0.0


# ------------------------------------------------------------------------- notes beside curves


def test_notes_name_the_peaks_and_sizes_of_the_curves(analysis, light) -> None:
    sources = SeriesSources(analysis, reference=light)
    for kind, quantity in (("torques", "torque"), ("power", "power")):
        for j, panel in enumerate(build_series(kind, sources).panels):
            for text, found in zip(
                (note for note, _ in panel.notes), (analysis, light), strict=True
            ):
                values = getattr(found, quantity)[:, j]
                top = np.abs(values).argmax()
                peak = format_value(values[top], panel.unit, 3)
                when = format_value(analysis.trajectory.t[top], "s", 3)
                assert f"peak {peak} at {when}" in text
                speed = format_value(
                    np.abs(found.solved.speed[:, j]).max(), ("rad/s", "m/s")[j == 3], 3
                )
                assert (f"speed up to {speed}" in text) == (kind == "power" and found is analysis)
    motion = analysis.trajectory
    for i, panel in enumerate(build_series("pose", sources).panels):
        sizes = [
            format_value(np.abs(rate[:, i]).max(), f"{panel.unit}/{per}", 3)
            for rate, per in ((motion.velocity, "s"), (motion.acceleration, "s²"))
        ]
        assert panel.notes[0][0] == f"speed up to {sizes[0]}, acceleration up to {sizes[1]}"
    for j, panel in enumerate(build_series("energy", sources).panels[:4]):
        driven, braked = (analysis.summary[j].driven, analysis.summary[j].braked)
        text = f"drives {format_value(driven, 'J', 3)}, brakes {format_value(braked, 'J', 3)}"
        assert panel.notes[0][0] == text
        assert panel.notes[1][0].startswith("reference: drives ")


@pytest.mark.parametrize(("kind", "rate"), [("speed", "velocity"), ("acceleration",) * 2])
def test_rates_are_those_of_the_motion(kind, rate, analysis) -> None:
    panels = build_series(kind, SeriesSources(analysis)).panels
    assert [p.unit for p in panels] == [
        f"{unit}/{'s' if kind == 'speed' else 's²'}" for unit in ("m", "m", "rad", "m")
    ]
    for i, panel in enumerate(panels):
        np.testing.assert_array_equal(
            panel.traces[0].values, getattr(analysis.trajectory, rate)[:, i]
        )


@pytest.mark.parametrize("size", [1, 49, 50, 51, 100, 101, 120])
def test_an_engine_has_about_fifty_marks(size, analysis) -> None:
    motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(60)
    samples = np.unique(np.linspace(0, motion.size - 1, size).astype(int))
    engine = EngineTorques("an engine", analysis.torque[samples] + 1.0, samples)
    for j, panel in enumerate(
        build_series("torques", SeriesSources(analysis, engine=engine)).panels
    ):
        marks = panel.traces[-1]
        at = np.flatnonzero(np.isfinite(marks.values))
        assert marks.marks
        assert 25 < at.size <= 50 or at.size == samples.size <= 50
        assert at[0] == samples[0]
        np.testing.assert_array_equal(marks.values[at], analysis.torque[at, j] + 1.0)


def test_a_table_may_lack_an_actuator(analysis) -> None:
    torque = analysis.torque.copy()
    torque[:, 1] = np.nan
    data = build_series("comparison", SeriesSources(analysis, engine=EngineTorques("e", torque)))
    assert [panel.source for panel in data.panels] == [
        name for name in ("M1", "M3", "M4") for _ in "ab"
    ]


def test_differences_are_of_the_formulas_and_have_their_largest_value(analysis, motion) -> None:
    published = analyze(APPENDIX_4, motion, misprints=Misprint.ALL)
    samples = np.arange(0, motion.size, 3)
    engine = EngineTorques("e", analysis.torque[samples] - [[0.5, 0.0, -0.25, 2.0]], samples)
    sources = SeriesSources(analysis, published=published, engine=engine)
    data = build_series("differences", sources)
    np.testing.assert_array_equal(data.time, motion.t[samples])
    for j, panel in enumerate(data.panels):
        as_published, own = panel.traces
        np.testing.assert_allclose(own.values, (0.5, 0.0, -0.25, 2.0)[j], atol=1e-12)
        np.testing.assert_array_equal(
            as_published.values, published.torque[samples, j] - engine.torque[:, j]
        )
    broken = failing(analysis, [(30, motion.size, Limit.GUIDE, 0)], float(motion.t[30]))
    data = build_series("differences", replace(sources, analysis=broken))
    assert data.until == 10
    np.testing.assert_array_equal(data.failing, samples >= 30)
    compared = build_series("comparison", sources).panels
    for j, panel in enumerate(compared[1::2]):
        values = analysis.torque[samples, j] - engine.torque[:, j]
        top = np.abs(values).argmax()
        assert panel.traces[0].peak == (motion.t[samples[top]], values[top])
        largest, when = (
            format_value(values[top], panel.unit, 3),
            format_value(motion.t[samples[top]], "s", 3),
        )
        assert panel.notes[0][0] == f"largest {largest} at {when}"


@pytest.mark.slow
def test_errors_and_commands_of_a_simulation(analysis, motion) -> None:
    run = simulate(APPENDIX_4.vary({"payload.mass": 0.5}), motion, model=APPENDIX_4)
    sources = SeriesSources(analysis, simulation=run)
    for kind, values in (("errors", run.error), ("commands", run.torque)):
        data = build_series(kind, sources)
        np.testing.assert_array_equal(data.time, run.t)
        assert data.until == run.t.size
        assert not data.failing.any()
        for i, panel in enumerate(data.panels):
            np.testing.assert_array_equal(panel.traces[0].values, values[:, i])
    np.testing.assert_array_equal(build_series("tracking", sources).time, run.t)
    text = caption(build_series("tracking", sources))
    farthest = np.linalg.norm(run.error[:, [0, 1, 3]], axis=1).max()
    assert f"The platform is at most {format_value(farthest, 'm', 3)} from its place" in text
    drift = format_value(np.abs(run.energy_drift).max(), "J", 2)
    assert f"energy drifts by {drift}" in text
    assert text.index("The simulated robot: ") < text.index("Controller: ")
    by_rate = f", {run.controller.bandwidth:g} Hz, damping {run.controller.damping:g}."
    assert by_rate in text
    for control in (
        Controller(ControlMode.FEED_FORWARD),
        Controller(proportional=(50.0,) * 4, derivative=(5.0,) * 4),
    ):
        other = replace(run, controller=control, design=analysis.design)
        text = caption(build_series("tracking", replace(sources, simulation=other)))
        assert f"Controller: {control.control.value}." in text
        assert "The simulated robot" not in text


# --------------------------------------------------------------------- joint forces, clearance


def test_loads_are_those_of_the_joints_up_to_the_failure(analysis, motion) -> None:
    broken = failing(analysis, [(40, motion.size, Limit.FOLDED, 2)], float(motion.t[40]))
    found = motion_loads(broken)
    assert found is not None
    panels = build_series("loads", SeriesSources(broken)).panels
    assert len(panels) == len(PLOTTED) + 2
    bending = np.abs(found.bars[..., 2]).max(axis=-1)
    share = 100.0 * found.utilization.max(axis=-1)
    for panel, values in zip(panels[-2:], (bending, share), strict=True):
        for leg, trace in enumerate(panel.traces):
            np.testing.assert_array_equal(trace.values[:40], values[:, leg])
            assert np.isnan(trace.values[40:]).all()
            top = values[:, leg].argmax()
            assert trace.peak == (motion.t[top], values[top, leg])
            assert panel.notes[leg][0] == f"peak {format_value(values[top, leg], panel.unit, 3)}"
    assert [p.name for p in panels[:4]] == [
        "Force at joint 2", "Force at joint 4", "Force at the guide", "Force at joint 5",
    ]  # fmt: skip


def test_least_clearance_is_that_of_all_samples() -> None:
    motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(2.5 * SAMPLES / 10.0)
    analysis = analyze(APPENDIX_4, motion)
    chosen = tuple(PairGroup)[:2]
    found = motion_clearance(analysis, reversed(chosen))
    everywhere = clearance(APPENDIX_4, motion.pose, chosen)
    low = int(everywhere.least.argmin())
    assert found.distance == everywhere.least[low]
    assert found.t == motion.t[low]
    assert found.names == everywhere.pairs[everywhere.pair[low]]
    np.testing.assert_array_equal(found.least, everywhere.least[found.samples])
    by_group = group_clearance(APPENDIX_4, motion.pose[found.samples], chosen)
    assert found.groups == chosen
    np.testing.assert_array_equal(found.by_group, by_group)
    steps = np.diff(found.samples)
    assert found.samples[0] == 0
    assert found.samples[-1] == motion.size - 1
    assert (steps > 0).all()
    assert steps.max() <= -(-motion.size // SAMPLES)
    assert {low - 1, low, low + 1} - {-1, motion.size} <= set(found.samples.tolist())


def test_clearance_is_drawn_between_the_samples_where_the_robot_can_be(analysis, motion) -> None:
    broken = failing(analysis, [(20, 30, Limit.GUIDE, 0)], float(motion.t[20]))
    found = motion_clearance(broken)
    all_pairs, by_pairs = build_series("clearance", SeriesSources(broken)).panels
    least = all_pairs.traces[0]
    assert np.isnan(least.values[20:30]).all()
    outside = np.setdiff1d(np.arange(motion.size), np.arange(20, 30))
    of_all = clearance(APPENDIX_4, motion.pose, tuple(ALL_PAIRS)).least
    np.testing.assert_allclose(least.values[outside], of_all[outside], atol=1e-12)
    assert least.peak == (found.t, found.distance)
    text = f"{format_value(found.distance, 'm', 3)} at {format_value(found.t, 's', 3)}"
    bodies = f"{found.names[0]} and {found.names[1]}"
    assert [words for words, _ in all_pairs.notes] == [text, bodies]
    assert [trace.label for trace in by_pairs.traces] == [group.value for group in found.groups]
    assert len({trace.color for trace in by_pairs.traces}) == len(by_pairs.traces)
    not_yet = SeriesSources(analysis, clearance=unknown_clearance(analysis))
    for panel in build_series("clearance", not_yet).panels:
        assert not panel.notes
        assert len(panel.traces) == 1
        assert np.isnan(panel.traces[0].values).all()
        assert panel.traces[0].peak is None


def test_a_motion_out_of_reach_has_no_clearance() -> None:
    start = np.add(preset_center(APPENDIX_4.geometry), (0.9, 0.0, 0.0, 0.0))
    away = point_to_point(start, start + np.array([0.0, 0.1, 0.0, 0.0])).sample(20)
    found = motion_clearance(analyze(APPENDIX_4, away))
    assert found.groups == ()
    assert found.by_group.shape == (found.samples.size, 0)
    assert math.isnan(found.distance)
    assert math.isnan(found.t)
    assert found.names == ("", "")


# ------------------------------------------------------------------------------------ captions


def text_of(kind, analysis, **others) -> str:
    return caption(build_series(kind, SeriesSources(analysis, **others)))


def test_failures_are_runs_of_one_reason(analysis, motion) -> None:
    t = motion.t
    runs = [
        (10, 20, Limit.GUIDE, 0), (20, 25, Limit.GUIDE, 2), (25, 26, Limit.FOLDED, 2),
        (40, 41, Limit.SINGULAR, -1), (45, 50, Limit.AXIS, 1), (55, motion.size, Limit.AXIS, 1),
    ]  # fmt: skip
    between = float(t[9] + 0.3 * (t[10] - t[9]))
    broken = failing(analysis, runs, between)
    found = failures(build_series("torques", SeriesSources(broken)))
    ends = [float(t[min(stop, motion.size - 1)]) for _, stop, _, _ in runs]
    starts = [between, *(float(t[start]) for start, *_ in runs[1:])]
    assert [(each.start, each.end) for each in found] == list(zip(starts, ends, strict=True))
    assert found[3].reason == "too close to a singular pose"
    assert found[0].reason == Limit.GUIDE.reason(0) != found[1].reason == Limit.GUIDE.reason(2)
    text = text_of("torques", broken)
    named = "; ".join(str(each) for each in found[:NAMED_FAILURES])
    assert f"The motion fails, shaded: {named}; and 2 more. Numbers are for the time" in text
    assert "Numbers are for" not in text_of("pose", broken)
    four = failing(analysis, [(10 * i, 10 * i + 5, Limit.GUIDE, 0) for i in range(1, 5)], between)
    assert "more." not in text_of("torques", four)


def test_a_failure_before_those_at_samples_is_one_more(analysis, motion) -> None:
    t = motion.t
    early = failing(analysis, [(30, 40, Limit.GUIDE, 0)], float(t[10]) + 1e-4)
    found = failures(build_series("torques", SeriesSources(early)))
    assert [(each.start, each.end) for each in found] == [
        (early.check.first.t,) * 2, (t[30], t[40]),
    ]  # fmt: skip
    assert str(found[0]).startswith("at ")
    assert " to " in str(found[1])
    assert failures(build_series("torques", SeriesSources(analysis))) == ()
    at_once = failing(analysis, [(0, 5, Limit.GUIDE, 0)], float(t[0]))
    data = build_series("loads", SeriesSources(at_once))
    assert [(each.start, each.end) for each in failures(data)] == [(t[0], t[5])]
    for panel in data.panels:
        assert not panel.notes
        assert all(np.isnan(trace.values).all() for trace in panel.traces)


def test_a_crossing_at_which_torques_have_no_bound_is_an_instant_that_fails(analysis) -> None:
    wild = replace(analysis)  # nothing of it is kept
    at = CrossingLoad(0.123456, Locus.CIRCLE, 1.0, 9.0, (0.0,) * 4)
    object.__setattr__(wild, "unbounded", (at,))
    found = failures(build_series("torques", SeriesSources(wild)))
    assert [(each.start, each.end) for each in found] == [(at.t, at.t)]
    text = text_of("torques", wild)
    assert "The motion fails, shaded: at 0.1235 s torques have no bound." in text
    assert "Numbers are for" not in text  # they are those of all samples


def test_a_band_is_explained_only_where_it_is_drawn(analysis) -> None:
    """Not of a motion that fails at once."""
    shifted = replace(analysis.trajectory, pose=analysis.trajectory.pose + 9.0)
    failing = analyze(APPENDIX_4, shifted)
    assert not failing.summary
    assert "The motion fails" in (text := text_of("torques", failing))
    assert "band" not in text


def test_captions_say_what_is_compared_and_what_is_summed(analysis, light, motion) -> None:
    published = analyze(APPENDIX_4, motion, misprints=Misprint.ALL)
    compared = {"reference": light, "published": published}
    for kind, sentence in {
        "torques": "The band is the RMS over time",
        "power": "Positive where an actuator drives.",
        "breakdown": "The parts add up to the total.",
        "loads": "Forces and stress are those in the legs’ planes",
    }.items():
        text = text_of(kind, analysis, **compared)
        assert sentence in text
        for word in ("Reference: design “Light”.", "As published: all five misprints."):
            assert (word in text) == (kind in ("torques", "power"))
    assert f"{motion.size} samples." in text_of("pose", analysis)
    uneven = replace(motion, t=motion.t**2)
    step = 1e3 * max(after - before for before, after in pairwise(uneven.t))
    solved = replace(analysis.solved, trajectory=uneven)
    assert f"in steps of {step:.3g} ms." in text_of("energy", replace(analysis, solved=solved))
    assert "do not balance" not in text_of("energy", analysis)
    assert "Formulas as published do not balance." in text_of("energy", published)
    for kind in ("torques", "pose"):
        said = "Formulas as published: all five misprints." in text_of(kind, published)
        assert said == (kind == "torques")
    assert "minus reference “Light”" in text_of("comparison", analysis, reference=light)
    with pytest.raises(InvalidInput, match="needs an engine"):
        text_of("comparison", analysis)


def test_a_reference_that_fails_says_so_beside_a_motion_that_does_not(analysis, motion) -> None:
    broken = failing(analysis, [(30, 40, Limit.GUIDE, 0)], float(motion.t[30]))
    said = "The reference fails at "
    assert said in text_of("torques", analysis, reference=broken)
    assert said not in text_of("torques", broken, reference=broken)
    assert said not in text_of("torques", analysis, reference=analysis)


@pytest.mark.parametrize(
    ("misprints", "words"),
    [
        (Misprint.EQ13_LEG_SPIN, "Eq. 13 leg spin."),
        (Misprint.APP3_MC4 | Misprint.EQ14_SINE_SIGNS, "App. 3 mc4, Eq. 14 sine signs."),
    ],
)
def test_misprints_are_named_by_their_place(misprints, words, motion) -> None:
    published = analyze(APPENDIX_4, motion, misprints=misprints)
    assert f"Formulas as published: {words}" in text_of("torques", published)


def test_notes_become_sentences(analysis) -> None:
    noted = replace(analysis.trajectory, notes=("First note", "Second note."), kind="by hand")
    data = build_series(
        "pose", SeriesSources(replace(analysis, solved=replace(analysis.solved, trajectory=noted)))
    )
    text = caption(data, ["Third"])
    assert "First note. Second note. Third. " in text
    assert " (by hand), " in text
    assert f"{noted.duration:.6g} s" in summary(data)


def test_sources_of_another_motion_are_refused_and_the_same_ones_taken(analysis, motion) -> None:
    copy = replace(motion, t=motion.t.copy(), pose=motion.pose.copy())
    SeriesSources(analysis, reference=analyze(APPENDIX_4, copy))
    pose = motion.pose.copy()
    pose[3, 0] += 1e-9
    for other in (replace(motion, t=2.0 * motion.t), replace(motion, pose=pose)):
        for name in ("reference", "published"):
            with pytest.raises(InvalidInput, match="same trajectory") as caught:
                SeriesSources(analysis, **{name: analyze(APPENDIX_4, other)})
            assert caught.value.argument == name


def test_friction_and_load_are_causes_where_there_are_any(motion) -> None:
    pushed = APPENDIX_4.vary({"friction.viscous_rotary": 0.2, "friction.coulomb_linear": 1.0})
    loaded = APPENDIX_4.vary({"load.force_x": 5.0})
    for design, labels in ((pushed, ["friction"]), (loaded, ["load"]), (APPENDIX_4, [])):
        panels = build_series("breakdown", SeriesSources(analyze(design, motion))).panels
        named = [trace.label for trace in panels[0].traces]
        assert named == ["gravity", "inertia", "centrifugal and Coriolis", *labels, "total"]
