"""One source, two ways to run it: compiled loops and NumPy arrays, for any batch of poses."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import paminsa_viz.model as model
from paminsa_viz import quantities
from paminsa_viz.clearance import kernels as clearance_kernels
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    InvalidInput,
    backend,
    compiled,
    solve_field,
    xy_grid,
)
from paminsa_viz.model.arrays import as_kernels_take
from paminsa_viz.model.dynamics import InverseDynamics, TorqueBreakdown
from paminsa_viz.model.grids import ROTARY_TORQUES
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.lumped import term_factors
from paminsa_viz.model.measures import least_margin
from paminsa_viz.model.robot import where
from paminsa_viz.synthesis.proof.bisection import Control
from paminsa_viz.trajectory import equations
from tests.support.cases import BY_HAND, PROTOTYPES, Case, cases

Call = Callable[[Design, Any, Any, Any], list[Any]]
"""A function of the model on (design, pose, velocity, third), and its arrays."""


def dynamics(result: InverseDynamics) -> list[Any]:
    return [result.torque, result.multipliers, result.status, result.leg]


def breakdown(parts: TorqueBreakdown) -> list[Any]:
    return [parts.gravity, parts.inertial, parts.velocity, parts.friction, parts.total]


def configuration(found: model.Configuration) -> list[Any]:
    return [found.actuators, found.beta, found.psi, found.phi, *found.points.values()]


def motion(found: model.JointMotion) -> list[Any]:
    joints = (*found.velocity.values(), *found.acceleration.values())
    return [found.actuators_velocity, found.actuators_acceleration, found.psi_acceleration, *joints]


CALLS: dict[str, Call] = {
    "inverse_kinematics": lambda d, p, v, a: configuration(model.inverse_kinematics(d.geometry, p)),
    "joint_rates": lambda d, p, v, a: motion(model.joint_rates(d.geometry, p, v, a)),
    "forward_kinematics": lambda d, p, v, a: [
        *vars(model.forward_kinematics(d.geometry, p)).values()
    ],
    "nearest_solution": lambda d, p, v, a: [model.nearest_solution(d.geometry, p, v)],
    "closure": lambda d, p, v, a: [model.closure(d.geometry, p, v)],
    "closure_matrix": lambda d, p, v, a: [model.closure_matrix(d.geometry, p, v)],
    "jacobian": lambda d, p, v, a: [model.jacobian(d.geometry, p)],
    "inverse_jacobian": lambda d, p, v, a: [model.inverse_jacobian(d.geometry, p)],
    "inverse_jacobian_rate": lambda d, p, v, a: [model.inverse_jacobian_rate(d.geometry, p, v)],
    "check_reach": lambda d, p, v, a: [*vars(model.check_reach(d.geometry, p)).values()],
    "measure_singularity": lambda d, p, v, a: [
        *vars(model.measure_singularity(d.geometry, p)).values()
    ],
    "unit_torques": lambda d, p, v, a: [model.unit_torques(d.geometry, p)],
    "static_torques": lambda d, p, v, a: [model.static_torques(d, p)],
    "static_breakdown": lambda d, p, v, a: [
        model.static_breakdown(d, p).per_leg,
        model.static_breakdown(d, p).total,
    ],
    "potential_energy": lambda d, p, v, a: [model.potential_energy(d, p)],
    "kinetic_energy": lambda d, p, v, a: [model.kinetic_energy(d, p, v)],
    "mass_matrix": lambda d, p, v, a: [model.mass_matrix(d, p)],
    "inverse_dynamics": lambda d, p, v, a: dynamics(model.inverse_dynamics(d, p, v, a)),
    "torque_breakdown": lambda d, p, v, a: breakdown(model.torque_breakdown(d, p, v, a)),
    "forward_dynamics": lambda d, p, v, a: [model.forward_dynamics(d, p, v, a)],
    "torque_regressor": lambda d, p, v, a: [model.torque_regressor(d.geometry, p, v, a)],
    "published_regressor": lambda d, p, v, a: [
        model.torque_regressor(d.geometry, p, v, a, gravity=3.7, misprints=model.Misprint.ALL)
    ],
    "actuator_velocity": lambda d, p, v, a: [model.actuator_velocity(d, p, v)],
    "actuator_power": lambda d, p, v, a: [model.actuator_power(d, p, v, a)],
}
EACH = pytest.mark.parametrize("name", CALLS)
THIRD = {"forward_dynamics": "torque", "actuator_power": "torque"}
NEEDS = {
    "velocity": {"joint_rates", "inverse_jacobian_rate", "kinetic_energy", "actuator_velocity",
                 "actuator_power", "inverse_dynamics", "torque_breakdown", "forward_dynamics",
                 "torque_regressor", "published_regressor"},
    "third": {"joint_rates", "inverse_dynamics", "torque_breakdown", "forward_dynamics",
              "torque_regressor", "published_regressor", "actuator_power"},
}  # fmt: skip
FIRST = {"forward_kinematics": "actuators", "nearest_solution": "actuators"}
SECOND = {"nearest_solution": "near", "closure": "actuators", "closure_matrix": "actuators"}


def near(got: Any, expected: Any, name: str, relative: float = 1e-11) -> None:
    """Equal but for rounding, in every result; NaN and infinities in the same places."""
    assert len(got) == len(expected)
    for one, two in zip(got, expected, strict=True):
        assert np.shape(one) == np.shape(two)
        finite = np.abs(two)[np.isfinite(two)] if np.size(two) else np.zeros(0)
        size = finite.max(initial=1e-300)
        np.testing.assert_allclose(one, two, rtol=relative, atol=relative * size, err_msg=name)


def mixed_states(case: Case) -> tuple[Any, Any, Any]:
    """States of which some are out of reach or not finite."""
    pose, v, a = (np.concatenate([array, array[:4]]) for array in case.states(6))
    pose[6:] = [[9.0, 0, 0, 0], [0, 0, 0, -5.0], [0, np.nan, 0, -0.5], [0, 0, 0, np.inf]]
    return pose, v, a


@pytest.mark.slow
@given(case=cases())
def test_compiled_and_numpy_agree_on_everything(case: Case) -> None:
    states = mixed_states(case)
    backend.compile_now()
    for name, call in CALLS.items():
        with_kernels = call(case.design, *states)
        with backend.use_numpy():
            assert not backend.is_compiled()
            without = call(case.design, *states)
        assert backend.is_compiled()
        near(with_kernels, without, name, 1e-9 if name == "measure_singularity" else 1e-11)


def test_what_is_compiled_is_told_apart_by_the_text_of_its_file(tmp_path: Path) -> None:
    """Of a number at the top of a file nothing is in the code of its functions."""

    def digest(name: str, text: str) -> str:
        names: dict[str, Any] = {}
        exec(compile(text, name, "exec"), names)
        return compiled.register(names["double"])

    texts = ["FACTOR = 2.0\ndef double(x):\n    return FACTOR * x\n"]
    texts.append(texts[0].replace("2.0", "3.0"))
    file = tmp_path / "formula.py"
    found = []
    for text in (*texts, texts[0]):
        file.write_text(text)
        found.append(digest(str(file), text))
    assert found[0] == found[2] != found[1]
    assert digest("no file", texts[0]) == digest("no file", texts[1]) != found[0]


@pytest.mark.slow
def test_kernels_are_compiled_ahead_of_their_first_call(monkeypatch: pytest.MonkeyPatch) -> None:
    for loop in compiled.over_poses(ROTARY_TORQUES.function, ROTARY_TORQUES.results):
        assert len(loop.signatures) == 1
    called = []
    names = ("inverse_dynamics_kernel", "mass_matrix", "regressor")
    for name in names:
        monkeypatch.setattr(compiled, name, lambda *_, name=name: called.append(name))
    compiled.warm_up()
    assert sorted(called) == sorted(names)


@pytest.mark.slow
def test_arrays_of_any_kind_need_no_kernel_but_those_compiled_ahead() -> None:
    """Numba compiles a kernel again, for seconds, for arrays that are read-only or in steps."""
    backend.compile_now()
    formula = quantities.formulas()[0]
    pose = np.random.default_rng(3).uniform(-0.1, 0.1, (8, 4)) - [0, 0, 0, 0.5]
    frozen = pose.copy()
    frozen.flags.writeable = False
    for states in (pose, frozen, pose[::2], np.asfortranarray(pose), np.asfortranarray(frozen)):
        model.inverse_dynamics(APPENDIX_4, states, states, states)
        model.mass_matrix(APPENDIX_4, states)
        model.torque_regressor(APPENDIX_4.geometry, states, states, states)
        backend.over_list(formula, mechanism(APPENDIX_4.geometry), states)
    kernels = (compiled.inverse_dynamics_kernel, compiled.mass_matrix, compiled.regressor)
    for kernel in (*kernels, *backend._kernels.loops[formula]):
        assert len(kernel.signatures) == 1, kernel.py_func.__name__


@pytest.mark.parametrize("numpy", [False, True])
@given(case=cases(), columns=st.integers(1, 5), only_x=st.booleans())
def test_a_grid_is_all_sums_of_its_parts(
    numpy: bool, case: Case, columns: int, only_x: bool
) -> None:
    outer = case.states(6)[0]
    inner = np.linspace([-0.02, 0.01, 0.0, 0.02], [0.03, -0.02, 0.0, -0.01], columns)
    inner = inner * [1, not only_x, 1, not only_x]
    m = mechanism(case.design.geometry)
    found = np.empty((len(outer), 3, columns))

    def fill() -> None:
        backend.over_grid(ROTARY_TORQUES, m, outer, inner)(slice(None), slice(None), found)

    if numpy:
        with backend.use_numpy():
            fill()
    else:
        fill()
    sums = (outer[:, None] + inner).reshape(-1, 4)
    expected = backend.over_list(ROTARY_TORQUES, m, sums).reshape(len(outer), columns, 3)
    near(np.moveaxis(found, 1, 0), np.moveaxis(expected, -1, 0), "over_grid", 1e-10)


@pytest.mark.slow
@EACH
@given(case=cases(), shape=st.sampled_from([(), (0,), (1,), (3,), (2, 3), (2, 0, 3), (1, 2, 1)]))
def test_any_batch_is_its_poses_one_by_one(name: str, case: Case, shape: tuple[int, ...]) -> None:
    """Compiled, and on NumPy."""
    call = CALLS[name]
    n = int(np.prod(shape))
    states = [array[np.arange(n) % len(array)] for array in mixed_states(case)]
    batch = [array.reshape(*shape, 4) for array in states]

    def compare() -> None:
        results = call(case.design, *batch)
        for result in results:
            assert np.shape(result)[: len(shape)] == shape
        for i in range(n):
            alone = call(case.design, *(array[i] for array in states))
            these = [np.asarray(r).reshape(n, *np.shape(r)[len(shape) :])[i] for r in results]
            near(these, alone, name)

    compare()
    with backend.use_numpy():
        compare()


def test_numbers_of_any_kind() -> None:
    """Lists, tuples, integers and narrower floats; always computed in float64."""
    pose, v, a = [[0, 0, 0, -0.5], [0.25, -0.125, 0.5, -0.625]], [1, -1, 2, 0], [0, 3, -4, 1]
    kinds = (
        (pose, v, a),
        (tuple(map(tuple, pose)), tuple(v), tuple(a)),
        tuple(np.array(array, np.float32) for array in (pose, v, a)),  # exact in binary
        (np.array(pose), np.array(v, np.int8), np.array(a, np.int64)),
        (np.asfortranarray(pose), np.array(v)[::-1][::-1], np.array(a)),
    )
    for name, call in CALLS.items():
        expected = call(APPENDIX_4, np.array(pose), np.array(v, float), np.array(a, float))
        for made in kinds:
            results = call(APPENDIX_4, *made)
            for result in results:
                assert np.asarray(result).dtype in (np.float64, np.uint8, np.int8, np.bool_), name
            near(results, expected, name, 1e-13)


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((2, 5)), 0.0, ["a"] * 4, [1j] * 4])
def test_unusable_argument_is_named(bad: Any) -> None:
    good = (BY_HAND, np.zeros(4), np.zeros(4))
    for name, call in CALLS.items():
        wrong = {FIRST.get(name, "pose"): (bad, *good[1:])}
        if name in NEEDS["velocity"] or name in SECOND:
            wrong[SECOND.get(name, "velocity")] = (good[0], bad, good[2])
        if name in NEEDS["third"]:
            wrong[THIRD.get(name, "acceleration")] = (*good[:2], bad)
        for argument, states in wrong.items():
            with pytest.raises(InvalidInput) as caught:
                call(APPENDIX_4, *states)
            assert caught.value.argument == argument, name
            assert re.search("4 entries|real numbers", caught.value.problem), name


@PROTOTYPES
def test_inputs_are_left_alone(design: Design) -> None:
    arrays = BY_HAND.copy(), np.full((3, 4), 0.1), np.full((3, 4), 0.2)
    copies = [array.copy() for array in arrays]
    for name, call in CALLS.items():
        call(design, *arrays)
        for array, copy in zip(arrays, copies, strict=True):
            np.testing.assert_array_equal(array, copy, err_msg=name)


def ratio_of_lengths(m: Any, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any, Any]:
    """A formula that the package does not know: it calls one that it does."""
    worst, _ = least_margin(m, x, y, c, s, z)
    return where(worst > 0.0, np.hypot(x, y) / m.base_radius, np.nan), worst


@pytest.mark.parametrize(
    "formula",
    [*quantities.formulas(), backend.Formula(ratio_of_lengths, 1)],
    ids=lambda formula: f"{formula.function.__name__}-{formula.results}",
)
def test_any_formula_runs_compiled_and_on_arrays(formula: backend.Formula) -> None:
    backend.compile_now()
    m = mechanism(APPENDIX_4.geometry)
    pose = np.random.default_rng(3).uniform(-0.3, 0.3, (50, 4)) - [0, 0, 0, 0.5]
    compiled = backend.over_list(formula, m, pose)
    assert formula in backend._kernels.loops
    with backend.use_numpy():
        near(compiled.T, backend.over_list(formula, m, pose).T, "list", 1e-9)
    x, y = np.linspace(-0.3, 0.3, 7), np.linspace(-0.2, 0.2, 5)
    field = solve_field(APPENDIX_4.geometry, xy_grid(x, y, 0.3, -0.5))
    with backend.use_numpy():
        other = solve_field(APPENDIX_4.geometry, xy_grid(x, y, 0.3, -0.5))
        expected = other.solve(formula)
    assert expected.shape == (formula.results, 5, 7)
    near(field.solve(formula), expected, "grid", 1e-9)


def test_loops_over_states_write_their_results_and_nothing_behind_them() -> None:
    """Compiled loops do not look whether a place is inside of an array."""
    backend.compile_now()
    kernels = backend._kernels.get(7)
    assert kernels is not None
    m, e = mechanism(APPENDIX_4.geometry), term_factors(APPENDIX_4)
    pose = np.random.default_rng(3).uniform(-0.1, 0.1, (7, 4)) - [0, 0, 0, 0.5]
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    pose, rest = map(as_kernels_take, (pose, np.zeros((7, 4))))
    for count, run in (
        (10, lambda out: kernels.mass_matrix(m, e, pose, c, s, out)),
        (8, lambda out: kernels.inverse_dynamics_kernel(m, e, 9.81, pose, c, s, rest, rest, out)),
    ):
        whole = np.full((9, count), np.nan)
        run(whole[:7])
        assert np.isfinite(whole[:7]).all()
        assert np.isnan(whole[7:]).all()


@pytest.mark.parametrize(
    ("setting", "expected"), [("", [False, True, True]), ("numpy", [False, False, True])]
)
def test_kernels_are_loaded_when_they_pay(
    setting: str, expected: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """After many poses, unless the environment or a page puts it off."""
    monkeypatch.setenv("PAMINSA_VIZ_BACKEND", setting)
    monkeypatch.setattr(backend, "_kernels", backend._Kernels())  # as at the start
    found = []
    for count in (1_000, 200_000):
        model.static_torques(APPENDIX_4, np.tile([0.0, 0.0, 0.0, -0.5], (count, 1)))
        found.append(backend.is_compiled())
    thread = backend.compile_in_background()
    assert thread.daemon  # a page that ends does not wait for it
    thread.join()
    assert [*found, backend.is_compiled()] == expected
    # and a page never waits for a formula that it has not asked for at its start
    assert backend._kernels.get_loops(backend.Formula(ratio_of_lengths, 2), 10**6) is None


def test_what_needs_no_kernels_of_motions_does_not_wait_for_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Neither a formula nor what compiles kernels of its own, as a simulation does."""
    monkeypatch.setenv("PAMINSA_VIZ_BACKEND", "")
    monkeypatch.setattr(backend, "_kernels", backend._Kernels())  # as at the start
    monkeypatch.setattr(compiled, "warm_up", lambda: pytest.fail("kernels of motions were loaded"))
    monkeypatch.setattr(compiled, "over_poses", lambda *_: ("grid", "list"))
    assert backend.compiles()
    few, many = (backend.Formula(ratio_of_lengths, count) for count in (1, 2))
    assert backend._kernels.get_loops(few, backend.WORTH_LOADING - 1) is None
    assert backend._kernels.get(backend.WORTH_LOADING - 1) is None
    assert not backend.is_compiled()
    assert backend._kernels.get_loops(many, backend.WORTH_LOADING) == ("grid", "list")
    assert backend._kernels.get_loops(few, 0) == ("grid", "list")
    assert backend.is_compiled()
    with backend.use_numpy():
        assert backend._kernels.get_loops(many, 1) is None
        assert not backend.compiles()
    assert backend._kernels.get_loops(many, 1) == ("grid", "list")


def test_a_clock_of_work_stands_still_while_its_thread_waits_for_kernels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Or a limit of time would end a proof undecided at the first run after installing."""
    now = 100.0

    def compiling(*_: object) -> tuple[str, str]:
        nonlocal now
        now += 20.0
        return "grid", "list"

    monkeypatch.setenv("PAMINSA_VIZ_BACKEND", "")
    monkeypatch.setattr(backend, "time", SimpleNamespace(perf_counter=lambda: now))
    monkeypatch.setattr(backend, "_kernels", backend._Kernels())  # as at the start
    monkeypatch.setattr(clearance_kernels, "_search", clearance_kernels._Search())
    for module, name in (
        (compiled, "warm_up"),
        (compiled, "over_poses"),
        (clearance_kernels, "_compile"),
        (equations, "_compiled"),
    ):
        monkeypatch.setattr(module, name, compiling)
    formula = backend.Formula(ratio_of_lengths, 1)
    clock, control = backend.WorkClock(), Control(15.0)
    now += 3.0
    for load in (
        lambda: backend._kernels.get_loops(formula, backend.WORTH_LOADING),
        lambda: backend._kernels.get(backend.WORTH_LOADING),
        clearance_kernels._search.compiled,
        equations.load_kernel,
    ):
        before = now
        load()
        assert now == before + 20.0
        assert clock.elapsed == control.elapsed == 3.0
        assert backend.WorkClock().elapsed == 0.0
    assert not control.over
    thread = threading.Thread(target=equations.load_kernel)  # nobody here waits for what it does
    thread.start()
    thread.join()
    assert clock.elapsed == 23.0
    assert control.over


IN_A_NEW_PROCESS = """
import sys
import numpy as np
from paminsa_viz.model import APPENDIX_4, backend, static_torques
backend.compile_now()
torques = static_torques(APPENDIX_4, np.tile([0.05, -0.03, 0.3, -0.55], (3, 1)))
print("numba.np.linalg" in sys.modules, backend.is_compiled(), *torques[2])
"""


@pytest.mark.slow
@pytest.mark.skipif(not compiled._is_tried, reason="a newer Numba, of which this is not known")
def test_compiled_code_is_loaded_without_what_compiles_it() -> None:
    backend.compile_now()  # so that it is on the disk
    model.static_torques(APPENDIX_4, [0.05, -0.03, 0.3, -0.55])
    words = [sys.executable, "-c", IN_A_NEW_PROCESS]
    said = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    assert said[:2] == ["False", "True"]
    expected = model.static_torques(APPENDIX_4, [0.05, -0.03, 0.3, -0.55])
    np.testing.assert_array_equal(np.array(said[2:], float), expected)


def test_each_kernel_has_a_file_of_its_own(tmp_path: Path) -> None:
    """Whoever else writes at the same time, and whatever an older source has left."""

    def files(stamp: str = "source", version: str | None = None) -> Any:
        made = compiled._Files(str(tmp_path), "kernel", stamp)
        made._version = version or made._version
        return made

    first, second = files(), files()  # of two processes, which have seen nothing of each other
    first.save("a", 1)
    second.save("b", 2)
    files("older").save("a", 3)
    files(version="older").save("a", 4)
    for one in (first, second, files()):
        assert [one.load(key) for key in "abc"] == [1, 2, None]
    assert [files("older").load(key) for key in "ab"] == [3, None]
    assert files(version="older").load("a") == 4
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize("tried", [False, True])
def test_a_newer_numba_loads_all_that_it_may_need(
    tried: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compiled, "_is_tried", tried)
    refreshed = []
    context = compiled.mass_matrix.targetctx
    monkeypatch.setattr(context, "refresh", lambda: refreshed.append(1))
    compiled.mass_matrix._cache.load_overload((), context)
    assert refreshed == [1] * (not tried)


def test_what_is_not_on_the_disk_is_told(caplog: pytest.LogCaptureFixture) -> None:
    cache = compiled.mass_matrix._cache
    with caplog.at_level("INFO", compiled.log.name):
        assert cache.load_overload((), compiled.mass_matrix.targetctx) is None
    assert [one.getMessage() for one in caplog.records] == [f"{cache._name} is compiled"]


def test_kernels_are_compiled_by_calls_on_nothing() -> None:
    """Whatever a kernel reads and writes is not there then."""
    for dimensions in (1, 2, 3):
        assert compiled.nothing(dimensions).shape == (0,) * dimensions
