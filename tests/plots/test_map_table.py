"""Maps as CSV and NPZ: bitwise round trip, with provenance."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from io import BytesIO, StringIO
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.files.tables import table_csv, table_npz
from paminsa_viz.model import APPENDIX_4, static_imbalance
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.plots.map_table import map_table, value_columns
from paminsa_viz.plots.map_values import MapData, difference
from paminsa_viz.quantities import TORQUES
from tests.plots.samples import SAMPLE, made_up, real

COLUMNS = ["x_m", "y_m", "theta_rad", "z_m", "tau1_Nm", "tau2_Nm", "tau3_Nm", "status"]


def read(data: bytes) -> tuple[dict[str, str], list[str], list[list[str]]]:
    """Return header lines, column names and rows of a CSV."""
    lines = data.decode().splitlines()
    count = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    said = dict(line[2:].split(": ", 1) for line in lines[:count])
    rows = list(csv.reader(StringIO("\n".join(lines[count:]))))
    return said, rows[0], rows[1:]


def column(rows: list[list[str]], index: int) -> np.ndarray:
    """Return a column of numbers, NaN for what is empty."""
    return np.array([float(row[index]) if row[index] else np.nan for row in rows])


def check(data: MapData) -> None:
    """Assert that CSV and NPZ hold the bits of a map."""
    _, names, rows = read(table_csv(map_table(data)))
    assert names[4:-1] == list(value_columns(data))
    shape = data.status.shape
    assert np.array_equal(column(rows, 0).reshape(shape)[0], data.x)
    assert np.array_equal(column(rows, 1).reshape(shape)[:, 0], data.y)
    assert set(column(rows, 2)) == {data.theta}
    assert set(column(rows, 3)) == {data.z}
    for index, values in enumerate(data.values):
        back = column(rows, 4 + index).reshape(shape)
        assert np.array_equal(back.view(np.int64)[~np.isnan(back)],
                              values.copy().view(np.int64)[~np.isnan(values)])  # fmt: skip
        assert np.array_equal(np.isnan(back), np.isnan(values))
    with np.load(BytesIO(table_npz(map_table(data)))) as saved:
        for name, values in zip(value_columns(data), data.values, strict=True):
            assert saved[name].tobytes() == values.tobytes()
        assert np.array_equal(saved["status"], data.status)
        assert np.array_equal(saved["pose"], data.pose)
        assert data.leg is None or np.array_equal(saved["leg"], data.leg)
        assert np.array_equal(saved["x_m"], data.x)


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1), st.floats(1e-300, 1e300))
def test_numbers_come_back_bit_by_bit(seed: int, size: float) -> None:
    check(made_up(values=size * np.random.default_rng(seed).standard_normal((3, 27, 31))))


@pytest.mark.parametrize("quantities", [TORQUES, ("condition",)], ids=["torques", "condition"])
def test_computed_maps_come_back(quantities: tuple[str, ...]) -> None:
    check(real(15, quantities=quantities))


def test_columns_have_units_and_rows_have_a_status() -> None:
    data = real(15)
    _, names, rows = read(table_csv(map_table(data)))
    assert names == COLUMNS
    words = np.array([row[-1] for row in rows]).reshape(data.status.shape)
    assert ((words == "ok") == (data.status == 0)).all()
    assert set(np.unique(words)) >= {"ok", "stretched:leg1", "stretched:leg2", "stretched:leg3"}
    assert all(row[4] == "" for row in rows if row[-1] != "ok")
    without = read(table_csv(map_table(replace(data, leg=None))))[2]
    assert {row[-1] for row in without} == {"ok", "stretched"}


@pytest.mark.parametrize(
    ("quantity", "name"),
    [("f_4", "f4_N"), ("max_torque", "max_tau_Nm"), ("condition", "kappa"),
     ("reach_margin", "margin_m")],
)  # fmt: skip
def test_names_are_plain(quantity: str, name: str) -> None:
    assert value_columns(real(5, quantities=(quantity,))) == (name,)


def test_equal_names_are_numbered() -> None:
    assert value_columns(made_up(names=("a", "a", "!"), unit="")) == ("a_1", "a_2", "value")


def test_provenance_of_both_files_is_the_same() -> None:
    heavier = replace(APPENDIX_4.vary({"links.b8": 1.2}), name="Heavier")
    data = difference(real(5, design=heavier), real(5))
    said, names, _ = read(table_csv(map_table(data)))
    assert names[4] == "delta_tau1_Nm"
    with np.load(BytesIO(table_npz(map_table(data)))) as saved:
        assert json.loads(str(saved["provenance"])) == said
        assert saved["status_words"][2] == "stretched"
    assert said["design"] == "Heavier"
    assert said["reference"] == "Appendix 4"
    assert float(said["design links.b8 [kg]"]) == 1.2
    assert float(said["Mp2 [N]"]) == static_imbalance(heavier)
    assert all(key.isascii() for key in said)
    assert float(said["reference links.b8 [kg]"]) == 0.403
    assert float(said["pose theta [rad]"]) == np.pi / 3
    assert not any("tolerances" in key for key in said)
    tight = real(5, design=APPENDIX_4.vary({"tolerances.bar": 1e-5, "leg2.shaft": 2e-4}))
    said, *_ = read(table_csv(map_table(tight)))
    assert float(said["design tolerances.bar [m]"]) == 1e-5
    assert float(said["design leg2.shaft [m]"]) == 2e-4
    assert "design leg1.shaft [m]" not in said
    assert said["made by"].startswith("paminsa_viz ")


def test_maps_of_equal_legs_say_so_for_a_design_with_deviations() -> None:
    """Errors by tolerances follow the deviations of single legs, and so do not say it."""
    design = APPENDIX_4.vary({"leg2.shaft": 2e-4})
    note = equal_legs_note(design.deviations)
    assert map_table(real(3, design=design)).provenance["legs"] == note
    assert "legs" not in map_table(real(3)).provenance
    assert "legs" not in map_table(real(3, design=design, quantities=("tolerance_x",))).provenance


@pytest.mark.parametrize("name", ["two\nlines", "tab\t, comma", "\u2028", "日本", "\x00\x1b[31m"])
def test_design_name_stays_on_one_header_line(name: str) -> None:
    data: Any = made_up(design=replace(SAMPLE, name=name))
    said, names, rows = read(table_csv(map_table(data)))
    assert names == COLUMNS
    assert len(rows) == 27 * 31
    assert "design" in said


def test_equal_maps_give_equal_bytes() -> None:
    assert table_csv(map_table(made_up())) == table_csv(map_table(made_up()))
    assert table_npz(map_table(made_up())) == table_npz(map_table(made_up()))
