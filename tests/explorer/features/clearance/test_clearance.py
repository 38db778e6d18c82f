"""Clearance on the page: status, scene, motion, switchable pairs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import viser

from paminsa_viz.clearance import ALL_PAIRS, PairGroup, clearance, nearest_points
from paminsa_viz.explorer.core import actions, tab_store
from paminsa_viz.explorer.core import clearance as known_clearance
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.clearance import motion_job, pose_job
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.features.clearance.actions import find_along, find_nearest, set_pairs
from paminsa_viz.explorer.features.clearance.layers import nearest_bodies
from paminsa_viz.explorer.features.clearance.tab import CLEARANCE, clearance_html
from paminsa_viz.explorer.features.motion.plots import drawn_charts
from paminsa_viz.explorer.features.motion.tab import status_html as motion_status
from paminsa_viz.explorer.features.pose.tab import status_html
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.nodes import LayerView
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.files.example_designs import ExampleDesign, example_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.palette import DARK, LIGHT
from paminsa_viz.plots.series_builders import motion_clearance
from tests.support.desk import Desk
from tests.support.raw_page import RawPage
from tests.support.samples import enlarged, prototype_times

PANEL = CLEARANCE


def known(state: State) -> State:
    """Return the state once the clearance of its pose is there."""
    return state.updated("clearance", pose=solve(find_nearest, pose_job(state)))


@pytest.fixture
def state() -> State:
    return actions.move(initial_state(), x=0.08, y=0.05, theta=np.pi / 3)


def test_status_names_two_bodies_and_by_how_much(state: State) -> None:
    found = nearest_points(state.document.design, state.last_reachable.pose)
    assert found is not None
    assert found.distance > state.clearance.settings.required
    assert "apart" not in status_html(compute(known(state)))
    strict = known(state.updated("clearance.settings", required=found.distance + 0.002))
    text = status_html(compute(strict))
    assert "pv-warn" in text
    assert all(name in text for name in found.names)
    assert f"{1e3 * found.distance:.1f}" in text
    heavier = actions.vary(strict, {"geometry.platform_radius": 0.12})
    assert "apart" not in status_html(compute(heavier))  # of another robot


def test_overlap_is_said_in_red(state: State) -> None:
    design = state.document.design.vary({"geometry.platform_radius": 0.02})
    overlapping = known(actions.load_design(state, design))
    distance, why = known_clearance.reason(overlapping)
    assert distance < 0
    assert "overlap by" in why
    assert "pv-bad" in status_html(compute(overlapping))
    assert "overlap" in clearance_html(compute(overlapping))


def test_of_a_small_robot_is_said_how_large_its_bodies_should_be() -> None:
    for design, said in (
        (prototype_times(0.1), "set s_b, the size of the bodies among the lengths, to about 0.1"),
        (prototype_times(1.5), ""),
        (enlarged(APPENDIX_4, 0.1), ""),
    ):
        small = known(initial_state(design)).updated("clearance.settings", required=0.1)
        for text in (known_clearance.reason(small)[1], clearance_html(compute(small))):
            assert said in text
            assert ("s_b" in text) == bool(said)


def test_least_distance_follows_the_size_of_the_bodies_unless_it_was_chosen(state: State) -> None:
    def required(state: State, size: float) -> float:
        return actions.vary(state, {"geometry.body_scale": size}).clearance.settings.required

    assert required(state, 0.1) == 0.0005
    assert required(state, 1.5) == 0.005
    chosen = state.updated("clearance.settings", required=0.003)
    assert required(chosen, 0.1) == 0.003


def test_pairs_can_be_left_out(state: State) -> None:
    all_pairs = known_clearance.nearest(known(state))
    assert all_pairs is not None
    assert "the platform" in all_pairs.names
    without = known(set_pairs(state, PairGroup.PLATFORM, False))
    other = known_clearance.nearest(without)
    assert other is not None
    assert other.distance > all_pairs.distance
    assert "the platform" not in other.names
    assert known_clearance.nearest(set_pairs(without, PairGroup.PLATFORM, True)) is None
    kept = tab_store.restore(initial_state(), tab_store.dump(without))
    assert kept.clearance.settings.pairs == ALL_PAIRS - {PairGroup.PLATFORM}


def test_motion_warns_with_the_time_and_has_a_curve(state: State) -> None:
    store = MotionStore()
    state = motions.choose_preset(state, "circle").updated("plots", plot="clearance")
    analysis = store.analysis(state)
    assert analysis is not None
    waiting = store.all(state)
    assert waiting is not None
    assert not any(np.isfinite(t.values).any() for c in drawn_charts(state, waiting)
                   for t in c.traces)  # fmt: skip
    outcome = solve(find_along, motion_job(state, analysis))
    found = outcome.result
    assert found is not None
    every = clearance(analysis.design, analysis.trajectory.pose[::10]).least
    assert found.distance <= np.nanmin(every) + 1e-4
    state = state.updated("clearance", motion=outcome)
    assert "bodies" not in motion_status(compute(state))
    state = state.updated("clearance.settings", required=found.distance + 1e-3)
    text = motion_status(compute(state))
    assert "pv-warn" in text
    assert "bodies are close" in text
    assert found.names[0] in text
    hit = replace(outcome, result=replace(found, distance=-1e-3))
    text = motion_status(compute(state.updated("clearance", motion=hit)))
    assert "pv-bad" in text
    assert "bodies overlap" in text
    drawn = store.all(state)
    assert drawn is not None
    (least,) = drawn_charts(state, drawn)[0].traces
    assert np.nanmin(least.values) == pytest.approx(1e3 * found.distance, rel=1e-6)
    other = motions.choose_preset(state, "line")
    assert "bodies" not in motion_status(compute(other))


def test_line_joins_the_nearest_points(server: viser.ViserServer, state: State) -> None:
    page = RawPage(server)
    scene = page.client.scene
    view = LayerView(LAYERS["clearance"], nearest_bodies, SceneContext(scene))
    view.draw(compute(known(state)), False)
    nodes = scene._handle_from_node_name
    assert "/clearance/label" not in nodes
    shown = known(actions.set_layers(state, clearance=True))
    view.draw(compute(shown), False)
    found = known_clearance.nearest(shown)
    assert found is not None
    points = nodes["/clearance/line"].points
    np.testing.assert_allclose(points[0], found.points, atol=1e-6)
    for appearance, ground in ((Appearance.DARK, DARK), (Appearance.LIGHT, LIGHT)):
        view.draw(compute(replace(shown, appearance=appearance)), False)
        colors = np.asarray(nodes["/clearance/line"].colors).reshape(-1, 3)
        np.testing.assert_array_equal(colors[0], linear_colors(ground.ink)[0])
    assert "the platform" in nodes["/clearance/label"].text
    assert "11.5 mm" in nodes["/clearance/label"].text
    view.draw(compute(actions.move(shown, x=0.0)), False)
    assert "/clearance/label" not in nodes
    page.socket.close()


def test_switches_and_limit_set_the_state(desk: Desk) -> None:
    desk.set("clearance.frame", False)
    desk.until(lambda: PairGroup.FRAME not in desk.state.clearance.settings.pairs)
    desk.set("clearance.required", 12.5)
    desk.until(lambda: desk.state.clearance.settings.required == 0.0125)


@pytest.mark.slow
def test_example_robots_do_not_touch_on_their_motions() -> None:
    state = initial_state()
    for kind in (ExampleDesign.APPENDIX_4, ExampleDesign.PAYLOAD):
        document = replace(state.document, design=example_design(kind))
        analysis = MotionStore().analysis(replace(state, document=document))
        assert analysis is not None
        assert motion_clearance(analysis).distance > 0.005
