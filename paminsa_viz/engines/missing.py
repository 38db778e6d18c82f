"""Which physics engines are installed, and the error that says how to install one."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from typing import Final

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput, PaminsaError

INSTALL: Final = {
    "MuJoCo": ("mujoco", "it is part of the installation: pip install mujoco"),
    "Pinocchio": (
        "pinocchio",
        'it comes with the extra "verify", on Linux and macOS: pip install "paminsa-viz[verify]"',
    ),
}
"""Module of each engine, and how it is installed."""


@kinds_checked
def why_missing(engine: str) -> str:
    """Return why an engine of `INSTALL` cannot be used, or an empty string; it is not loaded.

    Raises:
        InvalidInput: If there is no engine of this name.
    """
    if engine not in INSTALL:
        raise InvalidInput("engine", f"{' or '.join(INSTALL)} is needed, not {engine!r}")
    return "" if is_installed(engine) else str(EngineMissing(engine))


@cache
def is_installed(engine: str) -> bool:
    """Return whether the module of an engine is there."""
    return find_spec(INSTALL[engine][0]) is not None


class EngineMissing(PaminsaError, ImportError):
    """A requested physics engine is not installed, or does not load.

    Attributes:
        engine: Its name.
    """

    def __init__(self, engine: str, cause: ImportError | None = None) -> None:
        self.engine = engine
        broken = cause is not None and not isinstance(cause, ModuleNotFoundError)
        super().__init__(
            f"{engine} {f'does not load ({cause})' if broken else 'is not installed'}; "
            f"{INSTALL[engine][1]}"
        )
