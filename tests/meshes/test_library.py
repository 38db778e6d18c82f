"""The mesh files equal the script's output, and are found in checkout and package."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from paminsa_viz.errors import InvalidInput
from paminsa_viz.meshes import part
from paminsa_viz.meshes.part import SURFACES
from tests.meshes.make_parts import ASSETS, script

pytestmark = pytest.mark.slow


PARTS = pytest.mark.parametrize("make", script.PARTS, ids=lambda make: make.__name__)


def names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*.*")}


def test_the_files_are_those_that_the_script_makes(tmp_path: Path) -> None:
    """The same in this process and as a program, with the instructions that any processor has."""
    first = {path: path.read_bytes() for path in script.write_parts(tmp_path)}
    command = [sys.executable, str(ASSETS / "make_parts.py"), str(tmp_path)]
    found: Any = np.show_config(mode="dicts")
    more = " ".join(found["SIMD Extensions"].get("found", []))  # by which NumPy sorts otherwise
    plain = {**os.environ, "NPY_DISABLE_CPU_FEATURES": more}
    said = subprocess.run(command, env=plain, capture_output=True, text=True, check=True).stdout
    assert first == {path: path.read_bytes() for path in map(Path, said.splitlines())}
    kept = part.checkout_folder()
    assert names(tmp_path) == names(kept)
    for path in tmp_path.rglob("*.glb"):
        made = trimesh.load_scene(path, process=False)
        old = trimesh.load_scene(kept / path.relative_to(tmp_path), process=False)
        assert list(made.geometry) == list(old.geometry)
        for name, mesh in made.geometry.items():
            assert mesh.vertices == pytest.approx(old.geometry[name].vertices, abs=1e-7)
            assert np.array_equal(mesh.faces, old.geometry[name].faces)
    assert (tmp_path / "README.md").read_text() == (kept / "README.md").read_text()


@PARTS
def test_a_part_comes_back_from_its_file_closed_and_upright(make) -> None:
    made, read = make(), part.fixed_part(make.__name__)
    assert {s.material for s in made.solids} == {s.material for s in read.solids} <= set(SURFACES)
    assert read.bounds() == pytest.approx(made.bounds(), abs=1e-7)
    for (name, ours), (other, theirs) in zip(made.merged(), read.merged(), strict=True):
        assert name == other
        assert len(ours.faces) == len(theirs.faces)
        assert ours.area == pytest.approx(theirs.area, rel=1e-5)
    for solid in made.solids:
        whole = solid.mesh.copy()
        whole.merge_vertices(merge_norm=True, merge_tex=True)
        assert whole.is_watertight, solid.material
        assert whole.volume > 0
    scene = trimesh.load_scene(part.checkout_folder() / f"{make.__name__}.glb")
    assert scene.bounds[:, 1] == pytest.approx(made.bounds()[:, 2], abs=1e-6)  # y is up there


def test_packaged_meshes_have_precedence_and_missing_ones_are_named(tmp_path, monkeypatch) -> None:
    kept = part.checkout_folder()
    monkeypatch.setattr(part.resources, "files", lambda name: tmp_path)
    monkeypatch.setattr(part, "checkout_folder", lambda: tmp_path / "nowhere")
    part.mesh_folder.cache_clear()
    try:
        with pytest.raises(part.MissingMeshes, match=r"python assets/make_parts\.py"):
            part.mesh_folder()
        packaged = tmp_path / "assets" / "meshes"
        shutil.copytree(kept, packaged)
        assert Path(str(part.mesh_folder())) == packaged
    finally:
        part.mesh_folder.cache_clear()


@pytest.mark.parametrize("name", ["../secret", "none", ""])
def test_an_unknown_part_is_refused(name: str) -> None:
    with pytest.raises(InvalidInput, match="there is no"):
        part.fixed_part(name)


@pytest.mark.parametrize("words", [["--help"], ["a", "b"]])
def test_the_script_refuses_other_arguments(words, capsys) -> None:
    assert script.main(words) == 2
    assert "usage" in capsys.readouterr().err
