"""Put the binary of another platform into an FMU, from the sources inside it.

    python3 add_platform.py paminsa_plant.fmu win64 x86_64-w64-mingw32-gcc
    python3 add_platform.py paminsa_plant.fmu darwin64 "zig cc -target aarch64-macos"
    python3 add_platform.py paminsa_plant.fmu linux64 gcc

Platforms are FMI's: linux64, linux32, win64, win32, darwin64. Any compiler for C99 will do.
"""

from __future__ import annotations

import io
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import zipfile

ENDINGS = {
    "linux64": ".so", "linux32": ".so", "win64": ".dll", "win32": ".dll", "darwin64": ".dylib",
}  # fmt: skip


class NotBuilt(Exception):
    """A binary could not be made, or there is no FMU to put it into; the text says why."""


def with_platform(fmu: bytes, platform: str, compiler: str) -> bytes:
    """Return an FMU with the binary of one more platform.

    Args:
        fmu: The FMU, with its sources.
        platform: Name of the platform.
        compiler: The C compiler, with options of its own if need be.

    Raises:
        NotBuilt: If it is no FMU with sources, or if there is no such platform or compiler, or the
            compiler fails.
    """
    ending = ENDINGS.get(platform)
    if ending is None:
        raise NotBuilt(f"there is no platform {platform!r}; there are {', '.join(ENDINGS)}")
    try:
        with zipfile.ZipFile(io.BytesIO(fmu)) as archive:
            inside = {name: archive.read(name) for name in archive.namelist()}
    except zipfile.BadZipFile as error:
        raise NotBuilt(f"it is no FMU, which is a zip file ({error})") from None
    sources = {os.path.basename(n): text for n, text in inside.items() if n.startswith("sources/")}
    model = next((name for name in sources if name.endswith(".c")), None)
    if model is None:
        raise NotBuilt("it has no C sources in its folder sources/")
    binary = model[:-2] + ending
    try:
        command = compiler_words(compiler)
    except ValueError as error:
        raise NotBuilt(f"compiler {compiler!r}: {error}") from None
    if not command:
        raise NotBuilt("a compiler has to be named")
    command += ["-std=c99", "-O2", "-ffp-contract=off", "-shared"]
    windows = platform.startswith("win")  # has no library m: clang would look for m.lib
    command += [] if windows else ["-fPIC", "-fvisibility=hidden"]
    command += [model, "-o", binary, *([] if windows else ["-lm"])]
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(text)
        try:
            done = subprocess.run(
                command, cwd=folder, capture_output=True, encoding="utf-8", errors="replace"
            )
        except OSError as error:
            raise NotBuilt(f"{compiler}: {error.strerror}") from None
        if done.returncode:
            said = " ".join(done.stderr.split())[:500] or f"exit code {done.returncode}"
            raise NotBuilt(f"{compiler} failed: {said}")
        if not os.path.exists(os.path.join(folder, binary)):
            raise NotBuilt(f"{compiler} made no {binary}")
        with open(os.path.join(folder, binary), "rb") as file:
            inside[f"binaries/{platform}/{binary}"] = file.read()
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in inside.items():
            info = zipfile.ZipInfo(name)
            info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(info, content)
    return stream.getvalue()


def compiler_words(compiler: str, separator: str = os.sep) -> list[str]:
    """Return the words of a compiler's command; a path alone may have spaces.

    Args:
        compiler: The command.
        separator: What separates the folders of a path; it escapes nothing.

    Raises:
        ValueError: If a quotation is not closed.
    """
    if shutil.which(compiler):
        return [compiler]
    lexer = shlex.shlex(compiler, posix=True)
    lexer.whitespace_split, lexer.commenters = True, ""
    lexer.escape = lexer.escape.replace(separator, "")
    return list(lexer)


def main(words: list[str]) -> int:
    """Run the program with the words of a command; return its exit code."""
    if len(words) != 3:
        print(__doc__)
        return 2
    path, platform, compiler = words
    try:
        with open(path, "rb") as file:
            made = with_platform(file.read(), platform, compiler)
        with open(path + ".new", "wb") as file:
            file.write(made)
        os.replace(path + ".new", path)
    except (NotBuilt, OSError) as error:
        print(f"{path}: {getattr(error, 'strerror', None) or error}", file=sys.stderr)
        return 1
    print(f"{path}: has a binary for {platform}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
