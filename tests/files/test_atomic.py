"""A file is replaced completely or stays as it was."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from paminsa_viz import interrupts
from paminsa_viz.errors import FileError
from paminsa_viz.files import atomic
from paminsa_viz.files.atomic import (
    check_folder,
    check_writable,
    make_folder,
    open_atomically,
    write_bytes,
    write_files,
    write_folder,
)


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


@pytest.fixture
def small_disk() -> Iterator[None]:
    """A disk on which no file can have more than 100 kB."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.usefixtures("small_disk")
def test_of_files_written_together_a_full_disk_leaves_none(tmp_path) -> None:
    old = tmp_path / "old.txt"
    old.write_text("old")
    names = [old, tmp_path / "new/inner/a.txt", tmp_path / "new/b.bin", tmp_path / "c.txt"]
    contents: list[str | bytes] = ["θ", "new", b"large" * 30_000, "new"]
    with pytest.raises(FileError, match=r"b\.bin.*cannot be written: file too large"):
        write_files(dict(zip(names, contents, strict=True)))
    assert list(tmp_path.iterdir()) == [old]
    assert old.read_text() == "old"
    contents[2] = b"\r\n"
    write_files(dict(zip(names, contents, strict=True)))
    assert [path.read_bytes() for path in names] == ["θ".encode(), b"new", b"\r\n", b"new"]
    assert sorted(tmp_path.rglob("*.*")) == sorted(names)


def test_files_are_on_the_disk_before_any_is_in_place_and_no_interrupt_parts_them(
    tmp_path, monkeypatch
) -> None:
    seen: list[object] = []
    steps = depth = 0

    @contextmanager
    def step() -> Iterator[None]:
        nonlocal steps, depth
        steps += depth == 0
        depth += 1
        try:
            yield
        finally:
            depth -= 1

    replace = os.replace
    monkeypatch.setattr(atomic, "indivisible", step)
    monkeypatch.setattr(os, "fsync", lambda number: seen.append(os.fstat(number).st_size))
    monkeypatch.setattr(
        os, "replace", lambda *paths: (seen.append(("step", steps, depth > 0)), replace(*paths))
    )
    write_files({tmp_path / "a.txt": "one", tmp_path / "b.bin": b"three"})
    assert seen[:2] == [3, 5]
    first, second = (one for one in seen if isinstance(one, tuple))
    assert first == second
    assert first[2]


WRITING = """
import sys, time
from paminsa_viz.files.atomic import open_atomically
with open_atomically(sys.argv[1]) as file:
    file.write("half")
    file.flush()
    print("writing", flush=True)
    time.sleep(60)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there are no locks there")
def test_what_a_killed_process_left_is_removed_by_the_next_writing(tmp_path) -> None:
    path = tmp_path / "a[1].txt"
    path.write_text("old")
    others = tmp_path / "mine.tmp", tmp_path / ".a[1].txt.keep.tmp"
    for each in others:
        each.touch()

    def start() -> subprocess.Popen[str]:
        command = [sys.executable, "-c", WRITING, str(path)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        assert process.stdout.readline() == "writing\n"
        return process

    def temporary() -> list[Path]:
        return sorted(set(tmp_path.iterdir()) - {path, *others})

    killed, living = start(), start()
    assert len(temporary()) == 2
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    assert path.read_text() == "old"
    write_bytes(path, b"new")
    assert len(temporary()) == 1  # of the one that still writes
    living.kill()
    living.communicate()
    write_bytes(path, b"newer")
    assert temporary() == []
    assert path.read_text() == "newer"
    assert all(each.exists() for each in others)


def test_one_who_writes_the_same_file_meanwhile_is_left_alone(tmp_path) -> None:
    path = tmp_path / "a.txt"
    with open_atomically(path) as file:
        file.write("last")
        write_bytes(path, b"meanwhile")
        assert path.read_text() == "meanwhile"
    assert path.read_text() == "last"
    assert list(tmp_path.iterdir()) == [path]


def test_what_another_takes_for_abandoned_before_it_is_locked_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one holds the lock of the first file, and has removed the second."""
    pytest.importorskip("fcntl")
    real, seen = atomic._lock, []

    def lock(number: int) -> bool | None:
        new = set(tmp_path.iterdir()) - set(seen)
        seen.extend(new)
        if len(seen) == 2:
            new.pop().unlink()
        return len(seen) > 1 and real(number)

    monkeypatch.setattr(atomic, "_lock", lock)
    write_bytes(tmp_path / "a.bin", b"whole")
    assert len(seen) == 3
    assert set(tmp_path.iterdir()) == {seen[0], tmp_path / "a.bin"}
    assert (tmp_path / "a.bin").read_bytes() == b"whole"


def test_what_cannot_be_written_is_known_before(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    for name in ("a.txt", "new.txt"):
        check_writable(tmp_path / name)
    for name, words in (
        ("none/a.txt", "its folder does not exist"),
        ("folder", "it is a folder"),
        ("pipe", "it is not a regular file"),
        ("a.txt/b.txt", "cannot be written: not a directory"),
        ("a\0b", "cannot be written: "),
    ):
        with pytest.raises(FileError, match=words):
            check_writable(tmp_path / name)
    assert (tmp_path / "a.txt").read_text() == "old"
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(FileError, match="its folder allows no new file"):
        check_writable(tmp_path / "new.txt")


def test_a_write_protected_file_is_not_replaced(tmp_path: Path, monkeypatch) -> None:
    """The system would let it be: its folder can be written to."""
    path, link = tmp_path / "log.csv", tmp_path / "link.csv"
    path.write_text("measured")
    path.chmod(0o444)
    link.symlink_to(path)
    # as it is for all but the system's administrator
    monkeypatch.setattr(os, "access", lambda one, _: bool(Path(one).stat().st_mode & 0o200))
    for name in (path, link):
        for write in (check_writable, lambda one: write_bytes(one, b"results")):
            with pytest.raises(FileError, match="csv: cannot be written: it is write-protected"):
                write(name)
    assert path.read_text() == "measured"
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_what_is_no_folder_is_known_before(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "a.txt").write_text("old")
    for name in (".", "new", "new/deeper"):
        check_folder(tmp_path / name)
    for name in ("a.txt", "a.txt/b/c"):
        with pytest.raises(FileError, match=r"cannot be written: a\.txt is not a directory"):
            check_folder(tmp_path / name)
    with pytest.raises(FileError, match="cannot be written: "):
        check_folder(tmp_path / ("long" * 200))
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(FileError, match="its folder allows no new file"):
        check_folder(tmp_path / "new" / "deeper")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_folders_are_made_with_those_that_they_are_in(tmp_path: Path) -> None:
    make_folder(tmp_path / "a" / "b")
    make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="cannot be written: "):
        make_folder(tmp_path / "file" / "c")
    written = write_folder(tmp_path / "kit", {"a.txt": "one", "sub/b.bin": b"two"})
    assert written == [tmp_path / "kit" / "a.txt", tmp_path / "kit" / "sub" / "b.bin"]
    assert [path.read_bytes() for path in written] == [b"one", b"two"]


def test_a_file_that_is_written_stays_locked_until_it_is_in_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also after it is closed: another writer would take it for one that a kill has left."""
    fcntl = pytest.importorskip("fcntl")
    replaced = []

    def replace(source: Path, target: Path, real=os.replace) -> None:
        with open(source, "rb") as file, pytest.raises(BlockingIOError):
            fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        replaced.append(target)
        real(source, target)

    monkeypatch.setattr(os, "replace", replace)
    write_bytes(tmp_path / "a.bin", b"whole")
    assert replaced == [tmp_path / "a.bin"]
    with open(tmp_path / "a.bin", "rb") as file:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)  # and no longer


def test_where_open_files_stay_neither_a_stop_nor_a_kill_leaves_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, where there are no locks either."""
    opened: set[int] = set()

    def unlink(path: Path, real=os.unlink) -> None:
        found = []
        for number in opened:
            with suppress(OSError):  # it is closed
                found.append(os.path.samestat(os.fstat(number), os.stat(path)))
        if any(found):
            raise PermissionError("it is open")
        real(path)

    def noted(*given: Any, real=os.open) -> int:
        opened.add(number := real(*given))
        return number

    monkeypatch.setattr(atomic, "OPEN_FILES_STAY", True)
    monkeypatch.setattr(atomic, "_lock", lambda number: None)
    monkeypatch.setattr(os, "unlink", unlink)
    monkeypatch.setattr(os, "open", noted)
    path = tmp_path / "a.txt"
    writing = open_atomically(path)
    writing.__enter__().write("half")
    assert len(list(tmp_path.iterdir())) == 1
    interrupts._actions[-1]()  # as Ctrl-C does, which ends the process then
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(FileError):
        writing.__exit__(None, None, None)
    (tmp_path / ".a.txt.0123abcd.tmp").touch()
    with open_atomically(path) as file:
        file.write("last")
        write_bytes(path, b"meanwhile")  # the file that is being written stays
    assert path.read_text() == "last"
    assert list(tmp_path.iterdir()) == [path]


def test_a_table_that_another_program_has_open_is_said_to_be_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On Windows nothing replaces a file that Excel shows."""

    def refuse(source: Path, target: Path) -> None:
        raise PermissionError(errno.EACCES, "Access is denied")

    monkeypatch.setattr(os, "replace", refuse)
    for stay, hint in ((True, "; another program may have it open"), (False, "")):
        monkeypatch.setattr(atomic, "OPEN_FILES_STAY", stay)
        with pytest.raises(FileError) as caught:
            write_bytes(tmp_path / "a.csv", b"")
        assert str(caught.value).endswith(f"a.csv: cannot be written: access is denied{hint}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="a folder that is in use cannot be removed")
def test_a_current_folder_that_has_been_removed_is_named_with_the_file(
    tmp_path, monkeypatch
) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    with pytest.raises(FileError, match=r"^a\.txt: cannot be written: its folder does not exist$"):
        write_bytes("a.txt", b"")
