"""Published torques over time: read in any unit of time, interpolated, never extrapolated."""

from __future__ import annotations

import io

import numpy as np
import pytest

from paminsa_viz.files.errors import TableFileError
from paminsa_viz.files.published_table import parse_published


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
    with pytest.raises(TableFileError) as caught:
        parsed(f"# a comment\nt_s,tau1_Nm\n{rows}")
    assert caught.value.row == place + 3  # the comment and the header are rows 1 and 2
    assert caught.value.column == "t_s"
