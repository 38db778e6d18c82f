"""Round numbers of axes and colors in the page in one file are those of `plots`."""

from __future__ import annotations

import json
import shutil
from typing import Any

import numpy as np
import pytest

from paminsa_viz.plots import ticks
from paminsa_viz.plots.ranges import robust_range
from paminsa_viz.plots.scale import Scale
from paminsa_viz.units import number
from tests.explorer.features.one_file.node import run_in_node
from tests.explorer.features.one_file.opened import START

RUN = """
const {maps, ends, texts, spans} = JSON.parse(fs.readFileSync("asked", "utf8"));
return {
  limits: maps.map((map) => colorLimit([Float64Array.from(map.map((value) => value ?? NaN))], 1)),
  ticks: ends.map(([limit, count]) => multiples(-limit, limit, dividingStep(limit, count))),
  texts: texts.map(roundText),
  steps: spans.map((span) => roundFrom(span, [1, 2, 2.5, 5])),
};
"""


@pytest.fixture(scope="module")
def asked() -> dict[str, list[Any]]:
    rng = np.random.default_rng(3)
    maps = [scale / rng.uniform(1e-3, 1, 200) * rng.choice([-1, 1], 200) for scale in
            (1e-4, 0.3, 1.0, 2.2, 7.0, 40.0)]  # fmt: skip
    maps += [np.linspace(-high, high, 60) for high in (0.7, 1.0, 3.3, 5.6)]
    maps += [np.append(np.linspace(0.9, 1.0, 60), 1.4), np.append(maps[0], np.inf)]
    maps += [np.zeros(9), np.full(9, 1e-12)]
    return {
        "maps": [[*map(float, each), None] for each in maps],  # and a cell without a value
        "ends": [[end * 10.0**power, count] for end in (1, 1.5, 2, 3, 4, 5, 6, 8)
                 for power in (-5, 0, 2) for count in range(4, 9)],
        "texts": [-250.0, 0.0, 0.25, 1e-8, -1.5e-7, 12.5],
        "spans": [10.0**power * part for power in (-3, 0, 4) for part in (1.0, 1.01, 2.3, 9.0)],
    }  # fmt: skip


@pytest.fixture(scope="module")
def found(asked: dict[str, list[Any]], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    if shutil.which("node") is None:
        pytest.skip("no node here")
    folder = tmp_path_factory.mktemp("scales")
    text = json.dumps(asked).replace("Infinity", "1e999")
    (folder / "asked").write_text(text, encoding="utf-8")
    return run_in_node(RUN, [START], folder)


@pytest.mark.slow
def test_colors_end_where_those_of_the_served_page_do(
    asked: dict[str, list[Any]], found: dict[str, Any]
) -> None:
    for values, limit in zip(asked["maps"], found["limits"], strict=True):
        array = np.array([np.nan if each is None else each for each in values])
        assert robust_range(array, signed=True) == pytest.approx((-limit, limit), rel=1e-12)


@pytest.mark.slow
def test_numbers_of_color_bars_and_axes_are_as_round(
    asked: dict[str, list[Any]], found: dict[str, Any]
) -> None:
    for (limit, count), shown in zip(asked["ends"], found["ticks"], strict=True):
        assert shown == pytest.approx(Scale(-limit, limit).ticks(count)), (limit, count)
    assert found["texts"] == [number(value) for value in asked["texts"]]
    for span, step in zip(asked["spans"], found["steps"], strict=True):
        assert step == ticks.nice_step(span, 1), span
