"""Tables in blocks, texts with any letters, published values at their ends, wrong bytes."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest

from paminsa_viz.files import tables
from paminsa_viz.files.design_file import decode_text
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.files.published_table import PublishedTorques
from paminsa_viz.files.tables import DataTable, table_csv, table_npz, table_text


def test_a_table_is_the_same_in_blocks_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    table = DataTable(
        {"n": np.arange(7).astype(str), "x": np.arange(7.0).reshape(1, 7)}, {"made by": "a test, τ"}
    )
    whole = table_csv(table)
    assert whole.decode().splitlines()[-7:] == [f"{n},{float(n)}" for n in range(7)]
    for size in (1, 3, 7):
        monkeypatch.setattr(tables, "ROWS_AT_ONCE", size)
        assert table_csv(table) == whole
    assert table_text(table).splitlines()[-7:] == [f"{n}\t{float(n)}" for n in range(7)]


def test_the_provenance_of_a_binary_table_is_readable_text() -> None:
    table = DataTable({"x": np.arange(2.0)}, {"made by": "a test, τ"})
    with np.load(io.BytesIO(table_npz(table))) as arrays:
        text = str(arrays["provenance"])
        assert list(arrays) == ["x", "provenance"]
    assert "τ" in text
    assert json.loads(text) == {"made by": "a test, τ"}
    other = DataTable({"x": np.arange(2.0)}, {}, {"matrix": np.eye(3)})
    with np.load(io.BytesIO(table_npz(other))) as arrays:
        assert list(arrays) == ["matrix", "provenance"]


def test_published_values_hold_from_their_first_time_to_their_last() -> None:
    torque = np.arange(12.0).reshape(3, 4)
    table = PublishedTorques("other", np.array([0.0, 1.0, 3.0]), torque)
    found = table.at(np.array([-0.1, 0.0, 0.5, 3.0, 3.1]))
    assert np.isnan(found[[0, 4]]).all()
    np.testing.assert_allclose(found[[1, 3]], torque[[0, 2]])
    np.testing.assert_allclose(found[2], torque[:2].mean(axis=0))
    computed = torque[[0, 2]] + 1.5
    off = table.differences(np.array([0.0, 3.0]), computed)
    np.testing.assert_allclose(off[[0, 2]], 1.5)
    np.testing.assert_allclose(off[1], torque[0] + (torque[2] - torque[0]) / 3 + 1.5 - torque[1])
    inside = table.differences(np.array([0.5, 2.0]), torque[:2])
    assert np.isnan(inside[[0, 2]]).all()
    assert np.isfinite(inside[1]).all()


@pytest.mark.parametrize("lines", range(4))
def test_the_line_of_a_byte_that_is_no_text_is_named(lines: int) -> None:
    """Lines are counted from the first byte on, empty ones too."""
    with pytest.raises(DesignFileError, match="is not a text file") as caught:
        decode_text(b"\n" * lines + b"\x80", "a.toml")
    assert caught.value.line == lines + 1
    assert decode_text(b"\n" * lines + b"a = 1", "a.toml") == "\n" * lines + "a = 1"
