"""Errors of the engines."""

from __future__ import annotations

from paminsa_viz.model.errors import PaminsaError


class EngineMissing(PaminsaError, ImportError):
    """A physics engine is asked for that is not installed.

    Attributes:
        engine: Its name.
        extra: The optional extra of this package that brings it.
    """

    def __init__(self, engine: str, extra: str = "verify") -> None:
        self.engine = engine
        self.extra = extra
        super().__init__(
            f"{engine} is not installed; it comes with the extra '{extra}': "
            f"pip install 'paminsa-viz[{extra}]'"
        )
