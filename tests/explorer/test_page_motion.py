"""Motions in a browser: played, plotted, uploaded, simulated."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.features.motion.tab import TIME
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.explorer.state.state import State
from paminsa_viz.plots.map_values import frame_half
from paminsa_viz.plots.series_uplot import MOST_POINTS
from paminsa_viz.trajectory import Trajectory, analyze, load_kernel
from paminsa_viz.units import number
from tests.support.chromium import COMPUTING, PIXEL, Tab, until

pytestmark = pytest.mark.browser

CURVES = """() => Object.values((window.__viserTestpoints || {}).uplots || {})
  .map(entry => entry.chart.data.map(series => Array.from(series)))"""

CURSORS = """() => Object.values(window.__viserTestpoints.uplots).map(({chart}) => {
  const line = chart.over.querySelector(".paminsa-time-cursor");
  if (!line || line.style.display === "none") return null;
  const x = line.getBoundingClientRect().left - chart.over.getBoundingClientRect().left;
  return chart.posToVal(x, "x");
})"""


SEEN = "name => window.__viserMutable.nodeRefFromName[name].visible"


def curves(tab: Tab) -> list[Any]:
    """Return the series of every chart, as the page has them: time, shading, ..., curves."""
    return tab.page.evaluate(CURVES)


def planned(tab: Tab) -> Trajectory:
    """Return the trajectory of the tab's state."""
    found = motions.planned(tab.state).trajectory
    assert found is not None
    return found


@pytest.fixture
def motion(tab: Tab) -> Tab:
    """The tab with the motion's controls and curves open, and a circle chosen."""
    tab.open_tab("Path")
    tab.open_tab("Motion plots")
    tab.dispatch(lambda s: motions.choose_preset(s, "circle"))
    until(lambda: len(curves(tab)) == 2, "two charts")
    until(lambda: "circle" in tab.page.inner_text("body"), "the caption")
    return tab


AXES = """values => Object.values(window.__viserTestpoints.uplots).map(
  ({chart}) => chart.axes.map(axis => axis.values(chart, values)))"""


def test_axes_of_charts_have_the_numbers_of_the_page(motion: Tab) -> None:
    """Whatever the browser's language; uPlot's own are 13,200 and -3."""
    values = (0.1 + 0.2, -3.0, 0.0, -13200.0, 250000.0, 1e6, -2.5e-7, -500.5)
    words = [number(value) for value in values]
    assert words[:4] == ["0.3", "−3", "0", "−13200"]
    until(lambda: motion.page.evaluate(AXES, values) == [[words, words]] * 2, "the numbers", 10)
    written = motion.page.evaluate(
        """() => Object.values(window.__viserTestpoints.uplots).map(
          ({chart}) => chart.axes.map(axis => axis._values))"""
    )
    texts = [text for chart in written for axis in chart for text in axis if text]
    assert any(text.startswith("−") for text in texts)
    assert not any("-" in text or "," in text for text in texts)


def test_robot_cursors_and_numbers_are_at_the_chosen_instant(motion: Tab) -> None:
    motion.dispatch(lambda s: motions.choose_preset(s, "paper-like"))
    until(lambda: planned(motion).duration < 1.3, "another motion")
    for time in (0.1, 0.617, 1.2):
        motion.type_number(TIME, time)
        wanted = planned(motion).at(time).pose
        motion.wait_platform(wanted)

        def at_the_instant(t: float = time) -> bool:
            found = motion.page.evaluate(CURSORS)
            return all(x is not None and abs(x - t) < 0.01 for x in found)

        until(at_the_instant, f"the cursors at {time}")
        until(lambda t=time: f"At {t:.3f} s" in motion.text("motion-numbers"), f"numbers at {time}")
        np.testing.assert_allclose(motion.state.last_reachable.pose, wanted, atol=1e-12)
    motion.click_in(motion.page.locator(".u-over").first)
    half = planned(motion).duration / 2
    until(lambda: abs(motion.state.playback.time - half) < 0.02, "the middle of the motion")
    motion.wait_platform(planned(motion).at(motion.state.playback.time).pose)


def test_pointer_in_a_plot_or_a_map_is_marked_in_the_scene_and_the_other_maps(motion: Tab) -> None:
    box = motion.steady_box(motion.page.locator(".u-over").first)
    place = planned(motion).at(planned(motion).duration / 2).pose
    motion.page.mouse.move(box["x"] + box["width"] / 2 - 2, box["y"] + box["height"] / 2)
    motion.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    until(
        lambda: np.allclose(motion.place("/cursor")[:2], place[:2], atol=3e-3),
        "the mark is where the robot is in the middle of the motion",
    )
    motion.open_tab("Torque maps")
    maps = motion.steady_box(motion.page.locator(".pv-map-markers").first)
    motion.page.mouse.move(maps["x"] + 0.3 * maps["width"], maps["y"] + 0.25 * maps["height"])
    marks = motion.page.locator(".pv-cursor")
    until(lambda: marks.count() == 2, "the two other maps are marked")
    motion.page.mouse.move(1270, 710)
    until(lambda: marks.count() == 0, "no mark is left")
    until(lambda: not motion.page.evaluate(SEEN, "/cursor"), "the mark in the scene is gone")


def test_piece_of_time_that_is_dragged_in_a_plot_is_marked_on_path_and_maps(motion: Tab) -> None:
    box = motion.steady_box(motion.page.locator(".u-over").first)
    start, middle = box["x"] + 0.25 * box["width"], box["y"] + box["height"] / 2
    motion.page.mouse.move(start, middle)
    motion.page.mouse.down()
    motion.page.mouse.move(start + 0.25 * box["width"], middle, steps=4)
    motion.page.mouse.up()
    until(lambda: motion.state.playback.piece is not None, "the piece is told")
    whole = planned(motion).duration
    np.testing.assert_allclose(motion.state.playback.piece, (whole / 4, whole / 2), atol=0.02)
    motion.open_tab("Torque maps")
    until(lambda: motion.page.locator(".pv-piece").count() >= 1, "it is drawn in the maps")
    motion.open_tab("Motion plots")
    box = motion.steady_box(motion.page.locator(".u-over").first)
    motion.page.mouse.dblclick(box["x"] + box["width"] / 2, middle)
    until(lambda: motion.state.playback.piece is None, "all of the time is shown")
    until(lambda: motion.page.locator(".pv-piece").count() == 0, "no piece is left in the maps")


UNDER_BAR = """() => {
  const shown = (selector) => [...document.querySelectorAll(selector)]
    .map((one) => one.getBoundingClientRect()).filter((box) => box.width);
  const bars = shown('.mantine-ScrollArea-scrollbar[data-orientation="vertical"]');
  const units = shown('[data-testid="motion-numbers"] td:last-child');
  const left = Math.min(...bars.map((box) => box.left));  // the dock is the leftmost
  return [bars.length, units.length, units.filter((box) => box.right > left).length];
}"""


def test_numbers_keep_clear_of_the_scrollbar(motion: Tab) -> None:
    motion.dispatch(actions.pin_reference)  # with its curves the numbers are more than fit
    motion.dispatch(lambda s: actions.vary(s, {"payload.mass": 3.0}))

    def units_under_bar() -> int:
        box = motion.steady_box(motion.page.locator(".u-over").first)
        motion.page.mouse.move(box["x"] + 40, box["y"] + 40)
        motion.page.mouse.move(box["x"] + 50, box["y"] + 50)  # or the bar is not to be seen

        def counted() -> Any:
            bars, units, under = motion.page.evaluate(UNDER_BAR)
            return [under] if bars and units else None

        return until(counted, "the dock scrolls", 15)[0]

    assert units_under_bar() == 0
    motion.dispatch(lambda s: s.updated("plots", plot="energy"))  # whose curves have long names
    until(lambda: "energy gained" in motion.text("motion-numbers"), "numbers of the energy")
    assert units_under_bar() == 0


def test_motion_is_played_to_its_end_and_a_pose_slider_stops_it(motion: Tab) -> None:
    motion.dispatch(lambda s: motions.change(s, timing=Timing.GIVEN, duration=4.0, kind=Kind.MOVE))
    until(lambda: planned(motion).duration == 4.0, "a motion of 4 s")
    chosen = motion.state.document.motion
    play = motion.page.get_by_role("button", name="Play", exact=True)
    play.click()
    until(lambda: 0 < motion.state.playback.time < 4.0, "it is on its way")
    motion.page.get_by_role("button", name="Pause", exact=True).wait_for()
    until(lambda: not motion.state.playback.playing, "it ends")
    np.testing.assert_allclose(
        motion.state.last_reachable.pose, planned(motion).pose[-1], atol=1e-12
    )
    motion.wait_platform()
    play.wait_for()
    # Playing is no step to undo: the last one is the choice of the motion.
    motion.session.undo()
    until(lambda: motion.state.document.motion != chosen, "the choice is undone")
    motion.dispatch(lambda s: motions.play(s.updated("playback", loop=True)))
    until(lambda: motion.state.playback.time > 0.1, "it plays")
    motion.open_tab("Pose")
    motion.type_number("z  [mm]", -480)
    motion.wait_pose(3, -0.48)
    assert not motion.state.playback.playing
    assert not motion.state.playback.following


def test_mass_slider_moves_the_curves_to_the_models_torques(motion: Tab) -> None:
    before = np.abs(curves(motion)[0][3:6]).max()
    motion.open_tab("Masses")
    motion.open_tab("Motion plots")  # another workspace has opened another tab beside it
    motion.press("m_B4 bar 9–4–5 [kg]", "End")
    until(lambda: motion.state.document.design.links.b4 > 0.8, "the mass grows")
    motion.wait_frames(300)
    design = motion.state.document.design

    def as_the_model() -> bool:
        series = np.array(curves(motion)[0])
        rows = np.searchsorted(planned(motion).t, series[0])
        wanted = analyze(design, planned(motion)).torque[rows, :3].T
        return bool(np.abs(series[3:6] - wanted).max() < 1e-9)

    until(as_the_model, "the page draws the model's torques")
    assert np.abs(curves(motion)[0][3:6]).max() > 1.2 * before
    assert len(curves(motion)[0][0]) < 1.1 * MOST_POINTS


def test_reference_and_misprints_are_plotted_for_comparison(motion: Tab) -> None:
    motion.dispatch(lambda s: actions.vary(actions.pin_reference(s), {"links.b4": 2.0}))
    motion.element("As published").click()
    until(lambda: motion.state.plots.published, "the switch is read")
    until(lambda: len(curves(motion)[0]) == 3 + 9, "nine curves")
    until(lambda: "as published" in motion.text("motion-numbers"), "numbers of all")


def test_engines_torques_are_marked_and_the_difference_passes(motion: Tab, mujoco: Any) -> None:
    motion.element("MuJoCo").click()
    motion.page.get_by_text("PASS").wait_for()
    answer = motion.state.engine_answer
    until(lambda: len(curves(motion)[0]) == 3 + 6, "the marks are drawn")
    series = curves(motion)[0]
    for curve, marks in zip(series[3:6], series[6:9], strict=True):
        apart = [a - b for a, b in zip(curve, marks, strict=True) if b == b and b is not None]
        assert len(apart) >= 25
        assert max(map(abs, apart)) < 1e-9
    # Another design has no marks until the engine has computed it.
    motion.dispatch(lambda s: actions.vary(s, {"links.b4": 2.0}))
    until(lambda: motion.state.engine_answer is not answer, "the engine computes again", COMPUTING)
    motion.dispatch(lambda s: s.updated("plots", plot="differences", published=True))
    until(lambda: motion.text("motion-numbers").count("PASS") == 4, "four verdicts")
    assert motion.text("motion-numbers").count("FAIL") == 4
    motion.page.get_by_text("the misprints").wait_for()


def test_impossible_motion_is_explained_and_its_failing_part_drawn(motion: Tab) -> None:
    motion.dispatch(
        lambda s: motions.change(
            motions.choose_kind(s, Kind.LINE), start=(0, 0, 0, -0.55), goal=(0.6, 0, 0, -0.55)
        )
    )
    until(lambda: "Not possible" in motion.text("motion-status"), "the status")
    first = analyze(motion.state.document.design, planned(motion)).check.first
    assert first is not None
    until(lambda: first.explanation in motion.text("motion-status"), "when and why")
    until(lambda: any(np.array(curves(motion)[0][2]) == 1.0), "failures are shaded")
    until(lambda: motion.place("/path/failing"), "the path that fails is drawn")
    reachable = motion.state.last_reachable
    motion.press(TIME, "End")
    until(lambda: motion.state.playback.time == planned(motion).duration, "the time goes on")
    assert motion.state.last_reachable == reachable


def test_csv_file_is_run_or_refused_by_row(motion: Tab) -> None:
    motion.dispatch(lambda s: motions.choose_kind(s, Kind.TABLE))
    until(lambda: "No motion yet" in motion.text("motion-status"), "a file is missing")
    rows = [
        f"{t:.3f},{50 * np.sin(t):.6f},{10 * t:.6f},{5 * t:.6f},-500" for t in np.linspace(0, 1, 51)
    ]
    swing = "\n".join(["t_s,x_mm,y_mm,theta_deg,z_mm", *rows]).encode()
    motion.upload("Open a CSV file…", "swing.csv", swing)
    until(lambda: motion.state.document.motion.table is not None, "the file is read")
    until(lambda: "Reachable" in motion.text("motion-status"), "it can be run")
    assert planned(motion).name == "swing"
    np.testing.assert_allclose(planned(motion).pose[-1, 0], 0.05 * np.sin(1.0), atol=1e-8)
    kept = motion.state.document.motion.table
    bad = b"t_s,x_m,y_m,theta_rad,z_m\n0,0,0,0,-0.5\n1,zero,0,0,-0.5\n"
    motion.upload("Open a CSV file…", "bad.csv", bad)
    motion.page.get_by_text("row 3, column x_m").wait_for()
    assert motion.state.document.motion.table is kept


def test_simulation_shows_its_error(motion: Tab) -> None:
    load_kernel()  # on a loaded machine the first compilation takes longer than a page is given
    motion.open_tab("Simulate")
    motion.page.get_by_role("button", name="Simulate", exact=True).click()
    until(lambda: motion.state.simulation.outcome is not None, "it has run", COMPUTING)
    motion.page.get_by_test_id("simulation").get_by_text("Ran to the end").wait_for()
    assert motion.state.plots.plot == "errors"
    errors = motion.page.get_by_text("Error of x, y, z").locator("visible=true")
    until(lambda: errors.count() == 1, "its error is plotted in the answer")
    motion.click("Torques")
    plots = motion.page.get_by_role("tab", name="Motion plots", exact=True)
    until(lambda: plots.get_attribute("aria-selected") == "true", "the plots are open")
    assert motion.state.plots.plot == "commands"


def test_motion_passes_a_singularity_when_the_box_is_checked(tab: Tab) -> None:
    tab.open_tab("Path")
    ends = {"start": (0.03, 0.02, 0.8, -0.5), "goal": (0.03, 0.02, 1.75, -0.5)}
    tab.dispatch(lambda s: motions.change(motions.choose_kind(s, Kind.MOVE), **ends))
    until(lambda: "Not possible" in tab.text("motion-status"), "the refusal")
    tab.dispatch(lambda s: motions.limit(motions.change(s, timing=Timing.SHORTEST), "torque", 10.0))
    tab.element("Pass singularities").check()
    until(lambda: "Reachable" in tab.text("motion-status"), "a possible motion")
    until(lambda: "Passes 1 singularity" in tab.text("motion-crossing"), "the crossing")
    assert "Quintic law" in tab.text("motion-passages")
    tab.page.get_by_test_id("crossing-chart").locator("svg").wait_for()
    tab.dispatch(lambda s: motions.limit(s, "torque", 0.5))
    tab.page.get_by_role("button", name="Change the limits").click()
    box = tab.page.get_by_label("M1–M3 [N·m]").locator("visible=true")
    until(lambda: box.evaluate("box => box === document.activeElement"), "the box has the focus")
    tab.page.keyboard.press("Control+a")
    tab.page.keyboard.type("10")
    tab.page.keyboard.press("Enter")
    until(lambda: "Reachable" in tab.text("motion-status"), "a possible motion again")
    tab.dispatch(lambda s: motions.scrub(s, 0.37))
    tab.open_tab("Pose")
    until(lambda: "lies between this pose and home" in tab.text("status"), "the status")


def test_rows_of_the_reference_are_seen_and_time_ends_with_the_motion(motion: Tab) -> None:
    def pinned(state: State) -> State:
        heavier = actions.vary(actions.pin_reference(state), {"joints.j7": 1.0})
        return motions.choose_preset(heavier, "paper-like")

    motion.dispatch(pinned)
    rows = motion.page.get_by_test_id("motion-numbers").locator("tr")
    until(lambda: rows.count() == 9, "a head, and four rows for each design")
    motion.wait_frames(300)
    box = rows.last.bounding_box()
    assert "M4 reference" in rows.last.inner_text()
    assert box["y"] + box["height"] <= motion.page.viewport_size["height"]
    end = planned(motion).duration
    until(lambda: motion.handle(TIME).max == round(end, 3), "the end of the slider")
    motion.press(TIME, "End")
    until(lambda: motion.state.playback.time == end, "the end of the motion")


def test_motion_is_drawn_on_a_map_and_its_points_are_typed(tab: Tab) -> None:
    tab.open_tab("Path")
    tab.open_tab("Torque maps")
    tab.dispatch(lambda s: actions.move(s, theta=np.pi / 3))
    tab.page.locator("[data-paminsa-picture][src]").first.wait_for()
    frame = 1e3 * frame_half(tab.state.document.design.geometry, *tab.state.document.pose[2:])
    marks = tab.page.locator("[data-paminsa-frame]").first
    end = "marks => JSON.parse(marks.dataset.paminsaFrame).edges[1]"
    until(lambda: abs(marks.evaluate(end) - frame) < 1, "clicks are read in the frame of θ = 60°")
    tab.page.get_by_role("button", name="draw a motion").first.click()
    tab.page.get_by_text("click: add waypoint 1").first.wait_for()
    places = ((-0.05, 0.1), (0.1, 0.1), (0.1, -0.08))
    for count, place in enumerate(places, 1):
        tab.click_map(*place)
        until(lambda n=count: len(tab.state.document.motion.waypoints) == n, f"{count} waypoints")
    drawn = np.array(tab.state.document.motion.waypoints)
    np.testing.assert_allclose(drawn[:, :2], places, atol=PIXEL)
    np.testing.assert_array_equal(drawn[:, 2:], [tab.state.document.pose[2:]] * 3)
    assert planned(tab).duration > 0
    tab.page.get_by_role("button", name="stop drawing").first.click()
    tab.page.get_by_text("click: go there").first.wait_for()
    tab.click_map(0.03, 0.02)
    until(lambda: tab.state.document.pose[0] != 0.0, "the robot goes there")
    assert len(tab.state.document.motion.waypoints) == 3
    tab.page.get_by_role("button", name="Edit 2").press("Enter")
    until(lambda: tab.state.point_editing.selected == 1, "another point is marked")
    field = tab.element("x [mm]")
    field.fill("-33.5")
    field.press("Enter")
    until(lambda: tab.state.document.motion.waypoints[1][0] == -0.0335, "the typed number")
    until(lambda: tab.place("/point_handle"), "the handle is in the scene")
    until(lambda: abs(tab.place("/point_handle")[0] + 0.0335) < 1e-9, "it is at the point")


def test_sample_of_a_drive_under_the_pointer_is_marked_where_the_robot_is_then(motion: Tab) -> None:
    motion.open_tab("Drives")
    motion.page.get_by_role("button", name="Find drives").click()
    samples = motion.page.locator(".js-plotly-plot .scatterlayer .point")
    until(lambda: samples.count() > 100, "the chart of the drive")
    samples.nth(100).scroll_into_view_if_needed()
    box = motion.steady_box(samples.nth(100))
    for off in (1.0, 2.0):
        motion.page.mouse.move(box["x"] + off, box["y"] + off)
        motion.wait_frames(100)
    path = planned(motion).pose[:, :2]

    def on_path() -> bool:
        place = np.array(motion.place("/cursor")[:2])
        return bool(np.linalg.norm(path - place, axis=1).min() < 3e-3)

    until(on_path, "the mark is on the path")
    assert motion.page.evaluate(SEEN, "/cursor")
