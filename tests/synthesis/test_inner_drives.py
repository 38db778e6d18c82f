"""Masses and drives together: a fixed point of both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.actuation.catalog import generic_catalog
from paminsa_viz.actuation.selection import size_design
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.synthesis.masses.case import InnerCase
from paminsa_viz.synthesis.masses.drives import solve_with_drives
from paminsa_viz.synthesis.masses.program import solve_inner
from paminsa_viz.trajectory import analyze
from tests.synthesis.inner_cases import MASSES, SPRING, WEIGHTS, motion, poses


def test_masses_are_the_best_with_drives_that_fit_them():
    case = InnerCase("peak_torque", (motion(),), MASSES, WEIGHTS[:1])
    found = solve_with_drives(APPENDIX_4, case, poses(), generic_catalog())
    assert found.feasible
    driven = found.inner.design
    assert all(driven.drives)
    # the drives' own inertia counts: the optimum is another than without them
    assert found.inner.objective > solve_inner(APPENDIX_4, case, poses()).objective
    again = solve_inner(replace(APPENDIX_4, drives=driven.drives), case, poses())
    assert again.objective == pytest.approx(found.inner.objective, rel=1e-9)
    assert np.abs(analyze(driven, motion()).torque[:, :3]).max() == pytest.approx(
        found.inner.objective, rel=1e-8
    )
    sized = size_design(found.selection.cycle, driven)
    assert all(figures is not None and figures.feasible for figures in sized)


def test_springs_and_missing_motions_are_refused():
    with pytest.raises(InvalidInput, match="without springs"):
        solve_with_drives(
            APPENDIX_4, InnerCase("moving_mass", (), MASSES, springs=(SPRING,)), poses(),
            generic_catalog(),
        )  # fmt: skip
    with pytest.raises(InvalidInput, match="at least one"):
        solve_with_drives(
            APPENDIX_4, InnerCase("moving_mass", (), MASSES), poses(), generic_catalog()
        )
