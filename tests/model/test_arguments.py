"""Every public function of a robot takes a design, and refuses what is no robot in one line."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import at_joint
from paminsa_viz.identification import make_log
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    InvalidInput,
    Misprint,
    check_reach,
    inverse_kinematics,
    jacobian,
    static_torques,
    xy_grid,
)
from paminsa_viz.precision import solve_pose
from paminsa_viz.synthesis import EXAMPLES, load_case
from paminsa_viz.trajectory import PRESET, paper_like, straight_path
from tests.test_api import CALLABLES
from tests.test_bad_calls import GOOD

GEOMETRY = APPENDIX_4.geometry

ROBOTS = {
    place: (value, first.name)
    for place, value in CALLABLES.items()
    if not inspect.isclass(value)
    and (first := next(iter(inspect.signature(value).parameters.values()), None)) is not None
    and first.annotation in ("Design", "Geometry")
    and first.name in ("design", "geometry")
}
"""Public functions whose first argument is a robot, and its name."""


def test_what_is_no_robot_is_named() -> None:
    for place, (function, argument) in ROBOTS.items():
        with pytest.raises(InvalidInput) as caught:
            function([1.0, 2.0])
        expected = rf"{argument}: a .*Design is needed, not an? list"
        assert re.fullmatch(expected, str(caught.value)), place


def test_a_file_or_a_geometry_in_place_of_a_design_is_told_the_way() -> None:
    for path in ("robot.toml", Path("robot.toml")):
        for function in (static_torques, inverse_kinematics):
            with pytest.raises(InvalidInput, match=r"; load_design\(path\) reads one$"):
                function(path, np.zeros(4))  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match=r"; Design\(geometry=...\) has Appendix 4's masses$"):
        static_torques(GEOMETRY, np.zeros(4))  # type: ignore[arg-type]
    assert replace(APPENDIX_4, geometry=GEOMETRY) == Design(geometry=GEOMETRY)


def taking_geometries() -> dict[str, Callable[..., Any]]:
    """Return all public functions and methods with an argument that is a geometry."""
    found: dict[str, Callable[..., Any]] = {}
    for value in CALLABLES.values():
        methods = vars(value).items() if inspect.isclass(value) else ()
        public = [
            getattr(value, name)
            for name, method in methods
            if not name.startswith("_") and inspect.isroutine(getattr(method, "__func__", method))
        ]
        for function in (value, *public):
            if inspect.isclass(function) or not callable(function):
                continue
            parameters = inspect.signature(function).parameters.values()
            if any("Geometry" in str(one.annotation) for one in parameters):
                found.setdefault(f"{function.__module__}.{function.__qualname__}", function)
    return found


TAKING = taking_geometries()
MOTION = paper_like(GEOMETRY).sample(20.0)
ALSO: dict[str, Any] = {
    "body": "leg1/b4", "trajectory": MOTION,
    "grid": xy_grid([-0.1, 0.0, 0.1], [-0.1, 0.1], 0.1, -0.5),
    "log": make_log(MOTION.t, inverse_kinematics(GEOMETRY, MOTION.pose).actuators, MOTION.pose),
    "position": inverse_kinematics(GEOMETRY, MOTION.pose).actuators, "plan": paper_like(GEOMETRY),
    "slider": np.full(1, 0.1), "zeta": np.full((1, 2), 0.5), "diagonal": np.full((1, 2), 0.5),
    "clearance": 0.0, "bar": "b3", "most": 1.0, "cells": 3, "count": 3, "fine": False,
    "gravity": 9.81,
    "misprints": Misprint.NONE,
    "path": straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5]),
    "solution": solve_pose(
        GEOMETRY, GOOD["lengths"], inverse_kinematics(GEOMETRY, GOOD["pose"]).actuators,
        near=GOOD["pose"],
    ),
}  # fmt: skip
"""Arguments besides those of `GOOD`."""


def owner(function: Callable[..., Any]) -> tuple[Any, ...]:
    """Return what a method belongs to."""
    match function.__qualname__.partition(".")[0]:
        case "Preset":
            return (PRESET["circle"],)
        case "Anchor":
            return (at_joint(4),)
        case "SynthesisCase":
            return (load_case(EXAMPLES["cell"]),)
        case "SolvedTrajectory":
            from paminsa_viz.trajectory import solve_trajectory

            return (solve_trajectory(GEOMETRY, MOTION),)
    return ()


def same(one: Any, other: Any) -> None:
    """Compare two results, with what they hold."""
    if is_dataclass(one):
        assert type(one) is type(other)
        for item in fields(one):
            same(getattr(one, item.name), getattr(other, item.name))
    elif isinstance(one, dict):
        assert one.keys() == other.keys()
        for name, value in one.items():
            same(value, other[name])
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            same(a, b)
    elif isinstance(one, np.ndarray | float | int):
        np.testing.assert_array_equal(one, other)
    else:
        assert type(one) is type(other)


@pytest.mark.slow
def test_a_design_is_taken_wherever_a_geometry_is_with_the_same_result() -> None:
    assert len(TAKING) >= 40
    for function in TAKING.values():
        given: dict[str, Any] = {}
        own = owner(function)
        for one in list(inspect.signature(function).parameters.values())[len(own) :]:
            if "Geometry" in str(one.annotation):
                given[one.name] = [GEOMETRY] if "Sequence" in str(one.annotation) else GEOMETRY
                robot = one.name
            elif one.default is one.empty:
                given[one.name] = (GOOD | ALSO)[one.name]
        design = [APPENDIX_4] if isinstance(given[robot], list) else APPENDIX_4
        same(function(*own, **given), function(*own, **given | {robot: design}))


@pytest.mark.parametrize(
    ("pose", "problem"),
    [
        ([0.0, 0.0, 0.0], r"^pose: .* 4 entries; the shape is \(3,\)$"),
        (["a", "b", "c", "d"], r"^pose: real numbers are needed, not text: array.astype"),
        (None, r"^pose: real numbers are needed, not None$"),
        ([0.0, None, 0.0, 0.0], r"^pose: real numbers are needed, not None$"),
        (np.zeros(4, object), r"^pose: real numbers are needed, not objects: array.astype"),
        ([0.0, 0.0, 0.0, 1j], r"^pose: real numbers are needed, not complex128$"),
    ],
)
def test_a_pose_that_is_none_is_described(pose: Any, problem: str) -> None:
    for function in (jacobian, static_torques, inverse_kinematics, check_reach):
        with pytest.raises(InvalidInput, match=problem):
            function(APPENDIX_4, pose)
