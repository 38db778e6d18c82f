"""Tables of measured poses: what is read, in which units, and what is refused where."""

from __future__ import annotations

from io import StringIO

import numpy as np
import pytest

from paminsa_viz.errors import TableFileError
from paminsa_viz.files import measurements as module
from paminsa_viz.files.measurements import measurement_table, parse_measurements
from paminsa_viz.files.tables import table_bytes
from paminsa_viz.precision.measurements import Measurements

HEAD = "x_m,y_m,theta_rad,z_m,theta1_rad,theta2_rad,theta3_rad,Z_m"
ROW = "0.01,0.02,0.3,-0.5,0.1,0.2,0.3,0.28"


def parse(text: str) -> module.MeasurementTable:
    return parse_measurements(StringIO(text, newline=""), "log.csv")


@pytest.mark.parametrize("width", [4, 6])
def test_a_written_table_reads_back_to_the_last_digit(width: int) -> None:
    random = np.random.default_rng(0)
    written = Measurements(random.normal(size=(5, 4)), random.normal(size=(5, width)))
    text = table_bytes(measurement_table(written, design="a robot"), "csv").decode()
    found = parse(text)
    assert np.array_equal(found.measurements.poses, written.poses)
    assert np.array_equal(found.measurements.actuators, written.actuators)
    lines = text.splitlines()
    header = next(row for row, line in enumerate(lines, 1) if line.startswith("x_m"))
    assert found.first_row == header + 1
    assert "# design: a robot" in lines


def test_units_and_order_are_free() -> None:
    head = "Z [mm],tilty_deg,theta1_deg,theta2_deg,theta3_deg,tiltx_deg,x_mm,y_mm,z_mm,theta [°]"
    found = parse(f"{head}\n280,2,10,20,30,1,5,6,-500,90\n").measurements
    assert np.allclose(found.actuators, [[*np.radians([10, 20, 30]), 0.28]])
    wanted = [[0.005, 0.006, np.pi / 2, -0.5, *np.radians([1, 2])]]
    assert np.allclose(found.poses, wanted)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "log.csv: is empty; a header row with x_m"),
        (HEAD.replace(",Z_m", ""), "column Z_m: the column is missing; a measured pose needs"),
        (HEAD.replace("z_m", "z"), "row 1, column z: its unit is missing; write z_m or z_mm"),
        (HEAD.replace("z_m", "z_inch"), "'inch' is no unit of it; write z_m or z_mm"),
        (f"{HEAD},tiltx_rad\n{ROW},0", "column tilty_rad: the column is missing; with tilt"),
        (HEAD, "there is no measured pose in it"),
        (f"{HEAD}\n{ROW}\n{ROW.replace('0.02', 'nan')}", "row 3, column y_m: 'nan' is not"),
        (f"{HEAD}\n{ROW.replace('0.02', '')}", "row 2, column y_m: the value is missing"),
        (f"{HEAD}\n{ROW},1", "row 2"),
        (f"{HEAD},weight_kg\n{ROW},1", "column weight_kg: there is no such column"),
    ],
    ids=[
        "empty", "no Z", "no unit", "unit", "half a tilt", "no rows", "nan", "blank", "long", "more"
    ],
)  # fmt: skip
def test_other_tables_are_refused_with_their_place(text: str, place: str) -> None:
    with pytest.raises(TableFileError) as caught:
        parse(text)
    assert place in str(caught.value)
    assert "\n" not in str(caught.value)


def test_too_many_rows_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_ROWS", 2)
    with pytest.raises(TableFileError, match="more than 2 measured poses"):
        parse("\n".join([HEAD, ROW, ROW, ROW]))
