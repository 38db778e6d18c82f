"""A simulation in the scene: the robot moves as simulated, a ghost as it should."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh
import viser

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.motion_results import MotionStore
from paminsa_viz.explorer.core.planning import checked, planned
from paminsa_viz.explorer.core.simulated import wanted_pose
from paminsa_viz.explorer.features.motion import simulation as simulations
from paminsa_viz.explorer.features.motion.layers import WantedPose
from paminsa_viz.explorer.features.motion.plots import caption_html
from paminsa_viz.explorer.features.motion.tab import MOTION, SIMULATING, simulation_html
from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.ghost import OPACITY, translucent
from paminsa_viz.explorer.state.motion import DEFAULT_LIMITS, Kind, Motion, Timing
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.simulation import SimulationSettings
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.meshes.bodies import body_glb
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.trajectory import Simulation
from paminsa_viz.trajectory.simulation import ControlMode
from tests.support.desk import desk_with
from tests.support.raw_page import RawPage
from tests.support.samples import prototype_times
from tests.support.tasks import finished


@pytest.fixture(scope="module")
def simulated() -> State:
    """The preset motion, simulated with the settings of the start."""
    state = simulations.simulate(initial_state())
    assert state.simulation.running is not None
    return finished(simulations.SIMULATION, state)


def simulation(state: State) -> Simulation:
    found = state.simulation.result
    assert found is not None
    return found


def test_motion_plots_say_that_a_simulation_runs() -> None:
    state = initial_state().updated("plots", plot="errors")
    found = MotionStore().all(state)
    assert "press Simulate" in caption_html(state, found, ())
    assert "Simulating …" in caption_html(simulations.simulate(state), found, ())


@pytest.mark.parametrize("size", [0.05, 5.0])
def test_motions_of_robots_of_other_lengths_can_be_run(size: float) -> None:
    design = prototype_times(size)
    opened = actions.with_design(initial_state(), design)
    assert opened.document.motion == initial_state(design).document.motion
    for kind in (Kind.CIRCLE, Kind.ARCH):
        motion = replace(opened.document.motion, kind=kind, timing=Timing.SHORTEST)
        plan = planned(motion, design)
        assert plan.trajectory is not None
        assert plan.problem == ""
        assert checked(plan.trajectory, design.geometry).possible
    springs = opened.springs.settings
    assert (springs.height, springs.radius) == pytest.approx((0.1 * size, 0.05 * size), rel=0.3)
    long_bars = {"geometry.crank_length": 1.3, "geometry.coupler_length": 1.6}
    long = initial_state(APPENDIX_4.vary(long_bars)).document.motion
    assert (long.radius, long.height) == (Motion().radius, 0.3)
    chosen = motions.limit(motions.change(opened, radius=0.0123), "torque", 4.0)
    back = actions.with_design(chosen, APPENDIX_4).document.motion
    assert (back.radius, back.height, back.limits.torque) == (0.0123, Motion().height, 4.0)
    assert back.limits.force == DEFAULT_LIMITS.force


def test_unknown_payload_follows_the_lengths_until_a_person_sets_it() -> None:
    def payload(state: State) -> float:
        return state.simulation.settings.payload_mismatch

    start, small = initial_state(), prototype_times(0.1)
    assert payload(start) == payload(initial_state(prototype_times(1.5))) == 5.0
    assert payload(initial_state(small)) == payload(actions.load_design(start, small)) == 5e-4
    assert payload(actions.restore(actions.load_design(start, small), start.document)) == 5.0
    assert payload(initial_state(prototype_times(10.0))) == 1e4
    chosen = start.updated("simulation.settings", payload_mismatch=2.0)
    assert payload(actions.load_design(chosen, small)) == 2.0


@pytest.mark.slow
def test_start_has_something_to_see(simulated: State) -> None:
    assert SimulationSettings().payload_mismatch > 0
    assert simulation(simulated).distance.max() > 0.02
    assert simulation(simulated).stopped is None
    assert simulated.playback.playing
    assert simulated.playback.time == 0.0


@pytest.mark.slow
def test_crossing_that_is_not_followed_stops_the_simulation_and_is_played_so_far() -> None:
    """Without feedback a robot of another payload comes to the singular locus at another time."""
    state = motions.limit(motions.choose_kind(initial_state(), Kind.MOVE), "torque", 10.0)
    ends = {"start": (0.03, 0.02, 0.8, -0.5), "goal": (0.03, 0.02, 1.75, -0.5)}
    state = motions.change(state, timing=Timing.SHORTEST, cross=True, **ends)
    state = state.updated("simulation.settings", control=ControlMode.FEED_FORWARD)
    state = finished(simulations.SIMULATION, simulations.simulate(state))
    found, trajectory = simulation(state), motions.planned(state).trajectory
    assert trajectory is not None
    (passage,) = trajectory.passages
    assert found.stopped is not None
    assert found.t[-1] == pytest.approx(passage.t, abs=2e-3)
    assert np.abs(found.energy_drift).max() < 1e-6
    assert state.playback.playing
    text = simulation_html(compute(state))
    assert "Stopped</b><br>Simulated with " in text
    assert "<br>It stopped " in text
    assert "no authority along the escape twist" in text
    assert "spacing" not in text


@pytest.mark.slow
def test_a_simulation_that_failed_is_not_offered_to_be_played(simulated: State) -> None:
    (switch,) = (entry for entry in SIMULATING if entry.key == "simulation.shown")
    assert switch.visible is not None
    assert switch.visible(simulated)
    job = simulations.wanted_job(simulated)
    failed = simulations.receive(simulated, Outcome(job, None, InvalidInput("gains", "too high")))
    assert not switch.visible(failed)


@pytest.mark.slow
def test_robot_is_where_it_was_simulated_and_the_ghost_where_it_should_be(simulated: State) -> None:
    found = simulation(simulated)
    for index in (0, found.t.size // 2, found.t.size - 1):
        state = motions.scrub(simulated, float(found.t[index]))
        np.testing.assert_allclose(state.last_reachable.pose, found.pose[index], atol=1e-9)
        wanted = wanted_pose(state)
        assert wanted is not None
        np.testing.assert_allclose(wanted, found.wanted.pose[index], atol=1e-9)
    away = np.linalg.norm(np.subtract(state.last_reachable.pose, wanted)[[0, 1, 3]])
    assert away == pytest.approx(found.distance[-1], rel=1e-9)


def test_motion_is_shown_where_the_simulation_is_not(simulated: State) -> None:
    state = motions.scrub(simulated, 0.6)
    planned = motions.planned(state).trajectory
    assert planned is not None
    for other in (
        simulations.show_simulation(state, False),
        actions.vary(state, {"links.b4": 0.9}),
        motions.scrub(motions.choose_preset(state, "circle"), 0.6),
    ):
        trajectory = motions.planned(other).trajectory
        assert trajectory is not None
        assert wanted_pose(other) is None
        np.testing.assert_allclose(other.last_reachable.pose, trajectory.at(0.6).pose, atol=1e-12)
    assert wanted_pose(actions.move(state, x=0.0)) is None


@pytest.mark.slow
def test_ghost_is_drawn_at_the_wanted_pose(server: viser.ViserServer, simulated: State) -> None:
    page = RawPage(server)
    scene = page.client.scene
    view = WantedPose(SceneContext(scene))
    view.draw(compute(initial_state()), False)
    nodes = scene._handle_from_node_name
    assert "/wanted" not in nodes
    state = motions.scrub(simulated, 0.7)
    view.draw(compute(state), False)
    wanted = wanted_pose(state)
    assert wanted is not None
    platform = nodes[node_name("platform", "/wanted")]
    np.testing.assert_allclose(platform.position, np.array(wanted)[[0, 1, 3]], atol=1e-6)
    assert nodes["/wanted"].visible
    assert "/wanted/m1" not in nodes
    for hidden in (actions.set_layers(state, wanted_pose=False), actions.go_home(state)):
        view.draw(compute(hidden), False)
        assert not nodes["/wanted"].visible
    page.socket.close()


@pytest.mark.parametrize("fine", [False, True])
def test_translucent_body_has_the_same_shape(fine: bool) -> None:
    solid = body_glb(APPENDIX_4.geometry, "leg1/b4", fine=fine)
    clear = translucent(solid)
    shapes = [trimesh.load(io.BytesIO(glb), file_type="glb").dump() for glb in (solid, clear)]
    for before, after in zip(*shapes, strict=True):
        np.testing.assert_array_equal(before.vertices, after.vertices)
        np.testing.assert_array_equal(before.faces, after.faces)
    count = clear.count(b'"alphaMode":"BLEND"')
    assert count == clear.count(b'"baseColorFactor"') > 0
    assert clear.count(f",{OPACITY}]".encode()) == count


def test_inputs_show_the_digits_of_a_robot_of_grams(server: viser.ViserServer) -> None:
    """They showed 0.001 kg in place of 0.0005, and limits of torque as zero."""
    entries = [*SIMULATING, *MOTION]
    with desk_with(server, entries) as desk:
        handles = [desk.handle(f"motion.limits.{name}") for name in ("torque", "force")]
        handles.append(desk.handle("simulation.payload_mismatch"))
        usual = [(handle.step, handle.precision) for handle in handles]
        assert usual == [(0.5, 3), (10.0, 3), (0.1, 3)]
        desk.dispatch(lambda state: actions.with_design(state, prototype_times(0.1)))
        small = [(5e-5, 7), (0.01, 4), (1e-4, 6)]
        desk.until(lambda: [(handle.step, handle.precision) for handle in handles] == small)
        assert [handle.value for handle in handles] == [6e-4, 0.4, 5e-4]
