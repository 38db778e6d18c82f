"""From a solved grid to a map: the model's numbers unchanged, and what they are called."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import paminsa_viz
from paminsa_viz.model import APPENDIX_4, solve_field, static_torques, xy_grid
from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.model.grids import Grid
from paminsa_viz.palette import LEG_COLORS
from paminsa_viz.plots.from_model import map_data
from paminsa_viz.quantities import QUANTITIES
from tests.plots.samples import real

POSE = (0.05, -0.03, np.pi / 3, -0.5)


def test_values_are_the_model_s_at_every_cell() -> None:
    data = real(21)
    x, y = np.meshgrid(data.x, data.y)
    pose = np.stack([x, y, np.full_like(x, POSE[2]), np.full_like(x, POSE[3])], axis=-1)
    torque = np.moveaxis(static_torques(APPENDIX_4, pose)[..., :3], -1, 0)
    good = data.status == 0
    assert 100 < good.sum() < good.size
    assert np.allclose(data.values[:, good], torque[:, good], rtol=1e-10)
    assert np.isnan(data.values[:, ~good]).all()
    assert data.colors == LEG_COLORS
    assert data.names == ("τ₁", "τ₂", "τ₃")
    assert data.singular_radius == pytest.approx(np.sqrt(0.35**2 + 0.1**2 - 0.035))


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_quantity_has_a_legend_and_can_be_mapped(quantity: str) -> None:
    data = real(21, quantities=(quantity,))
    assert data.title == QUANTITIES[quantity].title
    shown = data.values[np.isfinite(data.values)]
    assert shown.size
    if not data.signed:
        assert (shown >= 0).all() or (shown <= 0).all()
    else:
        assert shown.min() < 0 < shown.max()


def test_provenance_holds_every_number_of_the_design() -> None:
    source = real(5).provenance
    assert source.design == "Appendix 4"
    assert source.version == paminsa_viz.__version__
    assert dict(source.parameters)["links.b3 [kg]"] == 0.406
    assert dict(source.parameters)["geometry.magnification"] == 3.0
    loaded = APPENDIX_4.vary({"payload.mass": 2.5})
    assert ("payload", 2.5, "kg") in real(5, design=loaded).provenance.numbers


def test_what_does_not_belong_together_is_refused() -> None:
    axis = np.linspace(-0.1, 0.1, 5)
    field = solve_field(APPENDIX_4.geometry, xy_grid(axis, axis, POSE[2], POSE[3]))
    with pytest.raises(InvalidInput, match="pose"):
        map_data(field, APPENDIX_4, (0.0, 0.0, 1.0, -0.5))
    with pytest.raises(InvalidInput, match="geometry"):
        map_data(field, APPENDIX_4.vary({"geometry.base_radius": 0.36}), POSE)
    with pytest.raises(InvalidInput, match="unit"):
        map_data(field, APPENDIX_4, POSE, ("tau_1", "f_4"))
    with pytest.raises(InvalidInput, match="unit"):
        map_data(field, APPENDIX_4, POSE, ())
    other = replace(field, grid=Grid.over(POSE, x=axis, y=axis))
    with pytest.raises(InvalidInput, match="grid"):
        map_data(other, APPENDIX_4, POSE)
