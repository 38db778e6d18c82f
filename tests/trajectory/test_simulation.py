"""Forward simulation: the equations of motion, controllers, energy, and why it stops."""

from __future__ import annotations

import inspect
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    InvalidInput,
    KneeBranch,
    Limit,
    actuator_velocity,
    backend,
    check_reach,
    forward_dynamics,
    friction_torque,
    inverse_dynamics,
    inverse_kinematics,
    jacobian,
    mass_matrix,
    singular_radius,
    static_torques,
)
from paminsa_viz.model.singularity import singular_rotation
from paminsa_viz.progress import Canceled
from paminsa_viz.trajectory import (
    PRESET,
    SINGULAR_CLEARANCE,
    Controller,
    ControlMode,
    ImpossibleTrajectory,
    Simulation,
    SimulationFailed,
    Trajectory,
    actuator_inertia,
    equations,
    point_to_point,
    simulate,
    simulation,
)
from paminsa_viz.trajectory import plant as formulas
from paminsa_viz.trajectory.check import PassageWindow
from paminsa_viz.trajectory.equations import robot_numbers
from paminsa_viz.trajectory.sampled import Locus, Passage
from tests.support.cases import Case, assert_close, cases
from tests.support.samples import enlarged, with_knee
from tests.trajectory.plans import FRICTION, A, B, preset_plan
from tests.trajectory.test_plant import MODEL, ROBOT

pytestmark = pytest.mark.slow


NO_EXTRA = np.zeros(6)
EXTRA = np.array([11.0, -7.0, 23.0, 0.6, -0.4, 0.9])
WRENCH = [f"load.{kind}_{axis}" for kind in ("force", "moment") for axis in "xyz"]
LOAD = {
    "load.force_x": 30.0, "load.force_z": -50.0, "load.moment_z": 2.0, "load.point_x": -0.03,
    "load.point_y": 0.05, "load.point_z": 0.02,
}  # fmt: skip

HOME = np.array([0.0, 0.0, 0.0, -0.5])
ASIDE = np.array([0.05, 0.02, 0.2, -0.5])
LOADED = APPENDIX_4.vary({"payload.mass": 1.0})
SHORT = point_to_point(A, B, 0.6).sample(200)


def near(pose):
    """A pose a nanometer away: a motion needs two."""
    return pose + np.array([0, 0, 0, 1e-9])


STAY = point_to_point(HOME, near(HOME), 1.0).sample(50)
controls = pytest.mark.parametrize("control", ControlMode)


def run(design=APPENDIX_4, trajectory=SHORT, control=ControlMode.PD, **options) -> Simulation:
    return simulate(design, trajectory, controller=Controller(control), **options)


@given(cases())
def test_plant_formulas_are_the_models(case: Case) -> None:
    design = case.design.vary(FRICTION | LOAD)
    robot = robot_numbers(design)
    for pose, velocity, acceleration in zip(*case.states(3), strict=True):
        inverse = formulas.inverse_torques(robot, pose, velocity, acceleration, NO_EXTRA)
        exact = inverse_dynamics(design, pose, velocity, acceleration).torque
        assert_close(inverse, exact, 1e-10)
        loss = friction_torque(design.friction, actuator_velocity(design, pose, velocity))
        forward = formulas.acceleration_under(
            robot, pose, velocity, exact - loss, formulas.push(robot[2], pose[2], NO_EXTRA)
        )[:4]
        assert_close(forward, acceleration, 1e-8)
        assert_close(forward_dynamics(design, pose, velocity, exact), forward, 1e-8)
        # an extra wrench acts at the load's point, as if it were part of the load
        added = {path: design.value(path) + more for path, more in zip(WRENCH, EXTRA, strict=True)}
        pushed = formulas.inverse_torques(robot, pose, velocity, acceleration, EXTRA)
        exact = inverse_dynamics(design.vary(added), pose, velocity, acceleration).torque
        assert_close(pushed, exact, 1e-10)


@controls
@pytest.mark.parametrize("knee", KneeBranch)
def test_with_an_exact_model_the_robot_tracks(control: ControlMode, knee: KneeBranch) -> None:
    """With friction; without any, see `test_computed_torque_error_follows_its_bandwidth`."""
    samples = preset_plan(PRESET["paper-like"], knee).sample(200)
    design = with_knee(APPENDIX_4.vary(FRICTION), knee)
    found = simulate(design, samples, controller=Controller(control))
    assert found.stopped is None
    assert found.t.size == samples.size
    assert found.distance.max() < 1e-6  # a micrometer; without feedback errors grow by e^7
    assert np.abs(found.energy_drift).max() < 1e-6
    exact = inverse_dynamics(design, samples.pose, samples.velocity, samples.acceleration).torque
    size = np.abs(exact).max(axis=0)
    assert (np.abs(found.torque - exact) <= 1e-3 * size).all()


@controls
def test_compiled_and_python_equations_are_the_same(control: ControlMode) -> None:
    samples = point_to_point(A, A + 0.1 * (B - A), 0.05).sample(300)
    options = {"control": control, "offset": (1e-3, -2e-3, 5e-3, 1e-3), "model": MODEL}
    backend.compile_now()
    compiled = run(ROBOT, samples, tolerance=1e-6, **options)
    with backend.use_numpy():
        plain = run(ROBOT, samples, tolerance=1e-6, **options)
    np.testing.assert_allclose(compiled.pose, plain.pose, atol=1e-10)
    np.testing.assert_allclose(compiled.torque, plain.torque, atol=1e-6)


def test_compiled_equations_are_loaded_from_disk_by_another_process() -> None:
    """Numba's cache key holds closure variables: numbers and texts are alike in every process."""
    backend.compile_now()
    kernel = equations._compiled()
    held = inspect.getclosurevars(kernel.py_func).nonlocals.values()  # type: ignore[attr-defined]
    assert all(isinstance(part, int | str) for key in held for part in key)


@controls
def test_energy_balances_also_with_mismatch_and_friction(control: ControlMode) -> None:
    rough = LOADED.vary(FRICTION)
    found = run(rough, control=control, model=APPENDIX_4, offset=(2e-3, 0, 0.01, 0))
    turnover = np.abs(np.diff(found.energy)).sum()
    assert np.abs(found.energy_drift).max() <= 1e-6 * turnover
    assert found.loss[-1] > 0.01
    assert (np.diff(found.loss) >= -1e-9).all()


def test_payload_mismatch_settles_where_the_gains_predict() -> None:
    """At rest the PD torques make up for the unknown weight: error = weight's torque / gain."""
    samples = point_to_point(ASIDE, near(ASIDE), 2.0).sample(50)
    controller = Controller(proportional=(200, 200, 200, 2e4), derivative=(20, 20, 20, 800))
    found = simulate(LOADED, samples, model=APPENDIX_4, controller=controller)
    end = found.pose[-1]
    apart = (found.pose - samples.pose)[:, [0, 1, 3]]
    np.testing.assert_allclose(found.distance, np.sqrt((apart**2).sum(axis=1)))
    believed, true = (static_torques(d, samples.pose[-1]) for d in (APPENDIX_4, LOADED))
    needed = static_torques(LOADED, end) - believed
    actual, wanted = (
        inverse_kinematics(APPENDIX_4.geometry, pose).actuators for pose in (end, samples.pose[-1])
    )
    np.testing.assert_allclose(
        (wanted - actual) * controller.proportional, needed, atol=1e-3 * np.abs(true).max()
    )
    assert wanted[3] - actual[3] == pytest.approx(3 * 9.81 * 1.0 / 2e4, rel=0.02)


def test_computed_torque_error_follows_its_bandwidth() -> None:
    """With an exact model every coordinate is a damped oscillator of the chosen bandwidth."""
    offset = np.array([2e-3, -1e-3, 4e-3, 3e-3])
    controller = Controller(ControlMode.COMPUTED_TORQUE, bandwidth=2.0, damping=1.0)
    found = simulate(APPENDIX_4, SHORT, controller=controller, offset=offset)
    rate = 2 * np.pi * 2.0
    decay = (1 + rate * found.t) * np.exp(-rate * found.t)
    np.testing.assert_allclose(found.error, decay[:, None] * offset, atol=1e-7)


def test_pd_gains_follow_the_inertia() -> None:
    k = Controller(bandwidth=3.0, damping=0.7).gains(APPENDIX_4, A)
    j, m = jacobian(APPENDIX_4.geometry, A), mass_matrix(APPENDIX_4, A)
    inertia = np.diag(j.T @ m @ j)
    np.testing.assert_allclose(actuator_inertia(APPENDIX_4, A), inertia)
    np.testing.assert_allclose(k.proportional, (6 * np.pi) ** 2 * inertia)
    np.testing.assert_allclose(k.derivative, 2 * 0.7 * 6 * np.pi * inertia)


def test_open_loop_error_grows_as_linearized() -> None:
    """Held by constant torques the robot is unstable in theta; feedback makes it stable."""
    holding = static_torques(APPENDIX_4, HOME)
    h, turn = 1e-5, np.array([0, 0, 1.0, 0])
    low, high = (
        forward_dynamics(APPENDIX_4, HOME + s * h * turn, [0] * 4, holding) for s in (-1, 1)
    )
    rate = np.sqrt((high - low)[2] / (2 * h))
    assert rate == pytest.approx(5.7, abs=0.1)
    offset = (0, 0, 1e-6, 0)
    found = run(trajectory=STAY, control=ControlMode.FEED_FORWARD, offset=offset)
    np.testing.assert_allclose(found.error[:, 2], 1e-6 * np.cosh(rate * found.t), rtol=1e-3)
    held = run(trajectory=STAY, control=ControlMode.PD, offset=offset)
    assert abs(held.error[-1, 2]) < 1e-8


def test_simulation_stops_at_the_workspace_limit_with_its_reason() -> None:
    heavy = APPENDIX_4.vary({"payload.mass": 3.0})
    found = run(heavy, control=ControlMode.FEED_FORWARD, model=APPENDIX_4, trajectory=STAY)
    assert found.stopped is not None
    assert found.t[-1] == found.stopped.t < 1.0
    assert found.t.size < STAY.size + 1
    margins = check_reach(heavy.geometry, found.pose).margins
    assert (margins > 0).all()
    assert found.stopped.limit in (Limit.STRETCHED, Limit.SINGULAR)
    for rows in (found.pose, found.torque, found.error, found.energy_drift):
        assert len(rows) == found.t.size
        assert np.isfinite(rows).all()


def test_simulation_of_a_small_robot_stops_as_near_to_the_limit_in_proportion() -> None:
    poses = []
    for factor in (1.0, 0.01):
        design, slow = enlarged(APPENDIX_4, factor), np.sqrt(factor)  # lengths over g
        home = HOME * [factor, factor, 1.0, factor]
        stay = point_to_point(home, near(home), 2.0 * slow).sample(50 / slow)
        heavy = design.vary({"payload.mass": 3.0 * factor**3})
        found = run(heavy, control=ControlMode.FEED_FORWARD, model=design, trajectory=stay)
        assert found.stopped is not None
        assert found.stopped.limit is Limit.STRETCHED
        margin = check_reach(design.geometry, found.pose[-1]).margins.min()
        assert margin == pytest.approx(1e-4 * factor, rel=1e-3)
        poses.append(found.pose[-1] / [factor, factor, 1.0, factor])
    assert poses[1] == pytest.approx(poses[0], abs=1e-4)


def test_simulation_stops_at_the_end_of_a_guide() -> None:
    short = APPENDIX_4.vary({"geometry.guide_stroke": 0.14})
    stay = point_to_point(HOME, near(HOME), 2.0).sample(50)
    found = run(short, trajectory=stay, control=ControlMode.FEED_FORWARD, offset=(0, 0, 0.1, 0))
    assert found.stopped is not None
    assert found.stopped.limit is Limit.GUIDE
    margin = check_reach(short.geometry, found.pose[-1]).margins[found.stopped.leg, 2]
    assert margin == pytest.approx(0.0, abs=1e-9)
    assert f"leg {found.stopped.leg + 1}" in found.stopped.explanation


def test_excessive_gains_fail_early(monkeypatch) -> None:
    monkeypatch.setattr("paminsa_viz.trajectory.simulation._MOST_EVALUATIONS", 2000)
    monkeypatch.setattr("paminsa_viz.trajectory.simulation._MOST_A_SECOND", 0)
    controller = Controller(proportional=(1e9,) * 4, derivative=(1e7,) * 4)
    with pytest.raises(SimulationFailed, match="evaluations") as caught:
        simulate(APPENDIX_4, SHORT, controller=controller)
    assert 0 <= caught.value.t < SHORT.duration


def test_as_many_evaluations_as_are_allowed_are_made_and_no_more(monkeypatch) -> None:
    place = "paminsa_viz.trajectory.simulation"
    needed = simulate(APPENDIX_4, SHORT).evaluations
    monkeypatch.setattr(f"{place}._MOST_A_SECOND", 10)
    monkeypatch.setattr(f"{place}._MOST_EVALUATIONS", needed - 6)  # in 0.6 s
    assert simulate(APPENDIX_4, SHORT).evaluations == needed
    monkeypatch.setattr(f"{place}._MOST_EVALUATIONS", needed - 7)
    with pytest.raises(SimulationFailed, match=f"more than {needed - 1:,} evaluations"):
        simulate(APPENDIX_4, SHORT)


def test_a_simulation_tells_how_far_it_is_and_can_be_ended(monkeypatch) -> None:
    monkeypatch.setattr("paminsa_viz.trajectory.simulation._CALLS_A_REPORT", 50)
    told = []
    assert run(progress=lambda done: told.append(done)).stopped is None
    assert told == sorted(told)
    assert 0 <= told[0] < 0.2
    assert 0.8 < told[-1] <= 1
    with pytest.raises(Canceled):
        run(progress=lambda done: done > 0.3)


def test_impossible_simulations_are_rejected() -> None:
    with pytest.raises(ImpossibleTrajectory):
        run(trajectory=point_to_point(HOME, [0.3, 0, 0, -0.5]).sample(50))
    with pytest.raises(InvalidInput, match="geometry"):
        run(model=APPENDIX_4.vary({"geometry.base_radius": 0.36}))
    with pytest.raises(InvalidInput, match="offset: the robot cannot start there"):
        run(offset=(1.0, 0, 0, 0))
    for offset in ((np.nan, 0, 0, 0), np.zeros((2, 4))):
        with pytest.raises(InvalidInput, match="offset: four finite numbers"):
            run(offset=offset)
    for name, value in (("bandwidth", -1.0), ("damping", np.nan)):
        with pytest.raises(InvalidInput, match=name):
            Controller(**{name: value})
    with pytest.raises(InvalidInput, match="together"):
        Controller(proportional=(1, 1, 1, 1))
    with pytest.raises(InvalidInput, match="four"):
        Controller(proportional=(1, 1, 1, 1), derivative=(1, 1, -1, 1))


@pytest.mark.parametrize("knee", KneeBranch)
def test_payload_mismatch_agrees_with_mujoco(knee: KneeBranch) -> None:
    """MuJoCo's loops are springs, its steps finite and its torques linear between samples."""
    from paminsa_viz.engines.mujoco_model import play

    height = np.array([0, 0, 0, 0.0 if knee is KneeBranch.LOWER else 0.945])
    samples = point_to_point(A + height, B + height, 0.6).sample(400)
    loaded = APPENDIX_4.vary({"payload.mass": 0.5})
    blind = Controller(ControlMode.FEED_FORWARD)
    model = with_knee(APPENDIX_4, knee)
    ours = simulate(with_knee(loaded, knee), samples, model=model, controller=blind)
    part = slice(0, 101)  # a quarter of a second
    played = play(
        with_knee(loaded, knee), samples.t[part], samples.pose[part], samples.velocity[part],
        ours.torque[part],
    )  # fmt: skip
    drift = np.abs(ours.error[part]).max()
    assert drift > 0.01
    np.testing.assert_allclose(played.poses, ours.pose[part], atol=0.005 * drift)


@given(angles=st.tuples(*[st.floats(-3.1, 3.1)] * 2))
def test_turn_error_is_the_angle_from_one_arm_to_the_other(angles: tuple[float, float]) -> None:
    wanted, actual = (SimpleNamespace(dx=np.cos(a), dy=np.sin(a)) for a in angles)
    found = formulas.turn_error(wanted, actual)  # type: ignore[arg-type]
    turn = np.exp(1j * (angles[0] - angles[1]))
    assert abs(np.exp(1j * found) - turn) < 1e-12
    assert abs(found) <= np.pi


@pytest.mark.parametrize(("end", "kept"), [(0.25, 3), (0.2, 2)])
def test_a_motion_ends_at_its_event_once_also_where_a_sample_stands(end: float, kept: int) -> None:
    """And a solver that gives up fails, unless the robot has come within 10 mm of a limit."""
    states = np.arange(20.0).reshape(2, 10)
    last = states[-1] if end == 0.2 else np.full(10, 7.0)
    solution = SimpleNamespace(
        t=np.array([0.1, 0.2]), y=states.T, status=1, message="too stiff",
        t_events=[np.array([end])], y_events=[last[None]],
    )  # fmt: skip

    def room(least: float):  # type: ignore[no-untyped-def]
        return lambda t, pose: np.r_[np.full(13, 1.0), least]

    event, t, found = simulation._end(solution, room(0.0))
    assert t.tolist() == [0.1, 0.2, end][:kept]
    assert len(found) == kept
    np.testing.assert_array_equal(found[-1], last)
    assert (event.t, event.pose) == (end, tuple(last[:4]))
    solution.status = -1
    for least, fails in ((0.0099, False), (0.0101, True)):
        if not fails:
            event, t, _ = simulation._end(solution, room(least))
            assert (event.t, t.tolist()) == (0.2, [0.1, 0.2])
            continue
        with pytest.raises(SimulationFailed, match="too stiff"):
            simulation._end(solution, room(least))


@pytest.mark.parametrize(("begin", "end", "crosses"), [(0.1, 0.3, True), (0.3, 0.4, False)])
def test_solver_that_gives_up_in_a_planned_crossing_stops_there(
    begin: float, end: float, crosses: bool
) -> None:
    solution: Any = SimpleNamespace(
        t=np.array([0.1, 0.2]), y=np.tile([*HOME, 0, 0, 0, 0, 0, 0], (2, 1)).T, status=-1,
        message="step size is less than spacing between numbers",
    )  # fmt: skip
    windows = (PassageWindow(Passage(0.25, Locus.ROTATION), begin, end),)

    def ended() -> Any:
        return simulation._end(solution, lambda t, pose: np.ones(14), windows)

    if not crosses:
        with pytest.raises(SimulationFailed, match="spacing"):
            ended()
        return
    event, t, _ = ended()
    assert (event.t, event.limit, t.tolist()) == (0.2, Limit.SINGULAR, [0.1, 0.2])
    assert "no authority along the escape twist" in event.explanation
    assert event.explanation.startswith("at 0.2 s: the motion crosses")


@pytest.mark.parametrize("given", [True, False], ids=["of the design", "of the motion"])
def test_one_of_two_loads_alone_does_work(given: bool) -> None:
    """Of both the balance is that of `test_loads`."""
    swinging = replace(SHORT, load=np.tile(EXTRA, (SHORT.size, 1)))
    found = run(APPENDIX_4.vary(LOAD), SHORT) if given else run(APPENDIX_4, swinging)
    assert np.abs(found.push).max() > 0.1
    assert np.abs(found.energy_drift).max() < 1e-6 * np.abs(found.work).max()
    assert (found.work[0], found.loss[0], found.push[0]) == (0.0, 0.0, 0.0)
    bare = run()
    assert not bare.push.any()
    assert bare.work[0] == bare.loss[0] == 0.0


def test_gains_are_those_of_the_first_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    class Seen(Exception):
        pass

    def gains(self: Controller, model: Design, pose: np.ndarray) -> None:
        raise Seen(model, pose.tolist())

    monkeypatch.setattr(Controller, "gains", gains)
    with pytest.raises(Seen) as seen:
        run(model=LOADED)
    assert seen.value.args == (LOADED, A.tolist())


@pytest.mark.parametrize(
    ("where", "starts"), [("circle", True), ("turn", True), ("stretched", False)]
)
def test_a_robot_starts_up_to_the_clearance_and_a_tenth_of_a_millimeter_off_a_stretched_pantograph(
    where: str, starts: bool
) -> None:
    """Half of a tenth before each of its limits."""
    geometry = APPENDIX_4.geometry
    near = SINGULAR_CLEARANCE + 5e-5
    low = brentq(lambda z: check_reach(geometry, [0, 0, 0, z]).margins.min() - 5e-5, -1.1, -0.5)
    pose = {
        "circle": [float(singular_radius(geometry, 0.0)) - near, 0.0, 0.0, -0.5],
        "turn": [0.0, 0.0, singular_rotation(geometry) - near / geometry.platform_radius, -0.5],
        "stretched": [0.0, 0.0, 0.0, low],
    }[where]
    stay = Trajectory([0.0, 1e-3], [pose] * 2, np.zeros((2, 4)), np.zeros((2, 4)))
    if starts:
        assert run(trajectory=stay, control=ControlMode.COMPUTED_TORQUE).stopped is None
        return
    with pytest.raises(InvalidInput, match="cannot start there"):
        run(trajectory=stay)
