"""Public functions of poses, numbers and robots refuse what is none in one line: which, what, why.

The calls are made from the names of the arguments: a good value for each, then one after the other
is replaced by values that are none.
"""

from __future__ import annotations

import inspect
import re
import warnings
import weakref
from typing import Any

import numpy as np
import pytest

from paminsa_viz import actuation, balancing, elastostatics, meshes, precision
from paminsa_viz.balancing import (
    Spring,
    SpringPlace,
    along,
    at_joint,
    fit_springs,
    on_bar,
    on_slider,
    tornado,
)
from paminsa_viz.engines import why_missing
from paminsa_viz.errors import InvalidDesign, InvalidInput, PaminsaError
from paminsa_viz.files import DataTable, table_bytes
from paminsa_viz.identification import base_matrix, identity_row, make_log
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Grid,
    LoadCase,
    inverse_kinematics,
    lumped_matrix,
    solve_field,
    torque_regressor,
    xy_grid,
)
from paminsa_viz.plots import map_data
from paminsa_viz.precision import nominal_lengths
from paminsa_viz.quantities import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
    affordable_cells,
    find,
    parse_requirement,
)
from paminsa_viz.studies import DesignRange, sweep
from paminsa_viz.synthesis import find_objective
from paminsa_viz.trajectory import (
    PRESET,
    Controller,
    Profile,
    TimeLaw,
    chain,
    circle,
    fit_law,
    line,
    point_to_point,
    simulate,
    solve_trajectory,
    via_points,
)
from tests.test_api import CALLABLES

POSE = np.array([0.01, 0.02, 0.1, -0.5])
GOOD: dict[str, Any] = {
    "design": APPENDIX_4, "geometry": APPENDIX_4.geometry, "load": LoadCase(),
    "friction": APPENDIX_4.actuator_friction, "accuracy": APPENDIX_4.accuracy,
    "tolerances": 0.01, "spring": Spring(at_joint(4), on_slider(0.1), 10.0),
    "springs": (Spring(at_joint(4), on_slider(0.1), 10.0),),
    "places": (SpringPlace(at_joint(4), on_slider(0.1)),),
    "pose": POSE, "near": POSE, "start": POSE, "goal": POSE + 0.01, "center": POSE,
    "velocity": np.zeros(4), "acceleration": np.zeros(4), "torque": np.zeros(4),
    "speed": np.zeros(4),
    "actuators": inverse_kinematics(APPENDIX_4, POSE).actuators,
    "lengths": nominal_lengths(APPENDIX_4.geometry), "deviations": np.zeros((3, 14)),
    "values": np.zeros((3, 14)), "poses": np.stack([POSE, POSE + 0.01]), "point": POSE[:3],
    "t": np.linspace(0.0, 1.0, 11), "theta": 0.1, "z": -0.5, "x": np.linspace(-0.1, 0.1, 3),
    "y": np.linspace(-0.1, 0.1, 3), "height": 0.05, "radius": 0.05,
}  # fmt: skip
"""A value for each argument by its name; functions with others have tests of their own."""

BAD: dict[str, Any] = {
    "None": None, "text": "x", "mapping": {"a": 1.0}, "ragged": [[1.0], [1.0, 2.0]],
    "complex": np.full(4, 1j), "shape": np.zeros((2, 5)), "NaN": np.full(4, np.nan),
    "empty": np.zeros((0,)),
}  # fmt: skip
NEVER_RIGHT = ("None", "text", "mapping", "ragged", "complex")
"""Values that no such argument can be; the others may be shapes of another batch."""

TYPED = (
    "design",
    "geometry",
    "load",
    "friction",
    "accuracy",
    "tolerances",
    "spring",
    "springs",
    "places",
)


def _calls() -> dict[str, tuple[Any, dict[str, Any], tuple[str, ...]]]:
    """Return the functions with arguments, and which of those are to be replaced."""
    found = {}
    for place, function in CALLABLES.items():
        if inspect.isclass(function) or not place.startswith("paminsa_viz."):
            continue
        parameters = inspect.signature(function).parameters.values()
        needed = [one.name for one in parameters if one.default is one.empty]
        like = tuple(
            one.name for one in parameters
            if one.name in needed and (one.name in TYPED or "ArrayLike" in str(one.annotation))
        )  # fmt: skip
        if set(like) - set(TYPED) and set(needed) <= set(GOOD):
            given = {name: GOOD[name] for name in needed}
            if place.endswith("from_samples"):
                given["pose"] = np.tile(POSE, (11, 1))
            found.setdefault(function.__qualname__ + function.__module__, (place, given, like))
    return {place: (CALLABLES[place], given, like) for place, given, like in found.values()}


CALLS = _calls()


def refusal(function: Any, given: dict[str, Any]) -> PaminsaError | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            function(**given)
        except PaminsaError as error:
            return error
    return None


def test_most_functions_of_arrays_are_called() -> None:
    assert len(CALLS) >= 70


@pytest.mark.parametrize("place", CALLS)
def test_what_is_no_value_of_an_argument_is_refused_in_one_line(place: str) -> None:
    """Positions by name: the argument replaced is named, in one line; nothing else is raised."""
    function, good, replaced = CALLS[place]
    for name in replaced:
        for kind, value in BAD.items():
            error = refusal(function, good | {name: value})
            if kind not in NEVER_RIGHT and not (kind == "shape" and name in TYPED):
                continue
            assert isinstance(error, InvalidInput), f"{name}={kind}: {error!r}"
            text = str(error)
            assert re.search(rf"\b{name}\b", text), f"{name}={kind}: {text}"
            assert "\n" not in text
            assert len(text) < 200


@pytest.mark.parametrize("place", CALLS)
def test_no_result_keeps_an_array_of_its_caller(place: str) -> None:
    """Who moves a pose on in place, as loops do, changes no earlier result, nor half of one."""
    function, good, _ = CALLS[place]
    given = {n: v.copy() if isinstance(v, np.ndarray) else v for n, v in good.items()}
    alive = {n: weakref.ref(v) for n, v in given.items() if isinstance(v, np.ndarray)}
    found = function(**given)
    given.clear()
    assert [name for name, array in alive.items() if array() is not None] == []
    del found


def test_no_record_keeps_an_array_of_its_caller() -> None:
    t, signals = np.linspace(0.0, 0.5, 20), np.zeros((20, 4))
    for made in (
        make_log(t, signals, signals),
        precision.Measurements(signals, signals),
        Grid.over(signals[0], x=t),
    ):
        arrays = [*vars(made).values(), *(v for _, v in getattr(made, "axes", ()))]
        for kept in (one for one in arrays if isinstance(one, np.ndarray)):
            assert not np.shares_memory(kept, t), made
            assert not np.shares_memory(kept, signals), made


def test_counts_of_poses_are_refused_in_one_line() -> None:
    from paminsa_viz.precision import measuring_poses

    for value in (None, "3", 2.5, np.nan, True, 0, 10**9, [3]):
        with pytest.raises(InvalidInput, match="poses: "):
            measuring_poses(APPENDIX_4, value)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="coordinates: a whole number"):
        measuring_poses(APPENDIX_4, 3, coordinates=None)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="coordinates: 4 or 6"):
        measuring_poses(APPENDIX_4, 3, coordinates=5)


KINDS: dict[str, Any] = {
    "None": None, "text": "x y", "texts": ["a", "b"], "object": object(), "number": 3,
    "geometry": APPENDIX_4.geometry, "design": APPENDIX_4,
}  # fmt: skip
"""A value of each kind, for every argument of a function at once."""

ADMITTED = {
    "text": ("str", "ArrayLike"),
    "texts": ("Sequence[str]", "ArrayLike"),
    "number": ("int", "float", "Array", "Range"),
    "geometry": ("Geometry",),
    "design": ("Design", "Geometry"),
}
"""Words in an annotation that may be right for such a value."""

FORMULAS = ("least_margin", "where")
"""Written for compiled loops, over numbers and arrays alike: they check nothing."""


def _functions() -> dict[str, tuple[Any, dict[str, str]]]:
    """Return all public functions with arguments that have no default, and their annotations."""
    found = {}
    for place, function in CALLABLES.items():
        package = place.split(".")[1]
        if inspect.isclass(function) or package in ("cli", "explorer", "progress"):
            continue
        needed = {
            one.name: str(one.annotation)
            for one in inspect.signature(function).parameters.values()
            if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
        }
        if needed and function.__name__ not in FORMULAS:
            found.setdefault(inspect.unwrap(function), (place, function, needed))
    return {place: (function, needed) for place, function, needed in found.values()}


FUNCTIONS = _functions()


def test_all_public_functions_are_called() -> None:
    assert len(FUNCTIONS) >= 225


@pytest.mark.parametrize("place", FUNCTIONS)
def test_no_public_function_fails_deep_inside(place: str) -> None:
    """Whatever its arguments are, it names one that is wrong, and nothing else is raised."""
    function, needed = FUNCTIONS[place]
    for kind, value in KINDS.items():
        if all(
            any(word in annotation for word in ADMITTED.get(kind, ("None",)))
            for annotation in needed.values()
        ):
            continue
        error = refusal(function, dict.fromkeys(needed, value))
        assert isinstance(error, InvalidInput), f"{kind}: {error!r}"
        text = str(error)
        assert re.search(rf"\b({'|'.join(needed)})\b", text), f"{kind}: {text}"
        assert "\n" not in text
        assert len(text) < 200


MOTION = circle(POSE, 0.03).sample(20.0)
NO_NAME = "nothing"
FIELD = solve_field(APPENDIX_4, xy_grid([-0.1, 0.0, 0.1], [-0.1, 0.1], 0.1, -0.5))

NAMED: dict[str, Any] = {
    "joint": lambda: elastostatics.joint_forces(APPENDIX_4, POSE).of(NO_NAME),
    "bar of loads": lambda: elastostatics.bar_loads(
        elastostatics.joint_forces(APPENDIX_4, POSE), NO_NAME
    ),
    "bar of a counterweight": lambda: along(APPENDIX_4, NO_NAME, 1.0),
    "place of a counterweight": lambda: Counterweight(NO_NAME, 7, 0.1, 1.0),
    "anchor": lambda: on_bar(NO_NAME, 7, 0.1),
    "measure": lambda: fit_springs(APPENDIX_4, GOOD["places"], POSE[None], measure=NO_NAME),
    "mass": lambda: tornado(APPENDIX_4, FIELD.grid, paths=(NO_NAME,)),
    "value": lambda: APPENDIX_4.value(NO_NAME),
    "section": lambda: APPENDIX_4.elastic.section(NO_NAME),
    "changed value": lambda: APPENDIX_4.vary({NO_NAME: 1.0}),
    "coordinate": lambda: Grid.over(POSE, **{NO_NAME: [0.0, 1.0]}),
    "plane": lambda: circle(POSE, 0.05, plane=NO_NAME),
    "quantity": lambda: find((NO_NAME,)),
    "quantity of a map": lambda: map_data(FIELD, APPENDIX_4, POSE, (NO_NAME,)),
    "requirement": lambda: parse_requirement(NO_NAME),
    "objective": lambda: find_objective(NO_NAME),
    "table": lambda: table_bytes(DataTable({"a": np.zeros(2)}, ()), NO_NAME),
    "engine": lambda: why_missing(NO_NAME),
    "body": lambda: meshes.make_body(APPENDIX_4, NO_NAME),
    "lengths of a body": lambda: meshes.lengths_of(APPENDIX_4, NO_NAME),
    "color": lambda: meshes.color_of(NO_NAME),
    "fixed part": lambda: meshes.fixed_part(NO_NAME),
    "material": lambda: meshes.fixed_part("barrel").add(NO_NAME),
}  # fmt: skip


@pytest.mark.parametrize("what", NAMED)
def test_a_name_of_nothing_is_refused_in_one_line(what: str) -> None:
    with pytest.raises((InvalidInput, InvalidDesign), match=NO_NAME) as caught:
        NAMED[what]()
    assert "\n" not in str(caught.value)


WRONG_KINDS = {
    "duration: a number is needed": lambda: circle(POSE, 0.03, duration="2"),  # type: ignore[arg-type]
    "angle: a number": lambda: circle(POSE, 0.03, angle=None),  # type: ignore[arg-type]
    "plane: a text": lambda: circle(POSE, 0.03, plane=["xy"]),  # type: ignore[arg-type]
    "duration: a number is needed, not a str": lambda: via_points([POSE, POSE + 1.0], duration="2"),  # type: ignore[arg-type]
    "plans: a Plan": lambda: chain(3),  # type: ignore[arg-type]
    "profile: a Profile": lambda: TimeLaw("quintic"),  # type: ignore[arg-type]
    "ramp: a number": lambda: TimeLaw(ramp="a"),  # type: ignore[arg-type]
    "law: a TimeLaw": lambda: point_to_point(POSE, POSE + 0.01, law="quintic"),  # type: ignore[arg-type]
    "duration: a number is": lambda: line(POSE, POSE[:3], "a"),  # type: ignore[arg-type]
    "bars: at least one": lambda: elastostatics.utilization(
        elastostatics.joint_forces(APPENDIX_4, POSE), ()
    ),
    "robots: a whole number": lambda: precision.monte_carlo(APPENDIX_4, POSE, robots=True),
    "count: a whole number": lambda: elastostatics.robot_modes(APPENDIX_4, POSE, True),
    "duties: each has to be a Duty": lambda: actuation.duty_cycle(APPENDIX_4, [MOTION]),  # type: ignore[list-item]
    "high: a number": lambda: Requirement("condition", high="a"),  # type: ignore[arg-type]
    "bounds: a tuple": lambda: Requirements("a"),  # type: ignore[arg-type]
    "bounds: each has to be a Requirement": lambda: Requirements((3,)),  # type: ignore[arg-type]
    "theta: two finite": lambda: Requirements(theta=("a", 1.0)),  # type: ignore[arg-type]
    "shape: a WorkspaceShape": lambda: Workspace("box", (1.0,) * 3),  # type: ignore[arg-type]
    "size: three": lambda: Workspace(WorkspaceShape.CYLINDER, (1.0, 1.0)),  # type: ignore[arg-type]
    "center: three": lambda: Workspace(WorkspaceShape.BOX, (1.0,) * 3, (0.0, "a", None)),  # type: ignore[arg-type]
    "control: a ControlMode": lambda: Controller("pd"),  # type: ignore[arg-type]
    "duration: a number": lambda: PRESET["arch"].build(APPENDIX_4).lasting("1"),  # type: ignore[arg-type]
    "geometry: a Geometry or a Design": lambda: PRESET["arch"].build("a"),  # type: ignore[arg-type]
    "changes: a Mapping": lambda: APPENDIX_4.vary(None),  # type: ignore[arg-type]
    "path: a str": lambda: APPENDIX_4.value(3),  # type: ignore[arg-type]
    "path: a str is needed, not an int": lambda: APPENDIX_4.stored(3),  # type: ignore[arg-type]
    "bar: one of": lambda: APPENDIX_4.elastic.section([]),  # type: ignore[arg-type]
    "design: a Design": lambda: FIELD.load_torques(APPENDIX_4.geometry),  # type: ignore[arg-type]
    "design: a Design is needed": lambda: find(("f_4",))[0].over(FIELD, None),  # type: ignore[arg-type]
    "field: a Field": lambda: find(("condition",))[0].over(APPENDIX_4, APPENDIX_4),  # type: ignore[arg-type]
    "moment: a number": lambda: actuation.wrench_polytope(APPENDIX_4, POSE).section("1"),  # type: ignore[arg-type]
    "spread: a number": lambda: DesignRange.around(APPENDIX_4, "links.b3", None),  # type: ignore[arg-type]
    "values: real numbers": lambda: Requirement("condition", high=10.0).margin("x"),
    "shift: the last axis": lambda: MOTION.moved(POSE[:3]),
    "shift: one pose": lambda: MOTION.moved(np.zeros((MOTION.t.size, 4))),
}


@pytest.mark.parametrize(
    "name",
    [
        "torques",
        "drive_inertia_torque",
        "loaded",
        "load_torques",
        "load_force",
        "friction",
        "breakdown",
    ],
)
def test_a_solved_motion_takes_designs_alone(name: str) -> None:
    solved = solve_trajectory(APPENDIX_4, MOTION)
    with pytest.raises(InvalidInput, match="design: a Design is needed, not a Geometry"):
        getattr(solved, name)(APPENDIX_4.geometry)


@pytest.mark.parametrize("what", WRONG_KINDS)
def test_records_and_methods_refuse_other_kinds_in_one_line(what: str) -> None:
    with pytest.raises(InvalidInput, match=what) as caught:
        WRONG_KINDS[what]()
    assert "\n" not in str(caught.value)


NAN, INFINITE = float("nan"), float("inf")
MEASURED = precision.Measurements(GOOD["actuators"][None], POSE[None])
IMPOSSIBLE: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "tolerance: a number above 0": (
        lambda value: balancing.optimize(
            APPENDIX_4, balancing.Changes(), balancing.AddedMass(), tolerance=value
        ),
        (NAN, -1.0, 0.0),
    ),
    "size: a number of at least 0": (
        lambda value: precision.simulated_measurements(APPENDIX_4, MEASURED, size=value),
        (-1.0, NAN, INFINITE),
    ),
    "noise: a number of at least 0": (
        lambda value: precision.simulated_measurements(APPENDIX_4, MEASURED, noise=value),
        (-1e-5, NAN, INFINITE),
    ),
    "tolerance: a number above 0 is": (
        lambda value: simulate(APPENDIX_4, MOTION, tolerance=value),
        (-1.0, 0.0, NAN, INFINITE),
    ),
    "count: at least one mode": (
        lambda value: elastostatics.robot_modes(APPENDIX_4, POSE, value),
        (-1, 0),
    ),
    "budget: a time of at least 0 s": (
        lambda value: affordable_cells(("max_torque",), 10, value),
        (-1.0, NAN, INFINITE),
    ),
    "slower: 1e-09 to 1e+09": (
        lambda value: actuation.duty_cycle(APPENDIX_4, [actuation.Duty(MOTION)], slower=value),
        (1e300, 1e-300, -1.0, 0.0, NAN),
    ),
    "repeats: a number of at least 1": (
        lambda value: actuation.duty_cycle(APPENDIX_4, [actuation.Duty(MOTION, value)]),
        ("a", None, 0.5, NAN),
    ),
    "dwell: a time of at least 0 s": (
        lambda value: actuation.duty_cycle(APPENDIX_4, [actuation.Duty(MOTION, 1.0, value)]),
        ("a", None, -1.0, NAN),
    ),
    "speed: a number above 0": (
        lambda value: fit_law(TimeLaw(Profile.TRAPEZOID), value, 1.0),
        (NAN, -1.0, 0.0),
    ),
    "jerk: a number above 0": (
        lambda value: fit_law(TimeLaw(Profile.S_CURVE), 1.0, 1.0, value),
        (NAN, -1.0, 0.0),
    ),
    "max_condition: a number of at least 1": (
        lambda value: sweep(APPENDIX_4, FIELD.grid, max_condition=value),
        (NAN, -1.0, 0.0),
    ),
    "stiffness: a stiffness of at least 0": (
        lambda value: Spring(at_joint(4), on_slider(0.1), value),
        (NAN, INFINITE, -1.0, "a", None),
    ),
    "share: a number from 0 to 1": (
        lambda value: precision.monte_carlo(APPENDIX_4, POSE, robots=2).quantile(value),
        (NAN, -0.1, 95, "a", None),
    ),
    "part: a number from 0 to 1": (
        lambda value: balancing.length_tolerance(APPENDIX_4, 0.01, POSE, samples=2).quantile(value),
        (NAN, -0.1, 95, "a", None),
    ),
    "free_length: a length of at least 0": (
        lambda value: Spring(at_joint(4), on_slider(0.1), 1.0, value),
        (NAN, INFINITE, -1.0, "a", None),
    ),
}
"""By what is said of them: a call with a number, and numbers that it refuses."""

SEEDED: dict[str, Any] = {
    "calibrate": lambda seed: precision.calibrate(APPENDIX_4, MEASURED, seed=seed),
    "measuring_poses": lambda seed: precision.measuring_poses(APPENDIX_4, 3, seed=seed),
    "plan_calibration": lambda seed: precision.plan_calibration(APPENDIX_4, 12, seed=seed),
    "simulated_measurements": lambda seed: precision.simulated_measurements(
        APPENDIX_4, MEASURED, seed=seed
    ),
    "monte_carlo": lambda seed: precision.monte_carlo(APPENDIX_4, POSE, seed=seed),
    "length_tolerance": lambda seed: balancing.length_tolerance(APPENDIX_4, 0.01, POSE, seed=seed),
}


@pytest.mark.parametrize("place", SEEDED)
def test_impossible_seeds_are_refused(place: str) -> None:
    for seed in (-1, True, 1.5):
        with pytest.raises(InvalidInput, match="seed: a whole number"):
            SEEDED[place](seed)


WEIGHED: dict[str, Any] = {
    "base_matrix": lambda g: base_matrix(APPENDIX_4, g),
    "identity_row": lambda g: identity_row(APPENDIX_4, g),
    "lumped_matrix": lambda g: lumped_matrix(APPENDIX_4, g),
    "solve_trajectory": lambda g: solve_trajectory(APPENDIX_4, MOTION, gravity=g),
    "torque_regressor": lambda g: torque_regressor(APPENDIX_4, POSE, POSE, POSE, gravity=g),
}


@pytest.mark.parametrize("place", WEIGHED)
def test_a_gravity_that_no_design_has_is_refused(place: str) -> None:
    for gravity in (NAN, INFINITE, -1.0):
        with pytest.raises(InvalidInput, match=f"gravity: .* at least 0 .*, not {gravity!r}"):
            WEIGHED[place](gravity)
    WEIGHED[place](0.0)


@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_impossible_numbers_are_refused_in_one_line(what: str) -> None:
    call, values = IMPOSSIBLE[what]
    for value in values:
        with pytest.raises(InvalidInput, match=re.escape(what)) as caught:
            call(value)
        assert "\n" not in str(caught.value)
        assert str(value) in str(caught.value)
