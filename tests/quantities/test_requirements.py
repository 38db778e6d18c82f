"""Requirements: bounds on quantities of the registry, and the workspace over which they hold."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape

FINITE = st.floats(-1e6, 1e6)


@given(st.tuples(FINITE, FINITE).map(sorted), FINITE)
def test_margin_is_positive_inside_the_bounds_alone(bounds, value):
    low, high = bounds
    margin = Requirement("tau_1", low, high).margin(value)
    assert (margin >= 0) == (low <= value <= high)
    assert margin == min(value - low, high - value)


def test_margin_of_one_bound_is_the_distance_to_it():
    values = np.array([2.0, 10.0, 12.0, np.nan, np.inf])
    np.testing.assert_array_equal(
        Requirement("condition", high=10.0).margin(values), [8.0, 0.0, -2.0, np.nan, -np.inf]
    )
    np.testing.assert_array_equal(
        Requirement("reach_margin", low=10.0).margin(values), [-8.0, 0.0, 2.0, np.nan, np.inf]
    )


def test_headings_of_a_requirement_go_before_those_of_all():
    own = Requirement("condition", high=10.0, theta=(0.0, 0.1))
    common = Requirement("max_torque", high=10.0)
    needs = Requirements((own, common), theta=(-0.5, 0.5))
    assert needs.headings(own) == (0.0, 0.1)
    assert needs.headings(common) == (-0.5, 0.5)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: Requirement("kappa", high=1.0), "kappa"),
        (lambda: Requirement("condition"), "a least or a largest value"),
        (lambda: Requirement("condition", low=2.0, high=1.0), "low has to be"),
        (lambda: Requirement("condition", high=math.nan), "low has to be a number"),
        (lambda: Requirement("condition", high=1.0, theta=(1.0, 0.0)), "theta"),
        (lambda: Requirement("condition", high=1.0, z=(0.0, math.inf)), "z: two finite"),
        (lambda: Requirements(theta=(0.0, math.nan)), "theta: two finite"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, 0.0, 1.0)), "workspace.size"),
        (lambda: Workspace(WorkspaceShape.CYLINDER, (1.0, 2.0, 1.0)), "one diameter"),
        (lambda: Workspace(WorkspaceShape.BOX, (1.0, 1.0, 1.0), (math.nan, 0, 0)), "center"),
    ],
)
def test_impossible_requirements_are_refused(make, match):
    with pytest.raises(InvalidInput, match=match):
        make()
