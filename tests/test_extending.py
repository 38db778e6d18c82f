"""What `docs/extending.md` promises: one entry, and it is on the page, in commands, in exports."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import paminsa_viz
from paminsa_viz.cli import map as map_command
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.dock import MapsPanel
from paminsa_viz.explorer.features.export import exports
from paminsa_viz.explorer.features.export.tab import export_entries
from paminsa_viz.explorer.kit.entries import ButtonGroup, given
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.files.tables import TABLE_FORMATS, table_csv
from paminsa_viz.model import APPENDIX_4, Grid, backend, solve_field
from paminsa_viz.notebook import map_view
from paminsa_viz.plots.formats import FIGURE_FORMATS, FigureFormat
from paminsa_viz.quantities import QUANTITIES, Quantity
from paminsa_viz.studies.sweeps import sweep
from tests.support import commands
from tests.support.desk import desk_with

pytestmark = pytest.mark.slow


def eccentricity(m: Any, x: Any, y: Any, c: Any, s: Any, z: Any) -> tuple[Any]:
    """A formula of a pose as it would stand in a file of its own."""
    return (np.hypot(x, y) / m.base_radius,)


@pytest.fixture
def quantity(monkeypatch: pytest.MonkeyPatch) -> Iterator[Quantity]:
    """A quantity that only this test knows; commands read the registry when they are loaded."""
    made = Quantity(
        "eccentricity", "ecc", "eccentricity", "Distance from the axis over R_b", "1",
        backend.Formula(eccentricity, 1),
    )  # fmt: skip
    with monkeypatch.context() as patch:
        patch.setitem(QUANTITIES, made.key, made)
        importlib.reload(map_command)
        yield made
    importlib.reload(map_command)


def test_a_quantity_is_swept_drawn_written_and_chosen(
    quantity: Quantity, capsys, tmp_path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    grid = Grid.over((0.0, 0.1, 0.2, -0.5), x=np.linspace(-0.1, 0.15, 11))
    expected = np.hypot(grid.axes[0][1], 0.1) / 0.35
    field = solve_field(APPENDIX_4.geometry, grid)
    np.testing.assert_allclose(quantity.over(field, APPENDIX_4), expected, rtol=1e-14)
    found = sweep(APPENDIX_4, grid, (quantity.key,)).largest[quantity.key]
    assert found == pytest.approx(expected.max())
    words = ("--quantity", quantity.key, "--cells", "20", "--out", "a.csv", "--out", "a.svg")
    printed = commands.run_json("map", capsys, *words)
    assert 0 < printed["maps"][quantity.key]["largest"] < 2
    assert "ecc" in Path("a.csv").read_text()
    assert quantity.title in Path("a.svg").read_text()
    state = initial_state().updated("map_view", quantity=quantity.key)
    exported = exports.table(state.updated("export", single=True), MapStore(), "csv")
    assert b"ecc" in exported.content
    assert map_view(quantity=quantity.key, cells=20).data


def test_a_quantity_is_chosen_on_the_page(quantity: Quantity, server: Any) -> None:
    with desk_with(server, partial(MapsPanel, answers=())) as desk:
        desk.set("Family", quantity.family)
        desk.until(lambda: quantity.label in desk.handle("Show").options)
        desk.set("Show", quantity.label)
        desk.until(lambda: desk.state.map_view.quantity == quantity.key)


def buttons(key: str) -> set[str]:
    """The texts of a row of buttons on the export tab."""
    entries = {entry.key: entry for entry in export_entries(MapStore())}
    row = entries[key]
    assert isinstance(row, ButtonGroup)
    return set(given(row.choices, initial_state()))


@pytest.mark.parametrize(
    ("registry", "name", "writer", "written", "rows"),
    [
        (TABLE_FORMATS, "tsv", lambda table: table_csv(table).replace(b",", b"\t"), b"\t",
         ("export.table", "export.series")),
        (FIGURE_FORMATS, "eps", FigureFormat("eps"), b"%!PS", ("export.figure", "export.curves")),
    ],
    ids=["table", "figure"],
)  # fmt: skip
def test_a_format_is_written_by_commands_and_offered_on_the_page(
    registry: dict[str, Any], name: str, writer: Any, written: bytes, rows: tuple[str, str],
    capsys, tmp_path, monkeypatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(registry, name, writer)
    for command, words in (("map", ("--cells", "20")), ("trajectory", ("--rate", "50"))):
        commands.run_json(command, capsys, *words, "--out", f"{command}.{name}")
        assert written in Path(f"{command}.{name}").read_bytes()
    assert name.upper() in buttons(rows[0]) & buttons(rows[1])
    if registry is TABLE_FORMATS:
        assert exports.table(initial_state(), MapStore(), name).name.endswith(f".{name}")


CHANGES = {
    "model/parameters.py": (
        '    j9: float = parameter(0.259, "m_9", "kg", "joint 9, B8 to B4 (knee)")\n',
        '{}    j10: float = parameter(0.0, "m_10", "kg", "stop at the end of the guide link")\n',
    ),
    "model/lumped.py": (
        ("    m9: Any\n", "{}    m10: Any\n"),
        ("mc8 = m.B10 * (guide_link * guide_link) / 8.0",
         "{} + m.m10 * (guide_link * guide_link) / 2.0"),
    ),
    "engines/mechanism.py": ("foot, (guide,),", "foot, (guide, joint(10, behind)),"),
}  # fmt: skip
"""The three files of the worked example: old text, and what replaces it."""

CHECK = """
import numpy as np
from paminsa_viz.cli import main
from paminsa_viz.engines.verification import verify
from paminsa_viz.explorer.kit.design_numbers import GROUPS
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, mass_matrix
from paminsa_viz.trajectory import PRESET

assert "joints.j10" in [p.path for group in GROUPS for p in group.parameters]
stopped = APPENDIX_4.vary({"joints.j10": 0.7})
pose = [0.05, -0.02, 0.3, -0.5]
assert np.abs(mass_matrix(stopped, pose) - mass_matrix(APPENDIX_4, pose)).max() > 1e-3
save_design(stopped, "stopped.toml")
assert "j10_kg = 0.7" in open("stopped.toml").read()
assert main(["design", "check", "stopped.toml"]) == 0
found = verify(stopped, PRESET["arch"].build(stopped.geometry).lasting(0.3).sample(rate=50.0))
assert found.passed, found.worst
"""


@pytest.mark.usefixtures("mujoco")
def test_a_mass_with_its_slider_takes_three_files(tmp_path) -> None:
    package = tmp_path / "paminsa_viz"
    source = Path(paminsa_viz.__file__).parent
    shutil.copytree(source, package, ignore=shutil.ignore_patterns("*.nb?"))
    for name, changes in CHANGES.items():
        text = (package / name).read_text()
        for old, new in [changes] if isinstance(changes[0], str) else changes:
            assert text.count(old) == 1, (name, old)
            text = text.replace(old, new.format(old))
        (package / name).write_text(text)
    setting = os.environ | {"PYTHONPATH": str(tmp_path), "PAMINSA_VIZ_BACKEND": "numpy"}
    done = subprocess.run(
        [sys.executable, "-c", CHECK], cwd=tmp_path, env=setting, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
