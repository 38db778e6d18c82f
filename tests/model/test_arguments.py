"""Every public function of a robot takes a design, and refuses what is no robot in one line."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    actuator_acceleration,
    actuator_velocity,
    check_reach,
    closure_matrix,
    escape_twist,
    inverse_jacobian,
    inverse_jacobian_rate,
    inverse_kinematics,
    jacobian,
    measure_singularity,
    static_torques,
    unit_torques,
)
from tests.test_api import CALLABLES

POSE = np.array([[0.02, -0.01, 0.3, -0.55], [0.0, 0.03, -0.2, -0.5]])
RATE = np.array([0.1, 0.2, -0.3, 0.05])

ROBOTS = {
    place: (value, first.name)
    for place, value in CALLABLES.items()
    if not inspect.isclass(value)
    and (first := next(iter(inspect.signature(value).parameters.values()), None)) is not None
    and first.annotation in ("Design", "Geometry")
    and first.name in ("design", "geometry")
}
"""Public functions whose first argument is a robot, and its name."""


@pytest.mark.parametrize("place", ROBOTS)
def test_what_is_no_robot_is_named(place: str) -> None:
    function, argument = ROBOTS[place]
    with pytest.raises(InvalidInput, match=rf"^{argument}: a .*Design is needed, not an? list$"):
        function([1.0, 2.0])


@pytest.mark.parametrize(
    ("function", "rates"),
    [
        (jacobian, 0),
        (inverse_jacobian, 0),
        (unit_torques, 0),
        (escape_twist, 0),
        (inverse_jacobian_rate, 1),
        (actuator_velocity, 1),
        (actuator_acceleration, 2),
    ],
)
def test_a_design_is_taken_for_its_geometry(function: Callable[..., Any], rates: int) -> None:
    rest = [POSE, *[RATE] * rates]
    np.testing.assert_array_equal(function(APPENDIX_4, *rest), function(APPENDIX_4.geometry, *rest))


def test_results_of_a_design_are_those_of_its_geometry() -> None:
    design, geometry = APPENDIX_4, APPENDIX_4.geometry
    assert (
        inverse_kinematics(design, POSE).actuators == inverse_kinematics(geometry, POSE).actuators
    ).all()
    assert (check_reach(design, POSE).ok == check_reach(geometry, POSE).ok).all()
    assert (
        measure_singularity(design, POSE).determinant
        == measure_singularity(geometry, POSE).determinant
    ).all()
    joints = inverse_kinematics(design, POSE).actuators
    assert (closure_matrix(design, POSE, joints) == closure_matrix(geometry, POSE, joints)).all()


@pytest.mark.parametrize(
    ("pose", "problem"),
    [
        ([0.0, 0.0, 0.0], r"^pose: .* 4 entries; the shape is \(3,\)$"),
        (["a", "b", "c", "d"], r"^pose: real numbers are needed, not str"),
        (None, r"^pose: real numbers are needed, not NoneType$"),
        ([0.0, 0.0, 0.0, 1j], r"^pose: real numbers are needed, not complex128$"),
    ],
)
def test_a_pose_that_is_none_is_described(pose: Any, problem: str) -> None:
    for function in (jacobian, static_torques, inverse_kinematics, check_reach):
        with pytest.raises(InvalidInput, match=problem):
            function(APPENDIX_4, pose)
