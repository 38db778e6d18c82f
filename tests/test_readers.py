"""Whatever a file, a share code or a saved tab holds: it is read, or refused in one line."""

from __future__ import annotations

import base64
import io
import json
import zlib
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz import files
from paminsa_viz.errors import PaminsaError
from paminsa_viz.explorer.core import persistence, tab_store
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.files.design_file import read_content
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.files.drive_catalog import read_catalog
from paminsa_viz.files.logs import parse_log
from paminsa_viz.files.measurements import parse_measurements
from paminsa_viz.files.plain_data import (
    LARGEST_INTEGER,
    MOST_LEVELS,
    UnusableData,
    parse_json,
    parse_plain_toml,
)
from paminsa_viz.files.trajectory_table import parse_trajectory
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.synthesis import Regime
from paminsa_viz.synthesis.search.case import Effort
from paminsa_viz.synthesis.search.case_file import EXAMPLES, load_case
from paminsa_viz.synthesis.search.checkpoint import Checkpoint
from paminsa_viz.synthesis.search.outer import RegimeState, search_round
from tests.support.mutations import mutants
from tests.synthesis.search_cases import CYLINDER

ROBOT = replace(
    APPENDIX_4,
    counterweights=(Counterweight("b8", 8, 0.1, 1.0),),
    drives=(Drive("motor", 1e-6, envelope=((0.0, 1.0), (9.0, 0.5))), None, None, None),
)
NEEDED = Requirements((Requirement("condition", high=10.0),))
DOCUMENT = Document(design=ROBOT, pose=(0.0, 0.0, 0.1, -0.5), requirements=NEEDED)
COUNT = len(CYLINDER.paths)
ROWS = tuple(map(tuple, np.random.default_rng(1).uniform(size=(6, COUNT)).tolist()))
LOW, HIGH = CYLINDER.bounds.T
REACHED = RegimeState(
    Regime.SMALLER, 20, 352, ROWS, tuple((0.5 * (LOW + HIGH)).tolist()), (0.6,) * 20
)


def read_file(name: str, read: Callable[[Path], object], folder: Path, text: str) -> None:
    path = folder / name
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    read(path)


def read_checkpoint(path: Path) -> None:
    """Read one, and go on from what is taken."""
    short = replace(CYLINDER, effort=Effort(21, 4))
    with Checkpoint(path, CYLINDER) as found:
        for state in found.states:
            evaluator: Any = _Costs(short)
            search_round(evaluator, state, generations=1)


class _Costs:
    """An evaluator whose costs are no work."""

    regime = Regime.SMALLER

    def __init__(self, case: Any) -> None:
        self.case = case

    def costs(self, rows: Any, *_: Any) -> list[float]:
        return [float(np.sum(row)) for row in rows]


@cache
def checkpoint_text(folder: Path) -> str:
    path = folder / "valid.json"
    with Checkpoint(path, CYLINDER) as file:
        file.save((REACHED,))
    return path.read_text()


def open_packed(folder: Path, text: str) -> None:
    packed = zlib.compress(text.encode("utf-8", "surrogatepass"), 1)
    persistence.open_share_code("PMZ1-" + base64.urlsafe_b64encode(packed).decode().rstrip("="))


def read_table(parse: Callable[..., object], folder: Path, text: str) -> None:
    parse(io.StringIO(text, newline=""), "up.csv")


def motion_csv() -> str:
    rows = [f"{0.1 * t:.2f},{0.01 * t:.3f},0.0,0.1,-0.5" for t in range(8)]
    return "\n".join(["t_s,x_m,y_m,theta_rad,z_m", *rows, ""])


CATALOG = """kind,name,source,rotor_inertia_g_cm2,rated_torque_mNm,peak_torque_mNm,rated_speed_rpm,\
top_speed_rpm,gear_ratio,efficiency
motor,M 40,generic,100,120,500,3000,5000,,
gear,G 20,generic,,,,,,20,0.8
"""
LOG = Path(files.__file__).parent / "example_log.csv"
MEASURED = "theta1_rad,theta2_rad,theta3_rad,Z_m,x_mm,y_mm,theta_deg,z_mm\n" + 6 * (
    "0.1,0.2,-0.1,-0.3,1.0,2.0,3.0,-500.0\n"
)

READERS: dict[str, tuple[Callable[[Path], str], Callable[[Path, str], object]]] = {
    "design file": (
        lambda _: write_design(ROBOT, requirements=NEEDED),
        lambda _, text: read_content(text, "up.toml"),
    ),
    "case file": (
        lambda _: EXAMPLES["arch"].read_text("utf-8"),
        partial(read_file, "case.toml", load_case),
    ),
    "checkpoint": (checkpoint_text, partial(read_file, "at.json", read_checkpoint)),
    "document": (lambda _: persistence.dump(DOCUMENT), lambda _, text: persistence.load(text)),
    "saved tab": (
        lambda _: tab_store.dump(initial_state(ROBOT)),
        lambda _, text: tab_store.restore(initial_state(), text),
    ),
    "share code": (lambda _: persistence.dump(DOCUMENT), open_packed),
    "catalog": (lambda _: CATALOG, lambda _, text: read_catalog(text, "up.csv")),
    "motion": (lambda _: motion_csv(), partial(read_table, parse_trajectory)),
    "measurements": (lambda _: MEASURED, partial(read_table, parse_measurements)),
    "log": (
        lambda _: "".join(LOG.read_text("utf-8").splitlines(True)[:40]),
        partial(read_table, parse_log),
    ),
}  # fmt: skip
"""What is valid, and what reads it, by the kind of what comes from elsewhere."""


@pytest.mark.slow
@pytest.mark.parametrize("kind", READERS)
@settings(max_examples=100)
@given(data=st.data())
def test_mutants_are_read_or_refused_in_one_line(
    kind: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.getbasetemp()
    valid, read = READERS[kind]
    text = data.draw(mutants(valid(folder)))
    try:
        with np.errstate(all="ignore"):  # as commands do
            read(folder, text)
    except PaminsaError as error:
        message = str(error)
        assert message.isprintable(), message
        assert len(message) < 1000


@pytest.mark.parametrize("kind", READERS)
def test_what_is_mutated_is_valid(kind: str, tmp_path: Path) -> None:
    valid, read = READERS[kind]
    checkpoint_text.cache_clear()
    read(tmp_path, valid(tmp_path))


TEXTS = st.text(st.characters(exclude_categories=["Cs"]))
LEAVES = st.none() | st.booleans() | st.floats() | st.integers() | TEXTS


@pytest.mark.slow
@given(
    st.recursive(LEAVES, lambda inner: st.lists(inner) | st.dictionaries(TEXTS, inner)),
    st.integers(0, 60),
    st.integers(-(10**30), 10**30),
)
def test_plain_data_is_within_limits_or_refused(data: Any, levels: int, number: int) -> None:
    nested: Any = [data, number]
    for _ in range(levels):
        nested = {"a": nested}
    text = json.dumps(nested)
    depth = levels + 1 + _depth(data)
    if depth > MOST_LEVELS or abs(number) > LARGEST_INTEGER or _large(data):
        with pytest.raises(UnusableData):
            parse_json(text)
    else:
        assert repr(parse_json(text)) == repr(nested)


def _depth(data: Any) -> int:
    parts = data.values() if isinstance(data, dict) else data if isinstance(data, list) else None
    return 0 if parts is None else 1 + max(map(_depth, parts), default=0)


def _large(data: Any) -> bool:
    if isinstance(data, (dict, list)):
        return any(map(_large, data.values() if isinstance(data, dict) else data))
    return type(data) is int and abs(data) > LARGEST_INTEGER


def test_a_number_beyond_limits_is_found_where_it_is() -> None:
    with pytest.raises(UnusableData) as found:
        parse_plain_toml(f"[a]\nb = 1\n[[a.c]]\nd = [1, {'9' * 30}]\n")
    assert found.value.path == "a.c.0.d.1"
