"""Requirements checked by MuJoCo: it agrees, and says so where a bound is broken."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis.answer.checks import AnswerMargins
from paminsa_viz.synthesis.answer.engine_check import check_by_mujoco
from paminsa_viz.synthesis.masses.program import solve_inner
from tests.synthesis.inner_cases import case, motion, poses


@pytest.mark.parametrize("springs", [False, True])
def test_mujoco_confirms_the_optimum_and_its_active_bounds(springs):
    asked = case(springs=springs)
    found = solve_inner(APPENDIX_4, asked, poses())
    short = motion().take(np.arange(0, motion().size, 4))
    bounds = (*asked.bounds, Requirement("condition", high=10.0))
    margins = AnswerMargins(
        Requirements(bounds), found.springs, (short,), found.objective, asked.motion_force
    )
    checked = check_by_mujoco(found.design, margins, poses(), count=10)
    assert checked.passed
    assert checked.difference < 1e-6
    assert checked.left_out == ("condition",)
    assert [row.unit for row in checked.rows] == ["N m", "N", "N m", "N"]
    assert all(row.engine == pytest.approx(row.computed, abs=1e-4) for row in checked.rows)
    # a bound that is reached has no margin by MuJoCo's torques either
    assert abs(checked.rows[0].engine) < 1e-4
    tighter = tuple(replace(b, high=0.99 * b.high) for b in asked.bounds)
    margins = AnswerMargins(Requirements(tighter), found.springs)
    assert not check_by_mujoco(found.design, margins, poses()).passed


def test_poses_out_of_reach_are_refused():
    with pytest.raises(InvalidInput, match="out of reach"):
        check_by_mujoco(
            APPENDIX_4, AnswerMargins(Requirements()), np.array([[0.0, 0.0, 0.0, -3.0]])
        )
