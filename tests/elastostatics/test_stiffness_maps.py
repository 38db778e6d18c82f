"""Maps of the stiffness: NaN where there is no number, and solved again for elastic data alone."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from paminsa_viz.elastostatics import stiffness
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities import stiffness as of_stiffness
from paminsa_viz.quantities.stiffness import STIFFNESS

LOADED = APPENDIX_4.vary({"payload.mass": 5.0})


@pytest.mark.parametrize("quantity", STIFFNESS, ids=lambda q: q.key)
def test_no_number_where_the_pose_is_singular_or_out_of_reach(quantity) -> None:
    radius = float(singular_radius(APPENDIX_4.geometry, 0.2))
    grid = Grid.over([0.0, 0.0, 0.2, -0.5], x=[0.0, radius, radius - 1e-9, 2.0])
    field = solve_field(APPENDIX_4.geometry, grid)
    assert field.status[2] == Limit.OK  # the torques there are large and finite
    found = quantity.over(field, LOADED)
    assert np.isnan(found).tolist() == [False, True, True, True]
    assert quantity.family == "stiffness"


def test_masses_and_loads_solve_nothing_again(monkeypatch: pytest.MonkeyPatch) -> None:
    field = solve_field(APPENDIX_4.geometry, Grid.over([0.0, 0.0, 0.2, -0.5], x=[0.0, 0.1]))
    calls = []
    solve = stiffness.platform_stiffness
    monkeypatch.setattr(
        stiffness, "platform_stiffness", lambda *given: calls.append(given) or solve(*given)
    )
    for quantity in STIFFNESS:
        quantity.over(field, APPENDIX_4)
    assert len(calls) == 1
    light, heavy = (
        QUANTITIES["deflection"].over(field, APPENDIX_4.vary({"payload.mass": m})) for m in (1, 2)
    )
    np.testing.assert_allclose(heavy, 2 * light)
    assert len(calls) == 1
    thick = APPENDIX_4.vary({"elastic.b4_outer": 0.06})
    assert (QUANTITIES["stiffness_z"].over(field, thick) > 1.5e5).all()
    assert len(calls) == 2


def test_of_stiffness_and_compliance_a_map_keeps_one() -> None:
    field = solve_field(
        APPENDIX_4.geometry, Grid.over([0.0, 0.0, 0.2, -0.5], x=np.linspace(0, 0.1, 80))
    )
    found = stiffness.field_stiffness(field, LOADED)
    assert field.nbytes < 2 * found.compliance.nbytes
    np.testing.assert_allclose(
        found.compliance @ found.matrix, np.broadcast_to(np.eye(6), (80, 6, 6)), atol=1e-8
    )


def test_frequencies_of_drives_take_the_memory_of_a_block_of_poses(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    block = 200
    monkeypatch.setattr(of_stiffness, "BLOCK", block)
    poses = Grid.over([0.0, 0.0, 0.2, -0.5], x=np.linspace(0, 0.1, 3 * block)).poses()
    most, each = [], []
    for part in (slice(block), slice(None)):
        tracemalloc.start()
        each.append(of_stiffness._first_of_drives(APPENDIX_4, poses[part]))
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert most[1] < 1.5 * most[0]
    np.testing.assert_array_equal(each[1][:block], each[0])
