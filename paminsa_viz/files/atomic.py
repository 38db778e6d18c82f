"""Writing a file completely or not at all."""

from __future__ import annotations

import os
import secrets
import stat
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from glob import escape
from pathlib import Path
from typing import Any, TextIO

from paminsa_viz.errors import FileError
from paminsa_viz.interrupts import indivisible, on_interrupt

OPEN_FILES_STAY = sys.platform == "win32"
"""Whether the system refuses to remove or replace a file that is open."""


@contextmanager
def open_atomically(path: str | os.PathLike[str]) -> Iterator[TextIO]:
    """Open a text file (UTF-8, no newline translation) that appears only when it is complete.

    The text goes into a temporary file next to ``path``, which replaces it when the block ends
    well. When the block ends with an error, also by Ctrl-C, ``path`` stays as it was and the
    temporary file is removed; that of a process that was killed is removed by the next writing. A
    symbolic link keeps pointing at the file it names; an existing file keeps its mode, and one that
    is write-protected its content.

    Raises:
        FileError: If the file cannot be created, written or put in place.
    """
    with _written(path, mode="w", encoding="utf-8", newline="") as file:
        yield file


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file of any kind completely or not at all, as `open_atomically` does with a text.

    Raises:
        FileError: If the file cannot be created, written or put in place.
    """
    with _written(path, mode="wb") as file:
        file.write(content)


@contextmanager
def file_errors(
    name: str | os.PathLike[str], action: str, kind: type[FileError] = FileError
) -> Iterator[None]:
    """Let what the operating system refuses within the block be an error that names the file.

    Args:
        name: The file, as the person wrote it.
        action: What was tried: "read" or "written".
        kind: The error's type.

    Raises:
        FileError: Whenever an OSError is raised within.
    """
    try:
        yield
    except OSError as error:
        raise as_file_error(os.fspath(name), error, action, kind) from error


def keep_others_off(
    number: int, name: str | os.PathLike[str], kind: type[FileError] = FileError
) -> bool:
    """Lock an open file until it is closed, or this process is gone.

    Args:
        number: Its descriptor.
        name: The file, as the person wrote it.
        kind: The error's type.

    Returns:
        Whether it is locked; it is not where there are no locks.

    Raises:
        FileError: If another process has locked it.
    """
    locked = _lock(number)
    if locked is False:
        raise kind(os.fspath(name), "is being written by another process")
    return bool(locked)


def _lock(number: int) -> bool | None:
    """Lock an open file until it is closed, or this process is gone.

    Returns:
        Whether it is locked now, which it is not if another has locked it; None where there are no
        locks: on some network disks, and on Windows, where two runs into one file are the person's
        to avoid.
    """
    try:
        import fcntl
    except ImportError:
        return None
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def check_writable(path: str | os.PathLike[str]) -> None:
    """Check that a file can be written, as far as can be told without writing it.

    Raises:
        FileError: If its folder does not exist or allows no new file, or if there is something
            that is no regular file or is write-protected.
    """
    target, _ = _target(path)
    if not target.parent.is_dir():
        raise FileError(os.fspath(path), "cannot be written: its folder does not exist")
    if not os.access(target.parent, os.W_OK):
        raise FileError(os.fspath(path), "cannot be written: its folder allows no new file")


def check_folder(path: Path) -> None:
    """Check that a folder is there or can be made, as far as can be told without making it.

    Raises:
        FileError: If the nearest that exists, of it and the folders above it, is no folder or
            allows no new file.
    """
    with file_errors(path, "written"):
        whole = path.absolute()
        there = next(one for one in (whole, *whole.parents) if one.exists())
    if not there.is_dir():
        raise FileError(str(path), f"cannot be written: {there.name} is not a directory")
    if not os.access(there, os.W_OK):
        raise FileError(str(path), "cannot be written: its folder allows no new file")


def make_folder(path: Path) -> None:
    """Make a folder and those that it is in, where they are not there.

    Raises:
        FileError: If it cannot be made.
    """
    with file_errors(path, "written"):
        path.mkdir(parents=True, exist_ok=True)


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write texts (UTF-8) and other files, all of them or none; folders are made as needed.

    Each is written completely, to the disk, before the first one is put in place.

    Args:
        contents: Contents by the file's path.

    Raises:
        FileError: If a folder or a file cannot be made, written or put in place.
    """
    with _folders_of(contents):
        for path in contents:
            check_writable(path)
        with ExitStack() as files:
            for path, content in contents.items():
                file = files.enter_context(_written(path, mode="wb"))
                file.write(content.encode() if isinstance(content, str) else content)
                file.flush()
                os.fsync(file.fileno())
            with indivisible():
                files.close()


def write_folder(folder: Path, contents: Mapping[str, str | bytes]) -> list[Path]:
    """Write files into a folder, as `write_files` does, and return their paths.

    Args:
        folder: The folder.
        contents: Contents by name; names may have folders of their own.

    Raises:
        FileError: If a folder or a file cannot be made, written or put in place.
    """
    files = {folder / name: content for name, content in contents.items()}
    write_files(files)
    return list(files)


@contextmanager
def _folders_of(paths: Iterable[Path]) -> Iterator[None]:
    """Make the folders of files; those that are new are removed again if the block fails."""
    new: list[Path] = []
    try:
        for folder in dict.fromkeys(path.parent for path in paths):
            missing = [part for part in (folder, *folder.parents) if not os.path.exists(part)]
            new += reversed(missing)
            make_folder(folder)
        yield
    except BaseException:
        for folder in reversed(new):
            with suppress(OSError):
                folder.rmdir()
        raise


@contextmanager
def _written(path: str | os.PathLike[str], **how: Any) -> Iterator[Any]:
    name = os.fspath(path)
    target, mode = _target(path)
    temporary: Path | None = None
    number: int | None = None
    lock: int | None = None

    def remove() -> None:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()

    def interrupt() -> None:
        if OPEN_FILES_STAY and number is not None:
            with suppress(OSError):  # it is closed already
                os.close(number)
        remove()

    with on_interrupt(interrupt):
        try:
            with indivisible():
                _remove_abandoned(target)
                temporary, number, lock = _new_temporary(target)
            with open(number, **how) as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            if mode is not None:
                os.chmod(temporary, mode)
            with indivisible():
                os.replace(temporary, target)
        except OSError as error:
            raise as_file_error(name, error, "written") from error
        finally:
            remove()
            if lock is not None:
                os.close(lock)


def _new_temporary(target: Path) -> tuple[Path, int, int | None]:
    """Make a temporary file next to a target, and lock it.

    Returns:
        The file and two descriptors, one to write with, and one, or None where there are no locks,
        that keeps the lock until it is closed too.

    Raises:
        OSError: If it cannot be made.
    """
    while True:
        path = target.with_name(f"{_beginning(target)}{secrets.token_hex(4)}.tmp")
        number = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        locked = _lock(number)
        # Until it was locked another process may have taken it for an abandoned one.
        if locked is not False and path.exists():
            return path, number, os.dup(number) if locked else None
        os.close(number)


def _remove_abandoned(target: Path) -> None:
    """Remove temporary files that a process has left which was killed while it wrote a target."""
    with suppress(OSError):  # a folder that cannot be read
        for path in target.parent.glob(f"{escape(_beginning(target))}{'[0-9a-f]' * 8}.tmp"):
            with suppress(OSError):
                if OPEN_FILES_STAY:  # so nobody writes one that can be removed
                    path.unlink()
                    continue
                with open(path, "rb") as file:
                    if _lock(file.fileno()):  # nobody writes it
                        path.unlink()


def _beginning(target: Path) -> str:
    return f".{target.name[:50]}."


def _target(path: str | os.PathLike[str]) -> tuple[Path, int | None]:
    """Return the file that a path names, and the mode of the one that is there, if there is one.

    Raises:
        FileError: If there is something that is no regular file, or is write-protected.
    """
    name = os.fspath(path)
    try:
        target = Path(os.path.realpath(path))  # fails in a folder that has been removed
        try:
            found = target.stat().st_mode
        except FileNotFoundError:
            return target, None
    except (OSError, ValueError) as error:
        raise as_file_error(name, error, "written") from error
    if not stat.S_ISREG(found):
        kind = "a folder" if stat.S_ISDIR(found) else "not a regular file"
        raise FileError(name, f"cannot be written: it is {kind}")
    if not os.access(target, os.W_OK):  # its folder alone decides whether it can be replaced
        raise FileError(name, "cannot be written: it is write-protected")
    return target, stat.S_IMODE(found)


def as_file_error(
    name: str, error: OSError | ValueError, action: str, kind: type[FileError] = FileError
) -> FileError:
    """Return an operating system's error as one line that names the file as the person wrote it."""
    if isinstance(error, FileError):
        return error
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    if isinstance(error, FileNotFoundError) and action == "written":
        reason = "its folder does not exist"
    elif isinstance(error, FileExistsError):  # of a folder that was to be made
        reason = "a file has this name; a folder is needed"
    elif isinstance(error, PermissionError) and action == "written" and OPEN_FILES_STAY:
        reason += "; another program may have it open"
    return kind(name, f"cannot be {action}: {reason[:1].lower()}{reason[1:]}")
