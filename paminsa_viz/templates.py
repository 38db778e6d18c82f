"""The environment that templates of pages and reports are filled in with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.resources.abc import Traversable

from jinja2 import (
    BaseLoader,
    BytecodeCache,
    Environment,
    FileSystemBytecodeCache,
    StrictUndefined,
    TemplateNotFound,
)


class _Folders(BaseLoader):
    """Templates of folders, also of a package that is imported from a zip file."""

    def __init__(self, folders: Sequence[Traversable]) -> None:
        self.folders = folders

    def get_source(
        self, environment: Environment, template: str
    ) -> tuple[str, str, Callable[[], bool]]:
        for folder in self.folders:
            file = folder.joinpath(template)
            if file.is_file():
                return file.read_text("utf-8"), str(file), lambda: True
        raise TemplateNotFound(template)


def _kept_code() -> BytecodeCache | None:
    """Return where compiled templates are kept between runs, in a folder of this user's alone.

    Compiling those of a page's first tab takes as long as all else of its first picture.
    """
    try:
        return FileSystemBytecodeCache()
    except (RuntimeError, OSError):  # no such folder can be had
        return None


def html_environment(folders: Sequence[Traversable]) -> Environment:
    """Return an environment for HTML: all but `Markup` is escaped, and unknown names are errors.

    Args:
        folders: Where templates are looked for.
    """
    return Environment(
        loader=_Folders(folders),
        bytecode_cache=_kept_code(),
        autoescape=True,
        undefined=StrictUndefined,
        auto_reload=False,
        trim_blocks=True,
        lstrip_blocks=True,
    )
