"""What is written at the pointer over maps."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.hover import cell_at, emptiness, readout, reasons
from paminsa_viz.plots.map_values import MapData
from tests.plots.samples import made_up, real


@pytest.fixture(scope="module")
def data() -> MapData:
    return real(200, theta=0.6)


def test_every_masked_cell_says_why(data: MapData) -> None:
    words = reasons(data, 0)
    assert ((words == "") == (data.status == 0)).all()
    assert data.leg is not None
    stretched = (data.status == Limit.STRETCHED) & (data.leg == 1)
    assert stretched.any()
    assert set(words[stretched]) == {"out of reach: leg 2 over-stretched"}


def test_some_cells_have_the_reasons_of_all(data: MapData) -> None:
    cells = slice(20, 90, 7), slice(3, 170, 11)
    np.testing.assert_array_equal(reasons(data, 1, cells), reasons(data, 1)[cells])


@given(st.integers(0, 2), st.floats(0, 1, exclude_max=True), st.floats(0, 1, exclude_max=True))
def test_readout_is_that_of_the_nearest_cell(panel: int, right: float, up: float) -> None:
    data = real(60, theta=0.6)
    left, end, bottom, top = data.extent
    x, y = left + right * (end - left), bottom + up * (top - bottom)
    row, column = cell_at(data, x, y) or (-1, -1)
    assert abs(data.x[column] - x) <= np.abs(data.x - x).min() + 1e-12
    assert abs(data.y[row] - y) <= np.abs(data.y - y).min() + 1e-12
    found = readout(data, panel, x, y)
    assert found is not None
    place = [float(text) for text in re.findall(r"-?[\d.]+", found.cell.replace("−", "-"))]
    np.testing.assert_allclose(place, [1e3 * data.x[column], 1e3 * data.y[row]], atol=0.0501)
    assert found.pose.startswith("θ = 34.38°, z = ")
    why, value = reasons(data, panel)[row, column], data.values[panel, row, column]
    if why:
        assert found.text == why
    else:
        name, _, rest = found.text.replace("−", "-").partition(" = ")
        assert name == data.names[panel]
        assert rest.endswith(" N·m")
        shown = re.sub(r"·10(\S+)", lambda m: "e" + power(m[1]), rest.removesuffix(" N·m"))
        assert float(shown) == pytest.approx(value, rel=5.1e-4)


def power(superscript: str) -> str:
    return superscript.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))


def test_outside_the_map_there_is_no_readout(data: MapData) -> None:
    left, right, bottom, top = data.extent
    for x, y in ((left - 1e-9, 0.0), (right, 0.0), (0.0, bottom - 1e-9), (0.0, top)):
        assert cell_at(data, x, y) is None
        assert readout(data, 0, x, y) is None


def test_every_limit_has_a_reason() -> None:
    assert len({limit.reason(1) for limit in Limit}) == len(Limit)
    data = made_up(leg=None)
    assert set(reasons(data, 0)[data.status != 0]) == {"out of reach: a leg over-stretched"}


@pytest.mark.parametrize(
    ("code", "text"),
    [
        (Limit.OK, "no value here"),
        (Limit.STRETCHED, "nothing reachable here"),
        (Limit.SINGULAR, "singular everywhere"),
    ],
)
def test_an_empty_map_says_why(code: Limit, text: str) -> None:
    nothing, status = np.full((3, 27, 31), np.nan), np.full((27, 31), code, np.uint8)
    assert emptiness(made_up(values=nothing, status=status), 0) == text
    status[0] = Limit.STRETCHED  # no robot reaches all of the square
    assert emptiness(made_up(values=nothing, status=status), 0) == text
    assert emptiness(made_up(), 0) == ""
