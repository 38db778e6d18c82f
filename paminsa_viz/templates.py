"""The environment that templates of pages and reports are filled in with."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jinja2 import (
    BytecodeCache,
    Environment,
    FileSystemBytecodeCache,
    FileSystemLoader,
    StrictUndefined,
)


def _kept_code() -> BytecodeCache | None:
    """Return where compiled templates are kept between runs, in a folder of this user's alone.

    Compiling those of a page's first tab takes as long as all else of its first picture.
    """
    try:
        return FileSystemBytecodeCache()
    except (RuntimeError, OSError):  # no such folder can be had
        return None


def html_environment(folders: Sequence[Path]) -> Environment:
    """Return an environment for HTML: all but `Markup` is escaped, and unknown names are errors.

    Args:
        folders: Where templates are looked for.
    """
    return Environment(
        loader=FileSystemLoader(folders),
        bytecode_cache=_kept_code(),
        autoescape=True,
        undefined=StrictUndefined,
        auto_reload=False,
        trim_blocks=True,
        lstrip_blocks=True,
    )
