"""Which physics engines are installed, and the error that says how to install one."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from typing import Final

from paminsa_viz.errors import PaminsaError

INSTALL: Final = {
    "MuJoCo": ("mujoco", "it is part of the installation: pip install mujoco"),
    "Pinocchio": (
        "pinocchio",
        "it comes with the extra 'verify': pip install 'paminsa-viz[verify]'",
    ),
}
"""Module of each engine, and how it is installed."""


@cache
def why_missing(engine: str) -> str:
    """Return why an engine of `INSTALL` cannot be used, or an empty string; it is not loaded."""
    return "" if find_spec(INSTALL[engine][0]) else str(EngineMissing(engine))


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
