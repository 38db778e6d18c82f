"""Tables of logs: what is read, in which units, what is refused, and the logs that are shipped."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput, TableFileError
from paminsa_viz.files.example_logs import EXAMPLES, ExampleLog, example_log, given_log
from paminsa_viz.files.logs import log_table, parse_log, read_log
from paminsa_viz.files.tables import table_csv
from paminsa_viz.identification import make_log
from tests.support.identification_logs import clean_signals

RATE = 200.0
MOVED = "t_s,theta1_rad,theta2_rad,theta3_rad,Z_m"
TORQUES = "torque1_Nm,torque2_Nm,torque3_Nm,force4_N"
CURRENTS = "current1_A,current2_A,current3_A,current4_A"


@pytest.fixture
def signals() -> list[Any]:
    """Four seconds of times, positions and torques, which a test may spoil."""
    return [array.copy() for array in clean_signals(1, duration=4.0, rate=RATE)]


def read(text: str, **options: Any) -> Any:
    return parse_log(io.StringIO(text, newline=""), "robot.csv", **options)


def test_a_written_log_is_read_again_in_any_unit_and_order(signals: list[Any]) -> None:
    log = make_log(*signals)
    text = table_csv(log_table(log)).decode()
    again = read(text)
    np.testing.assert_array_equal(again.torque, log.torque)
    np.testing.assert_array_equal(again.position, log.position)
    assert again.rate == pytest.approx(RATE)
    t, position, torque = signals
    rows = np.column_stack([position[:, 3] * 1e3, np.degrees(position[:, :3]), torque / 2.0, t])
    head = "Z_mm,theta1_deg,theta2_deg,theta3_deg,current1_A,current2_A,current3_A,current4_A,t_s\n"
    stream = io.StringIO()
    np.savetxt(stream, rows, delimiter=",", fmt="%.17g")
    other = read(head + stream.getvalue(), gains=(2.0, 2.0, 2.0, 2.0))
    np.testing.assert_allclose(other.position, log.position, rtol=1e-13)
    np.testing.assert_allclose(other.torque, log.torque, rtol=1e-13)
    with pytest.raises(TableFileError, match="currents need gains"):
        read(head + stream.getvalue())


def test_missing_columns_are_named() -> None:
    with pytest.raises(TableFileError, match="column Z_m: the column is missing"):
        read("t_s,theta1_rad,theta2_rad,theta3_rad\n0,0,0,0\n")
    with pytest.raises(TableFileError, match="torques are missing"):
        read("t_s,theta1_rad,theta2_rad,theta3_rad,Z_m\n0,0,0,0,0\n")
    with pytest.raises(TableFileError, match="with torque columns come"):
        read("t_s,theta1_rad,theta2_rad,theta3_rad,Z_m,torque1_Nm\n0,0,0,0,0,0\n")


def test_columns_are_named_in_the_units_of_the_file() -> None:
    """A file in degrees must not be told to call them radians."""
    for head, words in (
        ("t_ms,theta1_deg,Z_mm", "theta2_deg.* needs t_ms,theta1_deg,theta2_deg,theta3_deg,Z_mm$"),
        ("t_s,theta1_deg,theta2_deg,theta3_deg", "Z_m: the column is missing"),
        ("t_s,Theta1_deg,theta2_deg,theta3_deg,Z_mm", "did you mean theta1_deg"),
        ("t_s,theta1_deg,theta2_deg,theta3_deg,z_mm", "did you mean Z_mm"),
    ):
        with pytest.raises(TableFileError, match=words):
            read(f"{head},{TORQUES}\n")


@pytest.mark.parametrize(
    ("head", "gains", "words"),
    [
        (f"{MOVED},{TORQUES},{CURRENTS}", None, "there are torques and currents; leave out one"),
        (MOVED, None, f"torques are missing: {TORQUES}, or currents with gains"),
        (f"{MOVED},{CURRENTS}", None, "currents need gains"),
        (f"{MOVED},{TORQUES}", (1.0, 1.0, 1.0, 1.0), "gains are for currents"),
    ],
    ids=["both", "neither", "no gains", "gains of torques"],
)
def test_torques_or_currents_with_gains_are_needed(head: str, gains: Any, words: str) -> None:
    zeros = ",".join(["0"] * len(head.split(",")))
    with pytest.raises(TableFileError, match=f"robot.csv: {words}"):
        read(f"{head}\n{zeros}\n", gains=gains)


@pytest.mark.parametrize("gains", [(1.0, 1.0, 1.0), (1.0, 1.0, 0.0, 1.0), (1.0, np.nan, 1.0, 1.0)])
def test_gains_are_four_numbers_other_than_nothing(gains: tuple[float, ...]) -> None:
    with pytest.raises(InvalidInput, match="gains: four numbers other than 0 are needed"):
        read(f"{MOVED},{CURRENTS}\n{','.join('0' * 9)}\n", gains=gains)


def test_degrees_read_as_radians_are_refused_with_the_row_of_the_file(signals: list[Any]) -> None:
    signals[1][:, :3] = np.degrees(signals[1][:, :3])
    text = io.StringIO()
    np.savetxt(text, np.column_stack(signals), delimiter=",")
    head = "# a comment\nt_s,theta1_rad,theta2_rad,theta3_rad,Z_m,"
    head += "torque1_Nm,torque2_Nm,torque3_Nm,force4_N\n"
    row = 3 + int(np.flatnonzero((np.abs(signals[1][:, :3]) > 2 * np.pi).any(axis=1))[0])
    named = rf"row {row}, column (theta\d)_rad.*degrees is \1_deg$"
    with pytest.raises(TableFileError, match=named):
        read(head + text.getvalue())
    # Degrees are what these are in already.
    signals[1][:, :3] *= 360.0
    text = io.StringIO()
    np.savetxt(text, np.column_stack(signals), delimiter=",")
    with pytest.raises(TableFileError, match=r"_deg: .* full turn; check the unit of the column$"):
        read(head.replace("_rad", "_deg") + text.getvalue())


def test_what_a_written_log_says_of_itself_and_a_gap_that_splits_it(
    signals: list[Any], tmp_path: Path
) -> None:
    kept = np.r_[0:400, 420:800]
    log = make_log(*(array[kept] for array in signals), split=True, name="first")
    table = log_table(log)
    assert table.provenance["log"] == "first"
    assert table.provenance["samples"] == "780"
    assert float(table.provenance["rate [1/s]"]) == log.rate
    assert table.provenance["note 1"] == log.notes[0] == "split at 1 gap"
    path = tmp_path / "moved.csv"
    path.write_bytes(table_csv(table))
    again = given_log(str(path), split=True)
    assert (again.name, again.starts) == ("moved", (0, 400))
    begin = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if line[:3] == "t_s")
    assert again.row(0) == begin + 1
    for reader in (read_log, given_log):
        with pytest.raises(TableFileError, match=f"row {begin + 401}, column t_s: .*at gaps"):
            reader(str(path))


def test_gaps_are_refused_unless_they_are_to_split(signals: list[Any]) -> None:
    kept = np.r_[0:400, 420:800]
    text = table_csv(log_table(make_log(*(one[kept] for one in signals), split=True))).decode()
    assert read(text, split=True).starts == (0, 400)
    with pytest.raises(TableFileError, match=r"column t_s: .*split it at gaps \(--split on"):
        read(text)


def test_a_log_without_rows_is_refused() -> None:
    with pytest.raises(TableFileError, match="at least 10 rows; there are 0"):
        read(f"{MOVED},{TORQUES}\n")


@pytest.mark.slow
def test_the_shipped_logs_are_twenty_seconds_each_by_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    logs = {name: given_log(name) for name in EXAMPLES}
    for log in logs.values():
        assert (len(log.t), log.rate) == (5001, pytest.approx(250.0))
    best, other, loaded = logs.values()
    assert np.array_equal(example_log().torque, best.torque)
    assert np.abs(best.position - other.position).max() > 0.1
    # 2 kg on the platform: M4 lifts k times their weight in the mean, M1 to M3 little of it
    more = np.abs(loaded.torque[:, 3]).mean() - np.abs(best.torque[:, 3]).mean()
    assert more == pytest.approx(3.0 * 2.0 * 9.81, rel=0.05)
    assert example_log(ExampleLog.PAYLOAD).name == "example_log_payload"
    # a file of that name comes first
    monkeypatch.chdir(tmp_path)
    Path("example").write_bytes(table_csv(log_table(other)))
    assert np.array_equal(given_log("example").torque, other.torque)
