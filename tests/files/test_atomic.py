"""A file is replaced completely or stays as it was."""

from __future__ import annotations

import os

import pytest

from paminsa_viz.files.atomic import open_atomically, write_bytes
from paminsa_viz.files.errors import FileError


def test_text_appears_only_when_the_block_ends(tmp_path) -> None:
    path = tmp_path / "a.txt"
    with open_atomically(path) as file:
        file.write("θ\r\n")
        assert not path.exists()
    assert path.read_bytes() == "θ\r\n".encode()
    assert list(tmp_path.iterdir()) == [path]


def test_bytes_replace_a_file(tmp_path) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"old")
    write_bytes(path, b"\r\n\0\xff")
    assert path.read_bytes() == b"\r\n\0\xff"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(FileError, match="its folder"):
        write_bytes(tmp_path / "no" / "a.bin", b"new")


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, OSError])
def test_an_error_leaves_the_old_text_and_nothing_else(tmp_path, error) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")

    def write() -> None:
        with open_atomically(path) as file:
            file.write("new")
            raise error("stop")

    with pytest.raises(FileError if error is OSError else error):
        write()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_links_and_modes_are_kept(tmp_path) -> None:
    path, link = tmp_path / "a.txt", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    with open_atomically(link) as file:
        file.write("new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_new_file_has_the_default_mode(tmp_path) -> None:
    (tmp_path / "usual").touch()
    with open_atomically(tmp_path / "a.txt"):
        pass
    assert (tmp_path / "a.txt").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_paths_that_are_no_regular_file_are_refused(tmp_path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name, words in [("", "a folder"), ("pipe", "not a regular file"), ("no/a", "its folder")]:
        with pytest.raises(FileError, match=words), open_atomically(tmp_path / name):
            pass
    with pytest.raises(FileError), open_atomically("nul\0byte"):
        pass
    with pytest.raises(FileError, match="too long"), open_atomically(tmp_path / ("a" * 300)):
        pass
