"""Public names of a package that are imported when they are first used.

A package with slow libraries, such as those of figures, lists what is public in ``__all__`` and
imports it where only type checkers look::

    if TYPE_CHECKING:
        from paminsa_viz.files.tables import save_table

    __all__ = ["save_table"]
    __getattr__ = late_names(__name__)

Those imports are carried out one by one, see PEP 562, so that the home of a name stands once.
``dir``, which completes names at a prompt, lists them before.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # that of `typing`, which takes longer to import than all of this
if TYPE_CHECKING:
    from collections.abc import Callable


def late_names(package: str) -> Callable[[str], object]:
    """Return the ``__getattr__`` of a package whose imports stand below ``if TYPE_CHECKING:``.

    The package gets a ``__dir__`` too, unless it has one.

    No name may be that of a module in the package, since importing the module replaces it.

    Args:
        package: The package's full name.
    """
    homes: dict[str, str] = {}
    here = vars(sys.modules[package])
    here.setdefault("__dir__", lambda: sorted({*here, *here["__all__"]}))

    def find(name: str) -> object:
        from importlib import import_module

        homes.update(homes or _homes(package))
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(homes[name]), name)
        here[name] = value
        return value

    return find


def _homes(package: str) -> dict[str, str]:
    """Return the modules of the names that a package imports for type checkers."""
    import ast
    from pkgutil import get_data

    source = get_data(package, "__init__.py") or b""
    return {
        alias.name: str(item.module)
        for block in ast.parse(source).body
        if isinstance(block, ast.If)
        for item in block.body
        if isinstance(item, ast.ImportFrom)
        for alias in item.names
    }
