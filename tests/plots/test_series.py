"""Figures over time: their data, layout and files."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import Bbox
from PIL import Image

from paminsa_viz.model import APPENDIX_4, Friction, InvalidInput, Misprint
from paminsa_viz.plots import series_builders, series_text
from paminsa_viz.plots.formats import Credits, drawing, figure_file
from paminsa_viz.plots.series import (
    FIGURES,
    EngineTorques,
    SeriesPanel,
    SeriesSources,
    Trace,
    runs,
    thinned,
)
from paminsa_viz.plots.series_builders import build_series
from paminsa_viz.plots.series_figure import draw_series, figure_bytes, render_series, value_range
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    ControlMode,
    analyze,
    point_to_point,
    preset_center,
    round_trip,
    simulate,
)

RUBBING = replace(APPENDIX_4, friction=Friction(viscous_rotary=0.2, coulomb_linear=2.0))
ACROSS = (0.45, 0.05, 0.3, 0.02)
"""From home across the singular circle."""
PAGE = 297 / 25.4
"""Height of a page [in]."""


@pytest.fixture(scope="module")
def motion():
    return PRESET["paper-like"].build(APPENDIX_4.geometry).sample(200)


@pytest.fixture(scope="module")
def analysis(motion):
    return analyze(RUBBING, motion)


@pytest.fixture(scope="module")
def still(motion):
    """Much slower, under a long name."""
    return analyze(RUBBING, replace(motion, t=600.0 / motion.t[-1] * motion.t, name="W" * 70))


def others_on(motion):
    """Return analyses to compare one of a motion with."""
    light = replace(RUBBING.vary({"links.b4": 0.2}), name="Light")
    return {
        "reference": analyze(light, motion),
        "published": analyze(RUBBING, motion, misprints=Misprint.ALL),
    }


@pytest.fixture(scope="module")
def everything(motion):
    """What every kind of figure can be made of."""
    return others_on(motion) | {
        "simulation": simulate(RUBBING.vary({"payload.mass": 0.5}), motion, model=RUBBING),
    }


@pytest.fixture(scope="module")
def failing():
    start = preset_center(APPENDIX_4.geometry)
    beyond = round_trip(point_to_point(start, np.add(start, ACROSS), 1.0))
    return analyze(APPENDIX_4, beyond.sample(200))


def _series(kind, analysis, **others):
    return build_series(kind, SeriesSources(analysis, **others))


@pytest.mark.slow
def test_torques_are_those_of_the_analysis(analysis, everything) -> None:
    data = _series("torques", analysis, **everything)
    for j, panel in enumerate(data.panels):
        reference, published, own = (trace.values for trace in panel.traces)
        np.testing.assert_array_equal(own, analysis.torque[:, j])
        np.testing.assert_array_equal(reference, everything["reference"].torque[:, j])
        np.testing.assert_array_equal(published, everything["published"].torque[:, j])
        summary, drawn = analysis.summary[j], panel.traces[-1]
        assert drawn.peak == (summary.peak_t, summary.peak)
        assert drawn.band == summary.rms
        assert len(panel.notes) == 3


def test_parts_add_up_to_the_last_curve_with_friction_only_where_there_is_some(
    motion, analysis
) -> None:
    for panel in _series("breakdown", analysis).panels:
        *parts, whole = (trace.values for trace in panel.traces)
        assert len(parts) == len(series_builders.CAUSES) - 1  # no load
        np.testing.assert_allclose(sum(parts), whole, atol=1e-12)
    smooth = _series("breakdown", analyze(APPENDIX_4, motion)).panels[0]
    labels = [trace.label for trace in smooth.traces]
    assert labels == ["gravity", "inertia", "centrifugal and Coriolis", "total"]


def test_energies_balance(analysis) -> None:
    robot, balance = _series("energy", analysis).panels[-2:]
    work, gained = (trace.values for trace in robot.traces)
    residual = balance.traces[0].values
    assert np.diff(work - gained - residual).min() > -1e-8  # friction only takes
    assert np.abs(residual).max() < 1e-5


def test_captions_do_not_claim_the_papers_motion(analysis) -> None:
    data = _series("pose", analysis)
    assert "It is not the motion of the paper’s Figs. 8-11" in series_text.caption(data)
    assert "Fig" not in data.title


@pytest.mark.slow
def test_differences_are_against_the_engine_first(analysis, everything) -> None:
    other = EngineTorques("an engine", analysis.torque + np.array([1e-3, 0.0, 0.0, 2.0]))
    data = _series("comparison", analysis, engine=other, **everything)
    differences = [panel.traces[0].values for panel in data.panels[1::2]]
    np.testing.assert_allclose(differences[0], -1e-3, rtol=1e-9)
    np.testing.assert_array_equal(differences[1], 0.0)
    assert data.panels[0].traces[1].label == "an engine"
    without = _series("comparison", analysis, published=everything["published"])
    assert without.panels[0].traces[1].label == "formulas as published"


def test_a_stopped_simulation_ends_where_it_stopped() -> None:
    circle = PRESET["circle"].build(APPENDIX_4.geometry).sample(100)
    blind = Controller(ControlMode.FEED_FORWARD)
    run = simulate(APPENDIX_4, circle, controller=blind, offset=(0.01, 0.0, 0.02, 0.0))
    assert run.stopped is not None
    data = _series("tracking", analyze(APPENDIX_4, circle), simulation=run)
    after = circle.t[circle.t > run.t[-1]]
    np.testing.assert_array_equal(data.time, [*run.t, *after])
    simulated, wanted = data.panels[0].traces
    assert np.isfinite(simulated.values).sum() == run.t.size
    assert np.isfinite(wanted.values).all()
    assert [(f.start, f.end) for f in series_text.failures(data)] == [(run.stopped.t, circle.t[-1])]
    assert "The simulation stopped at" in series_text.caption(data)


def test_failures_are_shaded_exactly_where_there_are_no_torques(failing) -> None:
    data = _series("torques", failing)
    (failure,) = series_text.failures(data)
    shaded = (data.time >= failure.start) & (data.time < failure.end)
    np.testing.assert_array_equal(shaded, np.isnan(data.panels[0].traces[-1].values))
    assert failing.check.first is not None
    assert failure.start == failing.check.first.t
    assert failure.reason == "too close to a singular pose"
    assert "The motion fails, shaded: 0.52" in series_text.caption(data)


def test_a_failure_between_two_samples_is_an_instant() -> None:
    start = preset_center(APPENDIX_4.geometry)
    quick = round_trip(point_to_point(start, np.add(start, ACROSS), 1.0)).sample(1.0)
    poses = quick.pose.copy()
    poses[1] = poses[0]
    analysis = analyze(APPENDIX_4, replace(quick, pose=poses, velocity=poses * 0 + [3, 0, 0, 0]))
    assert analysis.check.ok.all()
    assert not analysis.check.possible
    (failure,) = series_text.failures(_series("torques", analysis))
    assert failure.start == failure.end == analysis.check.first.t


def _texts(figure) -> list[tuple[str, Bbox]]:
    """Return all texts of a figure that is drawn, with their extents [pixels]."""
    texts = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for area in figure.axes:
        texts += [area._left_title, area.xaxis.label, area.yaxis.label, *area.texts]
        for axis, (low, high) in ((area.xaxis, area.get_xlim()), (area.yaxis, area.get_ylim())):
            ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            texts += [tick.label1 for tick in ticks if tick.label1.get_visible()]
    return [(text.get_text(), text.get_window_extent()) for text in texts if text.get_text()]


@pytest.mark.slow
@pytest.mark.parametrize("kind", FIGURES)
@pytest.mark.parametrize("width", [60.0, 170.0])
def test_texts_are_inside_the_figure_and_do_not_overlap(
    kind, width, still, analysis, everything
) -> None:
    """Narrow ones of one source, wide ones of as many as there can be."""
    shown = analysis if kind == "tracking" else still
    given = {} if width == 60.0 else others_on(shown.trajectory)
    if kind == "tracking":
        given["simulation"] = everything["simulation"]
    if kind == "comparison":
        given["engine"] = EngineTorques("engine", still.torque * (1 + 1e-12))
    data = _series(kind, shown, **given)
    with drawing():
        figure = draw_series(data, width, 150.0, data.title, series_text.caption(data))
        if width == 60.0:
            content = figure_file(figure, "png", 150, Credits(kind, ""))
            image = Image.open(io.BytesIO(content))
            assert image.width == round(width / 25.4 * 150)
            assert np.asarray(image.convert("L")).std() > 10
        else:
            figure.draw_without_rendering()
        found = _texts(figure)
        right, top = figure.bbox.max
    columns: dict[float, set[float]] = {}
    for area in figure.axes:
        place = area.yaxis.label.get_position()[0]
        columns.setdefault(round(area.get_position().x0, 6), set()).add(round(place, 2))
    assert all(len(places) == 1 for places in columns.values()), "labels of axes are not in line"
    assert int(right) == round(width / 25.4 * 150)
    assert top < PAGE * 150
    for words, box in found:
        assert min(box.x0, box.y0) >= 0, words
        assert max(box.x1 - right, box.y1 - top) <= 0.5, words
    for i, (words, box) in enumerate(found):
        for other, beside in found[i + 1 :]:
            apart = box.x1 <= beside.x0 + 1 or beside.x1 <= box.x0 + 1
            assert apart or box.y1 <= beside.y0 + 1.5 or beside.y1 <= box.y0 + 1.5, (words, other)


@pytest.mark.slow
def test_a_motion_that_fails_at_once_is_still_drawn() -> None:
    start = np.add(preset_center(APPENDIX_4.geometry), (0.9, 0.0, 0.0, 0.0))
    analysis = analyze(
        APPENDIX_4, point_to_point(start, np.add(start, (0.0, 0.1, 0.0, 0.0))).sample(20)
    )
    assert not analysis.summary
    for kind in (k for k in FIGURES if k not in ("tracking", "comparison")):
        data = _series(kind, analysis)
        assert "The motion fails" in series_text.caption(data), kind
        for trace in (trace for panel in data.panels for trace in panel.traces):
            assert kind == "pose" or not np.isfinite(trace.values).any(), kind
            assert trace.peak is None, kind
    assert figure_bytes("torques", analysis, dpi=40).startswith(b"\x89PNG")


def test_a_comparison_with_a_reference_that_fails_at_once_has_no_difference(analysis) -> None:
    """What the motion is, is still drawn; nothing says that it fails."""
    lengths = ("base_radius", "platform_radius", "arm_length", "shaft_length", "crank_length",
               "coupler_length", "platform_joint_height", "guide_link_length")  # fmt: skip
    small = {f"geometry.{name}": 0.3 * getattr(APPENDIX_4.geometry, name) for name in lengths}
    short = APPENDIX_4.vary(small)
    reference = analyze(short, analysis.trajectory)
    assert not reference.summary
    data = _series("comparison", analysis, reference=reference)
    assert [panel.symbol for panel in data.panels] == [
        symbol for each in series_builders.SYMBOLS for symbol in (each, f"Δ{each}")
    ]
    with drawing():
        figure = draw_series(data, 170.0, 40.0, data.title, series_text.caption(data))
        words = [text.get_text() for area in figure.axes for text in area.texts]
    assert words.count("no value") == 4
    assert not [text for text in words if "the motion fails" in text]
    entries = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert entries == ["this analysis"]


@pytest.fixture(scope="module")
def few_panels(analysis):
    return _series("clearance", analysis)


@pytest.mark.slow
def test_the_ring_of_a_clearance_is_its_least_value_with_words_that_can_be_read(
    few_panels,
) -> None:
    (trace,) = few_panels.panels[0].traces
    assert trace.peak[1] == np.nanmin(trace.values)
    with drawing():
        figure = draw_series(few_panels, 85.0, 60.0, few_panels.title, "")
    entries = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert "least" in entries
    assert "largest in size" not in entries
    small = 5.5  # points, of notes of a figure that is a column wide
    assert [note.get_fontsize() for note in figure.axes[0].texts] == [small, small]


@pytest.mark.slow
def test_a_figure_is_drawn_once_to_be_saved(few_panels, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    draw = Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda self, to: (drawn.append(self), draw(self, to)))
    render_series(few_panels, width_mm=85.0, dpi=60)
    assert len(drawn) == 1


@pytest.mark.slow
def test_vector_files_repeat_to_the_byte(few_panels, monkeypatch: pytest.MonkeyPatch) -> None:
    svg = render_series(few_panels, "svg")
    placed = ConstrainedLayoutEngine.execute

    def nearly(self, figure: Figure) -> None:
        """As where the solver's variables are elsewhere in memory."""
        placed(self, figure)
        for area in figure.axes:
            left, bottom, width, height = area.get_position().bounds
            area._set_position((left + 2e-16, bottom - 1e-16, width + 1e-16, height - 2e-16))

    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", nearly)
    assert svg == render_series(few_panels, "svg")
    assert "Appendix 4" in "".join(ElementTree.fromstring(svg).itertext())


@pytest.mark.slow
def test_without_title_and_caption_the_figure_is_lower(few_panels) -> None:
    full, bare = (
        Image.open(io.BytesIO(render_series(few_panels, dpi=50, title=title, caption=below)))
        for title, below in ((None, True), ("", False))
    )
    assert bare.height < full.height


@pytest.mark.parametrize(
    ("field", "kind", "more"),
    [
        ("simulation", "tracking", {}),
        ("engine", "comparison", {}),
        ("kind", "pictures", {}),
        ("engine", "torques", {"engine": EngineTorques("x", np.zeros((3, 4)))}),
        ("width_mm", "pose", {"width_mm": 55.0}),
        ("dpi", "pose", {"dpi": 5.0}),
        ("format", "pose", {"format": "gif"}),
        ("caption", "pose", {"caption": "none"}),
    ],
    ids=["no simulation", "no second source", "kind", "size", "width", "dpi", "format", "caption"],
)
def test_an_impossible_figure_names_its_argument(field, kind, more, analysis) -> None:
    with pytest.raises(InvalidInput) as caught:
        figure_bytes(kind, analysis, **more)
    assert caught.value.argument == field


@pytest.mark.slow
def test_another_motion_is_refused(analysis, failing, everything) -> None:
    run = everything["simulation"]
    late = np.append(run.t[:-1], run.t[-1] + 0.01)
    simulations = [replace(run, t=t) for t in (run.t + 0.01, run.t - 0.01, late)]
    others = [("torques", {"reference": failing})]
    for kind, other in [*others, *(("tracking", {"simulation": each}) for each in simulations)]:
        with pytest.raises(InvalidInput, match="same trajectory"):
            _series(kind, analysis, **other)


@given(st.integers(0, 2**32 - 1), st.integers(1, 300), st.integers(2, 40), st.integers(0, 4))
@example(0, 5, 2, 1)
@example(1, 200, 20, 2)
@example(2, 40, 40, 0)
def test_a_thinned_curve_keeps_ends_extremes_and_gaps(seed, count, most, gaps_drawn) -> None:
    drawn = np.random.default_rng(seed)
    values = drawn.standard_cauchy(count)
    for start, size in drawn.integers(0, (count, 9), (gaps_drawn, 2)):
        values[start : start + size] = np.nan
    if gaps_drawn % 2:
        values[:3] = values[-3:] = np.nan
    kept = thinned([values, values[::-1]], most)
    steps = np.diff(kept)
    assert (steps > 0).all()
    assert steps.max(initial=0) <= np.ceil((values.size - 1) / (most - 1))
    pieces = sum(len(runs(each)) for each in (values, values[::-1]))
    assert kept.size <= most + 5 * pieces
    assert {0, values.size - 1} <= set(kept.tolist())
    if np.isfinite(values).any():
        assert np.nanmax(values[kept]) == np.nanmax(values)
        assert np.nanmin(values[kept]) == np.nanmin(values)
    gaps = np.flatnonzero(np.diff(np.isnan(values)))
    shown = np.isnan(values[kept])
    assert np.diff(shown).sum() == gaps.size


@given(
    st.lists(st.floats(-1e12, 1e12), min_size=1, max_size=20), st.sampled_from(["m", "N", "rad"])
)
def test_a_value_axis_shows_all_values(numbers, unit) -> None:
    values = np.array(numbers)
    trace = Trace("x", values, "#000000")
    axis, low, high = value_range(SeriesPanel("x", "x", "x", unit, "#000000", (trace,)))
    shown = values * axis.factor
    assert low < shown.min()
    assert shown.max() < high
    assert max(abs(low), abs(high)) < 1.2e5
