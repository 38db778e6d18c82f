"""Contour lines of the page in one file are those of contourpy, at the levels of `plots`."""

from __future__ import annotations

import json
import shutil
from typing import Any

import numpy as np
import pytest
from contourpy import LineType, contour_generator

from paminsa_viz.plots.scale import Scale
from tests.explorer.features.one_file.node import run_in_node
from tests.explorer.features.one_file.opened import START

RUN = """
const fields = JSON.parse(fs.readFileSync("fields", "utf8"));
return fields.map(({ values, limit, singular }) =>
  contourLines(values.map((value) => value ?? NaN), Math.sqrt(values.length), limit, singular));
"""

LIMITS = (1.0, 0.3, 20.0, 6e-4)
RADIUS = 0.3085
POINTS = 50  # as many as are contoured: of a finer map every second or third


def middles(count: int) -> np.ndarray:
    return (np.arange(count) + 0.5) / count


def smooth_field(limit: float, holes: bool) -> np.ndarray:
    """A field with saddles that goes beyond its range, and has no value in places."""
    x, y = np.meshgrid(middles(POINTS), middles(POINTS))
    values = 1.3 * limit * np.sin(19 * x + 3 * y) * np.cos(17 * y - 5 * x * y)
    return np.where(holes & (np.hypot(x - 0.3, y - 0.6) < 0.2), np.nan, values)


POLES = [
    (0.02, RADIUS, POINTS),  # next to it, some values are within the range: its place is needed
    (0.02, RADIUS, 161),
    (0.2, 0.0, POINTS),  # all are beyond: it is found where it is not known, as in a difference
]
"""How much the fields with a pole have of it, where it is known to be, and points along a side."""


def field_with_pole(strength: float, count: int) -> np.ndarray:
    """A field that changes sign through infinity on a circle, as torques do."""
    x, y = np.meshgrid(middles(count), middles(count))
    return strength / (np.hypot(x - 0.5, y - 0.5) - RADIUS) + 0.1 * x


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> list[list[dict[str, Any]]]:
    """The lines of the smooth fields, then of those with a pole."""
    if shutil.which("node") is None:
        pytest.skip("no node here")
    fields = [(smooth_field(limit, holes), limit, 0.0) for limit in LIMITS for holes in (0, 1)]
    fields += [(field_with_pole(strength, count), 1.2, at) for strength, at, count in POLES]
    asked = [
        {"values": [None if v != v else v for v in values.ravel().tolist()], "limit": limit,
         "singular": radius}
        for values, limit, radius in fields
    ]  # fmt: skip
    folder = tmp_path_factory.mktemp("contours")
    (folder / "fields").write_text(json.dumps(asked), encoding="utf-8")
    return run_in_node(RUN, [START], folder)


def as_pieces(flat: list[float]) -> np.ndarray:
    """Pieces (n, 2, 2) with their lower end first, in order."""
    pieces = np.array(flat).reshape(-1, 2, 2)
    pieces = np.array([sorted(piece.tolist()) for piece in pieces]).reshape(-1, 4)
    return pieces[np.lexsort(pieces.round(9).T)]


@pytest.mark.slow
def test_pieces_are_those_of_contourpy(found: list[list[dict[str, Any]]]) -> None:
    for index, lines in enumerate(found[: -len(POLES)]):
        limit = LIMITS[index // 2]
        field = smooth_field(limit, bool(index % 2))
        generator = contour_generator(
            middles(POINTS), middles(POINTS), np.ma.masked_invalid(field), name="serial",
            line_type=LineType.Separate, corner_mask=False,
        )  # fmt: skip
        assert [line["level"] for line in lines] == list(Scale(-limit, limit).levels)
        for line in lines:
            wanted = [
                [*first, *second]
                for path in generator.lines(line["level"])
                for first, second in zip(path[:-1].tolist(), path[1:].tolist(), strict=True)
            ]
            assert len(wanted) > 50
            got, expected = as_pieces(line["pieces"]), as_pieces(np.ravel(wanted).tolist())
            np.testing.assert_allclose(got, expected, atol=1e-9)


@pytest.mark.slow
def test_no_line_runs_along_a_pole(found: list[list[dict[str, Any]]]) -> None:
    for lines, (strength, _, _) in zip(found[-len(POLES) :], POLES, strict=True):
        ends = [np.reshape(line["pieces"], (-1, 2)) for line in lines]
        assert sum(map(len, ends)) > 100
        for line, places in zip(lines, ends, strict=True):
            values = strength / (np.hypot(*(places - 0.5).T) - RADIUS) + 0.1 * places[:, 0]
            assert np.abs(values - line["level"]).max(initial=0.0) < 0.2, line["level"]
