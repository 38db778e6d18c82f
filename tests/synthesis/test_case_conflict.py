"""Requirements of a case that contradict: the ones that do, proven where closed forms say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis import Effort, ObjectiveLimit, synthesize
from paminsa_viz.synthesis.search.case_conflict import case_conflict
from tests.synthesis.search_cases import CYLINDER
from tests.synthesis.test_front import two_numbers

QUICK = Effort(20, 6)


@pytest.mark.slow
def test_the_limits_that_contradict_are_named_and_no_others():
    case = two_numbers()
    volume = ObjectiveLimit("volume", np.pi * 0.1**2 * 0.35)
    least = synthesize(replace(case, limits=(volume,))).objective
    mass = ObjectiveLimit("moving_mass", least - 0.2)
    footprint = ObjectiveLimit("footprint", 5.0)
    case = replace(case, limits=(footprint, mass, volume))
    found = case_conflict(case, effort=QUICK)
    assert found is not None
    assert found.items == (mass, volume)
    assert not found.proven
    assert not found.canceled
    # what is named contradicts, and each of it alone does not
    assert case_conflict(replace(case, limits=(footprint, volume)), effort=QUICK) is None
    assert case_conflict(replace(case, limits=(footprint, mass)), effort=QUICK) is None


def test_what_closed_forms_refuse_is_proven():
    small = replace(
        CYLINDER, limits=(ObjectiveLimit("moving_mass", 1e3), ObjectiveLimit("footprint", 0.3))
    )
    found = case_conflict(small, effort=Effort(40, 8))
    assert found is not None
    assert [item.objective for item in found.items] == ["footprint"]
    assert found.proven


def test_a_workspace_out_of_reach_needs_no_requirement():
    case = two_numbers()
    workspace = replace(case.workspace, center=(0.0, 0.0, -3.0))
    far = replace(case, requirements=replace(case.requirements, workspace=workspace))
    found = case_conflict(far, effort=QUICK)
    assert found is not None
    assert found.items == ()


def test_it_can_be_canceled():
    case = replace(
        two_numbers(), limits=(ObjectiveLimit("moving_mass", 1.0),),
    )  # fmt: skip
    bounds = (Requirement("condition", high=30.0), Requirement("f_4", high=1e4))
    case = replace(case, requirements=replace(case.requirements, bounds=bounds))
    found = case_conflict(case, effort=QUICK, progress=lambda searches, _: searches >= 2)
    assert found is not None
    assert found.canceled
