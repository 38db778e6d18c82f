"""The search for least distances, compiled by Numba once that pays.

Compiling takes some ten seconds the first time, loading it from disk half a second later on; a
pose takes some 30 ms in plain Python and 20 us compiled.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from paminsa_viz.clearance import search
from paminsa_viz.clearance.shapes import shapes_of
from paminsa_viz.model import backend
from paminsa_viz.model.design import APPENDIX_4

WORTH = 30
"""Number of poses from which plain Python would take longer than loading the compiled search."""


class _Search:
    """The compiled search, made once."""

    def __init__(self) -> None:
        self.function: Any = None
        self.requested = 0
        self.lock = threading.Lock()
        self.thread: threading.Thread | None = None

    def compiled(self) -> Any:
        """Return the compiled search, and wait for it; without Numba the plain one."""
        with backend.loading, self.lock:
            if self.function is None:
                found = _compile() if backend.can_compile() else search.least_distances
                self.function = found
            return self.function

    def get(self, poses: int) -> Any:
        """Return `search.least_distances` for a number of poses: compiled if that pays.

        While it is compiled in the background, few poses do not wait for it.
        """
        self.requested += poses
        waiting = self.thread is not None and self.thread.is_alive()
        if self.function is None and (poses < WORTH if waiting else self.requested < WORTH):
            return search.least_distances
        return self.compiled()


_search = _Search()
least_distances = _search.get
compiled = _search.compiled


def compile_in_background() -> threading.Thread:
    """Compile the search, or load it from disk, in a thread."""
    thread = threading.Thread(
        target=_search.compiled, name="paminsa-compile-clearance", daemon=True
    )
    _search.thread = thread
    thread.start()
    return thread


def _compile() -> Any:
    from paminsa_viz.model.compiled import OPTIONS, kernel, nothing, register

    function = search.least_distances
    digest = register(function, inline=False)

    @kernel(**OPTIONS)
    def least(s, position, quaternion, first, second, slot, distance, nearest, points):
        _ = digest
        function(s, position, quaternion, first, second, slot, distance, nearest, points)

    # on no poses: compiles it
    index = nothing(1).astype(np.int64)
    least(
        shapes_of(APPENDIX_4).arrays, nothing(3), nothing(3), index, index, index,
        nothing(2), nothing(2).astype(np.int64), nothing(3),
    )  # fmt: skip
    return least
