"""Maps of the stiffness: NaN where there is no number, and solved again for elastic data alone."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics import stiffness
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.grids import Grid, solve_field
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.quantities import QUANTITIES
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
