"""Published torques over time: read in any unit of time, interpolated, never extrapolated."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.errors import TableFileError
from paminsa_viz.files.published_table import (
    parse_published,
    parse_published_map,
    read_published,
    read_published_map,
)


def parsed(text: str):  # type: ignore[no-untyped-def]
    return parse_published(io.StringIO(text, newline=""), "fig6.csv")


def test_values_are_linear_between_rows_and_none_outside() -> None:
    table = parsed("# Fig. 6\nt_ms,tau2_Nm,f4_N\n100,1,10\n300,3,30\n")
    assert table.name == "fig6"
    found = table.at(np.array([0.0, 0.1, 0.2, 0.3, 0.31]))
    assert np.isnan(found[:, [0, 2]]).all()
    np.testing.assert_allclose(found[:, 1], [np.nan, 1, 2, 3, np.nan])
    np.testing.assert_allclose(found[:, 3], [np.nan, 10, 20, 30, np.nan])


def test_differences_are_at_the_rows_that_the_motion_has() -> None:
    table = parsed("t_s,tau1_Nm\n0,1\n1,2\n2,5\n")
    t = np.linspace(0.0, 1.5, 31)
    off = table.differences(t, np.repeat((1.0 + 2.0 * t)[:, None], 4, axis=1))
    np.testing.assert_allclose(off[:, 0], [0.0, 1.0, np.nan])
    assert np.isnan(off[:, 1:]).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t_s\n0\n1\n", "at least one of tau1_Nm"),
        ("tau1_Nm\n0\n", "t_s"),
        ("t_s,tau1_Nm\n0,1\n", "two rows"),
        ("t_s,tau1_Nm\n0,1\n0,2\n", "increase"),
        ("t_s,tau1_Nm\n0,x\n1,2\n", "x"),
        ("t_s,tau9_Nm\n0,1\n1,2\n", "tau9_Nm"),
    ],
)
def test_other_tables_are_refused(text: str, message: str) -> None:
    with pytest.raises(TableFileError, match=message):
        parsed(text)


@pytest.mark.parametrize("place", [1, 2, 3])
def test_the_row_that_goes_back_in_time_is_named(place: int) -> None:
    times = [0.0, 1.0, 2.0, 3.0]
    times[place] = times[place - 1] - 0.5
    rows = "".join(f"{t},1\n" for t in times)
    told = f"increase, and {times[place]} follows {times[place - 1]}"
    with pytest.raises(TableFileError, match=told) as caught:
        parsed(f"# a comment\nt_ms,tau1_Nm\n{rows}")
    assert caught.value.row == place + 3  # the comment and the header are rows 1 and 2
    assert caught.value.column == "t_ms"


def test_values_over_positions_are_in_the_rows_of_the_table(tmp_path: Path) -> None:
    text = "y_mm,tau3_Nm,x_mm,f4_kN\n20,1,10,2\n-40,3,30,4\n"
    found = parse_published_map(io.StringIO(text, newline=""), "map.csv")
    np.testing.assert_allclose(found.position, [[0.01, 0.02], [0.03, -0.04]])
    nan = np.nan
    np.testing.assert_allclose(found.torque, [[nan, nan, 1, 2000], [nan, nan, 3, 4000]])
    path = tmp_path / "fig3.csv"
    path.write_text(text)
    again = read_published_map(path)
    assert (found.name, again.name) == ("map", "fig3")
    np.testing.assert_array_equal(again.torque, found.torque)
    for text, message in (
        ("x_m,y_m,tau1_Nm\n", "at least one row"),
        ("x_m,y_m\n0,0\n", "at least one of tau1_Nm"),
        ("x_m,tau1_Nm\n0,0\n", "column y_m: the column is missing"),
    ):
        with pytest.raises(TableFileError, match=message):
            parse_published_map(io.StringIO(text, newline=""), "map.csv")


def test_a_file_is_read_as_its_text(tmp_path: Path) -> None:
    path = tmp_path / "fig6.csv"
    path.write_text("t_s,f4_N\n0,1\n1,2\n")
    assert read_published(path).name == "fig6"
    np.testing.assert_array_equal(read_published(path).torque[:, 3], [1.0, 2.0])


def test_maps_may_be_in_other_units() -> None:
    text = "x_mm,y [mm],tau2_Nm\n10,-20,3\n"
    found = parse_published_map(io.StringIO(text, newline=""), "map.csv")
    np.testing.assert_allclose(found.position, [[0.01, -0.02]])
    assert found.torque[0, 1] == 3.0
