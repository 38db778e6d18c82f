"""The mesh files are what the program makes, and are found wherever the package runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from paminsa_viz.meshes import __main__ as program
from paminsa_viz.meshes import library
from paminsa_viz.meshes.catalog import CATALOGUE
from paminsa_viz.meshes.materials import SURFACES


def test_the_files_kept_are_the_files_made(tmp_path: Path) -> None:
    library.write_meshes(tmp_path)
    kept = library.checkout_folder()
    assert {p.name for p in tmp_path.iterdir()} == {p.name for p in kept.iterdir()}
    for path in tmp_path.glob("*.glb"):
        made = trimesh.load_scene(path, process=False)
        old = trimesh.load_scene(kept / path.name, process=False)
        assert list(made.geometry) == list(old.geometry)
        for name, mesh in made.geometry.items():
            assert mesh.vertices == pytest.approx(old.geometry[name].vertices, abs=1e-7)
            assert np.array_equal(mesh.faces, old.geometry[name].faces)
    assert (tmp_path / "README.md").read_text() == (kept / "README.md").read_text()


def test_writing_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    first = {p.name: p.read_bytes() for p in library.write_meshes(tmp_path / "a")}
    second = {p.name: p.read_bytes() for p in library.write_meshes(tmp_path / "b")}
    assert first == second


def test_the_table_lists_every_file() -> None:
    table = (library.checkout_folder() / "README.md").read_text()
    for fitting in CATALOGUE:
        assert f"`{fitting.name}.glb`" in table
        assert fitting.purpose in table


@pytest.mark.parametrize("fitting", CATALOGUE, ids=lambda f: f.name)
def test_each_part_comes_back_from_its_file(fitting) -> None:
    made, read = fitting.make(), library.fixed_part(fitting.name)
    assert {p.material for p in made.pieces} == {p.material for p in read.pieces} <= set(SURFACES)
    assert read.bounds() == pytest.approx(made.bounds(), abs=1e-7)
    for (name, ours), (other, theirs) in zip(made.merged(), read.merged(), strict=True):
        assert name == other
        assert len(ours.faces) == len(theirs.faces)
        assert ours.area == pytest.approx(theirs.area, rel=1e-5)


@pytest.mark.parametrize("fitting", CATALOGUE, ids=lambda f: f.name)
def test_every_solid_of_a_part_is_closed(fitting) -> None:
    for piece in fitting.make().pieces:
        whole = piece.mesh.copy()
        whole.merge_vertices(merge_norm=True, merge_tex=True)
        assert whole.is_watertight, piece.material
        assert whole.volume > 0


def test_files_stand_upright_in_programs_with_y_up() -> None:
    scene = trimesh.load_scene(library.checkout_folder() / "lift_motor.glb")
    made = next(f for f in CATALOGUE if f.name == "lift_motor").make().bounds()
    assert scene.bounds[:, 1] == pytest.approx(made[:, 2], abs=1e-6)


def test_the_package_has_the_first_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    packaged = tmp_path / "assets" / "meshes"
    library.write_meshes(packaged)
    monkeypatch.setattr(library.resources, "files", lambda name: tmp_path)
    library.mesh_folder.cache_clear()
    try:
        assert Path(str(library.mesh_folder())) == packaged
    finally:
        library.mesh_folder.cache_clear()


def test_missing_files_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library.resources, "files", lambda name: tmp_path)
    monkeypatch.setattr(library, "checkout_folder", lambda: tmp_path / "nowhere")
    library.mesh_folder.cache_clear()
    try:
        with pytest.raises(library.MissingMeshes, match=r"python -m paminsa_viz\.meshes"):
            library.mesh_folder()
    finally:
        library.mesh_folder.cache_clear()


def test_unknown_part() -> None:
    with pytest.raises(KeyError):
        library.fixed_part("../secret")


def test_the_command_writes_where_it_is_told(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "paminsa_viz.meshes", str(tmp_path / "out")],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert len(done.stdout.splitlines()) == len(CATALOGUE) + 1
    assert (tmp_path / "out" / "slider.glb").read_bytes()[:4] == b"glTF"


@pytest.mark.parametrize("arguments", [["--help"], ["a", "b"]])
def test_the_command_refuses_what_it_does_not_know(arguments: list[str], capsys) -> None:
    assert program.main(arguments) == 2
    assert "usage" in capsys.readouterr().err
