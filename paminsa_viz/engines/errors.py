"""Errors of the engines."""

from __future__ import annotations

from paminsa_viz.model.errors import PaminsaError


class EngineMissing(PaminsaError, ImportError):
    """A physics engine is asked for that is not installed, or does not load.

    Attributes:
        engine: Its name.
        extra: The optional extra of this package that brings it.
    """

    def __init__(self, engine: str, cause: ImportError | None = None) -> None:
        self.engine = engine
        self.extra = "verify"
        broken = cause is not None and not isinstance(cause, ModuleNotFoundError)
        super().__init__(
            f"{engine} {f'does not load ({cause})' if broken else 'is not installed'}; "
            f"it comes with the extra '{self.extra}': pip install 'paminsa-viz[{self.extra}]'"
        )
